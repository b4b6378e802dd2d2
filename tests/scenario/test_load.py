"""Reading: what a file says in SI units, and every kind of mistake by its key with what would be right."""

import math
import re
from pathlib import Path

import missions
import numpy as np
import pytest
from scenario_schema import tables_of

import ospace
from ospace import scenario
from ospace.scenario.schema import Follow, Hold, Shift, ToMomentum, ToPose

GOOD = """
name = "A try"

[robot]
model = "ets_vii"
base = "floating"
position = ["1 km", 0, 0]
rpy = [0, 0, "90 deg"]
velocity = ["10 mm/s", 0, 0]
angular_velocity = [0, 0, "1 deg/s"]

[robot.joints]
joint_1 = "30 deg"
joint_2 = 0.25

[robot.joint_rates]
joint_3 = "1 rpm"

[target]
model = "target"
position = ["100100 cm", 0, 0]
spin = ["1 deg/s", 0, 0]

[limits]
share = 0.5
acceleration = "5 deg/s^2"

[control]
period = "2 ms"
step = 0.001

[[task]]
name = "rest"
type = "damping"

[[phase]]
name = "one"
timeout = "1 min"
duration = "1 s"

[[phase.task]]
name = "hand"
type = "pose"
point = "end_effector"
stiffness = 100.0
axes = "linear"
offset = { position = ["5 cm", 0, 0] }
goal = { follow = "grapple", offset = { position = ["-10 cm", 0, 0] }, duration = "8 s" }
completion = { position = "1 mm", angle = "0.1 deg", hold = "500 ms" }

[[phase]]
name = "two"
timeout = 5
grasp = { hand = "end_effector", fixture = "grapple" }

[[phase.task]]
name = "hand"
type = "pose"
point = "end_effector"
goal = { shift = ["0.1 m", 0, 0], duration = "2 s" }
completion = { position = "1 mm" }

[[phase]]
name = "three"
duration = 1
timeout = 2
release = true
"""


def test_a_scenario_is_what_its_file_says_in_si_units(load):
    made = load(GOOD)
    robot = made.robot
    np.testing.assert_allclose(made.start.q[:3], [1000.0, 0.0, 0.0])
    np.testing.assert_allclose(made.start.base_twist, [0.01, 0, 0, 0, 0, math.radians(1)], atol=1e-16)
    positions = robot.joint_positions(made.start.q)
    assert positions["joint_1"] == pytest.approx(math.radians(30.0))
    assert positions["joint_2"] == 0.25
    assert made.start.v[6 + robot.joint_names.index("joint_3")] == pytest.approx(math.pi / 30.0)
    np.testing.assert_allclose(made.targets["target"].start.base_twist[3:], [math.radians(1), 0, 0])
    assert (made.control.period, made.control.step) == (0.002, 0.001)
    limits = made.limits.of(robot, robot)
    assert limits.torque[0] == 45.0
    np.testing.assert_allclose(limits.acceleration, math.radians(5.0))
    one, two, three = made.phases
    assert (one.name, one.timeout, one.duration) == ("one", 60.0, 1.0)
    assert [task.name for task in one.tasks] == ["hand", "rest"]
    hand = one.tasks[0]
    assert hand.stiffness == 100.0
    assert hand.task(robot).rows(robot) == [0, 1, 2]
    np.testing.assert_allclose(hand.offset.pose.translation, [0.05, 0, 0])
    assert isinstance(hand.goal, Follow)
    assert (hand.goal.follow, hand.goal.duration) == ("grapple", 8.0)
    np.testing.assert_allclose(hand.goal.offset.pose.translation, [-0.1, 0, 0])
    assert hand.completion.make() == ospace.control.Completion(1e-3, math.radians(0.1), 0.5)
    assert (two.grasp.hand, two.grasp.position) == ("end_effector", 0.01)
    assert isinstance(two.tasks[0].goal, Shift)
    assert three.release


