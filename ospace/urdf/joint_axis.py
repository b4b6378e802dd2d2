"""The axis of a joint, asked of Pinocchio in one way for all joint types of one degree of freedom."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ospace.kernels.tree import Floats


def joint_axis(joint: pin.JointModel) -> Floats:
    """Return the axis of a joint of one degree of freedom: the part of its column that is not zero.

    Returns
    -------
    (3,)
        In the joint's own frame.
    """
    data = joint.createData()
    q = np.zeros(joint.idx_q + joint.nq)
    q[joint.idx_q] = 1.0 if joint.nq == 2 else 0.0
    joint.calc(data, q)
    column = np.asarray(data.S).ravel()
    return np.asarray(column[3:] if np.abs(column[3:]).max() > 0.0 else column[:3], dtype=np.float64)
