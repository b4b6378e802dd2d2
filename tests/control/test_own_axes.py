"""Tasks along and about the axes of their point: errors fall as they should, and what is not taken is free."""

import numpy as np
import pinocchio as pin
import pytest
from commands import accelerations, state, unlimited

from ospace import OspaceError
from ospace.control import Constant, Controller, Function, OrientationTask, PoseTask, PositionTask

ROLL_FREE = (True, True, True, True, True, False)
AXES = [
    "all",
    ROLL_FREE,
    (True, True, False, True, False, True),
    (True, False, True, False, True, True),
    (False, True, False, False, False, True),
]


def moving(pose, rng, *, roll, way):
    """A reference that moves from beside `pose`, turned about its own axis by `roll` (3,) and away by `way` (3,)."""
    small, rate, curve = rng.normal(scale=1e-4, size=6), rng.normal(size=6) * 0.3, rng.normal(size=6) * 0.3
    start = pin.SE3(
        pin.exp3(small[3:]) @ pose.rotation @ pin.exp3(roll), pose.translation + small[:3] + pose.rotation @ way
    )

    def at(time):
        moved = rate * time + 0.5 * curve * time**2
        return (
            pin.SE3(pin.exp3(moved[3:]) @ start.rotation, start.translation + moved[:3]),
            rate + curve * time,
            curve,
        )

    return at


def error_of(robot, point, axes, pose, q):
    """The error by its definition, from Pinocchio's frames alone."""
    T = robot.state(q).placement(point)
    seen = T.actInv(pose)
    taken = np.array([True] * 6 if axes == "all" else axes)
    turn = pin.log3(seen.rotation)
    free = ~taken[3:]
    if free.sum() == 1:
        a = free.astype(float)
        u = seen.rotation @ a
        off = np.cross(a, u)
        turn = off * np.arctan2(np.linalg.norm(off), a @ u) / np.linalg.norm(off)
    return np.concatenate([seen.translation, turn])[taken]


@pytest.mark.parametrize("axes", AXES)
@pytest.mark.parametrize("seed", range(3))
def test_errors_in_axes_of_the_point_fall_as_those_of_a_damped_spring(chaser, hand, axes, seed):
    """ë + d ė + k e = 0 along the motion of the command, however far off what is not taken is."""
    rng = np.random.default_rng(seed)
    q, v = state(chaser, seed)
    taken = np.array([True] * 6 if axes == "all" else axes)
    free_turn, free_way = ~taken[3:], ~taken[:3]
    roll = 2.0 * free_turn if free_turn.sum() == 1 else np.zeros(3)
    pose = chaser.state(q, v).placement(hand)
    reference = Function(moving(pose, rng, roll=roll, way=0.4 * free_way))
    task = PoseTask(
        name="task", point=hand, axes=axes, axes_in="point", stiffness=9.0, damping_ratio=0.7, reference=reference
    )
    controller = Controller(
        chaser, [task], base="flying", limits=unlimited(chaser), regularization=1e-10, trust_radius=1e6
    )
    command = controller.update(0.0, q, v)
    a, h, errors = accelerations(chaser, q, v, command), 1e-3, []
    for time in (-h, 0.0, h):
        q_t = pin.integrate(chaser.model, q, v * time + 0.5 * a * time**2)
        errors.append(error_of(chaser, hand, axes, reference.motion(time)[0], q_t))
    rate, curve = (errors[2] - errors[0]) / (2.0 * h), (errors[2] - 2.0 * errors[1] + errors[0]) / h**2
    left = curve + 2.0 * 0.7 * 3.0 * rate + 9.0 * errors[1]
    assert np.abs(rate).max() > 1e-2
    assert np.abs(left).max() < 5e-3 * np.abs(np.concatenate([curve, 4.2 * rate])).max()
    np.testing.assert_allclose(command.errors["task"], errors[1], rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("kind", [PoseTask, PositionTask, OrientationTask])
def test_all_axes_of_the_point_ask_for_what_all_inertial_axes_ask(chaser, hand, kind):
    q, v = state(chaser, 3)
    goal = chaser.state(q, v).placement(hand) * pin.SE3(pin.exp3(np.full(3, 1e-6)), np.full(3, 1e-6))
    torques = [
        Controller(
            chaser,
            [kind(name="task", point=hand, axes_in=axes_in, reference=Constant(goal), damping_ratio=0.0)],
            limits=unlimited(chaser),
        )
        .update(0.0, q, 0.0 * v)
        .torque
        for axes_in in ("inertial", "point")
    ]
    np.testing.assert_allclose(torques[0], torques[1], rtol=0, atol=1e-4 * np.abs(torques[0]).max())


def test_a_tool_straight_behind_its_goal_turns_about_some_axis(chaser, hand):
    q, v = state(chaser, 1)
    behind = chaser.state(q, v).placement(hand) * pin.SE3(pin.exp3(np.array([np.pi, 0.0, 0.0])), np.zeros(3))
    task = OrientationTask(
        name="task",
        point=hand,
        axes=(False, False, False, True, True, False),
        axes_in="point",
        reference=Constant(behind),
    )
    error = Controller(chaser, [task]).update(0.0, q, v).errors["task"]
    assert np.linalg.norm(error) == pytest.approx(np.pi, rel=1e-6)


def test_a_shortfall_in_own_axes_says_so(chaser, hand):
    far = pin.SE3(np.eye(3), np.array([50.0, 0.0, 0.0]))
    task = PoseTask(name="task", point=hand, axes=ROLL_FREE, axes_in="point", reference=Constant(far))
    q = chaser.neutral()
    command = Controller(chaser, [task]).update(0.0, q, np.zeros(chaser.nv))
    (short,) = command.shortfalls
    assert short.own_axes
    assert short.size.endswith("of its own axes")


def test_other_axes_than_inertial_ones_or_those_of_the_point_are_refused(hand):
    with pytest.raises(OspaceError, match="axes_in is 'tool': give 'inertial' or 'point'"):
        PoseTask(name="task", point=hand, axes_in="tool")
