"""What is not a real number is refused, by `OspaceError`, wherever a number is taken."""

from __future__ import annotations

import functools
import sys
import warnings
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace.checks import real_numbers
from ospace.control import (
    Base,
    Completion,
    Constant,
    Controller,
    Function,
    JointLimits,
    LookAtTask,
    MinimumJerk,
    PoseTask,
    PostureTask,
)
from ospace.simulation import Noise, rigid_body, tumbling

IDENTITY = pin.SE3.Identity()


@functools.cache
def robot():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))


def q():
    return robot().configuration({"joint_2": 0.5})


def v():
    return np.zeros(robot().nv)


def hand():
    return robot().point("end_effector")


def control(**options):
    return Controller(robot(), [PoseTask(name="hand", point=hand())], **options)


def moving(velocity=(0.0,) * 6, acceleration=(0.0,) * 6):
    task = PoseTask(name="hand", point=hand(), reference=Function(lambda time: (IDENTITY, velocity, acceleration)))
    return Controller(robot(), [task]).update(0.0, q(), v())


def simulated(**options):
    return ospace.simulate(robot(), q(), v(), **({"duration": 0.002} | options))


def limits(name, given):
    return JointLimits(
        **(
            {one: np.ones(2) for one in ("torque", "upper", "velocity", "acceleration")}
            | {"lower": -np.ones(2)}
            | {name: given}
        )
    )


class Commanded:
    """What a controller of anyone's own may return."""

    def __init__(self, **given):
        self.torque, self.base_wrench, self.wheel_torque = np.zeros(2), np.zeros(6), np.zeros(3)
        vars(self).update(given)


VECTORS = {  # a call, and numbers that it takes
    "state q": (lambda given: robot().state(given), q),
    "state v": (lambda given: robot().state(q(), given), v),
    "joint_positions": (lambda given: robot().joint_positions(given), q),
    "base_pose": (lambda given: robot().base_pose(given), q),
    "acceleration": (lambda given: ospace.inverse_dynamics(robot().state(q()), given), v),
    "evaluator q": (lambda given: ospace.OperationalSpaceEvaluator(robot(), hand()).update(given), q),
    "evaluator v": (lambda given: ospace.OperationalSpaceEvaluator(robot(), hand()).update(q(), given), v),
    "batch Q": (lambda given: ospace.operational_space_batch(robot(), hand(), given), lambda: q()[None]),
    "batch V": (lambda given: ospace.operational_space_batch(robot(), hand(), q()[None], given), lambda: v()[None]),
    "controller q": (lambda given: control().update(0.0, given, v()), q),
    "controller v": (lambda given: control().update(0.0, q(), given), v),
    "wheel_momentum": (lambda given: control(base="wheels", wheel_momentum=given), lambda: np.ones(3)),
    "base force": (lambda given: Base(force=given), lambda: np.ones(3)),
    "base torque": (lambda given: Base(torque=given), lambda: np.ones(3)),
    "torque limits": (lambda given: limits("torque", given), lambda: np.ones(2)),
    "lower limits": (lambda given: limits("lower", given), lambda: -np.ones(2)),
    "velocity limits": (lambda given: limits("velocity", given), lambda: np.ones(2)),
    "reference velocity": (lambda given: Constant(IDENTITY, given), lambda: np.ones(6)),
    "function velocity": (lambda given: moving(velocity=given), lambda: np.ones(6)),
    "function acceleration": (lambda given: moving(acceleration=given), lambda: np.ones(6)),
    "look-at axis": (lambda given: LookAtTask(name="t", point=hand(), axis=given), lambda: np.ones(3)),
    "simulated q": (lambda given: ospace.simulate(robot(), given, v(), duration=0.002), q),
    "simulated v": (lambda given: ospace.simulate(robot(), q(), given, duration=0.002), v),
    "simulated wheels": (lambda given: simulated(wheel_momentum=given), lambda: np.ones(3)),
    "wrench": (lambda given: simulated(wrenches={hand(): given}), lambda: np.ones(6)),
    "wrench in time": (lambda given: simulated(wrenches={hand(): lambda time: given}), lambda: np.ones(6)),
    "noise q": (lambda given: simulated(controller=lambda *_: np.zeros(2), noise=Noise(q=given)), v),
    "law": (lambda given: simulated(controller=lambda *_: given), lambda: np.ones(2)),
    "command torque": (lambda given: simulated(controller=lambda *_: Commanded(torque=given)), lambda: np.ones(2)),
    "command wrench": (lambda given: simulated(controller=lambda *_: Commanded(base_wrench=given)), lambda: np.ones(6)),
    "inertia": (lambda given: rigid_body(1.0, given), lambda: np.ones(3)),
    "mass_centre": (lambda given: rigid_body(1.0, np.ones(3), given), lambda: np.ones(3)),
    "spin": (lambda given: tumbling(robot(), IDENTITY, given), lambda: np.ones(3)),
    "drift": (lambda given: tumbling(robot(), IDENTITY, np.ones(3), given), lambda: np.ones(3)),
}
NUMBERS = {
    "joint position": lambda given: robot().configuration({"joint_2": given}),
    "posture": lambda given: PostureTask(name="t", posture={"joint_2": given}).check(robot(), Base()),
    "followed posture": lambda given: Controller(robot(), [PostureTask(name="t")]).follow("t", {"joint_2": given}),
    "stiffness": lambda given: PoseTask(name="t", point=hand(), stiffness=given),
    "period": lambda given: control(period=given),
    "controller's time": lambda given: control().update(given, q(), v()),
    "completion": lambda given: Completion(position=given),
    "hold": lambda given: Completion(position=1.0, hold=given),
    "start": lambda given: MinimumJerk(IDENTITY, IDENTITY, given, 1.0),
    "duration": lambda given: MinimumJerk(IDENTITY, IDENTITY, 0.0, given),
    "wheels": lambda given: Base(torque=1.0, wheels=True, wheel_momentum=given),
    "share": lambda given: JointLimits.of(robot(), share=given),
    "acceleration limit": lambda given: JointLimits.of(robot(), acceleration=given),
    "of a joint": lambda given: JointLimits.of(robot(), acceleration={"joint_2": given}),
    "simulated time": lambda given: simulated(duration=given),
    "step": lambda given: simulated(step=given, duration=1.0),
    "mass": lambda given: rigid_body(given, np.ones(3)),
}


