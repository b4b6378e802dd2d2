"""Where Ctrl-C is acted on: in ospace and the standard library at once, after an import, soon in other libraries."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import ospace
from ospace.cli import interrupts
from ospace.cli.interrupts import Interrupts

ROOT = Path(ospace.__file__).parents[1]


def function_of(package, body):
    """Return a function ``call(then)`` that belongs to a package."""
    names = {"__name__": f"{package}.made", "time": time}
    exec("def call(then):\n" + "".join(f"    {line}\n" for line in body.splitlines()), names)
    return names["call"]


@pytest.fixture(autouse=True)
def safe(monkeypatch):
    """Functions of this file stand for ones of ospace; nothing is left only because it takes long."""
    monkeypatch.setattr(interrupts, "_SAFE", interrupts._SAFE | {__name__.partition(".")[0]})
    monkeypatch.setattr(interrupts, "_PATIENCE", float("inf"))


def press():
    os.kill(os.getpid(), signal.SIGINT)


def interrupted(*calls):
    """Call functions of ospace one after the other until one is interrupted; return what was done and which it was."""
    did = []
    with Interrupts(interrupted.__code__) as held:
        try:
            for call in calls:
                call(did)
        except KeyboardInterrupt:
            return did, held.seen
        return [*did, "all"], held.seen


in_ospace = function_of("ospace", "then()\ntime.sleep(5)")


def test_ospace_and_the_standard_library_are_left_at_once():
    assert interrupted(lambda did: in_ospace(press)) == ([], True)
    in_the_standard_library = function_of("threading", "then()\ntime.sleep(5)")
    assert interrupted(lambda did: in_the_standard_library(press)) == ([], True)


PATIENT = "for _ in range(20):\n    then()\n    time.sleep(0.01)"


def started_by(package, did, body=PATIENT):
    """Return a function of ospace that interrupts a function of another package in its work, then goes on."""
    work, keys = function_of(package, body), [press]

    def then():
        if keys:
            keys.pop()()
        did.append("work")

    go_on = function_of("ospace", "then()\ntime.sleep(5)\n")
    return lambda _: (work(then), go_on(lambda: did.append("after")))


@pytest.fixture
def patient(monkeypatch):
    monkeypatch.setattr(interrupts, "_PATIENCE", 0.05)


@pytest.mark.parametrize("package", ["importlib", "_frozen_importlib_external"])
@pytest.mark.usefixtures("patient")
def test_an_import_is_finished_first(package):
    did = []
    assert interrupted(started_by(package, did)) == ([], True)
    assert did.count("work") == 20


def test_a_library_is_finished_first_where_it_is_quick():
    did = []
    assert interrupted(started_by("numba", did)) == ([], True)
    assert did.count("work") == 20


@pytest.mark.usefixtures("patient")
def test_a_library_is_left_where_it_takes_long():
    did = []
    assert interrupted(started_by("numba", did)) == ([], True)
    assert 1 < did.count("work") < 20
    assert "after" not in did


def test_what_a_finalizer_swallows_is_raised_again(capsys):
    class Finalized:
        def __del__(self):
            in_ospace(press)

    def drop(did):
        one = Finalized()
        did.append("before")
        del one
        function_of("ospace", "time.sleep(5)")(None)

    assert interrupted(drop) == (["before"], True)
    assert capsys.readouterr().err == ""


def test_an_interrupt_that_is_cleared_ends_nothing_more():
    """As the one that ends a view."""
    with Interrupts(test_an_interrupt_that_is_cleared_ends_nothing_more.__code__) as held:
        with pytest.raises(KeyboardInterrupt):
            in_ospace(press)
        held.clear()
        time.sleep(0.05)
        held.refuse()
        assert not held.seen


def test_an_interrupt_that_was_lost_is_raised_where_the_command_asks():
    with Interrupts(test_an_interrupt_that_was_lost_is_raised_where_the_command_asks.__code__) as held:
        with contextlib.suppress(BaseException):  # as some libraries do
            in_ospace(press)
        with pytest.raises(KeyboardInterrupt):
            held.refuse()


def test_handlers_are_as_before_afterwards():
    numbers = (signal.SIGINT, signal.SIGALRM)
    before = [signal.getsignal(number) for number in numbers], sys.unraisablehook
    interrupted(lambda did: in_ospace(press))
    assert ([signal.getsignal(number) for number in numbers], sys.unraisablehook) == before
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def command(program):
    given = [sys.executable, "-W", "error", "-c", program, "check", "target", "--samples", "2000"]
    return subprocess.run(given, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)


LOADED = """
import builtins, os, signal, sys
from ospace.cli.main import main
opens = builtins.open
def interrupts(path, *more, **options):
    file = opens(path, *more, **options)
    if str(path).endswith(".nbc"):
        builtins.open = opens
        print("interrupting", file=sys.stderr)
        os.kill(os.getpid(), signal.SIGINT)
    return file
builtins.open = interrupts
sys.exit(main())
"""


def test_a_kernel_that_is_being_loaded_leaves_no_file_open():
    """Between ``open`` and ``with`` nothing would close it."""
    command("import sys; from ospace.cli.main import main; sys.exit(main(['check', 'target', '--samples', '1']))")
    done = command(LOADED)
    assert done.stderr == "interrupting\nospace: interrupted\n"
    assert (done.returncode, done.stdout) == (130, "")


@pytest.mark.parametrize("error", ["TypeError", "SystemError"])
def test_another_error_that_a_library_makes_of_it(error):
    program = f"""
import os, signal, sys
from ospace.cli.main import main
from ospace.urdf import reader
def read(*arguments, **options):
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        raise {error}("a function returned a result with an exception set") from None
reader.read = read
sys.exit(main())
"""
    done = command(program)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "ospace: interrupted\n")
