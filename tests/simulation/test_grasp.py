"""Grasp as an inelastic impact, the combined model, and release: identities."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace import OspaceError, SpaceRobot
from ospace.dynamics.dense import Dense
from ospace.simulation import grasp, release, rigid_body, simulate, tumbling

MODELS = Path(__file__).parents[2] / "models"
REVERSIBLE = (
    "revolute",
    "prismatic",
    "continuous about any axis",
    "helical",
    "revolute about any axis",
    "continuous",
    "prismatic along any axis",
)


def chaser_and_target(seed, target_joints=4, held="base", **kind):
    """Two random trees that meet somehow: the fixture is near no hand, which is allowed."""
    chaser, target = trees.tree(seed, 7), trees.tree(seed + 100, target_joints, REVERSIBLE)
    target.name = "target"
    offset = pin.SE3(pin.exp3(np.array([0.3, 0.1, -0.2])), np.array([0.1, 0.2, 0.3]))
    return (
        trees.state(chaser, seed, **kind),
        chaser.point("link_3", axes="linear", offset=offset),
        trees.state(target, seed + 100, **kind),
        target.point(held, offset=offset),
    )


def momentum(*states):
    """Linear momentum, and angular momentum about the origin, of all."""
    total = np.zeros(6)
    for state in states:
        M_0 = ospace.momentum(state)
        total += np.r_[M_0[:3], M_0[3:] + np.cross(state.q[:3], M_0[:3])]
    return total


def energy(*states):
    total = 0.0
    for state in states:
        H = Dense(state, [state.robot.point("base")]).H
        x = np.r_[state.base_twist, state.v[6:]]
        total += 0.5 * x @ H @ x
    return total


CASES = [(seed, joints, held) for seed in range(4) for joints, held in ((0, "base"), (4, "base"), (4, "link_3"))]


@pytest.mark.parametrize(("seed", "joints", "held"), CASES)
def test_momentum_is_kept_and_energy_is_lost_as_the_formula_says(seed, joints, held):
    chaser, hand, target, fixture = chaser_and_target(seed, joints, held)
    one = grasp(chaser, hand, target, fixture)
    before = momentum(chaser, target)
    scale = sum(np.linalg.norm(momentum(state)) for state in (chaser, target)) + np.linalg.norm(one.impulse)
    assert np.abs(momentum(one.chaser, one.target) - before).max() < 1e-14 * scale
    assert np.abs(momentum(one.state) - before).max() < 3e-14 * scale  # through two ways to place the target's links
    lost = energy(chaser, target) - energy(one.state)
    assert one.energy_lost >= 0.0
    assert one.energy_lost == pytest.approx(lost, rel=1e-11)
    assert energy(one.chaser, one.target) == pytest.approx(energy(one.state), rel=1e-12)


@pytest.mark.parametrize(("seed", "joints", "held"), CASES)
def test_velocity_is_the_projection_by_the_combined_inertia(seed, joints, held):
    """H_comb v⁺ = Nᵀ diag(H_c, H_t) [v_c; v_t], N the motions that the grasp leaves."""
    chaser, hand, target, fixture = chaser_and_target(seed, joints, held)
    one = grasp(chaser, hand, target, fixture)
    robot, q = one.state.robot, one.state.q
    parts = [release(one, q, column) for column in np.eye(robot.nv)]
    N = np.array([np.r_[a.v, b.v] for a, b in parts]).T
    n = chaser.robot.nv
    H = np.zeros((n + target.robot.nv,) * 2)
    H[:n, :n], H[n:, n:] = (_inertia(state) for state in (chaser, target))
    v = np.linalg.solve(N.T @ H @ N, N.T @ H @ np.r_[chaser.v, target.v])
    assert np.abs(v - one.state.v).max() < 1e-11
    assert np.abs(_inertia(one.state) - N.T @ H @ N).max() < 1e-11


def _inertia(state):
    upper = pin.crba(state.robot.model, state.robot.model.createData(), state.q)
    return np.triu(upper) + np.triu(upper, 1).T


@pytest.mark.parametrize(("seed", "joints", "held"), CASES)
def test_frames_and_their_velocities_stay(seed, joints, held):
    chaser, hand, target, fixture = chaser_and_target(seed, joints, held)
    one = grasp(chaser, hand, target, fixture)
    for name in chaser.robot.frame_names:
        _same_motion(one.state, one.state.robot.point(name), one.chaser, chaser.robot.point(name))
    for name in target.robot.frame_names:
        renamed = f"target/{name}" if name in chaser.robot.frame_names else name
        _same_motion(one.state, one.state.robot.point(renamed), one.target, target.robot.point(name))


def _same_motion(a, point_a, b, point_b):
    assert np.abs(a.placement(point_a).homogeneous - b.placement(point_b).homogeneous).max() < 1e-13
    velocities = [
        ospace.operational_space(state, point).jacobian @ np.r_[state.base_twist, state.v[6:]]
        for state, point in ((a, point_a), (b, point_b))
    ]
    assert np.abs(velocities[0] - velocities[1]).max() < 1e-12


@pytest.mark.parametrize("held", ["base", "link_3"])
@pytest.mark.parametrize("far", [False, True])
def test_a_release_after_a_while_keeps_momentum(held, far):
    """Grasp, move by joint torques, let go: momentum of all is kept, and what is let go moves as it did."""
    chaser, hand, target, fixture = chaser_and_target(6, 4, held, far=far)
    if far:
        target = target.robot.state(np.r_[chaser.q[:3] + 1.0, target.q[3:]], target.v)
    one = grasp(chaser, hand, target, fixture)
    robot = one.state.robot
    torque = 0.1 * np.random.default_rng(0).normal(size=robot.n_joints)
    run = simulate(robot, one.state.q, 0.2 * one.state.v, lambda *_: torque, duration=0.05)
    assert run.certificate().passed
    after = robot.state(run.q[-1], run.v[-1])
    parts = one.release(after.q, after.v)
    assert np.abs(momentum(*parts) - momentum(after)).max() < 1e-13 * max(1.0, np.abs(momentum(after)).max())
    again = grasp(parts[0], hand, parts[1], fixture)
    tolerance = 1e-8 if far else 1e-12
    assert np.abs(again.velocity_error).max() < tolerance
    assert np.abs(again.state.v - after.v).max() < tolerance
    assert again.position_error == pytest.approx(one.position_error, abs=tolerance)
    assert again.angle_error == pytest.approx(one.angle_error, abs=tolerance)


def test_pose_errors_are_those_of_the_points():
    chaser = rigid_body(100.0, (10.0, 10.0, 10.0), name="chaser")
    target = rigid_body(50.0, (5.0, 6.0, 7.0), (0.1, 0.0, 0.0), frames={"grapple": pin.SE3(np.eye(3), np.ones(3))})
    a = chaser.state(chaser.configuration())
    T = pin.SE3(pin.exp3(np.array([0.0, 0.0, 0.3])), np.zeros(3))
    b = tumbling(target, T, (0.0, 0.1, 0.0))
    one = grasp(a, chaser.point("chaser"), b, target.point("grapple"))
    assert one.position_error == pytest.approx(np.sqrt(3.0))
    assert one.angle_error == pytest.approx(0.3)


def test_two_bodies_that_meet_head_on_share_their_momentum():
    """m_1 = 3 kg at 2 m/s takes m_2 = 1 kg at rest, in one line: v = 1.5 m/s, impulse 1.5 N s, 1.5 J lost."""
    a, b = rigid_body(3.0, (1.0, 1.0, 1.0), name="a"), rigid_body(1.0, (1.0, 1.0, 1.0), name="b")
    one = grasp(
        a.state(a.configuration(), [2.0, 0, 0, 0, 0, 0]),
        a.point("a"),
        b.state(b.configuration(T_WB=pin.SE3(np.eye(3), np.array([1.0, 0.0, 0.0])))),
        b.point("b"),
    )
    assert np.allclose(one.impulse, (1.5, 0, 0, 0, 0, 0), atol=1e-15)
    assert np.allclose(one.state.v, (1.5, 0, 0, 0, 0, 0), atol=1e-15)
    assert one.energy_lost == pytest.approx(1.5)
    assert one.state.robot.total_mass == 4.0


def test_subtrees_stay_whole_and_numbers_follow_their_joints():
    """The hand is in the middle of the chaser's numbering: the target is numbered right behind it."""
    chaser = SpaceRobot.from_urdf(MODELS / "chaser_24dof.urdf")
    target = trees.tree(3, 3, REVERSIBLE)
    state = tumbling(target, pin.SE3.Identity(), (0.01, 0.02, 0.03))
    one = grasp(chaser.state(chaser.configuration()), chaser.point("right_hand"), state, target.point("base"))
    robot = one.state.robot
    assert set(robot.joint_names) == {*chaser.joint_names, *target.joint_names}
    for source in (chaser, target):
        for name in source.joint_names:
            j, k = source.model.getJointId(name), robot.model.getJointId(name)
            for numbers in ("armature", "upperEffortLimit", "upperVelocityLimit"):
                given, copied = getattr(source.model, numbers), getattr(robot.model, numbers)
                assert given[source.model.idx_vs[j]] == copied[robot.model.idx_vs[k]]
            for numbers in ("lowerPositionLimit", "upperPositionLimit"):
                given, copied = getattr(source.model, numbers), getattr(robot.model, numbers)
                assert given[source.model.idx_qs[j]] == copied[robot.model.idx_qs[k]]
    dense = Dense(one.state, [robot.point("left_hand")])
    assert np.abs(dense.H @ dense.H_inv - np.eye(robot.nv)).max() < 1e-9


