"""The shift and turn of a base since its first pose."""

from __future__ import annotations

import numpy as np

from ospace.kernels.tree import Floats


def base_displacement(poses: Floats) -> Floats:
    """Return how far a base has shifted and turned since its first pose.

    Parameters
    ----------
    poses : (N, 7)
        As `ospace.analysis.base_motion` returns them, or the first seven numbers of q.

    Returns
    -------
    (N, 2) array
        Shift of its origin, m, and angle of its turn, in [0, π] rad.
    """
    shift = np.linalg.norm(poses[:, :3] - poses[0, :3], axis=1)
    (v_0, w_0), v, w = (poses[0, 3:6], poses[0, 6]), poses[:, 3:6], poses[:, 6]
    cosine, sine = w_0 * w + v @ v_0, w_0 * v - w[:, None] * v_0 - np.cross(v_0, v)  # of half the turn
    return np.column_stack([shift, 2.0 * np.arctan2(np.linalg.norm(sine, axis=1), np.abs(cosine))])
