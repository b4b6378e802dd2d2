"""A log from anywhere is read or refused, by its headers where it is large; nothing of it is a traceback."""

import io
import json
import os
import random
import resource
import struct
import warnings
import zipfile
from functools import partial

import numpy as np
import pytest

from ospace import OspaceError
from ospace.scenario import log, series
from ospace.simulation import Trajectory
from ospace.visual import plots

MUTATIONS = int(os.environ.get("OSPACE_MUTATIONS", "40"))
GIGABYTE = 1_000_000_000


@pytest.fixture(scope="module")
def good(run, tmp_path_factory):
    return log.save(run, tmp_path_factory.mktemp("good") / "good.npz").read_bytes()


def entries(content):
    with zipfile.ZipFile(io.BytesIO(content)) as file:
        return {name: file.read(name) for name in file.namelist()}


def packed(content, method=zipfile.ZIP_DEFLATED):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as file:
        for name, one in content.items():
            file.writestr(name, one)
    return out.getvalue()


def npy(header, content=b""):
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + content


def with_header(header, content, good):
    return packed(entries(good) | {"phases/0/time.npy": npy(header, content)})


def with_text(text, good):
    array = io.BytesIO()
    np.save(array, np.array(text))
    return packed(entries(good) | {"about.npy": array.getvalue()})


def about(good):
    return json.loads(str(np.load(io.BytesIO(entries(good)["about.npy"]))))


def with_about(change, good):
    read = about(good)
    change(read)
    return with_text(json.dumps(read), good)


def patched(local, central, change, good):
    """Return the file with a number in each header of an entry changed."""
    content = bytearray(good)
    for mark, at in ((b"PK\x03\x04", local), (b"PK\x01\x02", central)):
        found = content.find(mark)
        while found >= 0:
            content[found + at : found + at + 2] = struct.pack("<H", change(content[found + at]))
            found = content.find(mark, found + 4)
    return bytes(content)


def bomb(good, copies=16):
    """Return 4 GB of zeros in 4 MB."""
    zeros = npy(b"{'descr': '<f8', 'fortran_order': False, 'shape': (31250000,), }\n", bytes(250_000_000))
    one = packed({"zeros.npy": zeros})
    with zipfile.ZipFile(io.BytesIO(one)) as file:
        info = file.infolist()[0]
    name = len(b"zeros.npy")
    local = one[: 30 + name + info.compress_size]
    central = one[len(local) : len(one) - 22]
    pointers = [central[:42] + struct.pack("<I", k * len(local)) + central[46:] for k in range(copies)]
    table = b"".join(pointers)
    end = struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, copies, copies, len(table), copies * len(local), 0)
    return local * copies + table + end


def many_entries(good):
    """Return what says that it has 10⁶ entries, which takes seconds to read."""
    central = b"PK\x01\x02" + bytes(42)
    table = central * 1_000_000
    return table + struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, 65535, 65535, len(table), 0, 0)


def hidden_end(good):
    """Return a file whose end leads to another, which counts otherwise."""
    return good[:-22] + b"PK\6\7" + bytes(16) + good[-22:]


def with_remark(content):
    """Return an archive behind whose end stand letters, as the format allows; NumPy writes none."""
    return content[:-2] + struct.pack("<H", 40) + bytes(40)


def set_phase(key, value):
    return partial(with_about, lambda read: read["phases"][0].update({key: value}))


