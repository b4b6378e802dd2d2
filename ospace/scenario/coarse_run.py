"""A scenario run beforehand in coarse control cycles: what closed loop, joint limits and target make of its phases.

A bound on reach knows nothing of joint limits, nor of the way that an arm takes: whether a hand follows a target that
turns, only a run can show. In cycles of 10 ms it takes a tenth of the time, and ends where the run itself does, but for
the error of its steps. That error halves at least with the cycle; so what is refused is an error beyond the tolerance
that stays the same at half the cycle. Sensors are exact there, and commands act at once: noise and delay do not grow
with the cycle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from ospace.scenario import summary_text
from ospace.scenario.errors import ScenarioError
from ospace.scenario.result import PhaseResult
from ospace.scenario.runner import run
from ospace.scenario.schema import NoiseTable, PhaseTable, Scenario

_COARSEST = 0.01
"""Of a control cycle, s."""
_IN_A_PHASE = 50
"""Cycles that even the shortest time-out holds."""
_STIFF = 0.2
"""Radians of a task's own oscillation, or of a spin, that a cycle may take."""
_STAYS = 0.75
"""An error that stays by so much at half the cycle is none of the steps, which would be half as large at most."""
_MOST_CYCLES = 20_000
"""Longer scenarios are not rehearsed: some 4 s."""


def rehearse(scenario: Scenario, progress: Callable[[float], None] | None = None) -> str:
    """Run a scenario in coarse control cycles, and refuse what does not complete.

    Parameters
    ----------
    scenario : Scenario
    progress : function, optional
        Called with the simulated time after each step, s.

    Returns
    -------
    str
        Why it was not rehearsed, empty where it was: it has more than 20 000 coarse cycles, or starts outside limits of
        joints, to which its controller first goes back.

    Raises
    ------
    ScenarioError
        A phase cannot be completed; says which, how far off it ends, and what limits bind.
    KeyboardInterrupt
        Ctrl-C ended it.
    """
    if scenario.robot.outside_limits(scenario.start.q):
        return "its start is outside limits of joints"
    cycle = _coarse(scenario)
    longest, most = sum(phase.timeout for phase in scenario.phases), _MOST_CYCLES * cycle * scenario.control.period
    if longest > most:
        return f"it may take {longest:g} s, of which {most:g} s are the most that is rehearsed"
    first = _open(scenario, cycle, progress)
    if first is None:
        return ""
    second = _open(scenario, max(1, cycle // 2), progress) if cycle > 1 else first
    if second is None or second.name != first.name or second.outcome != first.outcome:
        return ""
    plan = next(phase for phase in scenario.phases if phase.name == first.name)
    before, after = dict(_errors(plan, first)), dict(_errors(plan, second))
    beyond = [name for name, (error, most) in after.items() if error > most and before[name][0] > most]
    grasps = first.grasp is not None
    if (first.outcome == "timed out" or grasps) and not any(
        after[name][0] >= _STAYS * before[name][0] for name in beyond
    ):
        return ""
    where = f"{plan.key}.grasp" if grasps else plan.key
    raise ScenarioError(scenario.path, [(where, _reason(second))])


def _coarse(scenario: Scenario) -> int:
    """Return how many control periods a coarse cycle has."""
    stiffest = max((task.stiffness for plan in scenario.phases for task in plan.tasks), default=0.0)
    rates = [math.sqrt(stiffest)] + [
        float(np.abs(state.v[3:]).max())
        for state in (scenario.start, *(target.start for target in scenario.targets.values()))
    ]
    shortest = min(min(plan.timeout, plan.duration or math.inf) for plan in scenario.phases)
    longest = min(_COARSEST, shortest / _IN_A_PHASE, _STIFF / max(*rates, 1e-9))
    return max(1, math.floor(longest / scenario.control.period + 1e-9))


def _open(scenario: Scenario, cycle: int, progress: Callable[[float], None] | None) -> PhaseResult | None:
    """Return the phase that does not complete in cycles of so many periods."""
    plain = scenario.control
    period = cycle * plain.period
    coarse = {} if cycle == 1 else {"period": period, "step": period}
    control = plain.model_copy(update={**coarse, "delay": 0.0})
    result = run(replace(scenario, control=control, noise=NoiseTable.model_validate({})), progress)
    if result.interrupted:
        raise KeyboardInterrupt
    last = result.phases[-1]
    return None if last.outcome == "complete" else last


def _errors(plan: PhaseTable, phase: PhaseResult) -> Iterator[tuple[str, tuple[float, float]]]:
    """Yield errors at the end, and what was to be had: of tasks, or of the grasp."""
    if phase.grasp is not None and plan.grasp is not None:
        yield "grasp, position", (phase.grasp.position_error, plan.grasp.position)
        yield "grasp, angle", (phase.grasp.angle_error, plan.grasp.angle)
        return
    for task in plan.tasks:
        if task.completion is not None and task.name in phase.errors:
            linear, angular = phase.errors[task.name].last
            yield f"{task.name}, position", (float(linear), task.completion.position)
            yield f"{task.name}, angle", (float(angular), task.completion.angle)


def _reason(phase: PhaseResult) -> str:
    ends = ", ".join(f"'{name}' ends {last} off" for name, _, last in summary_text.tasks(phase) if name in phase.reason)
    limits = ", ".join(sorted(phase.active_limits, key=lambda one: -phase.active_limits[one])[:3])
    parts = [f"phase '{phase.name}' fails in a rehearsal", phase.reason, ends, limits and f"limits reached: {limits}"]
    return "; ".join(part for part in parts if part)
