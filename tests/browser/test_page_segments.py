"""Around a grasp and a release the page draws quantities of the segment's robot: combined while a target is held."""

import missions
import numpy as np
import pinocchio as pin
import pytest

from ospace.visual import run_report

pytestmark = pytest.mark.browser
BEFORE_AFTER = (
    -0.04,
    -0.02,
    -0.005,
    -0.0005,
    -1e-5,
    1e-5,
    0.0005,
    0.005,
    0.02,
    0.04,
)  # s, about each grasp and release
PARTS = ("whole", "base", "arms")


def centre_of_mass(robot, q):
    return pin.centerOfMass(robot.model, robot.model.createData(), q)


def effective_masses(robot, q, frame):
    """Return the eigenvalues of the translational Γ_e of a frame, kg, by crba and Jacobians."""
    model = robot.model
    data = model.createData()
    H = np.triu(pin.crba(model, data, q))
    H += np.triu(H, 1).T
    J = pin.computeFrameJacobian(model, data, q, model.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED)[:3]
    return np.linalg.eigvalsh(np.linalg.inv(J @ np.linalg.solve(H, J.T)))


def momentum(robot, q, v):
    """Return momentum about the centre of mass (6,)."""
    return np.array(pin.computeCentroidalMomentum(robot.model, robot.model.createData(), q, v).vector)


def opened(open_page, run):
    scene = run_report.scene_of(run.scenario)
    run_report.animate(scene, run)
    return scene, open_page(scene.html())


def segment_at(run, time):
    return next(one for one in reversed(run.segments) if time >= one.trajectory.time[0])


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A short run with a grasp and a release, of a robot that moves."""
    return missions.flown(tmp_path_factory.mktemp("segments"))


@pytest.mark.parametrize("which", ["flown", "grasped"])
def test_drawn_quantities_are_those_of_the_segment_s_robot(open_page, request, which):
    run = request.getfixturevalue(which)
    scene, page = opened(open_page, run)
    changes = [segment.trajectory.time[0] for segment in run.segments[1:]]
    times = np.array([change + offset for change in changes for offset in BEFORE_AFTER])
    layers = {layer.name: layer.paths for layer in scene.content().layers}
    ellipsoids = layers["operational-inertia"]
    frames = [label.text for label in scene.content().labels if label.layer == "points"]
    assert len(ellipsoids) == len(frames)
    arrows = [f"/quantities/{kind} {part}" for part in PARTS for kind in ("linear", "angular")]
    nodes = ["/quantities/mass centre", *ellipsoids, *arrows]
    found = page.along(nodes, times)
    semi_axes = np.linalg.norm(page.along(ellipsoids[:1], [0.0])[0, 0, :3, :3], axis=0)
    start = run.segments[0]
    scale = semi_axes.max() / effective_masses(start.robot, start.trajectory.q[0], frames[0])[-1] ** 0.5
    seen_robots, drawn, wanted = set(), [], []
    for time, poses in zip(times, found, strict=True):
        segment = segment_at(run, time)
        seen_robots.add(segment.robot.name)
        q, v = segment.trajectory.at(segment.robot, time)
        q[:3] -= scene.frame.origin + time * scene.frame.velocity
        v[:3] -= pin.XYZQUATToSE3(q[:7]).rotation.T @ scene.frame.velocity
        np.testing.assert_allclose(poses[0, :3, 3], centre_of_mass(segment.robot, q), rtol=0, atol=3e-4)
        for T, frame in zip(poses[1:], frames, strict=False):
            masses = (np.linalg.norm(T[:3, :3], axis=0) / scale) ** 2
            np.testing.assert_allclose(np.sort(masses), effective_masses(segment.robot, q, frame), rtol=2e-2)
        whole = nodes.index("/quantities/linear whole")
        drawn.append(poses[whole : whole + 2, :3, 2])
        wanted.append(momentum(segment.robot, q, v).reshape(2, 3))
    assert len(seen_robots) == 2
    for kind in range(2):  # arrows as long as the momentum, by one scale for all times
        arrow, h = np.array(drawn)[:, kind], np.array(wanted)[:, kind]
        np.testing.assert_allclose(arrow, h * (arrow * h).sum() / (h * h).sum(), rtol=0, atol=1e-2 * abs(arrow).max())


def test_the_arrow_of_the_whole_momentum_rests_while_the_target_is_held(open_page, grasped):
    """Nothing acts from outside: neither its length nor its direction changes by a hundredth."""
    held = next(segment for segment in grasped.segments if segment.holds)
    _, page = opened(open_page, grasped)
    times = np.linspace(held.trajectory.time[0], held.trajectory.time[-1], 40)
    found = page.along(["/quantities/linear whole", "/quantities/angular whole"], times)[:, :, :3, 2]
    for arrow in np.moveaxis(found, 1, 0):
        size = np.linalg.norm(arrow, axis=1)
        assert size.min() > 1e-3
        np.testing.assert_allclose(arrow, arrow[:1].repeat(len(times), axis=0), rtol=0, atol=1e-2 * size[0])
