"""Every visual stands where forward kinematics and its URDF put it, layers switch, quantities are what they claim."""

import re
import site
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest
import trimesh

import ospace
from ospace import SpaceRobot
from ospace.visual import Scene

pytestmark = pytest.mark.browser
MODELS = Path(ospace.__file__).parents[1] / "models"
ROBOTS = next(
    (one for one in (Path(two) / "cmeel.prefix/share/example-robot-data/robots" for two in site.getsitepackages())),
)
MESHED = {  # with meshes that are whole, scaled, and mirrored
    "laikago": "laikago_description/urdf/laikago.urdf",
    "quadruped": "quadruped_description/urdf/quadruped.urdf",
    "human": "human_description/robots/human.urdf",
}


def numbers(text, default):
    return np.array([float(one) for one in (text or default).split()])


def visuals(robot, q):
    """Yield path, world placement and element of each <visual>, from the file and Pinocchio's forward kinematics."""
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, q)
    for link in ElementTree.parse(robot.source).iter("link"):
        frame = model.getFrameId(link.get("name"), pin.FrameType.BODY)
        for k, visual in enumerate(one for one in link if one.tag in ("visual", "collision")):
            if visual.tag == "collision":
                continue
            origin = visual.find("origin")
            xyz, rpy = ("0 0 0", "0 0 0") if origin is None else (origin.get("xyz"), origin.get("rpy"))
            local = pin.SE3(pin.rpy.rpyToMatrix(numbers(rpy, "0 0 0")), numbers(xyz, "0 0 0"))
            yield f"/robot/link {link.get('name')}/visual {k}", data.oMf[frame] * local, visual.find("geometry")[0]


def bounds(robot, T, shape):
    """Return the corners of the world-aligned box about a shape at `T`."""
    R, p = T.rotation, T.translation
    if shape.tag == "mesh":
        name = shape.get("filename").split("robots/", 1)[1]
        scene = trimesh.load_scene(ROBOTS / name)
        vertices = np.concatenate([one.vertices for one in scene.dump()]) * numbers(shape.get("scale"), "1 1 1")
        world = vertices @ R.T + p
        return world.min(axis=0), world.max(axis=0)
    if shape.tag == "box":
        half = np.abs(R) @ (0.5 * numbers(shape.get("size"), ""))
    elif shape.tag == "sphere":
        half = np.full(3, float(shape.get("radius")))
    else:
        radius, length = float(shape.get("radius")), float(shape.get("length"))
        half = 0.5 * length * np.abs(R[:, 2]) + radius * np.sqrt(np.maximum(0.0, 1.0 - R[:, 2] ** 2))
    return p - half, p + half


def random_configuration(robot, seed):
    rng = np.random.default_rng(seed)
    turn = pin.Quaternion(pin.exp3(rng.normal(size=3))).coeffs()
    return np.asarray(
        pin.integrate(robot.model, pin.neutral(robot.model), np.r_[np.zeros(6), rng.uniform(-1, 1, robot.nv - 6)])
    ) + np.r_[rng.normal(size=3), turn - [0, 0, 0, 1], np.zeros(robot.nq - 7)]


@pytest.mark.parametrize("name", ["chaser_24dof", *MESHED])
def test_every_visual_is_where_it_belongs(open_page, name):
    file = ROBOTS / MESHED[name] if name in MESHED else MODELS / f"{name}.urdf"
    robot = SpaceRobot.from_urdf(file, package_dirs=[ROBOTS.parents[1]])
    scene = Scene(robot)
    q = random_configuration(robot, 3)
    start = pin.neutral(robot.model)
    scene.display(start)
    scene.display(q)
    assert scene.findings == []
    found = open_page(scene.html()).meshes()
    left = {path for path in found if "/robot/link " in path}
    expected = list(visuals(robot, q))
    assert len(expected) > 10
    for path, T, shape in expected:
        mine = {one for one in left if re.search(rf"{re.escape(path)}(\.\d+)?$", one)}
        assert mine, path
        left -= mine
        assert all(found[one]["triangles"] > 3 and found[one]["shown"] for one in mine)
        lower = np.min([found[one]["lower"] for one in mine], axis=0)
        upper = np.max([found[one]["upper"] for one in mine], axis=0)
        low, high = bounds(robot, T, shape)
        size = np.linalg.norm(high - low)
        round_ = shape.tag in ("cylinder", "sphere", "capsule")  # which triangles cut the corners of
        np.testing.assert_allclose([lower, upper], [low, high], rtol=0, atol=(2e-2 if round_ else 3e-6) * size)
        if shape.tag in ("box", "sphere"):
            np.testing.assert_allclose(found[min(mine)]["world"], T.homogeneous, rtol=0, atol=1e-12)
        if shape.tag == "cylinder":
            world = found[min(mine)]["world"]
            np.testing.assert_allclose(world[:3, 3], T.translation, rtol=0, atol=1e-12)
            np.testing.assert_allclose(world[:3, 1], T.rotation[:, 2], rtol=0, atol=1e-12)
    assert left == set()
