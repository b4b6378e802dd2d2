"""Momentum approaches a value."""

from __future__ import annotations

from ospace.kernels.jit.compile import inlined
from ospace.kernels.jit.load_store import load3, load6, store6
from ospace.kernels.spatial import cross, scale6, sub3, sub6, zero6
from ospace.kernels.tasks.reference import follow
from ospace.kernels.tasks.rows import write_base_wrench_columns, write_task_rows
from ospace.kernels.tasks.tables import BaseActuation, TaskRows, Tasks
from ospace.kernels.workspace import Work


@inlined
def momentum_rows(w: Work, base: BaseActuation, tasks: Tasks, rows: TaskRows, t: int, time: float) -> None:
    """Linear momentum, and angular about the centre of mass, approach h_ref: ḣ = ḣ_ref + k (h_ref − h)."""
    _, _, h_ref, rate_ref = follow(tasks, t, time)
    momentum = load6(w.momentum, 0)
    h = momentum[0:3] + sub3(momentum[3:6], cross(load3(w.mass_centre, 0), momentum[0:3]))
    for k in range(rows.block.shape[0]):
        store6(rows.block, k, zero6(h))
    write_base_wrench_columns(w, base, rows, 1.0, 1.0)
    write_task_rows(tasks, rows, t, sub6(h_ref, h), zero6(h), scale6(rate_ref, -1.0))
