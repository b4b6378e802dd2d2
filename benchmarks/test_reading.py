"""A URDF of 24 joints read by ospace, which proves what it read, and by Pinocchio, which does not."""

import pinocchio as pin
import pytest

import ospace

FILE = str(ospace.models.path("chaser_24dof"))


@pytest.mark.parametrize(
    "read",
    [ospace.SpaceRobot.from_urdf, lambda file: pin.buildModelFromUrdf(file, pin.JointModelFreeFlyer())],
    ids=["ospace", "pinocchio"],
)
def test_read_a_urdf(benchmark, read):
    benchmark.group = "reading a URDF"
    benchmark.pedantic(read, (FILE,), rounds=30, warmup_rounds=2)
