"""Meshes are measured where they are found: what does not fit their extent is reported, by link."""

import json
import os

import pytest
import trimesh

import ospace
from ospace.cli.main import main
from ospace.urdf.lint.rules import RULES
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
    trimesh.creation.box((20.0, 20.0, 100.0)).export(tmp_path / "arm_cm.dae")
    of_centimetres = (tmp_path / "arm_cm.dae").read_text().replace("<asset>", '<asset><unit name="cm" meter="0.01"/>')
    (tmp_path / "arm_cm.dae").write_text(of_centimetres)
    (tmp_path / "cut.dae").write_text(of_centimetres[: len(of_centimetres) // 2])
    (tmp_path / "garbage.dae").write_text("garbage")
    (tmp_path / "vast.obj").write_text("v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "arm.step").write_text("ISO-10303-21;")
    (tmp_path / "points.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n0 0 0\n"
    )

    def robot(file="arm.stl", scale="1 1 1", centre="0 0 0.5", moment=0.35, mass=4.0):
        path = tmp_path / "drawn.urdf"
        path.write_text(ROBOT.format(file=file, scale=scale, centre=centre, moment=moment, mass=mass))
        return ospace.SpaceRobot.from_urdf(path)

    return robot


def found_in(robot):
    found = of_meshes(robot.description, robot.source, robot.package_dirs, robot.findings)
    return [(finding.code, finding.subject) for finding in found]


@pytest.mark.parametrize(
    "fitting",
    [{}, {"file": "arm_mm.obj", "scale": "0.001 0.001 0.001"}, {"scale": "1 -1 1"}, {"file": "arm_cm.dae"}],
)
def test_a_mesh_that_fits_its_inertia_is_not_reported(read, fitting):
    assert found_in(read(**fitting)) == []


@pytest.mark.parametrize(
    ("wrong", "code"),
    [
        ({"moment": 40.0}, "gyration-large"),
        ({"moment": 1e-5, "mass": 0.1}, "gyration-small"),
        ({"centre": "0 0 2.5"}, "centre-outside"),
        ({"file": "arm_mm.obj"}, "units-length"),
        ({"file": "arm_cm.dae", "moment": 40.0}, "gyration-large"),
        ({"file": "arm_cm.dae", "scale": "100 100 100"}, "units-length"),
        ({"file": "cut.stl"}, "mesh-unreadable"),
        ({"file": "cut.dae"}, "mesh-unreadable"),
        ({"file": "garbage.dae"}, "mesh-unreadable"),
        ({"file": "arm.step"}, "mesh-unreadable"),
        ({"file": "points.ply"}, "mesh-unreadable"),
        ({"file": "vast.obj"}, "mesh-unreadable"),
        ({"file": "vast.obj", "scale": "1e12 1 1"}, "mesh-unreadable"),
    ],
)
def test_a_mesh_that_does_not_fit_is_reported_by_link(read, wrong, code):
    assert (code, "link 'arm'") in found_in(read(**wrong))


def test_a_missing_mesh_is_reported_once(read):
    robot = read(file="nowhere.stl")
    assert found_in(robot) == []
    assert [finding.code for finding in robot.findings] == ["mesh-missing"]


def test_a_mesh_that_two_shapes_of_a_link_name_is_reported_once(read, tmp_path):
    robot = read(file="cut.dae")
    text = robot.source.read_text()
    visual = text[text.index("<visual>") : text.index("</visual>") + len("</visual>")]
    robot.source.write_text(text.replace(visual, visual + visual.replace("visual", "collision")))
    assert found_in(ospace.SpaceRobot.from_urdf(robot.source)) == [("mesh-unreadable", "link 'arm'")]


def test_a_mesh_that_was_written_again_is_measured_again(read, tmp_path):
    robot = read()
    assert found_in(robot) == []
    trimesh.creation.box((200.0, 200.0, 1000.0)).export(tmp_path / "arm.stl")
    os.utime(tmp_path / "arm.stl", ns=(1, 1))
    assert ("units-length", "link 'arm'") in found_in(robot)


def test_meshes_of_an_unsound_robot_are_read_too(read, capsys):
    file = read(file="cut.dae").source
    file.write_text(file.read_text().replace('mass value="4.0"', 'mass value="-4.0"'))
    assert main(["check", str(file), "--json"]) == 1
    codes = [finding["code"] for finding in json.loads(capsys.readouterr().out)["findings"]]
    assert {"negative-mass", "mesh-unreadable"} <= set(codes)
    severities = [RULES[code].severity for code in codes]
    assert severities == sorted(severities, key=["error", "warning", "info"].index)


def test_check_reports_boxes_that_do_not_fit(read):
    robot = read(moment=40.0)
    report = check(robot, [robot.point("arm")], samples=1)
    assert "gyration-large" in [finding.code for finding in report.findings]
    assert report.errors == 0
