"""The code and the printed output of a page in Markdown, in the order in which a reader meets them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

_BLOCKS = re.compile(
    r"^```(?P<language>\w+)(?P<remark>[^\n]*)\n(?P<code>.*?)^```$"
    r"|^<!-- (?P<hidden>python|file (?P<file>\S+))\n(?P<content>.*?)^-->$"
    r"|^<!-- file (?P<next>\S+) -->$",
    re.MULTILINE | re.DOTALL,
)
_NUMBER = re.compile(r"[-+−]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
ALIKE, ROUNDING = 0.02, 1e-3


@dataclass(frozen=True)
class Block:
    """A fenced block, or one that only the tests see, as a comment ``<!-- python …-->`` or ``<!-- file NAME …-->``.

    ``<!-- file NAME -->`` before a fence says that the block is the file of that name. ``text measured`` has figures of
    some machine: any number may stand there.
    """

    language: str
    code: str
    line: int
    file: str = ""
    measured: bool = False


def blocks_of(page: Path) -> Iterator[Block]:
    text, file = page.read_text(encoding="utf-8"), ""
    for match in _BLOCKS.finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        if match["next"]:
            file = match["next"]
        elif match["hidden"]:
            language = "python" if match["hidden"] == "python" else "file"
            yield Block(language, match["content"], line, match["file"] or "")
        else:
            yield Block(match["language"], match["code"], line, file, "measured" in match["remark"])
            file = ""


def commands_of(block: Block) -> Iterator[tuple[str, str]]:
    """Yield each command of a block of text, and what is printed below it."""
    parts = re.split(r"^\$ ((?:.*\\\n)*.*)\n", block.code, flags=re.MULTILINE)
    for command, printed in zip(parts[1::2], parts[2::2], strict=True):
        yield command.replace("\\\n", " "), printed


def differs(printed: str, page: str, *, measured: bool = False) -> str:
    """Return the first line of a page that is not printed, or nothing; ``…`` stands for any lines, or any text of one.

    Numbers are alike to 2 %. Of errors below 1e-3 the size alone counts, and below 1e-8 any is as good: rounding
    differs from one machine to the next. Measured figures are broken into lines by their length: lines do not count.
    """
    if measured:
        joined = " ".join(printed.split())
        same = _alike(joined, " ".join(page.split()), measured=True)
        return "" if same else f"{page!r} is not what is printed: {printed!r}"
    lines = [" ".join(line.split()) for line in printed.splitlines() if line.strip()]
    skipping, place = False, 0
    for asked in (" ".join(line.split()) for line in page.splitlines() if line.strip()):
        if asked == "…":
            skipping = True
            continue
        found = next((k for k in range(place, len(lines)) if _alike(lines[k], asked)), None)
        if found is None or (found != place and not skipping):
            return f"the page has {asked!r}, printed is {lines[place : place + 3]}"
        place, skipping = found + 1, False
    return "" if skipping or place == len(lines) else f"the page lacks {lines[place]!r}"


def _alike(line: str, asked: str, *, measured: bool = False) -> bool:
    pattern = "".join(
        ".*" if part == "…" else rf"({_NUMBER.pattern})" if _NUMBER.fullmatch(part) else re.escape(part)
        for part in re.split(rf"({_NUMBER.pattern}|…)", asked)
    )
    match = re.fullmatch(pattern, line)
    if match is None:
        return False
    numbers = zip(_NUMBER.findall(asked), match.groups(), strict=True)
    return measured or all(_close(*(float(number.replace("−", "-")) for number in pair)) for pair in numbers)


def _close(a: float, b: float) -> bool:
    small = min(abs(a), abs(b))
    if max(abs(a), abs(b)) < ROUNDING:
        return max(abs(a), abs(b)) < 1e-8 or max(abs(a), abs(b)) < 10.0 * small
    return abs(a - b) <= ALIKE * max(abs(a), abs(b))
