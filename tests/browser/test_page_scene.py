"""Every visual stands where forward kinematics and its URDF put it, layers switch, quantities are what they claim."""

import io
import re
import site
from pathlib import Path
from xml.etree import ElementTree
from xml.sax import saxutils

import numpy as np
import pinocchio as pin
import pytest
import trimesh
from PIL import Image

import ospace
from ospace import SpaceRobot
from ospace.cli.main import main
from ospace.visual import Scene
from ospace.visual.scene import LAYERS, SHOWN

pytestmark = pytest.mark.browser
MODELS = Path(ospace.__file__).parents[1] / "models"
FOLDERS = [Path(folder) / "cmeel.prefix/share/example-robot-data/robots" for folder in site.getsitepackages()]
ROBOTS = next((folder for folder in FOLDERS if folder.is_dir()), FOLDERS[0])
MESHED = {  # with meshes that are whole, scaled, and mirrored
    "laikago": "laikago_description/urdf/laikago.urdf",
    "centauro": "centauro_description/urdf/centauro.urdf",
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
    return (
        np.asarray(
            pin.integrate(robot.model, pin.neutral(robot.model), np.r_[np.zeros(6), rng.uniform(-1, 1, robot.nv - 6)])
        )
        + np.r_[rng.normal(size=3), turn - [0, 0, 0, 1], np.zeros(robot.nq - 7)]
    )


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


# -- pictures ----------------------------------------------------------------------------------------------------


def colours(picture):
    """Return how many distinct colours a picture has, and shares of it that are golden and blue."""
    rgb = np.asarray(picture.convert("RGB")).reshape(-1, 3).astype(int)
    red, green, blue = rgb.T
    golden = (red > 100) & (red > green + 20) & (green > blue + 30)
    panels = (blue > 60) & (blue > red + 35) & (blue > green + 20)
    return len(np.unique(rgb, axis=0)), golden.mean(), panels.mean()


def test_a_screenshot_shows_the_robot(chromium, tmp_path, capsys):
    file = tmp_path / "chaser.png"
    assert main(["view", "chaser_24dof", "--screenshot", str(file)]) == 0
    assert capsys.readouterr().out == f"wrote {file}\n"
    picture = Image.open(file)
    assert (picture.format, picture.size) == ("PNG", (1000, 700))
    distinct, golden, panels = colours(picture)
    assert distinct > 1000
    assert golden > 0.005
    assert panels > 0.005


def test_a_page_is_drawn(open_page):
    scene = Scene(SpaceRobot.from_urdf(MODELS / "planar_2r.urdf"), background="paper")
    page = open_page(scene.html(), (400, 300), drawn=True)
    page.until("() => ospace.viewer.renderer.info.render.triangles > 1000")
    distinct, golden, panels = colours(Image.open(io.BytesIO(page.screenshot())))
    assert distinct > 300
    assert min(golden, panels) > 0.002


# -- layers ------------------------------------------------------------------------------------------------------


@pytest.fixture
def planar():
    return SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")


def layer_of(path):
    """Return the layer that a mesh belongs to, by its place in the scene."""
    for layer in ("robot", "collision", "inertia", "points"):
        if f"/{layer}/" in path.removeprefix("/robots/"):
            return layer
    kind = path.split("/")[2].split(" ")[0]
    return {"mass": "mass-centre", "inertia": "operational-inertia", "linear": "momentum", "angular": "momentum"}.get(
        kind, "manipulability"
    )


def shown_layers(page):
    """Return the layers of which all is shown; the others are hidden as a whole."""
    shown = {}
    for path, mesh in page.meshes().items():
        shown.setdefault(layer_of(path), set()).add(mesh["shown"])
    assert set(shown) == set(LAYERS)
    assert all(len(states) == 1 for states in shown.values()), shown
    return {layer for layer, states in shown.items() if states == {True}}


def test_layers_are_switched_by_their_buttons(open_page, planar):
    page = open_page(Scene(planar).html())
    shown = set(SHOWN)
    assert shown_layers(page) == shown
    boxes = page.locator("#layers input")
    assert boxes.count() == len(LAYERS)
    for name in LAYERS:
        box = page.locator(f"#layers input[data-layer='{name}']")
        assert box.is_checked() == (name in shown)
        box.press("Space")
        shown ^= {name}
        assert shown_layers(page) == shown
    page.locator("#layers input[data-layer='points']").press("Space")
    page.until("() => [...document.querySelectorAll('#labels span')].some((one) => one.textContent === 'end_effector')")
    assert page.locator("#labels").get_by_text("end_effector").is_visible()


def test_layers_shown_at_first_follow_the_option(open_page, tmp_path, capsys):
    file = tmp_path / "scene.html"
    arguments = ["view", "planar_2r", "--layers", "momentum, robot", "--collision", "--html", str(file)]
    assert main(arguments) == 0
    assert file.name in capsys.readouterr().out
    assert shown_layers(open_page(file)) == {"collision", "momentum"}


# -- quantities --------------------------------------------------------------------------------------------------


OFFSET = pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3]))


