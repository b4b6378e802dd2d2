"""The bridge to MuJoCo, against a model that MuJoCo reads from the same URDF by itself."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from robots.mujoco_robot import FREE_JOINT, MujocoRobot, example_robot, floating

import ospace
from ospace.bridge import mujoco as bridge
from ospace.control import Constant, PoseTask, PostureTask

NAMES = ("planar_2r", "chaser_24dof", "ets_vii")
UR5 = "ur_description/urdf/ur5_robot.urdf"
SCENE = """<mujoco><option gravity="0 0 0"/><worldbody>
  <body name="debris" pos="5 0 0"><freejoint/><geom type="sphere" size="0.1"/></body>{}</worldbody></mujoco>"""


def read(name):
    return ospace.SpaceRobot.from_urdf(ospace.models.path(name))


def random_state(robot, rng):
    angles = dict(zip(robot.joint_names, rng.uniform(-1.5, 1.5, robot.n_joints), strict=True))
    T_WB = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))
    return robot.configuration(angles, T_WB), rng.normal(size=robot.nv)


def inertia(state):
    terms = ospace.joint_space_dynamics(state)
    return np.block(
        [[terms.base_inertia, terms.coupling_inertia], [terms.coupling_inertia.T, terms.manipulator_inertia]]
    )


@pytest.fixture(params=NAMES)
def case(request):
    """A robot, MuJoCo's model of its URDF, and a random state."""
    robot = read(request.param)
    model = mujoco.MjModel.from_xml_string(floating(ospace.models.path(request.param)))
    return robot, model, *random_state(robot, np.random.default_rng(1))


def test_a_state_goes_there_as_by_name_and_comes_back(case):
    robot, model, q, v = case
    coordinates = bridge.Coordinates(robot, model)
    qpos, qvel = coordinates.export_state(q, v)
    by_name = MujocoRobot(robot.source)
    by_name.take(robot.state(q, v))
    np.testing.assert_allclose(qpos, by_name.data.qpos, atol=1e-15)
    np.testing.assert_allclose(qvel, by_name.data.qvel, atol=1e-15)
    for ours, back in zip((q, v), coordinates.import_state(qpos, qvel), strict=True):
        np.testing.assert_allclose(back, ours, atol=1e-15)


def test_inertia_goes_both_ways(case):
    robot, model, q, v = case
    coordinates, data = bridge.Coordinates(robot, model), mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = coordinates.export_state(q, v)
    mujoco.mj_forward(model, data)
    M = np.zeros((model.nv, model.nv))
    for row, unit in zip(M, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, row, unit)
    H = inertia(robot.state(q, v))
    np.testing.assert_allclose(coordinates.import_inertia(q, M), H, atol=1e-12 * np.abs(H).max())
    np.testing.assert_allclose(coordinates.export_inertia(q, H), M, atol=1e-12 * np.abs(M).max())


def test_forces_have_the_same_power(case):
    robot, model, q, v = case
    coordinates = bridge.Coordinates(robot, model)
    forces = np.random.default_rng(2).normal(size=robot.nv)
    _, qvel = coordinates.export_state(q, v)
    power = forces @ np.r_[robot.state(q, v).base_twist, v[6:]]
    assert coordinates.export_forces(q, forces) @ qvel == pytest.approx(power, rel=1e-12)


def test_torques_alone_are_forces_of_the_joints(case):
    robot, model, q, _ = case
    coordinates, torque = bridge.Coordinates(robot, model), np.arange(1.0, robot.n_joints + 1.0)
    joints = coordinates.export_forces(q, torque)
    assert joints.sum() == torque.sum()
    assert not joints[: model.jnt_dofadr[1]][:6].any() or robot.n_joints == 0


@pytest.mark.parametrize("name", NAMES)
def test_the_model_made_of_a_robot_is_the_one_of_its_urdf(name):
    """Of masses, inertias, axes and places alike: the same inertia matrix and bias in a random state."""
    robot = read(name)
    q, v = random_state(robot, np.random.default_rng(3))
    plant = bridge.Plant(robot)
    plant.reset(q, v)
    theirs = MujocoRobot(ospace.models.path(name))
    theirs.take(robot.state(q, v))
    H = theirs.inertia()
    np.testing.assert_allclose(plant.inertia(), H, atol=1e-11 * np.abs(H).max())
    T = plant.coordinates.velocity_map(q)
    np.testing.assert_allclose(T @ plant.data.qfrc_bias, theirs.bias(), atol=1e-9 * np.abs(theirs.bias()).max())


