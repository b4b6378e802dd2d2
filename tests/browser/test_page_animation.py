"""At any time, between records and keys too, the page has everything where the motion has it."""

from pathlib import Path

import missions
import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace import SpaceRobot
from ospace.cli.main import main
from ospace.simulation import simulate
from ospace.simulation.zero_momentum import FloatingMotion, joint_sweep
from ospace.visual import Scene, run_report

pytestmark = pytest.mark.browser
MODELS = Path(ospace.__file__).parents[1] / "models"
NEAR = 1e-6  # m, and of rotation matrices


def frame_pose(robot, q, name):
    """Return the pose of a frame by Pinocchio, (4, 4)."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.model.getFrameId(name)].homogeneous


def from_frame(T, frame, elapsed):
    """See a pose from the moving frame."""
    seen = T.copy()
    seen[:3, 3] -= frame.origin + elapsed * frame.velocity
    return seen


def test_a_page_of_a_grasp_moves_as_the_run_did(open_page, tmp_path):
    """Hand, base and target, before the grasp, while the target is held, and after its release."""
    run = missions.flown(tmp_path)
    assert [bool(segment.holds) for segment in run.segments] == [False, True, False]
    robot, target = run.scenario.robot, run.scenario.targets["target"].robot
    scene = run_report.scene_of(run.scenario)
    run_report.animate(scene, run)
    page = open_page(scene.html())
    hand = next(label.path for label in scene.content().labels if label.text == "end_effector")
    base = "/robots/0 planar_2r/base"
    other = f"/robots/1 {target.name}/base"
    ends = [segment.trajectory.time[[0, -1]] for segment in run.segments]
    rng = np.random.default_rng(1)
    times = np.sort(np.concatenate([rng.uniform(*end, 60) for end in ends]))
    assert page.evaluate("ospace.duration()") == pytest.approx(run.duration, abs=1e-6)
    found = page.along([hand, base, other], times)
    target_base = target.frame_names[0]
    worst = np.zeros(3)
    for time, nodes in zip(times, found, strict=True):
        segment = next(one for one, end in zip(run.segments, ends, strict=True) if time <= end[1])
        combined, trajectory = segment.robot, segment.trajectory
        q, _ = trajectory.at(combined, time)
        if not segment.holds:
            own_q = pin.interpolate(target.model, *around(segment.targets[0].time, segment.targets[0].q, time))
            wanted_target = frame_pose(target, own_q, target_base)
        else:
            chaser, held = segment.holds[0].grasp.release(q, np.zeros(combined.nv))
            alone, together = (frame_pose(*one, "end_effector") for one in ((robot, chaser.q), (combined, q)))
            np.testing.assert_allclose(alone, together, rtol=0, atol=1e-12)
            wanted_target = frame_pose(target, held.q, target_base)
        wanted = [frame_pose(combined, q, "end_effector"), frame_pose(combined, q, "base"), wanted_target]
        seen = np.array([from_frame(T, scene.frame, time) for T in wanted])
        worst = np.maximum(worst, np.abs(nodes - seen).max(axis=(1, 2)))
    assert worst.max() < NEAR
    moved = np.ptp(found[:, :, :3, 3], axis=0).max(axis=1)
    assert moved[0] > 0.01  # and it does move
    assert len({tuple(row) for row in np.round(found[:, 2, :3, :3].reshape(len(times), 9), 6)}) > 100


def around(times, Q, time):
    """Return the records before and after a time, and the share of the way between them."""
    k = int(np.clip(np.searchsorted(times, time) - 1, 0, len(times) - 2))
    return Q[k], Q[k + 1], float((time - times[k]) / (times[k + 1] - times[k]))


def test_a_page_of_a_robot_in_orbit_moves_as_the_run_did(open_page):
    """7000 km from the origin, at 7.5 km/s: seen from the frame that moves along, every digit is there."""
    robot = SpaceRobot.from_urdf(MODELS / "chaser_24dof.urdf")
    rng = np.random.default_rng(2)
    q = robot.configuration(T_WB=pin.SE3(pin.exp3(rng.normal(size=3)), np.array([7e6, -1e5, 3e5])))
    v = np.r_[np.zeros(3), rng.normal(scale=0.2, size=3), rng.normal(scale=0.5, size=robot.n_joints)]
    v[:3] = pin.XYZQUATToSE3(q[:7]).rotation.T @ [0.0, 7.5e3, 0.0]
    run = simulate(robot, q, v, duration=1.5)
    scene = Scene(robot, [robot.point("right_hand")])
    scene.animate(run)
    np.testing.assert_allclose(scene.frame.velocity, [0.0, 7.5e3, 0.0], atol=1e-9)
    hand = next(label.path for label in scene.content().labels if label.text == "right_hand")
    page = open_page(scene.html())
    times = np.sort(rng.uniform(0.0, 1.5, 100))
    found = page.along([hand], times)[:, 0]
    for time, T in zip(times, found, strict=True):
        # Interpolated as seen from the frame: between records of 7e6 m it would have nine digits less.
        Q, _ = scene.frame.inverse.to_user_frame(run.time, run.q, run.v)
        seen = frame_pose(robot, pin.interpolate(robot.model, *around(run.time, Q, time)), "right_hand")
        np.testing.assert_allclose(T, seen, rtol=0, atol=3e-6)
    records = run.time[:: len(run) // 20]
    far = [from_frame(frame_pose(robot, run.at(robot, t)[0], "right_hand"), scene.frame, t) for t in records]
    np.testing.assert_allclose(page.along([hand], records)[:, 0], far, rtol=0, atol=3e-6)
    assert np.ptp(found[:, :3, 3], axis=0).max() > 0.05


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """Return a robot, its sweep, and the page of `ospace view --sweep`."""
    file = tmp_path_factory.mktemp("sweep") / "sweep.html"
    assert main(["view", "planar_2r", "--pose", "joint_1=0.3", "--sweep", "--html", str(file)]) == 0
    robot = SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")
    return robot, joint_sweep(robot, robot.configuration({"joint_1": 0.3})), file


def test_a_sweep_keeps_the_centre_of_mass(open_page, swept):
    robot, motion, file = swept
    page = open_page(file)
    model, data = robot.model, robot.model.createData()
    nodes = ["/robots/0 planar_2r/base", "/robots/0 planar_2r/joint joint_1", "/robots/0 planar_2r/joint joint_2"]
    duration = page.evaluate("ospace.duration()")
    assert duration == pytest.approx(motion.time[-1], abs=1e-6)
    times = np.sort(np.random.default_rng(4).uniform(0.0, duration, 200))
    quantities = [f"/quantities/{name}" for name in ("mass centre", "linear whole", "angular whole")]
    found = page.along([*nodes, *quantities], times)
    masses = np.array([model.inertias[j].mass for j in range(1, 4)])
    levers = np.array([[*model.inertias[j].lever, 1.0] for j in range(1, 4)])
    centres = np.einsum("j,tjab,jb->ta", masses, found[:, :3], levers)[:, :3] / masses.sum()
    np.testing.assert_allclose(centres, centres[:1].repeat(len(times), axis=0), rtol=0, atol=NEAR)
    np.testing.assert_allclose(found[:, 3, :3, 3], centres, rtol=0, atol=NEAR)
    assert np.ptp(found[:, 0, :3, 3], axis=0).max() > 0.01  # the base does react
    assert np.ptp(found[:, 0, :3, :3], axis=0).max() > 0.1
    assert np.linalg.norm(found[:, 4:, :3, 2], axis=-1).max() < 2e-4  # no arrow of the whole momentum
    for q, v in zip(motion.q, motion.v, strict=True):
        h = pin.computeCentroidalMomentum(model, data, q, v).vector
        assert np.abs(h).max() < 1e-9


def test_records_that_are_far_apart_are_joined(open_page, swept):
    """Of every second record alone: the others are there too, and no link comes off the one before."""
    robot, motion, _ = swept
    scene = Scene(robot)
    scene.animate(FloatingMotion(motion.time[::2], motion.q[::2], motion.v[::2]))
    page = open_page(scene.html())
    start = motion.q[0, :3]
    nodes = ["/robots/0 planar_2r/base", "/robots/0 planar_2r/joint joint_1", "/robots/0 planar_2r/joint joint_2"]
    last = len(motion.time) - len(motion.time) % 2
    times = np.r_[motion.time[:last:5], np.random.default_rng(7).uniform(0.0, motion.time[last - 2], 100)]
    found = page.along(nodes, times)
    model, data = robot.model, robot.model.createData()
    for k, poses in zip(range(0, last, 5), found, strict=False):
        pin.forwardKinematics(model, data, motion.q[k])
        wanted = np.array([data.oMi[j].homogeneous for j in (1, 2, 3)])
        wanted[:, :3, 3] -= start
        np.testing.assert_allclose(poses, wanted, rtol=0, atol=5e-5 if k % 2 else 2 * NEAR)
    for one in (1, 2):  # where a link is in the one before never changes
        placement = np.linalg.solve(found[:, one - 1], found[:, one])[:, :3, 3]
        np.testing.assert_allclose(placement, placement[:1].repeat(len(times), axis=0), rtol=0, atol=2 * NEAR)


def test_a_base_makes_whole_turns(open_page):
    """A steady spin, whose arc from key to key would be the shorter one the other way round."""
    robot = SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")
    time = np.linspace(0.0, 6.0, 1201)
    q = np.array(
        [robot.configuration(T_WB=pin.SE3(pin.exp3(np.array([0.0, 2.0 * t, 0.0])), np.zeros(3))) for t in time]
    )
    v = np.zeros((len(time), robot.nv))
    v[:, 4] = 2.0
    scene = Scene(robot)
    scene.animate(FloatingMotion(time, q, v))
    times = np.random.default_rng(9).uniform(0.0, 6.0, 100)
    found = open_page(scene.html()).along(["/robots/0 planar_2r/base"], times)[:, 0, :3, :3]
    wanted = np.array([pin.exp3(np.array([0.0, 2.0 * t, 0.0])) for t in times])
    np.testing.assert_allclose(found, wanted, rtol=0, atol=2 * NEAR)


def test_the_player_plays_to_the_end_stops_and_begins_again(open_page):
    """Plays by itself to the end, stops there, and begins again; the slider and its words follow."""
    robot = SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")
    scene = Scene(robot)
    q = np.array([robot.configuration({"joint_1": angle}) for angle in (0.0, 0.2, 0.4)])
    scene.animate(FloatingMotion(np.array([0.0, 0.2, 50.0]), q, np.zeros((3, robot.nv))))
    page = open_page(scene.html())
    play, slider, clock = page.locator("#play"), page.locator("#time"), page.locator("#clock")
    assert (play.inner_text(), play.get_attribute("aria-pressed"), clock.inner_text()) == ("Play", "false", "0.00 s")
    assert float(slider.get_attribute("max")) == pytest.approx(50.0)
    slider.fill("49.7")
    play.press("Enter")
    page.until("() => document.getElementById('play').textContent === 'Play' && clock.textContent === '50.00 s'")
    assert slider.get_attribute("aria-valuetext") == "50.00 s"
    play.press("Enter")
    page.until("() => document.getElementById('play').textContent === 'Pause' && Number(time.value) < 40")
    play.press("Enter")
    slider.press("Home")
    assert (clock.inner_text(), play.inner_text()) == ("0.00 s", "Play")
    slider.fill("0.2")
    assert clock.inner_text() == "0.20 s"
    hand = next(label.path for label in scene.content().labels if label.text == "end_effector")
    np.testing.assert_allclose(page.placed(hand)[0], frame_pose(robot, q[1], "end_effector"), rtol=0, atol=NEAR)


def test_a_scene_that_stands_has_no_player(open_page):
    page = open_page(Scene(SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")).html())
    assert not page.locator("#player").is_visible()
