"""Meshes are measured where they are found: what does not fit their extent is told, by link."""

import pytest
import trimesh

import ospace
from ospace.validation.mesh_boxes import of_meshes
from ospace.validation.report import check

ROBOT = """<robot name="drawn">
  <link name="base">
    <inertial><mass value="100"/><inertia ixx="20" iyy="20" izz="20" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="arm">
    <visual><origin xyz="0 0 0.5" rpy="0.3 0 0"/><geometry><mesh filename="{file}" scale="{scale}"/></geometry></visual>
    <inertial><origin xyz="{centre}"/><mass value="{mass}"/>
      <inertia ixx="{moment}" iyy="{moment}" izz="{moment}" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="elbow" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="10" velocity="1"/></joint>
</robot>
"""


@pytest.fixture
def read(tmp_path):
    trimesh.creation.box((0.2, 0.2, 1.0)).export(tmp_path / "arm.stl")
    trimesh.creation.box((200.0, 200.0, 1000.0)).export(tmp_path / "arm_mm.obj")
    (tmp_path / "cut.stl").write_text("solid arm\n facet normal 0 0")
    (tmp_path / "elsewhere.dae").write_text("garbage")

    def robot(file="arm.stl", scale="1 1 1", centre="0 0 0.5", moment=0.35, mass=4.0):
        path = tmp_path / "drawn.urdf"
        path.write_text(ROBOT.format(file=file, scale=scale, centre=centre, moment=moment, mass=mass))
        return ospace.SpaceRobot.from_urdf(path)

    return robot


def told(robot):
    return [(finding.code, finding.subject) for finding in of_meshes(robot)]


@pytest.mark.parametrize(
    "fitting",
    [{}, {"file": "arm_mm.obj", "scale": "0.001 0.001 0.001"}, {"scale": "1 -1 1"}, {"file": "elsewhere.dae"}],
)
def test_a_mesh_that_fits_its_inertia_is_not_reported(read, fitting):
    assert told(read(**fitting)) == []


@pytest.mark.parametrize(
    ("wrong", "code"),
    [
        ({"moment": 40.0}, "gyration-large"),
        ({"moment": 1e-5, "mass": 0.1}, "gyration-small"),
        ({"centre": "0 0 2.5"}, "centre-outside"),
        ({"file": "arm_mm.obj"}, "units-length"),
        ({"file": "cut.stl"}, "mesh-unreadable"),
    ],
)
def test_a_mesh_that_does_not_fit_is_reported_by_link(read, wrong, code):
    assert (code, "link 'arm'") in told(read(**wrong))


def test_a_missing_mesh_is_reported_once(read):
    robot = read(file="nowhere.stl")
    assert told(robot) == []
    assert [finding.code for finding in robot.findings] == ["mesh-missing"]


def test_check_reports_boxes_that_do_not_fit(read):
    robot = read(moment=40.0)
    report = check(robot, [robot.point("arm")], samples=1)
    assert "gyration-large" in [finding.code for finding in report.findings]
    assert report.errors == 0
