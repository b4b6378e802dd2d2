"""Joints leave the base in peace: the velocity that they give it, J_b* φ̇ (2), falls to zero.

With y = J_b* φ̇ − [0; ω_b], from a frame that moves along with the base, and ẍ_b the base's drift at φ̈ = 0 (6),

    H_b ẍ_b = −c_b = −Ḣ_b [0; ω_b] − Ḣ_bm φ̇,   J̇_b* φ̇ = −H_b⁻¹ (Ḣ_bm φ̇ + Ḣ_b J_b* φ̇) = ẍ_b − H_b⁻¹ Ḣ_b y
    Ḣ_b y = Σ_i V_i ×* I_i y − I_i (V_i × y)

Where there is no momentum, H_b⁻¹ Ḣ_b y is zero.
"""

from __future__ import annotations

from ospace.kernels.jit.compile import inlined
from ospace.kernels.jit.load_store import load3, load6, load6_at, load21, store6
from ospace.kernels.spatial import (
    add6,
    cross_force,
    cross_motion,
    force_from,
    motion_at,
    scale6,
    sub6,
    sym6_mul,
    zero6,
)
from ospace.kernels.tasks.rows import write_task_rows
from ospace.kernels.tasks.tables import TaskRows, Tasks
from ospace.kernels.workspace import Work


@inlined
def zero_reaction_rows(w: Work, tasks: Tasks, rows: TaskRows, t: int) -> None:
    """The base's velocity by the joints, inertial axes, comes to rest; a wrench on the base does not count."""
    n = w.J_m_star.shape[0]
    x = zero6(load6(w.v, 0))
    for k in range(rows.block.shape[0]):
        column = load6_at(w.J_m_star, k, 0) if k < n else zero6(x)
        store6(rows.block, k, column)
        if k < n:
            x = add6(x, scale6(column, w.velocity[6 + k, 0]))
    y, changed = sub6(x, load6(w.v, 0)), zero6(x)
    for i in range(w.v.shape[0]):
        r, I, V = load3(w.r, i), load21(w.I, i), load6(w.v, i)
        moved = motion_at(r, y)
        momentum = sub6(cross_force(V, sym6_mul(I, moved)), sym6_mul(I, cross_motion(V, moved)))
        changed = add6(changed, force_from(r, momentum))
    drift = sub6(load6(w.base_drift, 0), sym6_mul(load21(w.base_inverse, 0), changed))
    write_task_rows(tasks, rows, t, scale6(x, -1.0), scale6(x, -1.0), drift)
