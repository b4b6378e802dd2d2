"""The base answers its joints so that momentum stays zero and the mass centre where it is, by Pinocchio's account."""

import itertools
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace import OspaceError, SpaceRobot
from ospace.simulation.zero_momentum import joint_sweep, zero_momentum_motion

MODELS = Path(ospace.__file__).parents[1] / "models"


@pytest.fixture(scope="module", params=["planar_2r", "chaser_7dof", "tree of all joints"])
def robot(request):
    if request.param.startswith("tree"):
        return trees.tree(3, 9)
    return SpaceRobot.from_urdf(MODELS / f"{request.param}.urdf")


def waving(robot, pace=1.0):
    """Return joints that all move, each at its own pace, from rest at the start's positions."""
    n = robot.n_joints
    rates = pace * np.linspace(0.7, 1.9, n)
    size = 0.5 / np.sqrt(n)

    def joints(time):
        return size * np.sin(rates * time), size * rates * np.cos(rates * time)

    return joints


def start_of(robot, seed=1):
    rng = np.random.default_rng(seed)
    q = pin.neutral(robot.model)
    q[:3] = rng.normal(size=3)
    q[3:7] = pin.Quaternion(pin.exp3(rng.normal(size=3))).coeffs()
    return np.asarray(pin.integrate(robot.model, q, np.r_[np.zeros(6), 0.3 * rng.normal(size=robot.nv - 6)]))


def test_momentum_is_zero_and_the_mass_centre_stays(robot):
    q = start_of(robot)
    motion = zero_momentum_motion(robot, q, waving(robot), 3.0)
    model, data = robot.model, robot.model.createData()
    np.testing.assert_allclose(motion.q[0], q, atol=1e-12)
    assert (motion.time[0], motion.time[-1]) == (0.0, 3.0)
    centre = np.array(pin.centerOfMass(model, data, q))
    scale = pin.crba(model, data, q)[:6, :6].max()
    for one, v in zip(motion.q, motion.v, strict=True):
        h = pin.computeCentroidalMomentum(model, data, one, v).vector
        assert np.abs(h).max() < 1e-11 * scale
        np.testing.assert_allclose(pin.centerOfMass(model, data, one), centre, rtol=0, atol=1e-11)
    turned = pin.log3(pin.XYZQUATToSE3(motion.q[0, :7]).rotation.T @ pin.XYZQUATToSE3(motion.q[-1, :7]).rotation)
    assert np.linalg.norm(turned) > 1e-4  # the base does answer


def test_joints_move_as_they_are_told(robot):
    joints = waving(robot)
    motion = zero_momentum_motion(robot, start_of(robot), joints, 1.0)
    first = motion.q[0].copy()
    for time, q, v in zip(motion.time[::10], motion.q[::10], motion.v[::10], strict=True):
        moved, rates = joints(time)
        wanted = pin.integrate(robot.model, first, np.r_[np.zeros(6), moved])
        np.testing.assert_allclose(q[7:], wanted[7:], rtol=0, atol=1e-12)
        np.testing.assert_array_equal(v[6:], rates)


def test_the_velocity_is_the_derivative(robot):
    """By central differences over two records, which are off by h²."""
    motion = zero_momentum_motion(robot, start_of(robot), waving(robot), 1.0)
    h = motion.time[1]
    for k in range(1, len(motion.time) - 1, 7):
        forth = pin.difference(robot.model, motion.q[k], motion.q[k + 1]) / h
        back = pin.difference(robot.model, motion.q[k - 1], motion.q[k]) / h
        np.testing.assert_allclose(0.5 * (forth + back)[:6], motion.v[k, :6], rtol=0, atol=5.0 * h * h)


def test_the_base_s_motion_is_of_fourth_order(monkeypatch):
    """Half the step, a sixteenth of the error in how the base is turned."""
    robot = trees.tree(3, 9)
    q = start_of(robot)
    joints = waving(robot, pace=6.0)

    def turned(step):
        monkeypatch.setattr("ospace.simulation.zero_momentum._STEP", step)
        return pin.XYZQUATToSE3(zero_momentum_motion(robot, q, joints, 1.0).q[-1, :7]).rotation

    best = turned(1.0 / 640.0)
    errors = [np.linalg.norm(pin.log3(best.T @ turned(step))) for step in (1 / 10.0, 1 / 20.0, 1 / 40.0)]
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.35)
    assert errors[1] / errors[2] == pytest.approx(16.0, rel=0.35)