def test_a_target_from_urdf_is_held_in_the_hand():
    chaser, target = (SpaceRobot.from_urdf(MODELS / f"{name}.urdf") for name in ("chaser_24dof", "target"))
    a = chaser.state(chaser.configuration())
    T_WH = a.placement(chaser.point("right_hand"))
    grapple = target.point("grapple")
    T_WB = T_WH * grapple.placement.inverse()
    b = tumbling(target, T_WB, (0.01, -0.02, 0.03))
    one = grasp(a, chaser.point("right_hand"), b, grapple)
    assert one.position_error < 1e-14
    assert one.angle_error < 1e-7
    assert "grapple" in one.state.robot.frame_names
    run = simulate(one.state.robot, one.state.q, one.state.v, duration=0.2)
    assert run.certificate().passed


def test_two_of_a_kind_have_names_of_their_own():
    body = rigid_body(1.0, (1.0, 1.0, 1.0), frames={"grapple": pin.SE3.Identity()})
    one = grasp(*(part for _ in range(2) for part in (body.state(body.configuration()), body.point("grapple"))))
    assert one.state.robot.frame_names == ["target", "target/target", "grapple", "target/grapple"]


# -- targets -----------------------------------------------------------------------------------------------------


def test_tumbling_target_turns_about_its_mass_centre():
    target = rigid_body(80.0, (20.0, 25.0, 30.0), (0.3, -0.2, 0.1))
    T_WB = pin.SE3(pin.exp3(np.array([0.5, 0.2, 0.1])), np.array([1.0, 2.0, 3.0]))
    state = tumbling(target, T_WB, (0.1, 0.2, 0.3), (0.01, 0.0, -0.02))
    assert np.allclose(state.base_twist[3:], (0.1, 0.2, 0.3))
    run = simulate(target, state.q, state.v, duration=2.0, step=0.01)
    centres = np.array([pin.XYZQUATToSE3(q).act(np.array([0.3, -0.2, 0.1])) for q in run.q])
    expected = T_WB.act(np.array([0.3, -0.2, 0.1])) + np.outer(run.time, (0.01, 0.0, -0.02))
    assert np.abs(centres - expected).max() < 1e-9
    assert run.certificate().passed


