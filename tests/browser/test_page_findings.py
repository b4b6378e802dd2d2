"""Whoever points at a link, or at its name, is shown what was found there."""

import pytest

from ospace import SpaceRobot
from ospace.cli.main import main
from ospace.visual import Scene

pytestmark = pytest.mark.browser
INERTIA = '<inertia ixx="1" iyy="1" izz="1.5" ixy="0" ixz="0" iyz="0"/>'
ROBOT = f"""<robot name="faulty">
<link name="base"><inertial><mass value="MASS"/>{INERTIA}</inertial>
  <visual><geometry><box size="1 1 1"/></geometry></visual></link>
<link name="arm"><inertial><origin rpy="90 0 0"/><mass value="3"/>{INERTIA}</inertial>
  <visual><geometry><box size="1 1 1"/></geometry></visual></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 3 0"/>
  <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""
PLACE = """(path) => {
  const { THREE } = MeshCat, { viewer, node } = ospace, at = new THREE.Vector3();
  node(path).getWorldPosition(at).project(viewer.camera);
  const pane = document.getElementById("pane").getBoundingClientRect();
  return [pane.x + 0.5 * (1 + at.x) * pane.width, pane.y + 0.5 * (1 - at.y) * pane.height];
}"""
HINTED = "(hint) => document.getElementById('pane').title.startsWith(hint)"


def point_at(page, path, hint):
    """Move the mouse to where a node is seen, and wait for the hint; an empty one stands nowhere."""
    x, y = page.evaluate(PLACE, path)
    page.mouse.move(x - 3, y)
    page.mouse.move(x, y)
    page.until(HINTED if hint else "() => document.getElementById('pane').title === ''", hint)


def test_a_faulty_link_shows_its_findings(open_page, tmp_path):
    file = tmp_path / "faulty.urdf"
    file.write_text(ROBOT.replace("MASS", "-2"))
    assert main(["view", str(file), "--html", str(tmp_path / "page.html")]) == 1
    page = open_page(tmp_path / "page.html", (900, 600))
    colours = {path: one["colour"] for path, one in page.meshes().items() if "/visual" in path}
    assert [(path.split("link ")[1].split("/")[0], f"{colour:06x}") for path, colour in sorted(colours.items())] == [
        ("arm", "ff9e00"), ("base", "ed2121"),
    ]  # fmt: skip
    assert page.locator("#labels span").all_inner_texts() == ["base: error", "arm: warning"]
    page.locator("[data-layer='names']").uncheck()
    point_at(page, "/robot/body base", "error negative-mass: link 'base', line 2: mass -2 kg is negative")
    point_at(page, "/robot/body arm", "warning units-angle: link 'arm', line 4")
    page.mouse.move(5, 400)
    page.until("() => document.getElementById('pane').title === ''")
    hints = page.locator("#labels span").evaluate_all("(all) => all.map((one) => one.title)")
    assert [hint.split(":")[0] for hint in hints] == ["error negative-mass", "warning units-angle"]
    page.locator("#notes summary").click()
    assert page.locator("#notes li").first.inner_text().startswith("error negative-mass: link 'base'")


def test_a_sound_robot_keeps_its_colours_and_shows_its_warnings(open_page, tmp_path):
    file = tmp_path / "sound.urdf"
    file.write_text(ROBOT.replace("MASS", "2"))
    robot = SpaceRobot.from_urdf(file)
    scene = Scene(robot, [], show=["robot"])
    scene.display(robot.configuration({"shoulder": 0.5}))
    page = open_page(scene.html(), (900, 600))
    assert {one["colour"] for path, one in page.meshes().items() if "/visual" in path} == {0xB8BDC7}
    point_at(page, "/robots/0 faulty/joint shoulder", "warning units-angle: link 'arm', line 4")
    point_at(page, "/robots/0 faulty/base", "")
