"""The plot of `ospace bench`: growth with the robot, and with the number of states."""

from __future__ import annotations

from pathlib import Path

from ospace.benchmark.report import Benchmark
from ospace.files import replacing


def save(result: Benchmark, path: Path) -> None:
    """Write the plot to `path`; its suffix tells the format."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    for each, colour in zip(result.growth, ("C0", "C2"), strict=True):
        known = [(nv, time) for nv, time in zip(each.sizes, each.dense, strict=True) if time is not None]
        label = f"ospace, {each.shape}: slope {each.slope:.2f}"
        left.loglog(each.sizes, each.ours, "o-", color=colour, label=label)
        label = f"crba + Cholesky alone, {each.shape}: slope {each.dense_slope:.2f}"
        left.loglog(*zip(*known, strict=True), "s--", color=colour, alpha=0.6, label=label)
    left.set(xlabel="degrees of freedom", ylabel="time of one state, µs", title="Γ_e⁻¹ and μ_e of two points")
    rows = sorted((row for row in result.batch if row.threads == 1), key=lambda row: row.states)
    sizes = [row.states for row in rows]
    right.loglog(sizes, [row.times.ours for row in rows], "o-", label="operational_space_batch, one thread")
    right.loglog(sizes, [row.times.theirs for row in rows], "s--", label="loop over pin.computeDelassusMatrix")
    title = f"Γ_e⁻¹ of {rows[0].points} points, {result.robot}"
    right.set(xlabel="states in a call", ylabel="time per state, µs", title=title)
    for axes in (left, right):
        axes.grid(True, which="both", alpha=0.25)
        axes.legend(fontsize="small", loc="upper left")
        axes.set_ylim(top=10.0 * axes.get_ylim()[1])  # room for the legend
    with replacing(path) as part:
        figure.savefig(part)