# -- what is refused ---------------------------------------------------------------------------------------------


def test_what_cannot_be_grasped_is_refused():
    chaser, hand, target, fixture = chaser_and_target(1)
    with pytest.raises(OspaceError, match="belongs to another robot"):
        grasp(chaser, fixture, target, hand)
    ball = trees.tree(5, 1, ("spherical",))
    with pytest.raises(OspaceError, match=r"joint 'joint_0' of 'tree_5' lies between .* a Spherical joint"):
        grasp(chaser, hand, trees.state(ball, 5), ball.point("link_0"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1.0, np.zeros((2, 2))), "inertia of 'target'"),
        ((1.0, [[1, 2, 0], [0, 1, 0], [0, 0, 1]]), "give a symmetric"),
        ((1.0, (1.0, 1.0, 1.0), (0.0, 1.0)), "mass_centre has shape"),
        ((1.0, (-1.0, 1.0, 1.0)), "no body has these"),
        ((1.0, (1.0, 1.0, 2.1)), "at most the sum of the other two"),
        ((0.0, (1.0, 1.0, 1.0)), "mass of 'target' is 0.0"),
        ((1.0, (1.0, np.nan, 1.0)), "inertia of 'target'"),
    ],
)
def test_bodies_that_make_no_sense_are_refused(arguments, message):
    with pytest.raises(OspaceError, match=message):
        rigid_body(*arguments)


def test_a_frame_of_the_name_of_its_body_is_refused():
    with pytest.raises(OspaceError, match="frame 'target' bears the name of the body"):
        rigid_body(1.0, (1.0, 1.0, 1.0), frames={"target": pin.SE3.Identity()})
