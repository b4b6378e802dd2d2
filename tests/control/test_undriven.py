"""Joints without a drive: they move as the others make them, and no state drives them."""

import arms
import missions
import numpy as np
import pinocchio as pin
import pytest
from commands import KEPT, SOLVERS, accelerations, state, unlimited

from ospace.control import (
    BaseAttitudeTask,
    Constant,
    Controller,
    DampingTask,
    JointLimits,
    OrientationTask,
    PoseTask,
    PostureTask,
)

LINK = '<link name="{0}"><inertial><origin xyz="{1}"/><mass value="{2}"/>{3}</inertial></link>'
INERTIA = '<inertia ixx="{0}" iyy="{0}" izz="{0}" ixy="0" ixz="0" iyz="0"/>'
JOINT = (
    '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="{3}"/><axis xyz="{4}"/>'
    '<limit lower="-2" upper="2" effort="{5}" velocity="{6}"/></joint>'
)
ROBOT = "".join(
    [
        '<robot name="flapping">',
        LINK.format("bus", "0 0 0", 200, INERTIA.format(30)),
        LINK.format("upper", "0.3 0 0", 6, INERTIA.format(0.3)),
        LINK.format("fore", "0.3 0 0", 4, INERTIA.format(0.2)),
        LINK.format("panel", "0 1 0", 15, INERTIA.format(4)),
        JOINT.format("shoulder", "bus", "upper", "0.5 0 0.2", "0 1 0", 80, 2),
        JOINT.format("elbow", "upper", "fore", "0.6 0 0", "0 1 0", 60, 2),
        JOINT.format("hinge", "bus", "panel", "0 0.5 0", "1 0 0", 0, 0),
        "</robot>",
    ]
)
REACH = {
    "name": "tip",
    "type": "position",
    "point": "fore",
    "axes": [True, False, True, False, False, False],
    "stiffness": 100.0,
    "weight": 10.0,
    "goal": {"shift": ["-5 cm", 0, "10 cm"], "duration": "0.8 s"},
}
RUN = missions.toml(
    missions.phase("reach", REACH, duration="1 s", timeout="2 s"),
    robot={"model": "flapping.urdf", "joints": {"shoulder": "20 deg", "elbow": "60 deg"}},
    tasks=[missions.REST],
)


def test_a_hinge_without_a_drive_is_moved_by_the_others_alone(tmp_path):
    (tmp_path / "flapping.urdf").write_text(ROBOT)
    done = missions.flown(tmp_path, RUN)
    assert done.passed
    assert done.exceeded == {}
    assert set(done.phases[0].statuses) == {"nominal", "falling short"}  # the hinge gives way
    assert not any("hinge" in name for name in done.phases[0].active_limits)
    (segment,) = done.segments
    hinge = list(segment.robot.joint_names).index("hinge")
    assert (segment.trajectory.torque[:, hinge] == 0.0).all()
    assert np.abs(segment.trajectory.torque).max() > 0.1
    assert np.abs(segment.trajectory.v[:, 6 + hinge]).max() > 1e-4


def idle(robot, *joints):
    torque = np.full(robot.n_joints, 20.0)
    torque[list(joints)] = 0.0
    return unlimited(robot, torque=torque)


