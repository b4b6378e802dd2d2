"""The robot that evaluator and batch are tried on."""

import pytest

import ospace


@pytest.fixture(scope="module")
def chaser():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
