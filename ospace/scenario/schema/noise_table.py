"""Table of sensor noise: what the controller sees is not quite what is."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot
from ospace.scenario.schema.keys import POSITIONS, RATES, ByJoint, is_a
from ospace.scenario.table import Either, Problem, Seed, Table
from ospace.scenario.units import Quantity
from ospace.simulation import Noise

_POSITIONS, _RATES = (replace(one, least=0.0) for one in (POSITIONS, RATES))


def _of_joints(by_joint: ByJoint) -> Either:
    """Return the type of one number for all joints, or of a table by joint name."""
    all_joints = Annotated[float, Quantity(by_joint.angular, least=0.0)]
    return Either(is_a(dict), {"is": Annotated[dict[str, Any], by_joint], "else": all_joints})


class NoiseTable(Table):
    """White noise of the sensors, drawn anew in each control cycle; standard deviations."""

    position: Annotated[float, Quantity("length", least=0.0)] = Field(0.0, description="Of the base, along each axis")
    angle: Annotated[float, Quantity("angle", least=0.0)] = Field(0.0, description="Of the base, about each axis")
    velocity: Annotated[float, Quantity("velocity", least=0.0)] = Field(0.0, description="Of the base, along each axis")
    angular_velocity: Annotated[float, Quantity("angular velocity", least=0.0)] = Field(
        0.0, description="Of the base, about each axis"
    )
    joints: Annotated[float | dict[str, Any], _of_joints(_POSITIONS)] = Field(
        0.0, description="Of all joints, or by joint name; sliding joints take the same number in m"
    )
    joint_rates: Annotated[float | dict[str, Any], _of_joints(_RATES)] = Field(
        0.0, description="Of all joints, or by joint name; sliding joints take the same number in m/s"
    )
    seed: Seed = Field(0, description="The same seed gives the same noise")

    @property
    def any(self) -> bool:
        """True where something is noisy."""
        given = (self.position, self.angle, self.velocity, self.angular_velocity, self.joints, self.joint_rates)
        return any(any(one.values()) if isinstance(one, dict) else bool(one) for one in given)

    def unknown_joints(self, robot: SpaceRobot) -> list[Problem]:
        """Return what is wrong with the noise of single joints."""
        problems = []
        for key, by_joint in (("joints", _POSITIONS), ("joint_rates", _RATES)):
            given = getattr(self, key)
            if isinstance(given, dict):
                problems += by_joint.read(given, robot, self.path(key))[1]
        return problems

    def of(self, robot: SpaceRobot, chaser: SpaceRobot, segment: int) -> Noise | None:
        """Return the noise on the state of `robot`, which is the chaser or has its joints; None where there is none."""
        if not self.any:
            return None
        q = np.repeat([self.position, self.angle, 0.0], [3, 3, robot.nv - 6])
        v = np.repeat([self.velocity, self.angular_velocity, 0.0], [3, 3, robot.nv - 6])
        self._write(q, self.joints, _POSITIONS, robot, chaser)
        self._write(v, self.joint_rates, _RATES, robot, chaser)
        return Noise(q, v, (self.seed, segment))

    def _write(
        self,
        deviation: Floats,
        given: float | dict[str, Any],
        by_joint: ByJoint,
        robot: SpaceRobot,
        chaser: SpaceRobot,
    ) -> None:
        if not isinstance(given, dict):
            deviation[6:] = given
            return
        for name, value in by_joint.read(given, chaser, "")[0].items():
            deviation[6:][robot.rates_of(name)] = value