HOSTILE = {
    "empty": lambda good: b"",
    "no archive": lambda good: b"no archive" * 100,
    "cut": lambda good: good[:-100],
    "deep JSON": partial(with_text, "[" * 200_000 + "]" * 200_000),
    "no JSON": partial(with_text, "{"),
    "an integer of 4000 digits": set_phase("start", 10**4000),
    "encrypted": partial(patched, 6, 8, lambda flags: flags | 1),
    "method 9": partial(patched, 8, 10, lambda method: 9),
    "LZMA": lambda good: packed(entries(good), zipfile.ZIP_LZMA),
    "LZMA, corrupted": lambda good: packed(entries(good), zipfile.ZIP_LZMA).replace(b"\x5d\x00", b"\x00\xff"),
    "BZIP2": lambda good: packed(entries(good), zipfile.ZIP_BZIP2),
    "a header that is no literal": partial(with_header, b"'''\n  (\n 1L", b""),
    "a header of brackets": partial(with_header, b"(" * 9000, b""),
    "a header with Python 2's integers": partial(
        with_header, b"{'descr': '<f8', 'fortran_order': False, 'shape': (1L,), }\n", bytes(8)
    ),
    "a header of objects": partial(
        with_header, b"{'descr': '|O', 'fortran_order': False, 'shape': (1,), }\n", bytes(8)
    ),
    "a header with a negative shape": partial(
        with_header, b"{'descr': '<f8', 'fortran_order': False, 'shape': (-1,), }\n", b""
    ),
    "10⁹ rows": partial(
        with_header, b"{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000,), }\n", bytes(800)
    ),
    "10⁹ letters": lambda good: packed(
        {"about.npy": npy(b"{'descr': '<U250000000', 'fortran_order': False, 'shape': (), }\n", bytes(800))}
    ),
    "4 GB": bomb,
    "10⁶ entries": many_entries,
    "another end": hidden_end,
    "a remark": with_remark,
    "10⁶ entries and a remark": lambda good: with_remark(many_entries(good)),
    "a segment of 0.0": set_phase("segment", 0.0),
    "a segment of true": set_phase("segment", True),
    "a segment of -1": set_phase("segment", -1),
    "a name that is a number": set_phase("name", 1),
    "a start of 1e308": set_phase("start", 1e308),
    "an outcome of its own": set_phase("outcome", "glorious"),
    "statuses that are no numbers": set_phase("statuses", {"nominal": "many"}),
    "errors that are a list": set_phase("errors", []),
    "a reason that is a list": set_phase("reason", ["a"]),
    "interrupted by a text": partial(with_about, lambda read: read.update(interrupted="yes")),
    "versions that are numbers": partial(with_about, lambda read: read.update(versions={"pin": 4})),
    "a mass of a text": partial(with_about, lambda read: read["segments"][0]["trajectory"].update(total_mass="heavy")),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_log_is_refused_in_one_line(good, tmp_path, name):
    file = tmp_path / "hostile.npz"
    file.write_bytes(HOSTILE[name](good))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for read in (log.load, Trajectory.load):
        with pytest.raises(OspaceError, match=r"hostile\.npz: ") as refused:
            read(file)
        assert "\n" not in str(refused.value)
        assert len(str(refused.value)) < 1000
    assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024 < 0.5 * GIGABYTE


@pytest.mark.parametrize("content", [b"<robot/>" * 100, b"no archive" * 100])
def test_another_file_is_called_so(tmp_path, content):
    (tmp_path / "robot.urdf").write_bytes(content)
    with pytest.raises(OspaceError, match=r"it is no whole \.npz file of numbers"):
        log.load(tmp_path / "robot.urdf")


@pytest.mark.parametrize("value", [1e308, -1e308, 1e101])
def test_numbers_of_which_nothing_can_be_computed_are_refused(good, tmp_path, value):
    with np.load(io.BytesIO(good)) as read:
        stored = dict(read)
    changed = {name: np.full_like(array, value) for name, array in stored.items() if array.dtype == np.float64}
    changed |= {name: stored[name] for name in changed if name.endswith("time")}
    np.savez(tmp_path / "hostile.npz", **stored | changed)
    with pytest.raises(OspaceError, match=r"array '.*' holds numbers beyond 1e\+100"):
        log.load(tmp_path / "hostile.npz")


@pytest.mark.parametrize("value", [0.0, 1e99, -1e99, np.inf, -np.inf, np.nan])
def test_what_is_read_can_be_drawn(good, tmp_path, value):
    """Of a run that went out of all bounds."""
    with np.load(io.BytesIO(good)) as read:
        stored = dict(read)
    changed = {name: np.full_like(array, value) for name, array in stored.items() if array.dtype == np.float64}
    changed |= {name: stored[name] for name in changed if name.endswith("time")}
    np.savez(tmp_path / "wild.npz", **stored | changed)
    draw(log.load(tmp_path / "wild.npz"), tmp_path)


def draw(read, folder):
    curves = series.of(read)
    plots.save(plots.figure(list(curves.values()), read.phases), folder / "out.svg")


def test_a_pipe_is_no_log(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for file in ("pipe", ""):
        with pytest.raises(OspaceError, match=r"no run can be read from it \(is (not a regular file|a folder)\)"):
            log.load(tmp_path / file)


def mutated(good, seed):
    """Return the log with something in it changed: bytes of the file, of an entry, or a value of its text."""
    chance = random.Random(seed)
    content = entries(good)
    name = chance.choice([*content, *["about.npy"] * 20])
    way = chance.randrange(4)
    if way == 0:
        return with_changed_bytes(good, chance)
    if way == 1:
        return packed(content | {name: with_changed_bytes(content[name], chance)})
    if way == 2:
        return packed({one: part for one, part in content.items() if one != name})
    read = about(good)
    change(read, chance)
    return with_text(json.dumps(read), good)


def with_changed_bytes(content, chance):
    changed = bytearray(content)
    for _ in range(chance.choice([1, 1, 3, 30])):
        changed[chance.randrange(len(changed))] = chance.randrange(256)
    if chance.random() < 0.2:
        del changed[chance.randrange(len(changed)) :]
    return bytes(changed)


VALUES = [
    None,
    True,
    0,
    -1,
    7,
    1e308,
    -1e308,
    1e-320,
    10**400,
    float("nan"),
    float("inf"),
    "",
    "a",
    "$\\frac{$",
    "\x1b[2J",
]
VALUES += ["x" * 300, [], {}, ["a"], {"a": 1}, {"array": "segments/0/trajectory/q"}, {"array": "none"}]


def change(tree, chance):
    """Change one value of a tree."""
    while True:
        keys = list(tree) if isinstance(tree, dict) else range(len(tree))
        if not keys:
            return
        key = chance.choice(keys)
        if isinstance(tree[key], dict | list) and tree[key] and chance.random() < 0.9:
            tree = tree[key]
        elif isinstance(tree, dict) and chance.random() < 0.2:
            tree[chance.choice(["x", "$\\frac{$", "\x1b[2J"])] = tree.pop(key)
            return
        else:
            tree[key] = chance.choice(VALUES)
            return


@pytest.mark.parametrize("seed", range(MUTATIONS))
def test_a_mutated_log_is_drawn_or_refused(good, tmp_path, seed):
    file = tmp_path / "mutated.npz"
    file.write_bytes(mutated(good, seed))
    try:
        read = log.load(file)
    except OspaceError:
        return
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        draw(read, tmp_path)
