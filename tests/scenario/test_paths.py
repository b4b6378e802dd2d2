"""Goals along paths: circles and ways through poses, their rates, and what is refused."""

import math

import missions
import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace import scenario
from ospace.kernels.minimum_jerk import rest_to_rest
from ospace.scenario.paths import AlongPath, circle, through

START = pin.SE3(pin.exp3(np.array([0.3, -0.5, 0.2])), np.array([1.0, 0.5, -0.2]))
MOVING = np.array([0.05, -0.02, 0.03, 0.1, 0.2, -0.15])
CENTRE, TURN, SHIFT = np.array([0.7, 0.1, 0.3]), np.array([0.4, -7.0, 1.0]), np.array([0.1, 0.2, -0.3])
POSES = [
    START,
    pin.SE3(START.rotation @ pin.exp3(np.array([0.0, 0.9, 0.4])), np.array([1.4, 0.4, 0.1])),
    pin.SE3(START.rotation @ pin.exp3(np.array([1.0, 0.2, 0.0])), np.array([1.5, 0.9, 0.1])),
    pin.SE3(START.rotation, np.array([0.9, 1.1, 0.4])),
]
PATHS = {
    "circle": circle(START, CENTRE, TURN, np.zeros(3), True),
    "helix": circle(START, CENTRE, TURN, SHIFT, False),
    "poses": through(POSES),
}


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("velocity", [np.zeros(6), MOVING])
@pytest.mark.parametrize("cycle", [1, 137, 500, 871, 999, 1002])
def test_velocities_and_accelerations_along_a_path_are_derivatives(name, velocity, cycle):
    way, h = AlongPath(PATHS[name], velocity, duration=1.0, first=7, period=1e-3), 1e-3
    (T_1, v_1, _), (_, v_2, a_2), (T_3, v_3, _) = (way((7 + cycle + k) * h) for k in (-1, 0, 1))
    np.testing.assert_allclose(v_2[:3], (T_3.translation - T_1.translation) / (2 * h), rtol=0, atol=2e-3)
    np.testing.assert_allclose(v_2[3:], pin.log3(T_3.rotation @ T_1.rotation.T) / (2 * h), rtol=0, atol=2e-3)
    np.testing.assert_allclose(a_2, (v_3 - v_1) / (2 * h), rtol=0, atol=2e-2)


@pytest.mark.parametrize("name", PATHS)
def test_a_path_starts_with_the_point_and_ends_at_rest(name):
    way = AlongPath(PATHS[name], MOVING, duration=1.0)
    pose, velocity, acceleration = way(0.0)
    assert pose.isApprox(START, 1e-12)
    np.testing.assert_allclose(velocity, MOVING, rtol=0, atol=1e-12)
    np.testing.assert_allclose(acceleration, 0.0, atol=1e-12)
    for time in (1.0, 2.5):
        pose, velocity, acceleration = way(time)
        end = {
            "circle": pin.SE3(pin.exp3(TURN) @ START.rotation, CENTRE + pin.exp3(TURN) @ (START.translation - CENTRE)),
            "helix": pin.SE3(START.rotation, CENTRE + pin.exp3(TURN) @ (START.translation - CENTRE) + SHIFT),
            "poses": POSES[-1],
        }[name]
        assert pose.isApprox(end, 1e-9)
        np.testing.assert_allclose(velocity, 0.0, atol=1e-12)
        np.testing.assert_allclose(acceleration, 0.0, atol=1e-9)


def test_a_circle_keeps_its_distance_from_the_axis():
    way, axis = AlongPath(PATHS["circle"], np.zeros(6), duration=1.0), TURN / np.linalg.norm(TURN)
    arms = [way(0.05 * k)[0].translation - CENTRE for k in range(21)]
    across = [np.linalg.norm(np.cross(axis, arm)) for arm in arms]
    np.testing.assert_allclose(across, across[0], rtol=1e-12)
    np.testing.assert_allclose([axis @ arm for arm in arms], axis @ arms[0], rtol=0, atol=1e-12)


def test_a_way_goes_through_its_poses_and_does_not_stop_there():
    way = AlongPath(PATHS["poses"], np.zeros(6), duration=1.0, period=1e-4)
    for pose in POSES[1:-1]:
        off = [
            (
                np.linalg.norm(T.translation - pose.translation)
                + np.linalg.norm(pin.log3(T.rotation.T @ pose.rotation)),
                k,
            )
            for k in range(10001)
            for T in [way(k * 1e-4)[0]]
        ]
        nearest, k = min(off)
        assert nearest < 5e-4
        assert np.linalg.norm(way(k * 1e-4)[1][:3]) > 0.5


