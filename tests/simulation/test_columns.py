"""A trajectory as one table: named after joints, with units, and the numbers that the arrays have."""

import csv

import numpy as np
import pytest

import ospace
from ospace import models, simulation

TENSOR = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
KINDS = f"""<robot name="kinds"><link name="bus"><inertial><mass value="9"/>{TENSOR}</inertial></link>{{}}</robot>"""
ARM = f"""<link name="l{{0}}"><inertial><mass value="1"/>{TENSOR}</inertial></link>"""
ARM += """<joint name="{0}" type="{1}"><parent link="bus"/><child link="l{0}"/><axis xyz="0 0 1"/>
 <limit lower="-1" upper="1" effort="9" velocity="9"/></joint>"""


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    kinds = (("a, b", "revolute"), ("slide", "prismatic"), ("spin", "continuous"))
    file = tmp_path_factory.mktemp("robot") / "r.urdf"
    file.write_text(KINDS.format("".join(ARM.format(*one) for one in kinds)))
    return ospace.SpaceRobot.from_urdf(file)


@pytest.fixture(scope="module")
def run(robot):
    v = np.linspace(0.1, 0.9, robot.nv)
    return ospace.simulate(robot, robot.neutral(), v, lambda time, q, v: np.array([1.0, 2.0, 3.0]), duration=0.02)


def test_columns_are_named_after_joints_with_units(robot, run):
    table = run.as_dict(robot)
    names = list(table)
    assert names[:9] == ["time [s]", *(f"base {a} [m]" for a in "xyz"), *(f"base q{a}" for a in "xyzw"), "a, b [rad]"]
    assert {"slide [m]", "spin cos", "spin sin", "slide rate [m/s]", "spin rate [rad/s]"} <= set(names)
    assert {"slide torque [N]", "spin torque [N m]", "kinetic energy [J]", "angular momentum z [kg m^2/s]"} <= set(
        names
    )
    np.testing.assert_array_equal(table["slide torque [N]"], run.torque[:, 1])
    np.testing.assert_array_equal(table["spin sin"], run.q[:, -1])
    np.testing.assert_array_equal(table["a, b rate [rad/s]"], run.v[:, 6])
    assert len(names) == 1 + robot.nq + robot.nv + robot.n_joints + 6 + 3 + 3 + 6 + 3
    assert list(run.as_dict())[8] == "q[7]"


def test_a_data_frame_has_the_same_columns(robot, run):
    frame = run.to_dataframe(robot)
    assert list(frame.columns) == list(run.as_dict(robot))
    assert frame.shape[0] == len(run)
    assert frame["slide [m]"].iloc[-1] == run.q[-1, 8]


def test_files_have_the_same_headings(robot, run, tmp_path):
    files = {file.stem: file for file in run.to_csv(tmp_path, robot)}
    with files["q"].open() as file:
        heading, *rows = csv.reader(file)
    assert heading[8:] == ["a, b [rad]", "slide [m]", "spin cos", "spin sin"]
    assert [float(cell) for cell in rows[-1]] == [run.time[-1], *run.q[-1]]


def test_another_robot_s_names_are_refused(run):
    other = ospace.SpaceRobot.from_urdf(models.path("target"))
    with pytest.raises(ospace.OspaceError, match="is of 'kinds'"):
        run.as_dict(other)


def test_without_pandas_the_extra_is_named(robot, run, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ospace.OspaceError, match=r"a data frame needs pandas: pip install -e '\.\[dataframe\]'"):
        run.to_dataframe(robot)


@pytest.mark.parametrize("name", models.names())
def test_every_number_of_a_robot_has_a_name_of_its_own(name):
    robot = ospace.SpaceRobot.from_urdf(name)
    names = simulation.columns.Names.of(robot)
    assert [len(set(one)) for one in names] == [robot.nq, robot.nv, robot.n_joints]