@pytest.mark.parametrize("solver", ["daqp", *SOLVERS])
@pytest.mark.parametrize("joints", [(2,), (0, 7, 17)])
def test_joints_without_a_drive_move_as_the_others_make_them(chaser, hand, head, solver, joints):
    """The least squares of the tasks over the accelerations that leave those torques zero, from Pinocchio's inertia."""
    q, v = state(chaser, 21, speed=0.05)
    near = Constant(chaser.state(q, v).placement(hand) * pin.SE3(np.eye(3), np.array([0.01, 0.0, 0.0])))
    tasks = [
        PoseTask(name="hand", point=hand, reference=near),
        OrientationTask(name="head", point=head),
        PostureTask(name="posture", weight=0.1),
    ]
    limits = unlimited(chaser, torque=np.where(np.isin(np.arange(18), joints), 0.0, np.inf))
    run = Controller(chaser, tasks, limits=limits, regularization=1e-6, solver=solver, trust_radius=1e6)
    command = run.update(0.0, q, v)
    assert (command.torque[list(joints)] == 0.0).all()
    assert command.status in KEPT
    assert not any(chaser.joint_names[j] in limit for j in joints for limit in command.active_limits)
    model, data = chaser.model, chaser.model.createData()
    H = pin.crba(model, data, q)
    H = np.triu(H) + np.triu(H, 1).T
    c = pin.nonLinearEffects(model, data, q, v)
    coupling = np.linalg.solve(H[:6, :6], np.column_stack([H[:6, 6:], c[:6]]))
    reduced, bias = H[6:, 6:] - H[6:, :6] @ coupling[:, :18], c[6:] - H[6:, :6] @ coupling[:, 18]
    A, asked = [], []
    free = Controller(chaser, tasks, limits=unlimited(chaser), regularization=1e-6, trust_radius=1e6).update(0.0, q, v)
    for task in tasks:
        rows = slice(*np.cumsum([0, 6, 3, 18])[[tasks.index(task), tasks.index(task) + 1]])
        A.append(np.sqrt(task.weight) * free._rows[0][rows])
        asked.append(np.sqrt(task.weight) * (free._rows[0][rows] @ free.joint_acceleration - free._rows[2][rows]))
    A, asked, k = np.vstack(A), np.concatenate(asked), len(joints)
    rows = reduced[list(joints)]
    kkt = np.block([[A.T @ A + 1e-6 * np.eye(18), rows.T], [rows, np.zeros((k, k))]])
    expected = np.linalg.solve(kkt, np.concatenate([A.T @ asked, -bias[list(joints)]]))[:18]
    atol = 1e-5 * np.abs(expected).max()
    np.testing.assert_allclose(command.joint_acceleration, expected, rtol=0, atol=atol)
    a = accelerations(chaser, q, v, command)
    np.testing.assert_allclose(a[6:], command.joint_acceleration, rtol=0, atol=1e-6 * np.abs(a).max())


@pytest.mark.parametrize("leveled", [False, True])
def test_no_state_drives_a_joint_without_a_drive(chaser, hand, leveled):
    limits = JointLimits.of(chaser, acceleration=5.0)
    torque = limits.torque.copy()
    torque[[1, 9]] = 0.0
    limits = JointLimits(torque, limits.lower, limits.upper, limits.velocity, limits.acceleration)
    tasks = [
        PoseTask(name="hand", point=hand, reference=Constant(pin.SE3.Identity()), level=0 if leveled else None),
        BaseAttitudeTask(name="base", robot=chaser, level=1 if leveled else None),
        DampingTask(name="rest"),
    ]
    names = [chaser.joint_names[j] for j in (1, 9)]
    seen = set()
    for seed in range(40):
        q, v = state(chaser, seed, speed=(0.0, 0.1, 1.0)[seed % 3])
        command = Controller(chaser, tasks, limits=limits).update(0.0, q, v)
        seen.add(command.status)
        assert command.status in (*KEPT, "softened"), command.explanation
        assert (command.torque[[1, 9]] == 0.0).all()
        for j, name in zip((1, 9), names, strict=True):
            rate = v[6 + j] + 1e-3 * command.joint_acceleration[j]
            passed = abs(rate) > limits.velocity[j] + 1e-7 or abs(command.joint_acceleration[j]) > 5.0 + 1e-4
            assert passed <= (name in command.softened), (seed, command.explanation)
    assert seen >= {"falling short", "softened"}


def test_a_joint_without_a_drive_that_is_too_fast_says_by_how_much():
    """The acceleration that would be missing to be at the limit after a period."""
    robot = arms.arm()
    limits, j = JointLimits.of(robot), 5
    torque, velocity = limits.torque.copy(), limits.velocity.copy()
    torque[j], velocity[j] = 0.0, 0.5
    limits = JointLimits(torque, limits.lower, limits.upper, velocity, limits.acceleration)
    v = np.zeros(robot.nv)
    v[6 + j] = 0.8
    run = Controller(robot, [DampingTask(name="rest")], limits=limits, period=0.01)
    command = run.update(0.0, robot.configuration(), v)
    after = 0.8 + 0.01 * command.joint_acceleration[j]
    assert command.status == "softened"
    assert command.softened == {"joint_5": pytest.approx((after - 0.5) / 0.01, rel=1e-9)}
