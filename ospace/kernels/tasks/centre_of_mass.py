"""The centre of mass follows a reference."""

from __future__ import annotations

from ospace.kernels.jit.compile import inlined
from ospace.kernels.jit.load_store import load3, load6, store6
from ospace.kernels.spatial import scale3, sub3
from ospace.kernels.tasks.reference import follow
from ospace.kernels.tasks.rows import write_base_wrench_columns, write_task_rows
from ospace.kernels.tasks.tables import BaseActuation, TaskRows, Tasks
from ospace.kernels.workspace import Work


@inlined
def centre_of_mass_rows(w: Work, base: BaseActuation, tasks: Tasks, rows: TaskRows, t: int, time: float) -> None:
    """The centre of mass follows the reference: moved by the base wrench alone, m c̈ = f."""
    place, _, v_ref, a_ref = follow(tasks, t, time)
    from_base = sub3(place, (w.q[0, 0], w.q[1, 0], w.q[2, 0]))
    momentum, none = load6(w.momentum, 0), (0.0, 0.0, 0.0)
    v = scale3(momentum[0:3], 1.0 / w.IC[0, 0])
    for k in range(rows.block.shape[0]):
        store6(rows.block, k, none + none)
    write_base_wrench_columns(w, base, rows, 1.0 / w.IC[0, 0], 0.0)
    error, rate = sub3(from_base, load3(w.mass_centre, 0)), sub3(v_ref[0:3], v)
    write_task_rows(tasks, rows, t, error + none, rate + none, scale3(a_ref[0:3], -1.0) + none)
