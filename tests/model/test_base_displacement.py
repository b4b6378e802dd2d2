"""Shift and turn of a base, against SciPy's rotations."""

import numpy as np
from scipy.spatial.transform import Rotation

from ospace.model.base_displacement import base_displacement


def test_shift_and_turn_of_a_base_are_those_of_its_rotations():
    rng = np.random.default_rng(0)
    places, turns = rng.normal(size=(50, 3)), Rotation.random(50, random_state=1)
    quaternions = turns.as_quat()
    quaternions[10:20] *= -1.0  # the same attitudes
    quaternions[20], quaternions[21] = quaternions[0], -quaternions[0]
    shift, turn = base_displacement(np.hstack([places, quaternions])).T
    np.testing.assert_allclose(shift, np.linalg.norm(places - places[0], axis=1), rtol=1e-15)
    wanted = (turns[0].inv() * turns).magnitude()
    wanted[20:22] = 0.0
    np.testing.assert_allclose(turn, wanted, atol=1e-14)
