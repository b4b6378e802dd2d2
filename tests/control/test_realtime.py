"""Cycles leave nothing for Python's collector to do, and `realtime` keeps it out of a loop and times the cycles."""

import gc
import time

import custom
import numba
import numpy as np
import pytest

import ospace
from ospace.control import BaseAttitudeTask, Controller, DampingTask, PoseTask, PostureTask, realtime
from ospace.control.realtime import Overrun
from ospace.exceptions import OspaceError

CYCLES = 2000


@pytest.fixture(scope="module")
def robot():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))


@pytest.fixture
def controller(robot):
    return Controller(robot, [PoseTask(name="hand", point=robot.point("end_effector")), PostureTask(name="posture")])


def controllers(robot):
    hand = robot.point("end_effector")
    tasks = [PoseTask(name="hand", point=hand), DampingTask(name="rest")]
    levels = [
        PoseTask(name="hand", point=hand, level=0),
        BaseAttitudeTask(name="base", robot=robot, level=1),
        DampingTask(name="rest"),
    ]
    return {
        "weighted": Controller(robot, tasks),
        "levels": Controller(robot, levels),
        "in Python": Controller(
            robot,
            [custom.Height(name="height", point=hand), *tasks],
            inequalities=custom.Below(name="ceiling", point=hand, height=10.0),
        ),
    }


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="interpreted kernels hold many tuples at once")
@pytest.mark.parametrize("kind", ["weighted", "levels", "in Python"])
def test_cycles_leave_no_objects_and_cause_no_collection(robot, kind):
    controller, collections = controllers(robot)[kind], []
    q, v = robot.configuration(), np.full(robot.nv, 0.01)

    def run(cycles):
        for k in range(cycles):
            controller.update(k * 1e-3, q, v)

    run(10)
    gc.collect()
    before = len(gc.get_objects())
    gc.callbacks.append(lambda phase, info: collections.append(info))
    try:
        run(CYCLES)
    finally:
        del gc.callbacks[-1]
    grown = len(gc.get_objects()) - before
    assert collections == []
    assert grown < 20
    assert gc.collect() == 0


@pytest.mark.parametrize("kind", ["weighted", "levels"])
def test_commands_that_are_kept_form_no_reference_cycles(robot, kind):
    controller = controllers(robot)[kind]
    kept = [controller.update(k * 1e-3, robot.configuration(), np.zeros(robot.nv)) for k in range(50)]
    assert kept[-1].active_limits == ()
    assert set(kept[-1].errors) == {task.name for task in controller.tasks}
    gc.collect()
    del kept
    assert gc.collect() == 0


def test_the_collector_rests_within_and_is_as_it_was_after(robot, controller):
    frozen = gc.get_freeze_count()
    with realtime(controller) as loop:
        assert not gc.isenabled()
        assert gc.get_freeze_count() > frozen
        inner = gc.get_freeze_count()
        with realtime(controller):
            pass
        assert not gc.isenabled()
        assert gc.get_freeze_count() >= inner
        command = loop.update(0.0, robot.configuration(), np.zeros(robot.nv))
    assert command.status == "nominal"
    assert gc.isenabled()
    assert gc.get_freeze_count() == frozen


def test_after_an_error_the_collector_is_as_it_was(robot, controller):
    with pytest.raises(OspaceError, match="q has shape"), realtime(controller) as loop:
        loop.update(0.0, [1.0], np.zeros(robot.nv))
    assert gc.isenabled()
    assert gc.get_freeze_count() == 0


def test_a_collector_that_was_off_stays_off(controller):
    gc.disable()
    try:
        with realtime(controller):
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()


def test_overruns_are_counted_with_their_times(robot, controller):
    q, v = robot.configuration(), np.zeros(robot.nv)
    with realtime(controller, period=1e-9) as loop:
        for k in range(3):
            loop.update(k * 1e-3, q, v)
    assert (loop.cycles, loop.overruns) == (3, 3)
    assert [one.time for one in loop.last_overruns] == [0.0, 1e-3, 2e-3]
    assert all(one.duration > 1e-9 for one in loop.last_overruns)
    with realtime(controller, period=1e3) as loop:
        loop.update(0.0, q, v)
    assert (loop.cycles, loop.overruns) == (1, 0)
    assert loop.largest.duration > 0.0


def test_a_cycle_tells_how_long_it_had_the_processor(robot, controller):
    """The rest was of other programs; sleep stands for these."""
    q, v = robot.configuration(), np.zeros(robot.nv)
    with realtime(controller, period=0.02) as loop:
        loop.update(0.0, q, v)
        assert loop.largest.processor > 0.0
        update = controller.update
        controller.update = lambda *state: (time.sleep(0.2), update(*state))[1]
        loop.update(1.0, q, v)
    assert loop.largest.time == 1.0
    assert loop.largest.processor < loop.largest.duration - 0.15
    assert loop.last_overruns[-1] == loop.largest
    assert "of it on a processor" in str(loop)


def test_the_record_has_percentiles_and_the_largest(controller):
    with realtime(controller) as loop:
        assert str(loop) == "no cycle"
        assert np.isnan(loop.percentile(50.0))
        for k in range(1, 1001):
            loop.note(0.1 * k, k * 1e-6)
        loop.note(0.25, 5e-3)
    assert loop.period == controller.period
    for share, micros in ((10.0, 101), (50.0, 501), (99.0, 991)):
        assert micros * 0.999e-6 <= loop.percentile(share) <= micros * 1.011e-6
    assert loop.percentile(100.0) == loop.largest.duration == 5e-3
    assert loop.largest == Overrun(0.25, 5e-3)
    assert list(loop.last_overruns) == [Overrun(0.25, 5e-3)]
    words = str(loop)
    assert "1001 cycles: median" in words
    assert "largest 5000 µs at 0.25 s; 1 overruns of 1 ms" in words
    with realtime(controller) as loop:
        loop.note(0.0, 0.0)
        loop.note(0.0, 1e6)  # beyond what the record resolves
    assert loop.largest.duration == 1e6


def test_what_the_loop_leaves_in_circles_is_told(controller):
    with realtime(controller) as loop:
        for _ in range(10):
            circle = []
            circle.append(circle)
        del circle
        loop.note(0.0, 1e-6)
    assert loop.garbage == 10
    assert "10 objects left in reference cycles" in str(loop)
    with realtime(controller) as loop:
        loop.note(0.0, 1e-6)
    assert loop.garbage == 0


def test_a_loop_drives_a_simulation(robot, controller):
    with realtime(controller) as loop:
        run = ospace.simulate(robot, robot.configuration(), np.zeros(robot.nv), loop, duration=0.05)
    assert len(run) == 51
    assert loop.cycles == 50


@pytest.mark.parametrize("period", [0.0, -1.0, np.nan, np.inf])
def test_a_period_that_is_none_is_refused(controller, period):
    with pytest.raises(OspaceError, match="give a finite number above 0"), realtime(controller, period):
        pass