def test_poses_that_differ_in_place_or_in_turn_alone_are_gone_through():
    places = [pin.SE3(START.rotation, START.translation + k * np.array([0.1, 0, 0])) for k in range(3)]
    turns = [pin.SE3(START.rotation @ pin.exp3(k * np.array([0.5, 0, 0])), START.translation) for k in range(3)]
    s = rest_to_rest(np.array(0.3))[0]
    at = AlongPath(through(places), np.zeros(6), duration=1.0)(0.3)[0]
    assert at.translation[0] - START.translation[0] == pytest.approx(0.2 * s)
    at = AlongPath(through(turns), np.zeros(6), duration=1.0)(0.3)[0]
    np.testing.assert_allclose(pin.log3(START.rotation.T @ at.rotation), [s, 0.0, 0.0], atol=1e-9)
    with pytest.raises(ospace.OspaceError, match="pose 2 on the way is where the one before it is"):
        through([places[0], places[1], places[1]])


def going(goal, **tip):
    done = {"completion": {"position": "2 mm", "hold": "0.1 s"}, "stiffness": 100.0}
    return missions.toml(
        missions.phase("go", missions.TIP | done | {"goal": goal} | tip, timeout="6 s"),
        robot=missions.PLANAR,
        control={"step": "2 ms", "period": "4 ms"},
        tasks=[missions.REST | {"weight": 1e-6}],
    )


def tip_places(run):
    robot = run.scenario.robot
    tip = robot.point("end_effector")
    return np.array([robot.state(q).placement(tip).translation for q in run.segments[0].trajectory.q])


def test_a_tip_draws_a_circle(load):
    made = load(going({"about": [0, 0, 0], "turn": [0, 0, 0.1], "duration": "1 s"}))
    first = made.start.placement(made.robot.point("end_effector")).translation
    centre = first - np.array([0.1, 0.0, 0.0])
    text = going({"about": centre.tolist(), "turn": [0, 0, "360 deg"], "duration": "4 s"})
    run = scenario.run(load(text))
    assert run.passed, [phase.reason for phase in run.phases]
    places = tip_places(run)
    np.testing.assert_allclose(np.linalg.norm(places[:, :2] - centre[:2], axis=1), 0.1, atol=2e-3)
    angle = np.unwrap(np.arctan2(*(places - centre)[:, 1::-1].T))
    assert angle[-1] - angle[0] == pytest.approx(2.0 * math.pi, abs=0.02)


def test_a_tip_goes_through_poses(load):
    made = load(going({"shift": [0.01, 0, 0], "duration": "1 s"}))
    first = made.start.placement(made.robot.point("end_effector")).translation
    via = [{"position": (first + np.array(by)).tolist()} for by in ([-0.1, 0.1, 0], [-0.25, 0.0, 0])]
    run = scenario.run(load(going({"via": via, "duration": "4 s"})))
    assert run.passed, [phase.reason for phase in run.phases]
    places = tip_places(run)
    for one in via:
        assert np.linalg.norm(places - one["position"], axis=1).min() < 4e-3


@pytest.mark.parametrize(
    ("goal", "key", "what"),
    [
        ({"about": [0, 0, 0], "duration": "1 s"}, "", "give one of: follow; shift or turn; via;"),
        ({"about": [0, 0, 0], "shift": [1, 0, 0], "duration": "1 s"}, ".about", "a circle needs a turn"),
        ({"about": [0, 0, 0], "turn": [0, 0, 1]}, ".duration", "a circle takes time"),
        ({"turns_along": False, "turn": [0, 0, 1], "duration": 1}, ".turns_along", "give about"),
        ({"abuot": [0, 0, 0], "turn": [0, 0, 1], "duration": 1}, ".abuot", "did you mean 'about'"),
        ({"via": [], "duration": 1}, ".via", "give at least one pose"),
        ({"via": [{}], "duration": 1}, ".via[0]", "give position, rpy or quaternion"),
        ({"via": [{"position": ["1 s", 0, 0]}], "duration": 1}, ".via[0].position[0]", "a unit of time"),
        ({"via": [{"position": [0.5, 0, 0]}]}, ".duration", "missing"),
        ({"via": [{"position": [0.5, 0, 0]}, {"position": [90.0, 0, 0]}], "duration": 1}, "", "out of reach"),
        ({"about": [40.0, 0, 0], "turn": [0, 0, 3.0], "duration": 1}, "", "out of reach"),
    ],
)
def test_paths_that_make_no_sense_are_refused(load, goal, key, what):
    with pytest.raises(ospace.ScenarioError) as error:
        load(going(goal))
    ((named, said),) = error.value.problems
    assert named == f"phase[0].task[0].goal{key}"
    assert what in said


def test_a_way_whose_first_pose_is_where_the_point_is_fails_by_name(load):
    made = load(going({"shift": [0.01, 0, 0], "duration": "1 s"}))
    first = made.start.placement(made.robot.point("end_effector")).translation.tolist()
    run = scenario.run(load(going({"via": [{"position": first}, {"position": [0.5, 0.2, 0]}], "duration": 1})))
    assert run.phases[0].outcome == "failed"
    assert "pose 1 on the way is where the one before it is" in run.phases[0].reason
