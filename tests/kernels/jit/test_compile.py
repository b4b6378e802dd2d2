"""Entries take read-only arrays as they take others, outlive a broken cache, and are compiled several at once."""

import os
import pickle
import subprocess
import sys
from functools import partial
from importlib import import_module

import numpy as np
import pytest

import ospace
from ospace.dynamics import evaluator
from ospace.kernels import evaluation
from ospace.kernels.jit import cache, compile, together

COMPILED = hasattr(evaluation.evaluate, "compile")
needs_compiler = pytest.mark.skipif(not COMPILED, reason="kernels run interpreted")

ENTRIES = """
from ospace.kernels.jit.compile import entry

@entry
def total(x, y):
    return x[0] + y[0]

@entry
def product(x, y):
    return x[0] * y[0]

@entry
def difference(x, y):
    return x[0] - y[0]
"""
PYTHON = sys.executable
X, Y = np.full(2, 3.0), np.full(2, 4.0)


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


@pytest.fixture
def folder(monkeypatch, tmp_path, request):
    """A cache of its own, and a module of entries that processes find; returns how to import it anew."""
    name = f"entries_of_{request.node.name.split('[')[0]}"
    (tmp_path / f"{name}.py").write_text(ENTRIES)
    monkeypatch.setenv("OSPACE_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.syspath_prepend(tmp_path)
    cache.directory.cache_clear()

    def load():
        sys.modules.pop(name, None)
        return import_module(name)

    directory = cache.directory
    yield load
    sys.modules.pop(name, None)
    directory.cache_clear()


# -- types of arrays -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def planar():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    v = np.linspace(0.1, 0.8, robot.nv)
    return robot, robot.configuration({robot.joint_names[0]: 0.5}), v


def results(run):
    return [run.inertia.copy(), run.bias_force.copy(), run.bias_acceleration.copy()]


@pytest.mark.parametrize("frozen", [(True, False), (False, True), (True, True)])
def test_read_only_arrays_take_the_straight_way(planar, frozen, monkeypatch):
    robot, q, v = planar
    run = ospace.OperationalSpaceEvaluator(robot, robot.point("end_effector"))
    known = results(run.update(q, v))
    codes = len(evaluation.evaluate.overloads) if COMPILED else 0

    def unexpected(*arguments):
        raise AssertionError("converted")

    monkeypatch.setattr(evaluator, "checked_vector", unexpected)
    run.update(read_only(q) if frozen[0] else q, read_only(v) if frozen[1] else v)
    assert all(map(np.array_equal, known, results(run)))
    if COMPILED:
        assert len(evaluation.evaluate.overloads) == codes


@pytest.mark.parametrize(
    "given",
    [
        list,
        tuple,
        lambda x: np.asfortranarray(np.tile(x, (2, 1)))[0],
        lambda x: np.repeat(x, 2)[::2],
        lambda x: read_only(np.repeat(x, 2))[::2],
        lambda x: x.astype(np.longdouble),
    ],
    ids=["list", "tuple", "fortran", "strided", "strided read-only", "longdouble"],
)
def test_what_is_no_array_of_doubles_is_converted(planar, given):
    robot, q, v = planar
    run = ospace.OperationalSpaceEvaluator(robot, robot.point("end_effector"))
    known = results(run.update(q, v))
    codes = len(evaluation.evaluate.overloads) if COMPILED else 0
    for pair in ((given(q), v), (q, given(v)), (given(q), given(v))):
        assert all(map(np.array_equal, known, results(run.update(*pair))))
    if COMPILED:
        assert len(evaluation.evaluate.overloads) == codes


def test_single_precision_is_converted(planar):
    robot, q, v = planar
    run = ospace.OperationalSpaceEvaluator(robot, robot.point("end_effector"))
    rounded = [x.astype(np.float32).astype(float) for x in (q, v)]
    known = results(run.update(*rounded))
    assert all(map(np.array_equal, known, results(run.update(*(x.astype(np.float32) for x in (q, v))))))


@needs_compiler
def test_interpreted_kernels_take_the_same_arrays():
    chosen = [sys.executable, "-m", "pytest", "-q", "-k", "straight_way or converted", __file__]
    interpreted = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(chosen, capture_output=True, text=True, env=interpreted, check=False)
    assert done.returncode == 0, done.stdout
    assert "skipped" not in done.stdout


@needs_compiler
@pytest.mark.parametrize("shares", [True, False])
def test_read_only_arrays_share_the_code_where_numba_lets_them(folder, monkeypatch, shares):
    monkeypatch.setattr(compile, "_SHARES_CODE", shares)
    total = folder().total
    frozen = read_only(X), read_only(Y)
    assert total(*frozen) == total(X, Y) == total(X, frozen[1]) == 7.0
    assert len(total.overloads) == (1 if shares else 3)


@needs_compiler
def test_other_types_are_refused_where_the_caller_converts(folder):
    total = folder().total
    compile.refuse_other_types(total, (X, Y))
    assert total(read_only(X), Y) == 7.0
    for other in ([3.0], X[::2].astype(np.float32), np.zeros(4)[::2], None):
        with pytest.raises(TypeError):
            total(other, Y)
    assert len(total.overloads) == 1


# -- the cache -----------------------------------------------------------------------------------------------


def with_a_flipped_bit(content, share):
    changed = bytearray(content)
    changed[int(share * (len(content) - 1))] ^= 1
    return bytes(changed)


DAMAGES = {
    "cut short": lambda content: content[:20],
    "empty": lambda content: b"",
    "garbled": lambda content: bytes(reversed(content)),
    "another pickle": lambda content: pickle.dumps(("0", {})),
    **{f"bit at {share:.0%}": partial(with_a_flipped_bit, share=share) for share in np.linspace(0.0, 1.0, 6)},
}


@needs_compiler
@pytest.mark.parametrize("which", ["*.nbi", "*.nbc", "*.nb?"])
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_broken_cache_is_repaired_by_the_first_process(folder, which, damage, tmp_path):
    folder().total(X, Y)
    files = list((tmp_path / "cache").rglob(which))
    assert files
    for file in files:
        file.write_bytes(DAMAGES[damage](file.read_bytes()))
    assert folder().total(X, Y) == 7.0
    again = folder().total
    assert again(X, Y) == 7.0
    assert sum(again.stats.cache_hits.values()) == 1


@needs_compiler
def test_a_child_compiles_for_the_cache(folder):
    entries = folder()
    jobs = [(entries.product, compile.kinds_of((X, Y))), (entries.total, compile.kinds_of((X, Y)))]
    with together._child(lambda: jobs.pop() if jobs else None) as feeder:
        feeder.join()
    assert not entries.total.overloads
    assert entries.total(X, Y) == 7.0
    assert entries.product(X, Y) == 12.0
    for one in (entries.total, entries.product):
        assert sum(one.stats.cache_hits.values()) == 1
        assert not sum(one.stats.cache_misses.values())


@needs_compiler
@pytest.mark.parametrize("executable", [PYTHON, "/nowhere/python", None], ids=["fails", "missing", "unknown"])
def test_all_is_compiled_whatever_becomes_of_children(folder, monkeypatch, executable):
    """An entry that no child can import, a program that is not there."""
    entries = folder()
    monkeypatch.setattr(together, "_cores", lambda: 2)
    monkeypatch.setattr(sys, "executable", executable)
    monkeypatch.setenv("PYTHONPATH", "")
    processes, popen = [], together.subprocess.Popen
    monkeypatch.setattr(together.subprocess, "Popen", lambda *a, **k: processes.append(popen(*a, **k)) or processes[-1])
    seen = []
    monkeypatch.setattr(cache, "listeners", [lambda number, of: seen.append((number, of))])
    together.compile_together((getattr(entries, name), (X, Y)) for name in ("total", "product", "difference"))
    of_all = [(0, 0), (1, 3), (2, 3), (3, 3)]
    if executable == PYTHON:  # the entry of a child that fails, if it came to take one, is compiled here after all
        assert {*of_all} <= {*seen} <= {*of_all, (1, 1)}
    else:
        assert sorted(seen) == of_all
    assert seen[-1] == (0, 0)
    assert all(len(one.overloads) == 1 for one in (entries.total, entries.product, entries.difference))
    assert len(processes) == (executable == PYTHON)
    assert all(process.returncode is not None for process in processes)


@needs_compiler
def test_an_interrupt_leaves_no_process(folder, monkeypatch):
    entries = folder()
    processes, popen = [], together.subprocess.Popen
    monkeypatch.setattr(together.subprocess, "Popen", lambda *a, **k: processes.append(popen(*a, **k)) or processes[-1])
    monkeypatch.setattr(together, "_cores", lambda: 2)

    def interrupt(signature):
        raise KeyboardInterrupt

    monkeypatch.setattr(entries.total, "compile", interrupt)
    with pytest.raises(KeyboardInterrupt):
        together.compile_together((getattr(entries, name), (X, Y)) for name in ("total", "product"))
    assert [process.poll() is not None for process in processes] == [True]


@needs_compiler
def test_without_a_cache_there_are_no_children(folder, monkeypatch):
    entries = folder()
    monkeypatch.setattr(together, "_cores", lambda: 2)
    monkeypatch.setattr(together.cache, "directory", lambda: None)
    monkeypatch.setattr(together, "_child", None)
    together.compile_together((getattr(entries, name), (X, Y)) for name in ("total", "product"))
    assert len(entries.total.overloads) == len(entries.product.overloads) == 1