@pytest.fixture(scope="module")
def measured():
    """Return a robot in motion, its state, and its scene."""
    robot = SpaceRobot.from_urdf(MODELS / "chaser_24dof.urdf")
    q = random_configuration(robot, 5)
    v = np.random.default_rng(6).normal(size=robot.nv)
    points = [robot.point("right_hand"), robot.point("left_hand", offset=OFFSET)]
    scene = Scene(robot, points, show=LAYERS)
    scene.display(q, v)
    return robot, points, q, v, scene


def spread(T):
    """Return M Mᵀ of a placement of a unit ball: squared semi-axes with their directions, whatever their signs."""
    return T[:3, :3] @ T[:3, :3].T


def close(actual, desired, error=1e-9):
    np.testing.assert_allclose(actual, desired, rtol=0, atol=error * np.abs(desired).max())


def test_ellipsoids_are_those_of_the_quantities(open_page, measured):
    robot, points, q, v, scene = measured
    names = [f"{kind} {point.frame} {k}" for kind in ("inertia", "floating", "held") for k, point in enumerate(points)]
    page = open_page(scene.html())
    placed = dict(zip(names, page.placed(*(f"/quantities/{name}" for name in names)), strict=True))
    legend = page.locator("label", has=page.locator("[data-layer='operational-inertia']")).locator("small").inner_text()
    scale = float(re.search(r"semi-axes are (\S+) cm", legend)[1]) / 100.0
    state, model, data = robot.state(q, v), robot.model, robot.model.createData()
    mass = pin.crba(model, data, q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    for k, point in enumerate(points):
        linear = robot.point(point.frame, "linear", offset=OFFSET if k else None)
        jacobian = ospace.operational_space(state, linear, method="dense").jacobian
        at = state.placement(linear).translation - q[:3]
        for kind in ("inertia", "floating", "held"):
            np.testing.assert_allclose(placed[f"{kind} {point.frame} {k}"][:3, 3], at, rtol=0, atol=1e-9)
        inertia = ospace.operational_space(state, linear).inertia
        drawn = spread(placed[f"inertia {point.frame} {k}"])
        close(drawn / np.trace(drawn), inertia / np.trace(inertia))
        assert np.sqrt(np.trace(drawn) / np.trace(inertia)) == pytest.approx(scale, rel=0.06)
        star = ospace.generalized_jacobian(state, linear).generalized_jacobian
        close(spread(placed[f"floating {point.frame} {k}"]), 0.2**2 * star @ star.T)
        held = jacobian[:, 6:]
        close(spread(placed[f"held {point.frame} {k}"]), 0.2**2 * held @ held.T)
    # by Pinocchio alone
    J = pin.computeFrameJacobian(model, data, q, model.getFrameId("right_hand"), pin.LOCAL_WORLD_ALIGNED)[:3]
    drawn = spread(placed["inertia right_hand 0"])
    inertia = np.linalg.inv(J @ np.linalg.inv(mass) @ J.T)
    close(drawn / np.trace(drawn), inertia / np.trace(inertia), 1e-7)


def test_arrows_point_along_the_momentum(open_page, measured):
    robot, _, q, v, scene = measured
    names = [f"{kind} {part}" for kind in ("linear", "angular") for part in ("whole", "base", "arms")]
    page = open_page(scene.html())
    placed = dict(zip(names, page.placed(*(f"/quantities/{name}" for name in names)), strict=True))
    assert all(np.linalg.det(T[:3, :3]) > 0.0 for T in placed.values())
    centre = np.array(pin.centerOfMass(robot.model, robot.model.createData(), q)) - q[:3]
    ball = page.placed("/quantities/mass centre")[0]
    np.testing.assert_allclose(ball[:3, 3], centre, rtol=0, atol=1e-9)
    h = ospace.momentum(robot.state(q, v))
    along = {"linear": h[:3], "angular": h[3:] - np.cross(centre, h[:3])}
    oracle = pin.computeCentroidalMomentum(robot.model, robot.model.createData(), q, v)
    close(np.r_[along["linear"], along["angular"]], oracle.vector, 1e-8)
    own = robot.model.inertias[1] * pin.Motion(v[:6])
    R = pin.XYZQUATToSE3(q[:7]).rotation
    base = {"linear": R @ own.linear, "angular": R @ own.angular - np.cross(centre, R @ own.linear)}
    for kind in ("linear", "angular"):
        arms = along[kind] - base[kind]
        whole, of_base, of_arms = (placed[f"{kind} {part}"][:3, 2] for part in ("whole", "base", "arms"))
        factor = np.linalg.norm(whole) / np.linalg.norm(along[kind])
        close(np.stack([whole, of_base, of_arms]), factor * np.stack([along[kind], base[kind], arms]), 1e-7)
        np.testing.assert_allclose(placed[f"{kind} whole"][:3, 3], centre, rtol=0, atol=1e-9)


BOXES = """<robot name="boxes">
  <link name="base"><inertial><origin xyz="0.1 0 0" rpy="0.3 -0.2 0.5"/><mass value="12"/>
    <inertia ixx="0.52" iyy="0.4" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="wrong"><inertial><mass value="2"/>
    <inertia ixx="1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="wrong"/><origin xyz="1 0 0"/>
    <axis xyz="0 0 1"/></joint>
</robot>"""


def test_ellipsoids_of_inertia(open_page, tmp_path):
    """A box of 20 x 40 x 60 cm and 12 kg, and a tensor that no mass can have."""
    file = tmp_path / "boxes.urdf"
    file.write_text(BOXES)
    robot = SpaceRobot.from_urdf(file)
    scene = Scene(robot, show=["inertia"])
    found = open_page(scene.html()).meshes()
    box = next(mesh for path, mesh in found.items() if "inertia/link base" in path)
    wrong = next(mesh for path, mesh in found.items() if "inertia/link wrong" in path)
    R = pin.rpy.rpyToMatrix(0.3, -0.2, 0.5)
    close(spread(box["world"]), R @ np.diag([0.1**2, 0.2**2, 0.3**2]) @ R.T * 5.0 / 3.0)
    np.testing.assert_allclose(box["world"][:3, 3], [0.1, 0.0, 0.0], rtol=0, atol=1e-12)
    assert box["triangles"] > 1000
    assert (box["colour"] >> 16, box["colour"] >> 8 & 255) == (255, 184)
    assert wrong["colour"] == 0xFF2626


# -- names -------------------------------------------------------------------------------------------------------

ODD = ("a/b", "__proto__", "constructor", "<b>bold</b>", "<object>", "toString", "%2F", "</script><img src=x>", "ü ''")


def test_points_with_any_name_are_shown(open_page, tmp_path):
    """All are solids of their own; none is read as a path, as something of JavaScript's, or as markup."""
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    shape = '<visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual>'
    odd = [saxutils.quoteattr(name) for name in ODD]
    links = "".join(f"<link name={name}>{body}{shape}</link>" for name in odd)
    joints = "".join(
        f"<joint name={name} type='prismatic'><parent link='base'/><child link={name}/><origin xyz='{k + 1} 0 0'/>"
        "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
        for k, name in enumerate(odd)
    )
    file = tmp_path / "odd.urdf"
    title = saxutils.quoteattr(ODD[-2])
    file.write_text(f"<robot name={title}><link name='base'>{body}</link>{links}{joints}</robot>", encoding="utf-8")
    robot = SpaceRobot.from_urdf(file)
    scene = Scene(robot, [robot.point(name) for name in ODD])
    scene.display(robot.configuration(dict.fromkeys(ODD, 0.5)))
    page = open_page(scene.html())
    boxes = [mesh for mesh in page.meshes().values() if mesh["triangles"] == 12]
    centres = sorted(tuple(np.round(mesh["world"][:3, 3], 9)) for mesh in boxes)
    assert centres == [(k + 1.0, 0.0, 0.5) for k in range(len(ODD))]
    assert page.locator("h1").inner_text() == ODD[-2]
    page.until("() => document.querySelectorAll('#labels span').length > 3")
    labels = page.evaluate("[...document.querySelectorAll('#labels span')].map((one) => one.textContent)")
    assert set(labels) == {*ODD, "centre of mass"}
    assert page.locator("img").count() == 0


def test_a_notebook_shows_a_scene(open_page, planar):
    """In a sandboxed frame, as a notebook has it."""
    page = open_page(
        f"<!DOCTYPE html><title>notebook</title>{Scene(planar)._repr_html_()}", (500, 400), bare=True, drawn=True
    )
    frame = page.frame_locator("iframe")
    frame.locator("#pane canvas").wait_for()
    inside = page.frames[1]
    inside.evaluate("ospace.ready")
    inside.wait_for_function("() => ospace.viewer.renderer.info.render.triangles > 1000")
    assert frame.locator("h1").inner_text() == "planar_2r"
