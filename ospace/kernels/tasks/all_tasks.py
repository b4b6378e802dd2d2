"""The rows of all tasks, each by the kernel of its kind."""

from __future__ import annotations

from ospace.kernels.jit.compile import inlined
from ospace.kernels.tasks.centre_of_mass import centre_of_mass_rows
from ospace.kernels.tasks.joints import joint_rows
from ospace.kernels.tasks.look_at import look_at_rows
from ospace.kernels.tasks.momentum import momentum_rows
from ospace.kernels.tasks.motion import motion_rows
from ospace.kernels.tasks.relative_pose import relative_pose_rows
from ospace.kernels.tasks.rows import base_response
from ospace.kernels.tasks.tables import (
    CENTRE_OF_MASS,
    DAMPING,
    LOOK_AT,
    MOMENTUM,
    MOTION,
    POSTURE,
    RELATIVE,
    ZERO_REACTION,
    BaseActuation,
    TaskRows,
    Tasks,
)
from ospace.kernels.tasks.zero_reaction import zero_reaction_rows
from ospace.kernels.workspace import Robot, Work


@inlined
def assemble_rows(w: Work, robot: Robot, base: BaseActuation, tasks: Tasks, rows: TaskRows, time: float) -> None:
    """Fill the rows of all tasks but the `CUSTOM` ones."""
    base_response(w, base)
    for t in range(tasks.kind.size):
        kind = tasks.kind[t]
        if kind == MOTION:
            motion_rows(w, robot, base, tasks, rows, t, time)
        elif kind == RELATIVE:
            relative_pose_rows(w, robot, base, tasks, rows, t, time)
        elif kind == LOOK_AT:
            look_at_rows(w, robot, base, tasks, rows, t, time)
        elif kind == CENTRE_OF_MASS:
            centre_of_mass_rows(w, base, tasks, rows, t, time)
        elif kind == MOMENTUM:
            momentum_rows(w, base, tasks, rows, t, time)
        elif kind == ZERO_REACTION:
            zero_reaction_rows(w, tasks, rows, t)
        elif kind in (POSTURE, DAMPING):
            joint_rows(w, robot, tasks, rows, t)
