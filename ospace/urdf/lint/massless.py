"""Joints that nothing resists: where links without mass hang from them, what is left is the links' tensors.

Such a subtree stores kinetic energy in rotation alone. It is eliminated from its tips inward, in one configuration
taken at random: with J the tensors that a joint feels and W the angular part of its columns,

    β = Wᵀ J W + a_r,   J_h ← J_h + R (J − J W β⁻¹ Wᵀ J) Rᵀ

A joint whose β is singular there is so in every configuration: H is singular.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ospace.kernels.articulated_body import NO_INERTIA
from ospace.kernels.tree import Floats
from ospace.urdf.description import Joint

_SEED = 0


@dataclass(frozen=True)
class JointMotion:
    """Rotation that a joint gives its body in some configuration.

    Attributes
    ----------
    rotation : (3, 3)
        Of the body's axes in those of the body that it hangs from.
    turning : (3, k)
        Angular velocity for each rate of the joint, in the body's axes.
    armature : (k,)
        Inertia of the drives, kg m² or kg.
    """

    rotation: Floats
    turning: Floats
    armature: Floats


def motion_of(joint: Joint, rotation: Floats, rng: np.random.Generator) -> JointMotion:
    """Take a joint of a URDF, whose frame is turned by `rotation`, at a position taken at random.

    Returns
    -------
    JointMotion
    """
    axis, none = np.array(joint.axis)[:, None], np.zeros((3, 1))
    about_axis = pin.exp3(axis[:, 0] * rng.uniform(-np.pi, np.pi))
    turn, turning = {
        "prismatic": (np.eye(3), none),
        "planar": (about_axis, np.hstack([none, none, axis])),
        "floating": (pin.exp3(rng.normal(size=3)), np.hstack([none, none, none, np.eye(3)])),
    }.get(joint.kind, (about_axis, axis))
    return JointMotion(rotation @ turn, turning, np.zeros(turning.shape[1]))


def motions_of(model: pin.Model) -> list[JointMotion]:
    """Take the joints of a model behind its free-flyer in a configuration taken at random.

    Returns
    -------
    list of JointMotion
    """
    rng = new_rng()
    q = pin.integrate(model, pin.neutral(model), rng.uniform(-1.0, 1.0, model.nv))
    motions = []
    for j in range(2, model.njoints):
        joint, first = model.joints[j], model.idx_vs[j]
        data = joint.createData()
        joint.calc(data, q)
        turning = np.asarray(data.S).reshape(6, -1)[3:]
        armature = np.asarray(model.armature)[first : first + model.nvs[j]]
        motions.append(JointMotion(model.jointPlacements[j].rotation @ data.M.rotation, turning, armature))
    return motions


def new_rng() -> np.random.Generator:
    """Return the generator of configurations: the same file is read in the same way each time.

    Returns
    -------
    np.random.Generator
    """
    return np.random.default_rng(_SEED)


def singular_joints(
    parents: Sequence[int], masses: Sequence[float], tensors: Sequence[Floats], motions: Sequence[JointMotion]
) -> list[int]:
    """Find the bodies whose joints move no mass, and nothing else that resists.

    Parameters
    ----------
    parents : sequence of int
        Number of the body from which each hangs, smaller than its own; −1 for the base.
    masses, tensors : sequence of float, of (3, 3)
        Of each body; kg, kg m².
    motions : sequence of JointMotion
        Of each body but the base.

    Returns
    -------
    list of int
        Numbers of the bodies.
    """
    mass, felt = np.array(masses), [np.array(tensor) for tensor in tensors]
    singular = []
    for k in range(len(parents) - 1, 0, -1):
        mass[parents[k]] += mass[k]
        if mass[k] != 0.0:
            continue
        J, motion = felt[k], motions[k - 1]
        U = J @ motion.turning
        beta = motion.turning.T @ U + np.diag(motion.armature)
        if not np.linalg.eigvalsh(beta)[0] > NO_INERTIA * np.trace(J):
            singular.append(k)
        beyond = J - U @ np.linalg.pinv(beta, hermitian=True) @ U.T
        felt[parents[k]] += motion.rotation @ beyond @ motion.rotation.T
    return singular[::-1]