def test_fixed_links_are_sites_in_their_place():
    robot = read("chaser_24dof")
    q, v = random_state(robot, np.random.default_rng(4))
    plant = bridge.Plant(robot)
    plant.reset(q, v)
    hand = robot.state(q).placement(robot.point("right_hand"))
    np.testing.assert_allclose(plant.data.site("right_hand").xpos, hand.translation, atol=1e-12)


def controller_of(robot, base="floating"):
    goal = robot.state(robot.configuration({"joint_2": 0.9})).placement(robot.point("end_effector"))
    tasks = [
        PoseTask(name="hand", point=robot.point("end_effector"), reference=Constant(goal)),
        PostureTask(name="posture"),
    ]
    return ospace.Controller(robot, tasks, base=base, period=2e-3)


@pytest.mark.parametrize("base", ["floating", "flying"])
def test_a_controlled_motion_is_the_one_that_ospace_simulates(base):
    robot = read("chaser_7dof")
    q, v = robot.configuration({"joint_2": 0.6, "joint_4": -1.0}), np.full(robot.nv, 0.01)
    run = ospace.simulate(robot, q, v, controller_of(robot, base), duration=0.5, period=2e-3)
    plant, controller = bridge.Plant(robot), controller_of(robot, base)
    plant.reset(q, v)
    while plant.time < 0.5 - 1e-9:
        plant.step(controller.update(plant.time, plant.q, plant.v), controller.period)
    assert np.abs(run.q[-1] - q).max() > 0.01  # there is a motion to compare
    np.testing.assert_allclose(plant.q, run.q[-1], atol=1e-7)
    np.testing.assert_allclose(plant.v, run.v[-1], atol=1e-6)


def test_other_bodies_stay_where_they_are():
    robot = read("planar_2r")
    body = bridge.mjcf(robot).partition("<worldbody>")[2].partition("</worldbody>")[0]
    model = mujoco.MjModel.from_xml_string(SCENE.format(body))
    plant = bridge.Plant(robot, model)
    q, v = random_state(robot, np.random.default_rng(5))
    plant.reset(q, v)
    np.testing.assert_allclose(plant.q, q, atol=1e-15)
    assert plant.data.qpos[:7].tolist() == [5, 0, 0, 1, 0, 0, 0]
    assert plant.inertia().shape == (robot.nv, robot.nv)
    H = inertia(robot.state(q, v))
    np.testing.assert_allclose(plant.inertia(), H, atol=1e-11 * np.abs(H).max())


def test_continuous_joints_are_angles_there():
    robot = ospace.SpaceRobot.from_urdf(example_robot("kinova_description/robots/kinova.urdf"), free_mimic=True)
    assert robot.nq > robot.nv + 1
    plant = bridge.Plant(robot)
    q, v = random_state(robot, np.random.default_rng(6))
    plant.reset(q, v)
    np.testing.assert_allclose(plant.q, q, atol=1e-15)


def refused(call):
    with pytest.raises(ospace.OspaceError) as caught:
        call()
    return str(caught.value)


def test_what_does_not_fit_is_refused_with_a_remedy():
    robot, other = read("planar_2r"), read("ets_vii")
    assert "no joint 'joint_3'" in refused(lambda: bridge.Coordinates(other, bridge.model_of(robot)))
    fused = mujoco.MjModel.from_xml_path(str(ospace.models.path("planar_2r")))
    assert "takes the root link for the world" in refused(lambda: bridge.Coordinates(robot, fused))
    heavy = bridge.model_of(robot)
    heavy.opt.gravity[2] = -9.81
    assert "opt.gravity" in refused(lambda: bridge.Plant(robot, heavy))
    plant = bridge.Plant(robot)
    plant.reset(robot.neutral())
    assert "no whole number" in refused(lambda: plant.step(None, 1.5e-3))
    assert "torque" in refused(lambda: plant.step([1.0]))
    assert "length" in refused(lambda: plant.coordinates.import_state(np.zeros(9)))
    assert "MjModel" in refused(lambda: bridge.Coordinates(robot, None))
    panda = ospace.SpaceRobot.from_urdf(example_robot("panda_description/urdf/panda.urdf"))
    assert "free_mimic=True" in refused(lambda: bridge.model_of(panda))
    assert FREE_JOINT in bridge.mjcf(robot)
