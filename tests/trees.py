"""Seeded random space robots: trees of any branching that mix all of Pinocchio's joint types."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ospace import OspaceError, SpaceRobot, State
from ospace.urdf.coupling import Following, couple


def _axis(rng: np.random.Generator) -> np.ndarray:
    axis = rng.normal(size=3)
    return axis / np.linalg.norm(axis)


JOINT_TYPES = {
    "revolute": lambda rng: [pin.JointModelRX(), pin.JointModelRY(), pin.JointModelRZ()][rng.integers(3)],
    "revolute about any axis": lambda rng: pin.JointModelRevoluteUnaligned(_axis(rng)),
    "continuous": lambda rng: [pin.JointModelRUBX(), pin.JointModelRUBY(), pin.JointModelRUBZ()][rng.integers(3)],
    "continuous about any axis": lambda rng: _unbounded(_axis(rng)),
    "prismatic": lambda rng: [pin.JointModelPX(), pin.JointModelPY(), pin.JointModelPZ()][rng.integers(3)],
    "prismatic along any axis": lambda rng: pin.JointModelPrismaticUnaligned(_axis(rng)),
    "planar": lambda rng: pin.JointModelPlanar(),
    "floating": lambda rng: pin.JointModelFreeFlyer(),
    "spherical": lambda rng: pin.JointModelSpherical(),
    "spherical by angles": lambda rng: pin.JointModelSphericalZYX(),
    "translation": lambda rng: pin.JointModelTranslation(),
    "universal": lambda rng: pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])),
    "helical": lambda rng: pin.JointModelHZ(0.3),
    "composite": lambda rng: _composite(),
}


def _unbounded(axis: np.ndarray) -> pin.JointModel:
    """Pinocchio's bindings take no axis for this joint, its URDF parser does."""
    described = f"""<robot name="one"><link name="a"/><link name="b"/><joint name="j" type="continuous">
        <parent link="a"/><child link="b"/><axis xyz="{axis[0]:.17g} {axis[1]:.17g} {axis[2]:.17g}"/></joint></robot>"""
    return pin.buildModelFromXML(described).joints[1]


def _composite() -> pin.JointModelComposite:
    joint = pin.JointModelComposite(2)
    joint.addJoint(pin.JointModelRY(), pin.SE3.Identity())
    joint.addJoint(pin.JointModelPX(), pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3])))
    return joint


def inertia(rng: np.random.Generator, mass: float) -> pin.Inertia:
    """A box of random sides, turned and shifted at random."""
    sides = rng.uniform(0.2, 0.6, 3)
    box = pin.Inertia.FromBox(mass, *sides)
    R = pin.exp3(rng.normal(size=3))
    return pin.Inertia(mass, rng.normal(scale=0.2, size=3), R @ box.inertia @ R.T)


def tree(seed: int, joints: int, types: tuple[str, ...] | None = None, branching: float = 0.5) -> SpaceRobot:
    """A robot of `joints` joints; each hangs from the one before, or with probability `branching` from any above it.

    Pinocchio's crba holds only where every subtree is numbered without a gap, so a new joint may hang from the last
    one or from one on its way to the base.
    """
    rng = np.random.default_rng(seed)
    names = types or tuple(JOINT_TYPES)
    model = pin.Model()
    model.name = f"tree_{seed}"
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, inertia(rng, rng.uniform(5.0, 20.0)), pin.SE3.Identity())
    model.addBodyFrame("base", root, pin.SE3.Identity(), 0)
    for k in range(joints):
        parent = model.njoints - 1
        if rng.random() < branching:
            parent = int(rng.choice(list(model.supports[parent])[1:]))
        placement = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(scale=0.4, size=3))
        kind = names[k % len(names)] if k < len(names) else names[rng.integers(len(names))]
        j = model.addJoint(parent, JOINT_TYPES[kind](rng), placement, f"joint_{k}")
        model.appendBodyToJoint(j, inertia(rng, rng.uniform(0.5, 4.0)), pin.SE3.Identity())
        model.addBodyFrame(f"link_{k}", j, pin.SE3.Identity(), 0)
    model.armature = np.r_[np.zeros(6), rng.uniform(0.0, 0.1, model.nv - 6)]
    return SpaceRobot.from_model(model)


ONE_POSITION = ("revolute", "revolute about any axis", "prismatic", "prismatic along any axis")
"""Joints that can mimic each other."""


def coupled(seed: int, joints: int = 9, followers: int = 3) -> SpaceRobot:
    """A robot some of whose joints mimic others: before and behind their leaders, on other branches, by ratios like 0.

    Its twin without the couplings is `robot.free`.
    """
    rng = np.random.default_rng(seed)
    robot = tree(seed, joints, (*ONE_POSITION, "planar", *ONE_POSITION))
    single = [name for name in robot.joint_names if robot.model.joints[robot.joint_number(name)].nq == 1]
    known: dict[str, Following] = {}
    for name in rng.permutation(single):
        leaders = [other for other in single if other not in (name, *known)]
        if len(known) == followers or not leaders or name in {one.leader for one in known.values()}:
            continue
        one = Following(str(rng.choice(leaders)), float(rng.choice([-1.0, 0.5, 2.0, 0.0])), float(rng.normal()))
        try:
            couple(robot.model, known | {str(name): one})
        except OspaceError:
            continue  # a leader would hang from its follower
        known[str(name)] = one
    return SpaceRobot.from_model(couple(robot.model, known))


def state(robot: SpaceRobot, seed: int, far: bool = False) -> State:
    """A random state; `far`: where a satellite is, 7e6 m from the origin."""
    rng = np.random.default_rng(seed)
    q = pin.integrate(robot.model, pin.neutral(robot.model), rng.uniform(-1.5, 1.5, robot.nv))
    q[:3] = rng.normal(size=3) * (7e6 if far else 1.0)
    return robot.state(q, rng.normal(size=robot.nv))
