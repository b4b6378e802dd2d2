"""`ospace map` as its users meet it: tables, documents, files, exit status, Ctrl-C."""

import json
import os
import re
import signal

import numpy as np
import pytest

import ospace
from ospace import analysis
from ospace.analysis.arm_map import ArmMap
from ospace.cli import map_files
from ospace.cli.main import main

TURN = "joint_1=-3.141592653589793:3.141592653589793,joint_2=-3.141592653589793:3.141592653589793"
FEW = ("--random", "500")


@pytest.fixture
def mapped(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")

    def call(*arguments):
        try:
            status = main(["map", *map(str, arguments)])
        except SystemExit as leaving:
            status = leaving.code
        out, err = capsys.readouterr()
        return status, out, "".join(line for line in err.splitlines(True) if "compiling" not in line)

    return call


def test_the_published_arm(mapped):
    status, out, err = mapped("planar_2r", "--over", TURN, "--grid", "37")
    assert (status, err) == (0, "")
    assert out.startswith("planar_2r: end_effector (position) over joint_1, joint_2\n")
    told = " ".join(out.split())
    assert "path-independent 0 to 0.3511 m, 0.5537 to 1.4362 m (PIW) path-dependent" in told
    assert "path-dependent 0.3511 to 0.5537 m, 1.4362 to 2.2872 m (PDW), 64.1 % of the area" in told
    assert "  postures          1369, grid of 37 values of each joint\n" in out
    assert "  left out          no joint moves the hand along: z\n" in out
    assert max(map(len, out.splitlines())) <= 80


def test_everything_fits_80_columns_and_is_named(mapped):
    status, out, err = mapped("chaser_24dof", "--point", "right_hand", "--what", "all", *FEW)
    assert (status, err) == (0, "")
    assert out.startswith("chaser_24dof: right_hand (position and attitude) over 11 joints\n")
    assert max(map(len, out.splitlines())) <= 80
    for title in ("turn of the base  ", "momentum of wheels about z", "turn at most", "base level"):
        assert title in out
    assert re.search(r"^ +180 deg +100\.0 %|^ +\d+ deg +100\.0 %", out, re.MULTILINE)


def test_the_document_has_all_in_si_units(mapped):
    status, out, err = mapped("planar_2r", "--what", "all", *FEW, "--seed", "3", "--json")
    assert (status, err) == (0, "")
    document = json.loads(out)
    assert document["postures"] == {"chosen": "random, seed 3", "wanted": 500, "mapped": 500}
    assert [joint["name"] for joint in document["joints"]] == ["joint_1", "joint_2"]
    assert document["rows"] == [True, True, False, False, False, False]
    by_name = {one["name"]: one for one in document["quantities"]}
    assert by_name["base_turn"]["unit"] == "rad"
    assert 0.0 < by_name["base_turn"]["largest"] < np.pi
    assert document["workspaces"]["reach"][1] == pytest.approx(107.5 / 47.0)
    assert len(document["rays"]) == 98
    assert sum(one["distance"] is None for one in document["rays"]) == 82
    assert document["level_base"][-1]["share"] == 1.0
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    joints = dict(zip(("joint_1", "joint_2"), by_name["disturbance"]["at_largest"], strict=True))
    state = robot.state(robot.configuration(joints))
    assert by_name["disturbance"]["largest"] == pytest.approx(analysis.disturbance_map(state).sizes[0])


def test_a_seed_gives_the_same_document(mapped):
    one, again = (mapped("planar_2r", *FEW, "--seed", "5", "--json") for _ in range(2))
    assert one == again
    assert mapped("planar_2r", *FEW, "--seed", "6", "--json") != one


def test_every_posture_is_a_row_of_the_files(mapped, tmp_path, monkeypatch):
    monkeypatch.setattr(map_files, "_AT_ONCE", 70)
    status, out, err = mapped("planar_2r", "--what", "singularity", *FEW, "--csv", "a.csv", "--npz", "a.npz")
    assert (status, err) == (0, "")
    assert out.endswith("wrote a.csv\nwrote a.npz\n")
    names, *lines = (tmp_path / "a.csv").read_text().splitlines()
    assert names == "joint_1_rad,joint_2_rad,singular_value,manipulability"
    arrays = np.load(tmp_path / "a.npz", allow_pickle=False)
    rows = arrays["rows"]
    assert list(arrays["columns"]) == names.split(",")
    np.testing.assert_allclose(np.array([line.split(",") for line in lines], dtype=float), rows, rtol=1e-11)
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    found = ArmMap.empty(analysis.Arm(robot, robot.point("end_effector", "linear")), ["singularity"])
    found, values = found.with_postures(rows[:, :2])
    np.testing.assert_allclose(values, rows[:, 2:], rtol=1e-12)
    np.testing.assert_allclose(arrays["voxel_low"], found.voxels.low)
    np.testing.assert_allclose(arrays["shell_radii"], found.shell_radii)
    assert sorted(one.name for one in tmp_path.iterdir()) == ["a.csv", "a.npz"]


def test_other_joints_stand_where_they_are_put(mapped):
    status, out, _ = mapped("planar_2r", "--over", "joint_2=0:1", "--pose", "joint_1=0.5", "--grid", "3", "--json")
    assert status == 0
    document = json.loads(out)
    assert [joint["name"] for joint in document["joints"]] == ["joint_2"]
    assert document["postures"]["mapped"] == 3
    by_name = {one["name"]: one for one in document["quantities"]}
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    q = robot.configuration({"joint_1": 0.5, "joint_2": 1.0})
    hand = robot.state(q).placement(robot.point("end_effector")).translation
    assert by_name["hand_x"]["smallest"] == pytest.approx(hand[0])
    assert by_name["hand_y"]["largest"] == pytest.approx(hand[1])


def test_a_pose_beyond_limits_is_warned_of(mapped):
    status, _, err = mapped("planar_2r", "--pose", "joint_1=9", "--what", "disturbance", *FEW)
    assert status == 0
    assert err.startswith("ospace: warning: --pose is outside limits: 'joint_1' by")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["no.urdf"], "no.urdf"),
        (["planar_2r", "--point", "hand"], "has no frame 'hand'"),
        (["planar_2r", "--over", "joint_9"], "has no joint 'joint_9'"),
        (["planar_2r", "--over", "joint_1,joint_1"], "--over 'joint_1': joint 'joint_1' is given twice"),
        (["planar_2r", "--over", "joint_1=1"], "--over 'joint_1=1': write joint=low:high"),
        (["planar_2r", "--over", "joint_1=2:1"], "range of joint 'joint_1' is empty, 2 to 1"),
        (["planar_2r", "--over", "joint_1=nan:1"], "give a finite number"),
        (["planar_2r", "--pose", "joint_1"], "--pose 'joint_1': write joint=value"),
        (["planar_2r", "--what", "reach,nonsense"], "--what: 'nonsense' is unknown: give some of reach"),
        (["planar_2r", "--what", ","], "a map of nothing"),
        (["planar_2r", "--grid", "1"], "grid is 1: give a whole number from 2 on"),
        (["chaser_7dof", "--grid", "100"], "--grid 100: 100^7 postures are more than"),
        (["planar_2r", "--random", "0"], "'0' is not a whole number from 1 to"),
        (["planar_2r", "--random", "9", "--grid", "9"], "not allowed with argument"),
        (["planar_2r", "--npz", "a.csv"], "'a.csv' does not end in .npz"),
        (["planar_2r", "--csv", "no/a.csv"], "no such folder"),
        (["planar_2r", "--csv", "a.npz", "--npz", "a.npz"], "is to be written twice"),
        (["chaser_24dof"], "several links may be the hand: give one with --point, such as right_hand"),
        (["target"], "has no joint that moves a leaf link: there is no arm to map"),
        (["chaser_24dof", "--point", "base"], "no joint stands between the base and 'base'"),
    ],
)
def test_what_cannot_be_mapped_is_told(mapped, tmp_path, arguments, message):
    status, out, err = mapped(*arguments)
    assert (status, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


def test_the_tables_outlive_a_file_that_cannot_be_written(mapped):
    status, out, err = mapped("planar_2r", "--what", "disturbance", *FEW, "--csv", "/dev/full")
    assert status == 2
    assert "turn of the base per joint rate" in out
    assert err == "ospace: error: /dev/full: no table: No space left on device\n"


@pytest.fixture
def interrupt(monkeypatch):
    """Press Ctrl-C while the postures of a chunk are measured."""

    def call(chunk):
        honest, done = ArmMap.with_postures, []

        def with_postures(self, x):
            done.append(len(x))
            if len(done) == chunk:
                os.kill(os.getpid(), signal.SIGINT)
            return honest(self, x)

        monkeypatch.setattr(ArmMap, "with_postures", with_postures)

    return call


def test_ctrl_c_keeps_the_postures_that_are_done(mapped, tmp_path, interrupt):
    interrupt(2)
    status, out, err = mapped("planar_2r", "--random", "50000", "--csv", "a.csv", "--npz", "a.npz")
    assert status == 130
    count = int(re.fullmatch(r"ospace: interrupted after (\d+) of 50000 postures\n", err)[1])
    assert count in (8192, 16384)  # the chunk that is measured then is done or not
    assert f"  postures  {count} of 50000, random, seed 0\n" in out
    assert "path-independent" not in out
    assert len((tmp_path / "a.csv").read_text().splitlines()) == count + 1
    assert np.load(tmp_path / "a.npz")["rows"].shape == (count, 8)


def test_ctrl_c_before_the_first_posture(mapped, monkeypatch):
    def interrupted(self, x):
        raise KeyboardInterrupt

    monkeypatch.setattr(ArmMap, "with_postures", interrupted)
    status, out, err = mapped("planar_2r", "--json", "--csv", "a.csv")
    assert (status, err) == (130, "ospace: interrupted after 0 of 20000 postures\n")
    document = json.loads(out)
    assert document["interrupted"]
    assert document["quantities"] == []
    status, out, _ = mapped("planar_2r")
    assert (status, out.splitlines()[1]) == (130, "  postures  0 of 20000, random, seed 0")


def test_ctrl_c_while_workspaces_are_searched_keeps_the_map(mapped, monkeypatch):
    def interrupted(arm, seed):
        raise KeyboardInterrupt

    monkeypatch.setattr("ospace.analysis.workspace_shells.workspaces", interrupted)
    status, out, err = mapped("planar_2r", *FEW, "--json")
    assert (status, err) == (130, "ospace: interrupted after 500 of 500 postures\n")
    document = json.loads(out)
    assert ("workspaces" in document, len(document["rays"]), document["postures"]["mapped"]) == (False, 98, 500)
