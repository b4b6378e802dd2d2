"""The page of a map: cubes coloured by a quantity, slices, tooltips, and the robot where a cube was clicked."""

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace import analysis
from ospace.analysis.map_result import MapResult
from ospace.cli.main import main
from ospace.visual import map_report
from ospace.visual.scene import Scene

pytestmark = pytest.mark.browser
SHOWN = "Array.from(ospaceMap.shown)"
COLOUR = (
    """(k) => { const c = new MeshCat.THREE.Color(); ospaceMap.cubes.getColorAt(k, c); return c.getHexString(); }"""
)
SEEN = """(k) => {
  const { THREE } = MeshCat, T = new THREE.Matrix4(), at = new THREE.Vector3();
  ospaceMap.cubes.getMatrixAt(k, T);
  ospaceMap.cubes.updateWorldMatrix(true, false);
  at.setFromMatrixPosition(T).applyMatrix4(ospaceMap.cubes.matrixWorld).project(ospace.viewer.camera);
  const pane = document.getElementById("pane").getBoundingClientRect();
  return [pane.x + 0.5 * (1 + at.x) * pane.width, pane.y + 0.5 * (1 - at.y) * pane.height];
}"""


def result_of(robot, frame, what=("reach", "singularity"), **options):
    arm = analysis.Arm(robot, robot.point(frame, options.pop("axes", "all")), **options)
    found = analysis.map_arm(arm, what, random=800)
    return MapResult(found, None, None, found.count, "random, seed 0")


@pytest.fixture
def opened(open_page):
    def call(result, **options):
        page = open_page(map_report.render(result, name="robot"), (900, 800), **options)
        page.evaluate("ospaceMap.loaded")
        return page

    return call


def coupled():
    robot = trees.coupled(3)
    return robot, robot.leaf_links[-1], {"joints": ["joint_1", "joint_2"], "at": trees.state(robot, 1).q}


@pytest.mark.parametrize("which", ["chaser_7dof", "coupled"])
def test_the_robot_stands_where_pinocchio_has_it(opened, which):
    robot, frame, options = coupled() if which == "coupled" else (None, "end_effector", {})
    robot = robot or ospace.SpaceRobot.from_urdf(ospace.models.path(which))
    result = result_of(robot, frame, **options)
    arm, scene = result.arm, Scene(robot)
    page = opened(result)
    for x in (arm.home, *arm.draw(np.random.default_rng(2), 3)):
        page.evaluate("(x) => ospaceMap.put(x)", x.tolist())
        q, data = arm.configurations(x[None])[0], robot.model.createData()
        pin.forwardKinematics(robot.model, data, q)
        expected = [data.oMi[j].homogeneous for j in range(1, robot.model.njoints)]
        np.testing.assert_allclose(page.placed(*scene.nodes), expected, atol=1e-9)


def test_cubes_are_the_voxels_in_the_colours_of_their_values(opened):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    result = result_of(robot, "end_effector", axes="linear")
    found, page = result.arm_map, opened(result)
    count = len(found.voxels.index)
    assert page.evaluate("ospaceMap.cubes.count") == count
    assert page.input_value("#field-quantity") == "1"
    assert page.locator("#field-quantity option:checked").inner_text() == "smallest singular value of J*"
    assert page.input_value("#field-end") == "high"
    values = found.voxels.high[:, 1]
    assert page.inner_text("#field-most") == f"{values.max():.4g}"
    assert page.evaluate(COLOUR, int(values.argmin())) == "440154"
    assert page.evaluate(COLOUR, int(values.argmax())) == "fde725"
    page.select_option("#field-end", "low")
    assert page.evaluate(COLOUR, int(found.voxels.low[:, 1].argmax())) == "fde725"
    page.select_option("#field-quantity", "0")
    assert page.inner_text("#field-least").endswith(" m")


def test_a_slice_shows_one_layer_of_cubes(opened):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("ets_vii"))
    result = result_of(robot, "end_effector")
    index, page = result.arm_map.voxels.index, opened(result)
    assert page.input_value("#field-slice") == "1"  # so that the robot is seen
    for axis in range(3):
        page.select_option("#field-slice", str(axis))
        layers = np.unique(index[:, axis])
        for place in (0, len(layers) - 1):
            page.locator("#field-place").fill(str(place))
            assert page.evaluate(SHOWN) == np.flatnonzero(index[:, axis] == layers[place]).tolist()
            told = page.inner_text("#field-at")
            assert told.startswith(f"{'xyz'[axis]} = ")
            assert float(told.split()[2]) == pytest.approx(result.arm_map.voxel * layers[place], rel=1e-3)
    page.select_option("#field-slice", "")
    assert len(page.evaluate(SHOWN)) == len(index)
    assert not page.locator("#field-place").is_visible()


def test_a_cube_tells_its_posture_and_takes_the_robot_there(opened):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    result = result_of(robot, "end_effector", axes="linear")
    found, page = result.arm_map, opened(result)
    cube = int(found.voxels.high[:, 1].argmax())
    x, y = page.evaluate(SEEN, cube)
    page.mouse.move(x - 3, y)
    page.mouse.move(x, y)
    page.wait_for_function("document.querySelector('#pane').title")
    hint = page.get_attribute("#pane", "title")
    posture = found.voxels.at_high[cube, 1]
    assert hint.startswith(f"smallest singular value of J*, largest: {found.voxels.high[cube, 1]:.4g} with the hand")
    assert f"joint_1 {posture[0]:.4f} rad ({np.rad2deg(posture[0]):.1f} deg)" in hint
    page.mouse.click(x, y)
    np.testing.assert_allclose(page.evaluate("ospaceMap.x"), posture, atol=1e-6)
    assert page.inner_text("#field-told") == hint
    page.locator("[data-layer='map']").uncheck()
    page.mouse.move(x - 3, y)
    assert page.get_attribute("#pane", "title") == ""
    page.locator("#field-home").click()
    np.testing.assert_allclose(page.evaluate("ospaceMap.x"), result.arm.home)


def test_extremes_are_buttons_that_put_the_robot_there(opened):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    result = result_of(robot, "end_effector", ("reach", "level-base"), axes="linear")
    page = opened(result)
    page.get_by_role("button", name="robot where turn of the base is largest").click()
    c = [one.name for one in result.arm_map.quantities].index("base_turn")
    np.testing.assert_allclose(page.evaluate("ospaceMap.x"), result.arm_map.whole.at_high[0, c])
    assert page.locator("#level-table tbody tr").count() == len(result.grades)


def test_the_command_writes_the_page(open_page, tmp_path):
    file = tmp_path / "map.html"
    assert main(["map", "planar_2r", "--random", "400", "--html", str(file)]) == 0
    page = open_page(file, (900, 800))
    page.evaluate("ospaceMap.loaded")
    facts = dict(row.split("\t") for row in page.locator("#facts-table tbody tr").all_inner_texts())
    assert facts["path-dependent"].startswith("1.4436 to 2.2872 m (PDW)")
    assert page.locator("figure svg").count() == 6


def test_a_map_that_was_interrupted_before_its_first_posture_has_a_page(opened):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    arm = analysis.Arm(robot, robot.point("end_effector"))
    page = opened(MapResult(analysis.ArmMap.empty(arm, ["reach"]), None, None, 9, "random", True))
    assert page.locator("#extremes + p").inner_text() == "No posture was mapped."
    assert not page.locator("#field-controls").is_visible()
