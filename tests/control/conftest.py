"""The robot that controllers are tried on."""

import numpy as np
import pinocchio as pin
import pytest

import ospace


@pytest.fixture(scope="module")
def chaser():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))


@pytest.fixture(scope="module")
def hand(chaser):
    return chaser.point("right_hand")


@pytest.fixture(scope="module")
def head(chaser):
    return chaser.point("head", offset=pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([0.1, 0.2, -0.1])))
