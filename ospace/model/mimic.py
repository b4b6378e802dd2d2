"""Joints that mimic others, as Pinocchio's model has them; and the same robot with these joints free.

A follower stands at ratio · φ + offset where its leader stands at φ. With G the map of rates, φ̇_free = G φ̇, every
quantity of the robot is one of its free twin: H = Gᵀ H_free G, c = Gᵀ c_free, J = J_free G.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ospace.kernels.tree import PRISMATIC, REVOLUTE, Floats, Ints
from ospace.urdf.coupling import Following, copy_frames, copy_joint_numbers

MIMIC = "JointModelMimic"


@dataclass(frozen=True)
class Coupling:
    """Coupling of a joint to another.

    Attributes
    ----------
    leader : int
        Pinocchio's number of the joint that is followed.
    ratio, offset : float
        Of the follower's position; rad, or m.
    kind : int
        REVOLUTE or PRISMATIC of `ospace.kernels.tree`.
    axis : (3,)
        In the follower's frame.
    """

    leader: int
    ratio: float
    offset: float
    kind: int
    axis: Floats


def couplings_of(model: pin.Model) -> dict[int, Coupling]:
    """Return how the joints of a model follow others, by Pinocchio's number of the follower."""
    followers = [j for j in range(1, model.njoints) if model.joints[j].shortname() == MIMIC]
    if not followers:
        return {}
    data, found = model.createData(), {}
    pin.forwardKinematics(model, data, pin.neutral(model))
    leader_of = {model.idx_vs[j]: j for j in range(1, model.njoints) if model.nvs[j]}
    for j in followers:
        joint = model.joints[j].extract()
        ratio, offset = float(joint.scaling), float(joint.offset)
        S = np.asarray(data.joints[j].S, dtype=np.float64).ravel() * (np.sign(ratio) or 1.0)
        if ratio == 0.0:  # the column is zero: all that is left to know is where the offset puts the joint
            S = pin.log6(data.joints[j].M).vector * (np.sign(offset) or 1.0)
        kind = PRISMATIC if S[:3].any() else REVOLUTE
        axis = S[:3] if kind == PRISMATIC else S[3:] if S.any() else np.array([0.0, 0.0, 1.0])
        found[j] = Coupling(leader_of[joint.idx_v], ratio, offset, kind, axis / np.linalg.norm(axis))
    return found


class FreeJoints:
    """The robot without its couplings: Pinocchio's model of it, and the way there from the coupled one.

    Attributes
    ----------
    model : pin.Model
        Joints, bodies, frames and their order as in the coupled model.
    followers : dict of str to Following
        What couples it again, by `ospace.urdf.coupling.couple`.
    G : (nv_free, nv)
        Rates of the free robot by those of the coupled one.
    order : (nq_free,)
        Where the coordinates of the free robot stand among those of the coupled one with its followers behind them.
    """

    def __init__(self, model: pin.Model, couplings: Mapping[int, Coupling]) -> None:
        self.model = pin.Model()
        self.model.name, self.model.gravity = model.name, pin.Motion.Zero()
        self._followed = [(model.idx_qs[one.leader], model.nqs[one.leader], one) for one in couplings.values()]
        order: list[int] = []
        rates: list[Floats] = []
        for j in range(1, model.njoints):
            joint, own = model.joints[j], slice(model.idx_vs[j], model.idx_vs[j] + model.nvs[j])
            if j in couplings:
                one = couplings[j]
                make = pin.JointModelRevoluteUnaligned if one.kind == REVOLUTE else pin.JointModelPrismaticUnaligned
                joint = make(one.axis)
                order.append(model.nq + list(couplings).index(j))
                rates.append(one.ratio * np.eye(model.nv)[model.idx_vs[one.leader]])
            else:
                order += range(model.idx_qs[j], model.idx_qs[j] + model.nqs[j])
                rates += [*np.eye(model.nv)[own]]
            self.model.addJoint(model.parents[j], joint, model.jointPlacements[j], model.names[j])
            copy_joint_numbers(model, j, self.model, j)
            self.model.appendBodyToJoint(j, model.inertias[j], pin.SE3.Identity())
        copy_frames(model, self.model, {j: j for j in range(model.njoints)})
        self.followers = {
            str(model.names[j]): Following(str(model.names[one.leader]), one.ratio, one.offset)
            for j, one in couplings.items()
        }
        self.G: Floats = np.array(rates)
        self.order: Ints = np.array(order, dtype=np.int64)

    def configuration(self, q: Floats) -> Floats:
        """Return the configuration (nq_free,) of the free robot where the coupled one is at `q` (nq,)."""
        angles = [q[k] if count == 1 else np.arctan2(q[k + 1], q[k]) for k, count, _ in self._followed]
        behind = [one.ratio * at + one.offset for at, (_, _, one) in zip(angles, self._followed, strict=True)]
        free: Floats = np.r_[q, behind][self.order]
        return free