def test_out_and_back_along_one_joint_brings_the_base_back(robot):
    """One joint alone encloses no area: whatever its pace, the base comes back."""
    for i in range(min(3, robot.n_joints)):

        def joints(time, i=i):
            moved, rates = np.zeros(robot.n_joints), np.zeros(robot.n_joints)
            moved[i], rates[i] = np.sin(np.pi * time) ** 2, np.pi * np.sin(2.0 * np.pi * time)
            return moved, rates

        motion = zero_momentum_motion(robot, start_of(robot), joints, 1.0)
        np.testing.assert_allclose(
            pin.XYZQUATToSE3(motion.q[-1, :7]).homogeneous,
            pin.XYZQUATToSE3(motion.q[0, :7]).homogeneous,
            rtol=0,
            atol=1e-6,
        )


def test_out_and_back_along_two_joints_in_turn_turns_the_base():
    """A cat turns so: the base ends elsewhere than it began, with its momentum zero all the while."""
    robot = SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")

    def joints(time):
        a, b = 2.0 * np.pi * time, 2.0 * np.pi * time
        return np.array([1.0 - np.cos(a), np.sin(b)]), 2.0 * np.pi * np.array([np.sin(a), np.cos(b)])

    motion = zero_momentum_motion(robot, robot.configuration(), joints, 1.0)
    turned = pin.log3(pin.XYZQUATToSE3(motion.q[-1, :7]).rotation)
    np.testing.assert_allclose(motion.q[-1, 7:], motion.q[0, 7:], atol=1e-9)
    assert np.abs(turned[2]) > 1e-3


def test_a_sweep_goes_to_the_limits_and_back():
    robot = SpaceRobot.from_urdf(MODELS / "chaser_7dof.urdf")
    q = robot.configuration(dict.fromkeys(robot.joint_names[:2], 0.1))
    motion = joint_sweep(robot, q)
    assert (np.diff(motion.time) > 0.0).all()
    np.testing.assert_allclose(motion.q[-1, 7:], q[7:], atol=1e-9)
    np.testing.assert_allclose(motion.v[[0, -1]], 0.0, atol=1e-9)
    for k in range(7, robot.nq):
        low, high = robot.model.lowerPositionLimit[k], robot.model.upperPositionLimit[k]
        if np.isfinite([low, high]).all():
            np.testing.assert_allclose([motion.q[:, k].min(), motion.q[:, k].max()], [low, high], atol=1e-6)
        assert np.ptp(motion.q[:, k]) > 0.1
    moving = (np.abs(motion.v[:, 6:]) > 1e-12).sum(axis=1)
    assert moving.max() == 1  # one joint after the other
    centre = pin.centerOfMass(robot.model, robot.model.createData(), q)
    for one in motion.q[::50]:
        np.testing.assert_allclose(pin.centerOfMass(robot.model, robot.model.createData(), one), centre, atol=1e-11)


def test_a_sweep_tells_how_far_the_base_turns():
    """The published arm turns its base by 43.285 deg while joint 1 goes from 0 to 90 deg (Papadopoulos, Dubowsky)."""
    robot = SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")
    motion = joint_sweep(robot, robot.configuration())
    np.testing.assert_allclose(motion.ranges, [[-2.9671, 2.9671]] * 2)
    for i, (shift, turn) in enumerate(motion.largest):
        part = motion.q[motion.moving == i]
        assert np.ptp(part[:, 7 + i]) == pytest.approx(2 * 2.9671, abs=1e-6)
        assert np.ptp(part[:, 8 - i]) < 1e-12
        turns = [np.linalg.norm(pin.log3(pin.XYZQUATToSE3(q[:7]).rotation)) for q in part]
        assert turn == pytest.approx(max(turns), abs=1e-9)
        assert shift == pytest.approx(np.linalg.norm(part[:, :3], axis=1).max(), abs=1e-12)
    rising = motion.q[: np.argmax(motion.q[:, 7]), 7]
    at = np.interp(np.pi / 2, rising, motion.base[: len(rising), 1])
    assert at == pytest.approx(np.radians(43.28500849), abs=1e-4)


@pytest.mark.parametrize("duration", [0.0, -1.0, np.nan, np.inf])
def test_a_duration_that_is_none_is_refused(duration):
    robot = SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")
    with pytest.raises(OspaceError, match="give a positive number"):
        zero_momentum_motion(robot, robot.configuration(), waving(robot), duration)


