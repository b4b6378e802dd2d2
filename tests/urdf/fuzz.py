"""Mutations of sound files: ``PYTHONPATH=tests python -m urdf.fuzz --count 20000 --seed 1``.

Whatever a file holds, nothing dies, and no robot that is made of it has an H that is not finite or is indefinite.
"""

from __future__ import annotations

import argparse
import re
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pinocchio as pin
from urdf.corpus import VARIANTS

import ospace
from ospace.dynamics.dense import Dense

NUMBERS = [
    "0",
    "-1",
    "1e-300",
    "1e400",
    "nan",
    "inf",
    "0x1",
    "1,5",
    " 2 ",
    "1e12",
    "-1e12",
    "1e-12",
    "",
    "3.",
    "1e9",
    "1e200",
    "-1e308",
    "5e-324",
    "1.7976931348623157e308",
]
EXPRESSIONS = [
    "${m}",
    "${m / 0}",
    "${'x' * 10**9}",
    "${[m] * 10**4}",
    "$(arg k)",
    "$(find made)",
    "$(env HOME)",
    "${xacro.load_yaml('mutated.xacro')}",
    "${().__class__}",
    "${float('nan')}",
    "${m",
    "$(eval 2 * 3)",
    "${-m}",
]
WORDS = ["base", "arm", "hand", "hinge", "world", "fixed", "floating", "planar", "continuous", "prismatic", "", "\n"]
TAGS = [
    "<link/>",
    "<joint/>",
    "<inertial/>",
    "</link>",
    "<robot>",
    "<!--",
    "-->",
    "<![CDATA[",
    "&amp;",
    "&#0;",
    "<?x?>",
]
ENCODINGS = ["utf-8", "iso-8859-1", "windows-1252", "utf-16", "utf-16-le", "shift_jis", "cp037", "utf-7"]
XACROS = 8  # one in so many files is a xacro, which takes ten times as long to read
LIMITS = ospace.Limits(seconds=5, memory=300_000_000)
TOLERANCE = 1e-9  # of the unit diagonal: rounding, and the violation that inertias may have


def mutated(rng: np.random.Generator, seeds: list[bytes]) -> bytes:
    """Some changes to one of the seeds."""
    content = seeds[rng.integers(len(seeds))]
    changes = GENTLE if rng.integers(3) else ROUGH  # most of what is rough is no XML any more
    for _ in range(int(rng.integers(1, 4))):
        content = changes[rng.integers(len(changes))](rng, content)
    return content


def with_quaternions(content: bytes) -> bytes:
    """The same file in URDF 1.2, its plain origins turned by a quaternion."""
    turned = re.sub(rb'(<origin xyz="[^"]*")/>', rb'\1 quat_xyzw="0.48 -0.6 0 0.64"/>', content)
    return re.sub(rb"<robot name=", b'<robot version="1.2" name=', turned, count=1)


def encoded(rng: np.random.Generator, content: bytes) -> bytes:
    """The same text otherwise: another encoding, which it may declare, a namespace, a prefix, blank lines before it."""
    text = content.decode("utf-8", errors="replace")
    encoding = ENCODINGS[rng.integers(len(ENCODINGS))]
    for change in rng.choice(5, int(rng.integers(1, 4)), replace=False):
        if change == 0:
            text = text.replace('<?xml version="1.0"?>', f'<?xml version="1.0" encoding="{encoding}"?>', 1)
        elif change == 1:
            text = text.replace("<robot ", '<robot xmlns="http://example.org/r" ', 1)
        elif change == 2:
            text = text.replace("</robot>", "<s:a s:b='ä'/></robot>", 1)
        elif change == 3:
            text = "\n \n" + text
        else:
            text = text.replace("arm", "ärmel")
    return text.encode(encoding, errors="replace")


def as_xacro(content: bytes) -> bytes:
    """The same file as a xacro: its masses are properties, and a macro makes its joints."""
    part = b"""<xacro:property name="m" value="2"/><xacro:arg name="k" default="1"/>
<xacro:macro name="j" params="n"><gazebo a="${n * m}"/></xacro:macro><xacro:j n="$(arg k)"/>"""
    head = re.sub(rb"<robot ", b'<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ', content, count=1)
    return re.sub(rb"(<robot [^<>]*>)", lambda match: match[1] + part, head, count=1).replace(
        b'<mass value="2"/>', b'<mass value="${m}"/>'
    )


def _of(rng: np.random.Generator, choices: list[str]) -> bytes:
    return choices[rng.integers(len(choices))].encode()


def _replace(pattern: bytes, rng: np.random.Generator, content: bytes, new: bytes) -> bytes:
    places = list(re.finditer(pattern, content))
    if not places:
        return content
    place = places[rng.integers(len(places))]
    return content[: place.start()] + new + content[place.end() :]


def _number(rng: np.random.Generator, content: bytes) -> bytes:
    size = 10.0 ** (rng.integers(-2, 2) if rng.integers(2) else rng.integers(-13, 13))
    random = f"{rng.normal() * size:.{rng.integers(1, 17)}g}".encode()
    return _replace(
        rb"(?<=[\" ])-?[0-9][0-9.e+-]*", rng, content, _of(rng, NUMBERS) if rng.integers(4) == 0 else random
    )