MISTAKES = {
    "unknown key": ("stiffness = 100.0", "stifness = 100.0", "phase[0].task[0].stifness", "did you mean 'stiffness'?"),
    "unknown key at the top": ('name = "A try"', 'nmae = "A try"', "nmae", "did you mean 'name'?"),
    "unknown key in a goal": ('duration = "8 s"', 'durration = "8 s"', "phase[0].task[0].goal.durration", "'duration'"),
    "missing key": ('timeout = "1 min"', "", "phase[0].timeout", "missing"),
    "missing key, and one alike": ("timeout = 5", "time_out = 5", "phase[1].timeout", "did you mean 'time_out'?"),
    "missing table": ("[robot", "[robbot", "robot", "missing; did you mean 'robbot'?"),
    "unknown frame": ('point = "end_effector"', 'point = "end_efector"', "phase[0].task[0].point", "'end_effector'"),
    "unknown joint": ('joint_1 = "30', 'joint1 = "30', "robot.joints.joint1", "did you mean 'joint_1'"),
    "unknown model": ('model = "ets_vii"', 'model = "ets_vi"', "robot.model", "did you mean 'ets_vii'?"),
    "missing file": ('model = "ets_vii"', 'model = "no.urdf"', "robot.model", "no.urdf"),
    "unknown task": ('type = "damping"', 'type = "dampning"', "task[0].type", "did you mean 'damping'?"),
    "unknown base": ('base = "floating"', 'base = "floatin"', "robot.base", "did you mean 'floating'"),
    "unknown solver": ("step = 0.001", 'solver = "dakp"', "control.solver", "did you mean 'daqp'?"),
    "unknown integrator": ("step = 0.001", 'integrator = "rk5"', "control.integrator", "did you mean 'rk4'?"),
    "unknown fixture": (
        'fixture = "grapple"',
        'fixture = "graple"',
        "phase[1].grasp.fixture",
        "did you mean 'grapple'",
    ),
    "unknown hand": ('hand = "end_effector"', 'hand = "hand"', "phase[1].grasp.hand", "known: base"),
    "unknown frame of the target": (
        'follow = "grapple"',
        'follow = "grap"',
        "phase[0].task[0].goal.follow",
        "'grapple'",
    ),
    "unknown axes": ('axes = "linear"', 'axes = "lineal"', "phase[0].task[0].axes", "did you mean 'linear'?"),
    "wrong unit": (
        'timeout = "1 min"',
        'timeout = "1 m"',
        "phase[0].timeout",
        "unit 'm', a unit of length; give a number in s, or a text with a unit of s, ms, min",
    ),
    "no unit": ('timeout = "1 min"', 'timeout = "1"', "phase[0].timeout", "a text needs a unit"),
    "wrong unit in a list": ('["10 mm/s", 0, 0]', '["10 mm", 0, 0]', "robot.velocity[0]", "m/s, cm/s, mm/s, km/s"),
    "wrong type": ('timeout = "1 min"', "timeout = true", "phase[0].timeout", "True is not a time"),
    "a text for a number": ("share = 0.5", 'share = "half"', "limits.share", "give a number"),
    "a number for a text": ('name = "two"', "name = 2", "phase[1].name", "2 is not a text"),
    "a list that is too short": ('["1 km", 0, 0]', '["1 km", 0]', "robot.position", "give a list of 3 of length"),
    "not finite": ('timeout = "1 min"', "timeout = inf", "phase[0].timeout", "must be finite"),
    "not a number": ('timeout = "1 min"', "timeout = nan", "phase[0].timeout", "is not a number"),
    "out of range": ("share = 0.5", "share = 1.5", "limits.share", "must be at most 1"),
    "negative": ("stiffness = 100.0", "stiffness = -1", "phase[0].task[0].stiffness", "must be at least 0 1/s^2"),
    "zero time": ('timeout = "1 min"', 'timeout = "0 s"', "phase[0].timeout", "must be above 0 s"),
    "longer than its time-out": (
        'duration = "8 s"',
        'duration = "2 min"',
        "phase[0].task[0].goal.duration",
        "120.5 s of motion",
    ),
    "too many steps": ("step = 0.001", "step = 1e-6", "phase", "more than 2000000 steps of 1e-06 s"),
    "a base of no kind": ('base = "floating"', "base = 3", "robot.base", "give the name of a mode, or a table"),
    "not whole": ("step = 0.001", "step = 0.0015", "control.period", "not a whole number of steps"),
    "two phases of one name": ('name = "two"', 'name = "one"', "phase[1].name", "two phases are called 'one'"),
    "nothing ends a phase": ("duration = 1\n", "", "phase[2]", "nothing ends the phase"),
    "two goals": (
        '{ shift = ["0.1 m", 0, 0],',
        "{ shift = [0, 0, 0], hold = true,",
        "phase[1].task[0].goal",
        "give one of",
    ),
    "nothing to release": (
        'grasp = { hand = "end_effector", fixture = "grapple" }',
        "",
        "phase[2].release",
        "nothing is held",
    ),
    "no target": (
        '[target]\nmodel = "target"\nposition = ["100100 cm", 0, 0]\nspin = ["1 deg/s", 0, 0]',
        "",
        "phase[0].task[0].goal.follow",
        "no target",
    ),
    "held already": (
        "release = true",
        'grasp = { hand = "end_effector", fixture = "grapple" }',
        "phase[2].grasp",
        "held already, and one hand holds a target: leave out the grasp",
    ),
    "no table": ('hold = "500 ms" }', 'hold = "500 ms" }\nofset = 3', "phase[0].task[0].ofset", "'offset'"),
    "model and body": ('model = "target"', 'model = "target"\nbody = {mass = 1}', "target", "either model"),
    "no joints to move": (
        'type = "damping"',
        'type = "posture"\nposture = {joint_9 = 1}',
        "task[0].posture.joint_9",
        "did you mean",
    ),
    "broken TOML": ("share = 0.5", "share = ", "", "is not TOML: Invalid value (at line"),
}


