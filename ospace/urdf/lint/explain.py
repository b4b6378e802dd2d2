"""Explain the rules: for ``ospace check --explain`` and for docs/findings.md, which is `page()`."""

from __future__ import annotations

from ospace.exceptions import OspaceError, closest
from ospace.urdf.lint.rules import GROUPS, RULES, Rule

_INTRODUCTION = """\
# Findings

Every finding of [`ospace check`](check.md), and every reason to refuse a file, by its code. Codes are stable. The page
is written from `ospace/urdf/lint/rules/`; `ospace check --explain CODE` prints one entry.

- **error**: the model has no sound dynamics. `SpaceRobot.from_urdf` raises `UnsoundModelError` with all findings, the
  command ends with status 1.
- **refused**: the file is not a URDF, or its links do not form a tree. `SpaceRobot.from_urdf` raises `UrdfError`, which
  has the code, and the command ends with status 2.
- **warning**: the model can be computed with, and is hardly what was meant.
- **info**: worth knowing.

Remedies name arguments of `SpaceRobot.from_urdf`. In the shell `--package-dir DIR` is `package_dirs=[DIR]`,
`--root LINK` is `root='LINK'`, `--free-mimic` is `free_mimic=True`, and `--max-nodes N` is `limits=Limits(nodes=N)`.

Codes marked "repaired by `--fix`" are those for which there is one right repair.
"""


def text(name: str) -> str:
    """Write all that is known of a rule, to be read in a terminal.

    Returns
    -------
    str

    Raises
    ------
    OspaceError
        There is no rule of that name.
    """
    if name not in RULES:
        raise OspaceError(f"there is no code '{name}'{closest(name, RULES)}")
    code = RULES[name]
    return (
        f"{code.name} ({level(code)})\n{code.summary}\n\n"
        f"Example  {code.example}\nReason   {code.reason}\nRemedy   {code.remedy}\n"
    )


def page() -> str:
    """Write docs/findings.md.

    Returns
    -------
    str
    """
    parts = [_INTRODUCTION]
    for title, codes in GROUPS.items():
        parts.append(f"\n## {title}\n")
        for code in codes:
            parts.append(
                f"\n### `{code.name}`\n\n*{level(code)}.* {_escaped(code.summary)}\n\n    {code.example}\n\n"
                f"**Reason.** {_escaped(code.reason)}\n\n**Remedy.** {_escaped(code.remedy)}\n"
            )
    return "".join(parts)


def level(code: Rule) -> str:
    """Return the severity of a rule, and whether --fix repairs it.

    Returns
    -------
    str
    """
    gravity = "refused" if code.unreadable else code.severity
    return f"{gravity}, repaired by --fix" if code.fixable else gravity


def _escaped(text: str) -> str:
    """Keep Markdown from taking elements for HTML and J* for emphasis."""
    return text.replace("<", "\\<").replace("*", "\\*")