def _expression(rng: np.random.Generator, content: bytes) -> bytes:
    return _replace(rb"(?<=\")[^\"<>]*(?=\")", rng, content, _of(rng, EXPRESSIONS))


def _word(rng: np.random.Generator, content: bytes) -> bytes:
    return _replace(rb"(?<=\")[a-z]+(?=\")", rng, content, _of(rng, WORDS))


def _element(rng: np.random.Generator, content: bytes) -> bytes:
    return _replace(rb"<[a-z]+[^<>]*/>", rng, content, b"" if rng.integers(2) else _of(rng, TAGS))


def _attribute(rng: np.random.Generator, content: bytes) -> bytes:
    return _replace(rb" [a-z_]+=\"[^\"]*\"", rng, content, b"")


def _cut(rng: np.random.Generator, content: bytes) -> bytes:
    start = int(rng.integers(len(content) + 1))
    return content[:start] + content[start + int(rng.integers(40)) :]


def _repeat(rng: np.random.Generator, content: bytes) -> bytes:
    start = int(rng.integers(len(content) + 1))
    piece = content[start : start + int(rng.integers(300))]
    to = int(rng.integers(len(content) + 1))
    return content[:to] + piece + content[to:]


def _insert(rng: np.random.Generator, content: bytes) -> bytes:
    at = int(rng.integers(len(content) + 1))
    return content[:at] + (_of(rng, TAGS) if rng.integers(2) else rng.bytes(int(rng.integers(1, 5)))) + content[at:]


def _flip(rng: np.random.Generator, content: bytes) -> bytes:
    if not content:
        return content
    changed = bytearray(content)
    changed[rng.integers(len(content))] ^= 1 << int(rng.integers(8))
    return bytes(changed)


GENTLE = [_number, _number, _number, _number, _word, _element, _attribute]
ROUGH = [_number, _word, _element, _attribute, _cut, _repeat, _insert, _flip]


def verdict(file: Path, rng: np.random.Generator) -> str:
    """Read the file; "robot", or the kind of refusal. Raises where the promise is broken."""
    root = ("base", "arm")[rng.integers(2)] if rng.integers(8) == 0 else None
    try:
        robot = ospace.SpaceRobot.from_urdf(file, free_mimic=bool(rng.integers(2)), root=root, limits=LIMITS)
    except ospace.UrdfError as error:
        return "refused" if error.code in str(error) else f"refused without the code {error.code}"
    except ospace.UnsoundModelError as error:
        errors = [finding for finding in error.findings if finding.severity == "error"]
        return "unsound" if errors else "unsound without an error"
    except ospace.OspaceError as error:
        return "refused" if "to be the root" in str(error) else f"refused: {error}"
    assert all(finding.severity != "error" for finding in robot.findings)
    for _ in range(3):
        q = pin.integrate(robot.model, robot.configuration(), rng.uniform(-3.0, 3.0, robot.nv))
        H = Dense(robot.state(q), []).H
        assert np.isfinite(H).all(), "H is not finite"
        diagonal = np.diag(H)
        assert (diagonal >= -TOLERANCE * np.abs(H).max()).all(), "H has a negative diagonal"
        scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
        smallest = np.linalg.eigvalsh(scale[:, None] * H * scale)[0]
        assert smallest >= -TOLERANCE * len(H), f"H is indefinite: {smallest}"
    return "robot"


def run(count: int, seed: int, folder: Path) -> Counter[str]:
    """Read `count` mutations; the number of each verdict."""
    rng = np.random.default_rng(seed)
    sound = [variant for variant in VARIANTS if len(variant.content) < 5000 and variant.status == 0]
    seeds = [variant.content for variant in sound if variant.file.endswith(".urdf")]
    seeds = [*seeds, *map(with_quaternions, seeds)]
    seeds += [ospace.models.path(name).read_bytes() for name in ("planar_2r", "ets_vii")]
    xacros = [variant.content for variant in sound if variant.file.endswith(".xacro")]
    xacros += [as_xacro(seed) for seed in seeds[::10]]
    counts: Counter[str] = Counter()
    for k in range(count):
        is_xacro = rng.integers(XACROS) == 0
        content = mutated(rng, xacros if is_xacro else seeds)
        if is_xacro and rng.integers(2):
            content = _expression(rng, content)
        if rng.integers(6) == 0:
            content = encoded(rng, content)
        file = folder / ("mutated.xacro" if is_xacro else "mutated.urdf")
        file.write_bytes(content)
        try:
            counts[verdict(file, rng)] += 1
        except Exception as error:
            kept = folder / f"broken_{seed}_{k}{file.suffix}"
            kept.write_bytes(content)
            raise AssertionError(f"{kept}: {type(error).__name__}: {error}") from error
    return counts


if __name__ == "__main__":
    import tempfile

    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--count", type=int, default=20_000)
    options.add_argument("--seed", type=int, default=0)
    given = options.parse_args()
    start = time.perf_counter()
    counted = run(given.count, given.seed, Path(tempfile.mkdtemp()))
    print(f"{given.count} inputs, seed {given.seed}: {dict(counted)} in {time.perf_counter() - start:.0f} s")  # noqa: T201