@pytest.mark.parametrize(("before", "after", "key", "words"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_named(load, before, after, key, words):
    assert before in GOOD
    with pytest.raises(ospace.ScenarioError) as raised:
        load(GOOD.replace(before, after, 3 if before == "[robot" else 1))
    error = raised.value
    keys = dict(error.problems)
    assert key in keys, error
    assert words in keys[key], error
    assert "made.toml" in str(error)
    assert key in str(error)


def test_all_problems_are_reported_together(load):
    text = (
        GOOD.replace('timeout = "1 min"', 'timeout = "1 kg"').replace("stiffness", "stifness").replace("share", "shar")
    )
    with pytest.raises(ospace.ScenarioError) as raised:
        load(text)
    assert [key for key, _ in raised.value.problems] == ["limits.shar", "phase[0].timeout", "phase[0].task[0].stifness"]
    assert str(raised.value).count("\n") == 3


@pytest.mark.parametrize(
    "content", [b"\xff\xfe", b"a = " + b"[" * 5000, b"a = 1\n" * 200_000], ids=["bytes", "deep", "long"]
)
def test_a_file_that_is_no_scenario_is_refused(tmp_path, content):
    file = tmp_path / "made.toml"
    file.write_bytes(content)
    with pytest.raises(ospace.ScenarioError, match=r"made\.toml"):
        scenario.load(file)


@pytest.mark.parametrize("name", ["", "nothing.toml"])
def test_a_missing_scenario_file_is_refused(tmp_path, name):
    with pytest.raises(ospace.ScenarioError, match=r"folder|directory"):
        scenario.load(tmp_path / name)


def test_a_target_may_be_a_body_of_given_mass_and_inertia(load):
    body = """[target.body]
name = "can"
mass = "1.2 t"
inertia = [300, 400, 500, "10 kg m^2", 20, 30]
mass_centre = ["5 cm", 0, 0]
frames = { grapple = { position = ["-1 m", 0, 0], quaternion = [0, 0, 1, 0] } }
"""
    made = load(GOOD.replace('model = "target"\n', "").replace("[limits]", body + "\n[limits]"))
    body_inertia = made.targets["target"].robot.model.inertias[1]
    assert body_inertia.mass == 1200.0
    np.testing.assert_allclose(body_inertia.inertia, [[300, 10, 20], [10, 400, 30], [20, 30, 500]])
    fixture = made.targets["target"].robot.point("grapple")
    np.testing.assert_allclose(fixture.placement.translation, [-1, 0, 0])
    np.testing.assert_allclose(fixture.placement.rotation, np.diag([-1, -1, 1]), atol=1e-15)


@pytest.mark.parametrize(
    ("given", "goal", "check"),
    [
        ('"hold"', Hold, lambda goal: goal.duration == 0.0),
        ('{ hold = true, duration = "2 s" }', Hold, lambda goal: goal.duration == 2.0),
        ('{ position = ["1 km", 0, 0] }', ToPose, lambda goal: goal.position[0] == 1e3 and goal.rotation is None),
        ('{ rpy = [0, 0, "180 deg"] }', ToPose, lambda goal: goal.position is None and goal.rotation[0, 0] == -1.0),
        ('{ turn = ["1 deg", 0, 0] }', Shift, lambda goal: goal.turn[0] == math.radians(1.0)),
    ],
)
def test_every_kind_of_goal_is_read(load, given, goal, check):
    made = load(GOOD.replace('{ shift = ["0.1 m", 0, 0], duration = "2 s" }', given))
    found = made.phases[1].tasks[0].goal
    assert isinstance(found, goal)
    assert check(found)


def test_a_goal_of_momentum_needs_wheels(load):
    text = GOOD.replace('type = "damping"', 'type = "momentum"\ngoal = { angular = ["1 N m s", 0, 0] }')
    with pytest.raises(ospace.ScenarioError, match=r"phase\[0\]: .* joints do not change momentum"):
        load(text)
    goal = load(text.replace('"floating"', '"wheels"')).phases[0].tasks[1].goal
    assert isinstance(goal, ToMomentum)
    np.testing.assert_allclose(goal.momentum, [0, 0, 0, 1, 0, 0])


def test_a_model_s_path_is_relative_to_the_scenario(tmp_path):
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "mine.urdf").write_text(ospace.models.path("ets_vii").read_text())
    file = tmp_path / "made.toml"
    file.write_text(GOOD.replace('model = "ets_vii"', 'model = "robots/mine.urdf"'))
    assert scenario.load(file).robot.source == tmp_path / "robots" / "mine.urdf"


@pytest.mark.parametrize("name", ospace.models.scenarios())
def test_scenarios_that_come_with_ospace_have_phases(name):
    assert scenario.load(ospace.models.scenario(name)).phases


def test_an_unknown_scenario_names_the_nearest():
    with pytest.raises(ospace.OspaceError, match=r"did you mean 'grasp'"):
        ospace.models.scenario("grsp")


def test_the_first_scenario_of_the_docs_passes(load):
    page = (Path(ospace.__file__).parents[1] / "docs" / "scenario.md").read_text()
    blocks = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    assert scenario.run(load(blocks[0])).passed
    grasping = blocks[0].split("[[phase]]")[0].replace("planar_2r", "chaser_24dof")
    load(re.sub(r"\[robot.joints\].*", "", grasping, flags=re.DOTALL) + blocks[1])


def test_the_docs_name_every_key():
    page = (Path(ospace.__file__).parents[1] / "docs" / "scenario.md").read_text()
    keys = {key for _, properties in tables_of(scenario.schema.json_schema()) for key in properties}
    assert len(keys) > 50
    for key in keys:
        assert re.search(rf"\b{key}\b", page), key
    for kind in scenario.schema.TASKS:
        assert f'`"{kind}"`' in page


REACHING = missions.reaching()


@pytest.mark.parametrize(
    ("was", "now", "key"),
    [
        ("[[task]]", '[control]\nperiod = "1e300 s"\n[[task]]', "control.period"),
        ("[[task]]", "[control]\nperiod = 1e-300\n[[task]]", "control.period"),
        ("[[task]]", "[control]\nstep = 1e-320\n[[task]]", "control.step"),
        ('type = "damping"', 'type = "damping"\nweight = 1e308', "task[0].weight"),
        ('type = "damping"', 'type = "damping"\nweight = 1' + "0" * 400, "task[0].weight"),
        ('type = "damping"', 'type = "damping"\nstiffness = 1e200', "task[0].stiffness"),
        ('type = "damping"', 'type = "damping"\ndamping_ratio = 1e9', "task[0].damping_ratio"),
        ('type = "damping"', 'type = "damping"\nlevel = 99999999999', "task[0].level"),
        ("mass = 50", "mass = 1e300", "target.body.mass"),
        ("mass = 50", "mass = 1e-300", "target.body.mass"),
        ("[3, 4, 5]", "[1e-310, 1e-310, 1e-310]", "target.body.inertia"),
        ("[3, 4, 5]", "[1e300, 1e300, 1e300]", "target.body.inertia[0]"),
        ("[1.0, 0.5, 0]", "[1e200, 0, 0]", "target.position[0]"),
        ("[1.0, 0.5, 0]", '[0, 0, 0]\nvelocity = ["1e300 m/s", 0, 0]', "target.velocity[0]"),
        ("[1.0, 0.5, 0]", '[0, 0, 0]\nspin = ["1e300 rad/s", 0, 0]', "target.spin[0]"),
        ('joint_1 = "20 deg"', "joint_1 = 1e300", "robot.joints.joint_1"),
        ('timeout = "2 s"', "timeout = 1e300", "phase[0].timeout"),
    ],
)
def test_numbers_beyond_all_measure_are_refused(load, was, now, key):
    assert was in REACHING
    with pytest.raises(scenario.ScenarioError) as refusal:
        load(REACHING.replace(was, now, 1))
    what = dict(refusal.value.problems)[key]
    assert re.search("must be (from|at most|at least|finite)|give a whole number from 0 to|at least 1e-09", what), what
    assert len(what) < 200


def test_a_whole_number_of_thousands_of_digits_is_refused(load):
    with pytest.raises(scenario.ScenarioError, match="a number of 1000 digits or more"):
        load(REACHING.replace("mass = 50", "mass = " + "9" * 5000))


def test_joints_that_are_not_given_start_inside_their_limits(load, tmp_path):
    text = Path(ospace.models.path("planar_2r")).read_text().replace('lower="-2.9671"', 'lower="0.5"')
    (tmp_path / "shifted.urdf").write_text(text)
    made = load(missions.short(robot={"model": "shifted.urdf"}))
    assert made.robot.outside_limits(made.start.q) == {}
    np.testing.assert_array_equal(made.start.q, made.robot.neutral())
    given = load(missions.short(robot={"model": "shifted.urdf", "joints": {"joint_1": 0.7}}))
    assert given.start.q[7] == 0.7
    assert given.start.q[8] == made.start.q[8]


def test_problems_of_keys_and_of_names_are_reported_together(load):
    """Units, a frame, a joint, a later phase's frame after a grasp, and the fixture of that grasp."""
    text = GOOD.replace('timeout = "1 min"', 'timeout = "5 kg"').replace(
        'point = "end_effector"\nstiff', 'point = "end_efector"\nstiff'
    )
    text = text.replace("joint_1 = ", "joint_11 = ").replace('fixture = "grapple"', 'fixture = "graple"')
    text += '[[phase.task]]\nname = "held"\ntype = "orientation"\npoint = "grap"\n'
    with pytest.raises(ospace.ScenarioError) as raised:
        load(text)
    assert [key for key, _ in raised.value.problems] == [
        "phase[0].timeout",
        "robot.joints.joint_11",
        "phase[0].task[0].point",
        "phase[1].grasp.fixture",
        "phase[2].task[0].point",
    ]


def test_a_wrong_value_brings_no_other_problem(load):
    """A time-out, a period and a duration that are unknown are compared with nothing."""
    text = GOOD.replace('timeout = "1 min"', 'timeout = "1 kg"').replace('period = "2 ms"', 'period = "2 mss"')
    text = text.replace("duration = 1\n", 'duration = "1"\n').replace("grasp = {", 'grasp = "x" # {')
    with pytest.raises(ospace.ScenarioError) as raised:
        load(text)
    assert [key for key, _ in raised.value.problems] == [
        "control.period",
        "phase[0].timeout",
        "phase[1].grasp",
        "phase[2].duration",
    ]


def test_a_completion_without_a_bound_is_refused(load):
    with pytest.raises(ospace.ScenarioError, match=r"phase\[1\]\.task\[0\]\.completion: .* give position or angle"):
        load(GOOD.replace('completion = { position = "1 mm" }', 'completion = { hold = "1 s" }'))


def test_a_file_with_a_byte_order_mark_is_read(tmp_path):
    file = tmp_path / "made.toml"
    file.write_bytes(b"\xef\xbb\xbf" + missions.SHORT.encode())
    assert scenario.load(file).phases


def test_control_characters_in_a_key_are_shown_as_text(load):
    with pytest.raises(ospace.ScenarioError) as raised:
        load(missions.short(robot={"model": "planar_2r", "joints": {'"a\\u001b[2J"': 1}}))
    assert "\x1b" not in str(raised.value)
    assert r"robot.joints.a\x1b[2J" in str(raised.value)


TABLE_AND_ELBOW = """<robot name="gantry">
<link name="base">INERTIAL</link><link name="carriage">INERTIAL</link><link name="arm">INERTIAL</link>
<joint name="table" type="planar"><parent link="base"/><child link="carriage"/><axis xyz="0 0 1"/></joint>
<joint name="elbow" type="revolute"><parent link="carriage"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="10" velocity="2"/></joint>
</robot>""".replace(
    "INERTIAL",
    '<inertial><mass value="50"/><inertia ixx="5" iyy="5" izz="5" ixy="0" ixz="0" iyz="0"/></inertial>',
)
GANTRY = """
[robot]
model = "gantry.urdf"
joint_rates = { elbow = 3 }
[limits]
acceleration = { elbow = "7 rad/s^2" }
[[phase]]
name = "rest"
duration = 1
timeout = 2
[[phase.task]]
name = "rest"
type = "damping"
"""


def test_rates_and_limits_of_a_joint_behind_one_with_several_rates(load, tmp_path):
    (tmp_path / "gantry.urdf").write_text(TABLE_AND_ELBOW)
    made = load(GANTRY)
    np.testing.assert_array_equal(made.start.v[6:], [0, 0, 0, 3])
    np.testing.assert_array_equal(made.limits.of(made.robot, made.robot).acceleration, [np.inf] * 3 + [7.0])


@pytest.mark.parametrize("key", ["joints", "joint_rates"])
def test_one_number_for_a_joint_with_several_rates_is_refused(load, tmp_path, key):
    """Which of its coordinates would take it?"""
    (tmp_path / "gantry.urdf").write_text(TABLE_AND_ELBOW)
    with pytest.raises(ospace.ScenarioError, match="joint 'table' has 3 degrees of freedom") as error:
        load(GANTRY.replace("joint_rates = {", f"{key} = {{ table = 1.0,"))
    assert [name for name, _ in error.value.problems] == [f"robot.{key}.table"]


def test_torque_and_velocity_may_have_shares_of_their_own(load):
    whole = load(GOOD.replace("share = 0.5", "")).limits
    either = load(GOOD.replace("share = 0.5", "share = 0.5\ntorque_share = 0.2")).limits
    both = load(GOOD.replace("share = 0.5", "torque_share = 0.2\nvelocity_share = 0.3")).limits
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("ets_vii"))
    full = whole.of(robot, robot)
    for made, torque, velocity in ((either, 0.2, 0.5), (both, 0.2, 0.3)):
        limits = made.of(robot, robot)
        np.testing.assert_allclose(limits.torque, torque * full.torque)
        np.testing.assert_allclose(limits.velocity, velocity * full.velocity)
    text = GOOD.replace("share = 0.5", "share = 0.5\ntorque_share = 0.2\nvelocity_share = 1")
    with pytest.raises(ospace.ScenarioError, match=r"limits\.share: torque_share and velocity_share leave it nothing"):
        load(text)
