"""Damping and friction of joints: what they take is accounted for, against Pinocchio, MuJoCo and by hand."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import trees
from robots.mujoco_robot import MujocoRobot

import ospace
from ospace import SpaceRobot
from ospace.dynamics.joint_friction import JointFriction
from ospace.simulation import SimulationError, grasp, rigid_body, simulate, tumbling
from ospace.simulation.plant import Plant
from ospace.simulation.runge_kutta import IntegratedMotion

AXES_TURN = ("spherical by angles", "universal", "composite")
SMOOTH = tuple(name for name in trees.JOINT_TYPES if name not in AXES_TURN)
# A large bus and three links, the last of a gram-sized inertia: with this friction it stops within 0.1 ms.
ARM = """<robot name="arm"><link name="bus"><inertial><mass value="100"/>
<inertia ixx="20" iyy="20" izz="20" ixy="0" ixz="0" iyz="0"/></inertial></link>{links}</robot>"""
LINK = """<link name="l{k}"><inertial><origin xyz="0 0.02 {half}"/><mass value="{mass}"/>
<inertia ixx="{I}" iyy="{I}" izz="{I}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j{k}" type="{kind}"><parent link="{parent}"/><child link="l{k}"/><origin xyz="0 0 0.4"/>
<axis xyz="{axis}"/><limit lower="-3" upper="3" effort="50" velocity="9"/>
<dynamics damping="{damping}" friction="{friction}"/></joint>"""


def urdf(damping=(10, 10, 10), friction=(1, 1, 1)):
    links = "".join(
        LINK.format(
            k=k,
            half=0.2,
            mass=(8, 3, 0.5)[k],
            I=(0.2, 0.05, 0.001)[k],
            kind=("revolute", "prismatic", "revolute")[k],
            parent=("bus", "l0", "l1")[k],
            axis=("0 1 0", "0 0 1", "1 0 0")[k],
            damping=damping[k],
            friction=friction[k],
        )
        for k in range(3)
    )
    return ARM.format(links=links)


@pytest.fixture
def arm(tmp_path):
    def made(**numbers):
        file = tmp_path / "arm.urdf"
        file.write_text(urdf(**numbers))
        return SpaceRobot.from_urdf(file)

    return made


def moving(robot, seed=0):
    rng = np.random.default_rng(seed)
    q = robot.configuration(dict(zip(robot.joint_names, rng.uniform(-1, 1, robot.n_joints), strict=True)))
    return q, np.r_[0.1 * rng.normal(size=6), rng.normal(size=robot.n_joints)]


def torques(time, q, v):
    return 5.0 * np.sin(np.array([3.0, 5.0, 7.0]) * time + np.arange(3)) * (1.0, 1.0, 0.2)


def rubbing(seed, types):
    """A random tree with damping and friction at all joints, without the inertia of drives."""
    rng = np.random.default_rng(seed)
    model = pin.Model(trees.tree(seed, 8, types).model)
    model.armature = np.zeros(model.nv)
    model.damping = np.r_[np.zeros(6), rng.uniform(0.0, 2.0, model.nv - 6)]
    friction = np.r_[np.zeros(6), rng.uniform(0.0, 0.3, model.nv - 6)]
    model.upperDryFrictionLimit, model.lowerDryFrictionLimit = friction, -friction
    return SpaceRobot.from_model(model)


@pytest.mark.parametrize("options", [{}, {"integrator": "symplectic"}, {"tolerance": 1e-10}], ids=str)
@pytest.mark.parametrize("law", [None, torques])
def test_the_certificate_accounts_for_the_work_that_friction_takes(arm, law, options):
    run = simulate(robot := arm(), *moving(robot), law, duration=0.3, **options)
    certificate = run.certificate()
    assert certificate.passed, str(certificate)
    assert (np.diff(run.dissipated) >= 0.0).all()
    assert run.dissipated[-1] > 0.1 * run.kinetic_energy[0]
    np.testing.assert_allclose(certificate["linear momentum"].error, 0.0, rtol=0, atol=1e-10)


@pytest.mark.parametrize("options", [{}, {"integrator": "symplectic"}, {"tolerance": 1e-10}], ids=str)
def test_the_certificate_notices_friction_whose_work_is_not_accounted_for(arm, options, monkeypatch):
    """Friction that acts, and energy that it took forgotten."""
    robot = arm()
    monkeypatch.setattr(
        IntegratedMotion, "dissipated", property(lambda motion: 0.0, lambda motion, taken: None), raising=False
    )
    certificate = simulate(robot, *moving(robot), duration=0.1, **options).certificate()
    assert not certificate["work and energy"].passed
    assert certificate["linear momentum"].passed


@pytest.mark.parametrize("v_is", ["moving", "still"])
def test_the_plant_is_aba_with_the_torque_of_friction(arm, v_is):
    robot = arm()
    q, v = moving(robot)
    if v_is == "still":
        v[6:] = 0.0
    plant, acceleration = Plant(robot), np.empty(robot.nv)
    plant.torque[:] = [1.0, -2.0, 0.3]
    power = plant.accelerate(0.0, q, v, acceleration)
    resistance = -10.0 * v[6:] - np.tanh(v[6:] / ospace.dynamics.joint_friction.FRICTION_VELOCITY)
    tau = np.r_[np.zeros(6), plant.torque + resistance]
    np.testing.assert_allclose(acceleration, pin.aba(robot.model, robot.model.createData(), q, v, tau), rtol=1e-13)
    assert power == pytest.approx(plant.torque @ v[6:], rel=1e-13)
    assert plant.rates[6] == pytest.approx(-resistance @ v[6:], rel=1e-13)


def test_damping_against_mujoco(arm, tmp_path):
    """Viscous damping is exact there; motion for 0.3 s by its own Runge–Kutta steps."""
    robot = arm(damping=(3, 8, 0.02), friction=(0, 0, 0))
    q, v = moving(robot, 1)
    engine = MujocoRobot(tmp_path / "arm.urdf")
    for k, name in enumerate(robot.joint_names):
        engine.model.dof_damping[engine.model.jnt_dofadr[engine.joint(name)]] = (3, 8, 0.02)[k]
    engine.model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    engine.model.opt.timestep = 1e-3
    engine.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    engine.take(robot.state(q, v))
    for _ in range(300):
        mujoco.mj_step(engine.model, engine.data)
    run = simulate(robot, q, v, duration=0.3)
    rates = [engine.data.qvel[engine.model.jnt_dofadr[engine.joint(name)]] for name in robot.joint_names]
    positions = [engine.data.qpos[engine.model.jnt_qposadr[engine.joint(name)]] for name in robot.joint_names]
    np.testing.assert_allclose(run.v[-1, 6:], rates, rtol=0, atol=1e-8)
    np.testing.assert_allclose(run.q[-1, 7:], positions, rtol=0, atol=1e-8)
    free = simulate(arm(damping=(0, 0, 0), friction=(0, 0, 0)), q, v, duration=0.3)
    assert np.abs(free.v[-1, 6:] - rates).max() > 0.05  # so it is the damping that was compared


@pytest.mark.parametrize("types", [SMOOTH, ("revolute", "prismatic along any axis", "spherical", "planar")])
@pytest.mark.parametrize("integrator", ["rk4", "symplectic"])
def test_integrators_agree_on_trees(types, integrator):
    robot = rubbing(3, types)
    state = trees.state(robot, 3)
    start = state.q, 0.3 * state.v
    exact = simulate(robot, *start, duration=0.1, tolerance=1e-11)
    errors = []
    for step in (1e-3, 5e-4):
        run = simulate(robot, *start, duration=0.1, step=step, integrator=integrator)
        assert run.certificate().passed, str(run.certificate())
        errors.append(np.abs(run.v[-1] - exact.v[-1]).max())
    assert errors[0] < (1e-7 if integrator == "rk4" else 1e-4)
    assert errors[1] < 0.35 * errors[0] or errors[1] < 1e-10


@pytest.mark.parametrize("integrator", ["rk4", "symplectic"])
@pytest.mark.parametrize("seed", range(3))
def test_steep_friction_stays_stable_and_right(arm, seed, integrator):
    """At 1 ms rk4 would be unstable above 2800 1/s; friction acts faster here."""
    robot = arm()
    q, v = moving(robot, seed)
    assert Plant(robot).friction_rate(q) > 2.8e3
    run = simulate(robot, q, v, duration=0.2, integrator=integrator)
    assert run.certificate().passed, str(run.certificate())
    exact = simulate(robot, q, v, duration=0.2, tolerance=1e-10)
    np.testing.assert_allclose(run.v[-1], exact.v[-1], rtol=0, atol=1e-7 if integrator == "rk4" else 1e-4)


def test_friction_too_steep_for_any_step_is_refused_by_rk4_and_done_by_symplectic(arm):
    robot = arm(damping=(1e6, 1e6, 1e6))
    with pytest.raises(SimulationError, match="or integrator='symplectic'"):
        simulate(robot, *moving(robot), duration=0.01)
    run = simulate(robot, *moving(robot), duration=0.05, integrator="symplectic")
    assert run.certificate()["linear momentum"].passed
    assert np.isfinite(run.v).all()


def test_the_combined_robot_has_damping_and_friction_of_both(arm):
    chaser, other = arm(damping=(1, 2, 3), friction=(0.1, 0.2, 0.3)), arm(damping=(4, 5, 6), friction=(0.4, 0.5, 0.6))
    there = tumbling(other, pin.SE3(np.eye(3), np.array([2.0, 0.0, 1.0])), (0.1, 0.0, 0.0))
    held = grasp(chaser.state(chaser.configuration()), chaser.point("l2"), there, other.point("l1")).state.robot
    by_name = {name: k for k, name in enumerate(held.joint_names)}
    friction = JointFriction.of(held)
    for prefix, first in (("", 0), ("arm/", 3)):
        for k in range(3):
            row = by_name[f"{prefix}j{k}"]
            assert friction.damping[row] == first + k + 1
            np.testing.assert_allclose(friction.coulomb[:, row], 0.1 * (first + k + 1), rtol=1e-14)
    body = rigid_body(10.0, (1.0, 1.0, 1.0))
    held = grasp(
        chaser.state(chaser.configuration()),
        chaser.point("l2"),
        tumbling(body, pin.SE3.Identity(), (0.3, 0, 0)),
        body.point("target"),
    )
    run = simulate(held.state.robot, held.state.q, held.state.v, duration=0.05)
    assert run.dissipated[-1] > 0.0
    assert run.certificate().passed, str(run.certificate())


def test_a_robot_without_friction_has_none():
    robot = SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    assert Plant(robot).friction is None
    run = simulate(robot, robot.configuration(), [0.1] * robot.nv, duration=0.01)
    assert not run.dissipated.any()