def test_zero_momentum_motion_refuses_bad_input():
    robot = SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")
    with pytest.raises(OspaceError, match="q"):
        zero_momentum_motion(robot, np.zeros(3), waving(robot), 1.0)
    with pytest.raises(OspaceError):
        joint_sweep(robot, robot.configuration() * np.nan)
    with pytest.raises(OspaceError, match="no joint to move"):
        joint_sweep(
            SpaceRobot.from_urdf(MODELS / "target.urdf"), SpaceRobot.from_urdf(MODELS / "target.urdf").configuration()
        )


# -- how far and how long a sweep goes ---------------------------------------------------------------------------


@pytest.fixture
def hinged(tmp_path):
    """Make a body with another on a joint."""

    def made(kind, limits):
        body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
        file = tmp_path / "r.urdf"
        file.write_text(
            f'<robot name="r"><link name="a">{body}</link><link name="b">{body}</link><joint name="j" type="{kind}">'
            f'<parent link="a"/><child link="b"/><axis xyz="0 0 1"/>{limits}</joint></robot>'
        )
        return SpaceRobot.from_urdf(file)

    return made


def limit(lower, upper):
    return f'<limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/>'


@pytest.mark.parametrize(
    ("kind", "limits", "at", "expected"),
    [
        ("revolute", limit(-1.0, 2.0), 0.5, (-1.0, 2.0)),
        ("revolute", limit(-4.1, 0.1), 0.0, (-4.1, 0.1)),
        ("revolute", limit(-1e9, 1e9), 0.0, (-np.pi, np.pi)),
        ("revolute", limit(-6283.0, 6283.0), 10.0, (10.0 - np.pi, 10.0 + np.pi)),
        ("revolute", limit(-6.28, 6.28), 6.0, (6.0 - np.pi, 6.28)),
        ("continuous", "", 0.3, (0.3 - np.pi, 0.3 + np.pi)),
        ("prismatic", limit(0.0, 1.5), 0.0, (0.0, 1.5)),
        ("prismatic", limit(-1000.0, 1000.0), 0.0, (-1.0, 1.0)),
        ("prismatic", limit(-1000.0, 0.2), 0.0, (-1.0, 0.2)),
    ],
)
def test_a_range_that_is_too_wide_is_cut(hinged, kind, limits, at, expected):
    robot = hinged(kind, limits)
    q = robot.configuration({"j": at})
    motion = joint_sweep(robot, q)
    moved = np.r_[0.0, np.cumsum([pin.difference(robot.model, a, b)[6] for a, b in itertools.pairwise(motion.q)])]
    np.testing.assert_allclose(at + np.array([moved.min(), moved.max()]), expected, rtol=0, atol=1e-9)
    assert motion.time[-1] < 12.1


def test_a_joint_far_beyond_its_limits_takes_no_longer(hinged):
    robot = hinged("revolute", limit(-1.0, 1.0))
    motion = joint_sweep(robot, robot.configuration({"j": 1e6}))
    assert motion.time[-1] < 12.1
    assert np.ptp(motion.q[:, 7]) <= 4.0 * np.pi


@pytest.mark.parametrize(
    ("kind", "turning"),
    [
        ("planar", [False, False, True]),
        ("floating", [False] * 3 + [True] * 3),
        ("spherical", [True] * 3),
        ("spherical by angles", [True] * 3),
        ("translation", [False] * 3),
        ("universal", [True] * 2),
        ("helical", [True]),
        ("composite", [True, False]),
        ("prismatic along any axis", [False]),
    ],
)
def test_the_sweep_tells_joints_that_turn_from_joints_that_shift(kind, turning):
    """Half a turn to either side, or a metre: by the columns of the joint, whatever it is called."""
    robot = trees.tree(1, 1, types=(kind,))
    motion = joint_sweep(robot, pin.neutral(robot.model))
    moved = np.cumsum([pin.difference(robot.model, a, b)[6:] for a, b in itertools.pairwise(motion.q)], axis=0)
    np.testing.assert_allclose(moved.max(axis=0), np.where(turning, np.pi, 1.0), rtol=1e-6)
    np.testing.assert_allclose(moved.min(axis=0), np.where(turning, -np.pi, -1.0), rtol=1e-6)


def test_a_sweep_reports_its_progress_by_joint():
    robot = SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")
    shares = []
    motion = joint_sweep(robot, robot.configuration(), progress=shares.append)
    assert len(shares) == len(motion.time)
    assert (shares[0], shares[-1]) == (0.0, 1.0)
    assert (np.diff(shares) > 0.0).all()

    def interrupted(share):
        if share > 0.1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        joint_sweep(robot, robot.configuration(), progress=interrupted)
