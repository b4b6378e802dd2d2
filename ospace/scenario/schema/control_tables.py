"""Tables of limits and of control: how far joints may go, periods, solver, integrator."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, WithJsonSchema, model_validator

from ospace.control import JointLimits
from ospace.control.controller import DEFAULT_HORIZON
from ospace.control.solvers import Solver, solver_named
from ospace.exceptions import OspaceError
from ospace.model.robot import SpaceRobot
from ospace.scenario import plugins
from ospace.scenario.schema.keys import ACCELERATIONS, Period, is_a
from ospace.scenario.table import Either, OneOf, Problem, Table, Text
from ospace.scenario.units import Quantity
from ospace.simulation.integrators import INTEGRATORS

_WHOLE = 1e-9
_DELAYS = 8.0
"""How many delays of commands motion limits are seen ahead, so that joints rest at them."""
Share = Annotated[float, Quantity("number", above=0.0, most=1.0)]
Setting = Annotated[float, Quantity("number", above=0.0)]


def _installed(solver: str) -> str:
    if plugins.is_reference(solver):
        if not callable(plugins.checked(solver)):
            raise ValueError(f"'{solver}' is no function from a program to z or None")
        return solver
    try:
        solver_named(solver)
    except OspaceError as error:
        raise ValueError(str(error)) from None
    return solver


def _pairs_of_links(value: object) -> list[tuple[str, ...]]:
    found: list[tuple[str, ...]] = []
    for one in value if isinstance(value, list) else [None]:
        names = [one] if isinstance(one, str) else one
        if not (isinstance(names, list) and len(names) in (1, 2) and all(isinstance(x, str) and x for x in names)):
            raise ValueError('give a list of pairs of links, as [["hand", "panel"], "mast"]')
        found.append(tuple(names))
    return found


_NAMES: dict[str, Any] = {"type": "array", "items": {"type": "string"}, "minItems": 1, "maxItems": 2}
_PAIRS: dict[str, Any] = {"type": "array", "items": {"anyOf": [{"type": "string"}, _NAMES]}}


class LimitsTable(Table):
    """Limits of the joints, taken from the model."""

    share: Share = Field(1.0, description="Of the model's torque and velocity limits")
    torque_share: Share | None = Field(None, description="Of the model's torque limits alone; share if left out")
    velocity_share: Share | None = Field(None, description="Of the model's velocity limits alone; share if left out")
    acceleration: Annotated[
        float | dict[str, Any] | None,
        Either(
            is_a(dict),
            {
                "is": Annotated[dict[str, Any], ACCELERATIONS],
                "else": Annotated[float, Quantity("angular acceleration", above=0.0, infinite=True)],
            },
        ),
    ] = Field(None, description="Of all joints, or by joint name; sliding joints take the same number in m/s^2")

    clearance: Annotated[float, Quantity("length", above=0.0)] | None = Field(
        None, description="Distance that links keep from each other and from the target; none is kept if left out"
    )
    may_touch: Annotated[list[tuple[str, ...]], BeforeValidator(_pairs_of_links), WithJsonSchema(_PAIRS)] = Field(
        [], description="Pairs of links that may come nearer, or one link for all of its pairs"
    )

    def mistakes(self) -> Iterable[Problem]:
        """Return whether the share of both has nothing left to be of."""
        if {"share", "torque_share", "velocity_share"} <= self.model_fields_set:
            yield self.path("share"), "torque_share and velocity_share leave it nothing: leave one of the three out"
        if self.may_touch and self.clearance is None and "clearance" not in dict(self._noted):
            yield self.path("may_touch"), "says nothing without limits.clearance: give that as well"

    def accelerations(self, robot: SpaceRobot) -> tuple[dict[str, float], list[Problem]]:
        """Return the limits of acceleration by joint, SI units, and what is wrong with others."""
        if isinstance(self.acceleration, dict):
            return ACCELERATIONS.read(self.acceleration, robot, self.path("acceleration"))
        return {} if self.acceleration is None else dict.fromkeys(robot.joint_names, self.acceleration), []

    def of(self, robot: SpaceRobot, actuated: SpaceRobot) -> JointLimits:
        """Return the limits of `robot`, of whose joints those of `actuated` have drives."""
        limits = JointLimits.of(
            robot,
            acceleration=self.accelerations(actuated)[0],
            share=self.share,
            torque_share=self.torque_share,
            velocity_share=self.velocity_share,
        )
        idle = np.array([name not in actuated.rate_names for name in robot.rate_names], dtype=bool)
        if not idle.any():
            return limits
        free = np.where(idle, np.inf, 0.0)
        return replace(
            limits,
            torque=np.where(idle, 0.0, limits.torque),
            lower=limits.lower - free,
            upper=limits.upper + free,
            velocity=limits.velocity + free,
            acceleration=limits.acceleration + free,
        )


class ControlTable(Table):
    """Times, solver and integrator of control and simulation."""

    period: Period = Field(1e-3, description="Of the control cycle, a whole number of steps")
    step: Period = Field(1e-3, description="Of the integrator; the period if that is shorter")
    solver: Annotated[Text, AfterValidator(_installed)] = Field(
        "daqp", description="daqp, proxqp, a back-end of qpsolvers that is installed, or a plugin's, as my_module:solve"
    )
    integrator: Annotated[str, OneOf(INTEGRATORS)] = Field("rk4", description="Scheme that integrates the motion")
    trust_radius: Setting = Field(1.0, description="Joint motion that an error may ask for undamped, rad or m")
    singular: Setting = Field(1e-5, description="Independence of a task's rows, 0 to 1, below which joints are damped")
    damping: Setting = Field(1e-5, description="Weight of that damping, relative to the mean square of the rows")
    regularization: Setting = Field(1e-6, description="Weight of squared accelerations")
    limit_horizon: Period | None = Field(
        None,
        description="How far ahead motion limits are seen; 40 ms, or two periods or eight delays if that is longer",
    )

    delay: Annotated[float, Quantity("time", least=0.0, most=10.0)] = Field(
        0.0, description="From what is measured to when the command acts, a whole number of steps"
    )

    @property
    def settings(self) -> dict[str, Any]:
        """Arguments that a `Controller` takes of it, by name."""
        taken = ("period", "trust_radius", "singular", "damping", "regularization", "limit_horizon")
        settings = {name: getattr(self, name) for name in taken} | {"solver": self.solves}
        if self.limit_horizon is None and self.delay:
            settings["limit_horizon"] = max(DEFAULT_HORIZON, 2.0 * self.period, _DELAYS * self.delay)
        return settings

    @model_validator(mode="after")
    def _short_step(self) -> ControlTable:
        if "step" not in self.model_fields_set:
            self.step = min(self.step, self.period)
        return self

    @property
    def solves(self) -> str | Solver:
        """The solver, by its name or as the function of a plugin."""
        if not plugins.is_reference(self.solver):
            return self.solver
        function: Solver = plugins.found(self.solver)
        return function

    def mistakes(self) -> Iterable[Problem]:
        """Yield the times that are not a whole number of steps."""
        for key, time, least in (("period", self.period, 1), ("delay", self.delay, 0)):
            count = time / self.step
            whole = math.isfinite(count) and abs(count - round(count)) <= _WHOLE * max(1.0, count)
            if math.isfinite(count) and not (whole and round(count) >= least):
                yield self.path(key), f"{time:g} s is not a whole number of steps of {self.step:g} s"