def named(table):
    return pytest.mark.parametrize("take", table.values(), ids=table)


@pytest.mark.parametrize(("take", "good"), VECTORS.values(), ids=VECTORS)
@pytest.mark.parametrize(
    "spoilt",
    [
        lambda good: good + 1j,
        lambda good: good.astype(complex),  # without an imaginary part it is no real number either
        lambda good: good.astype(str),
        lambda good: good.astype(str).astype(object),
        lambda good: (good + 0j).astype(object),
        lambda good: np.full(good.shape, None),
        lambda good: good.astype(bool),
        lambda good: good.astype("timedelta64[s]"),
        lambda good: "1.0",
        lambda good: {"x": 1.0},
    ],
    ids=["complex", "complex type", "text", "text objects", "complex objects", "None", "bool", "time", "word", "dict"],
)
def test_arrays_that_are_not_real_are_refused(take, good, spoilt):
    take(good())
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ospace.OspaceError):
            take(spoilt(good()))


@named(NUMBERS)
@pytest.mark.parametrize("given", [1j, np.complex128(1.0), "1.0", b"1.0", [1.0, 2.0], print], ids=str)
def test_numbers_that_are_not_real_are_refused(take, given):
    take(1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ospace.OspaceError):
            take(given)


@pytest.mark.parametrize(
    "given",
    [
        [1, 2, 3],
        (1.0, 2, 3),
        np.arange(1, 4),
        np.arange(1, 4, dtype=np.uint8),
        np.arange(1, 4, dtype=np.float32),
        np.arange(1, 4, dtype=np.longdouble),
        [Fraction(2, 2), 2, 3.0],
        np.array([1, 2.0, 3], dtype=object),
    ],
    ids=repr,
)
def test_every_kind_of_real_numbers_is_taken(given):
    found = real_numbers(given)
    assert found.dtype == np.float64
    np.testing.assert_array_equal(found, [1.0, 2.0, 3.0])


@pytest.mark.parametrize("given", [10**400, [10**400], [[1.0], [1.0, 2.0]], Decimal("nan"), "nan", sys], ids=repr)
def test_what_no_double_can_hold_is_refused(given):
    with pytest.raises((TypeError, ValueError)):
        real_numbers(given)


@pytest.mark.parametrize(
    "take",
    [
        lambda: ospace.SpaceRobot.from_urdf(None),
        lambda: ospace.SpaceRobot.from_urdf(3),
        lambda: ospace.SpaceRobot.from_model(None),
        lambda: ospace.SpaceRobot.from_model("planar_2r"),
        lambda: ospace.OperationalSpaceEvaluator(robot(), hand(), None),
        lambda: ospace.OperationalSpaceEvaluator(robot(), hand(), [None]),
        lambda: ospace.OperationalSpaceEvaluator(robot(), hand(), [["inertia"]]),
        lambda: ospace.operational_space_batch(robot(), hand(), q()[None], quantities=None),
        lambda: ospace.operational_space_batch(robot(), hand(), q()[None], quantities=3),
    ],
)
def test_none_and_other_types_are_refused(take):
    with pytest.raises(ospace.OspaceError):
        take()
