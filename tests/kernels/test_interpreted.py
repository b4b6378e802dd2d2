"""The kernels give the same results interpreted, and with every access to memory checked."""

import os
import subprocess
import sys

import numpy as np
import pytest

PROGRAM = """
import numpy as np, ospace, trees
import ospace.kernels.jit.simd
robot = trees.tree(5, 16)
state = trees.state(robot, 5)
points = [robot.point("base"), robot.point("link_15"), robot.point("link_7", "angular")]
forward = ospace.operational_space(state, points)
inverted = ospace.operational_space(state, points[1], "inverted")
floating = ospace.free_floating(state, points)
joint_space = ospace.joint_space_dynamics(state)
generalized = ospace.generalized_jacobian(state, points)
plain = trees.tree(6, 9, ("revolute", "continuous about any axis", "prismatic"))
moving = trees.state(plain, 6)
ends = [plain.point("base", "linear"), plain.point("link_8"), plain.point("link_4")]
run = ospace.OperationalSpaceEvaluator(plain, ends).update(moving.q, moving.v)
width = {width}
if width:
    ospace.kernels.jit.simd.widest = lambda: width
batch = run if not width else ospace.operational_space_batch(
    plain, ends, [moving.q] * 3, [moving.v] * 3, ("inertia", "bias_force", "generalized_jacobian", "momentum"),
    threads=1,
)
if width:
    several = [batch.generalized_jacobian, batch.momentum]
else:
    several = []
results = [
    *several, run.inertia, run.bias_force, batch.inertia, batch.bias_force,
    ospace.momentum(state), forward.inertia_inverse, forward.bias_acceleration, forward.response, forward.jacobian,
    inverted.inertia, inverted.bias_force, floating.bias_acceleration, floating.floating_inertia_inverse,
    joint_space.coupling_inertia, joint_space.manipulator_inertia, joint_space.base_bias,
    joint_space.manipulator_bias, generalized.generalized_jacobian, generalized.momentum_velocity,
]
np.savez({out!r}, *results)
"""


def results(folder, width, **environment):
    out = str(folder / "results.npz")
    paths = os.pathsep.join([os.path.dirname(os.path.dirname(__file__)), *sys.path])
    subprocess.run(
        [sys.executable, "-c", PROGRAM.format(out=out, width=width)],
        check=True,
        env={**os.environ, "PYTHONPATH": paths, **environment},
        timeout=300,
    )
    with np.load(out) as saved:
        return [saved[name] for name in saved.files]


@pytest.mark.parametrize(
    "environment",
    [{"NUMBA_DISABLE_JIT": "1"}, {"NUMBA_BOUNDSCHECK": "1"}],
    ids=["interpreted", "bounds checked"],
)
def test_interpreted_and_bounds_checked_kernels_give_the_same_results(tmp_path, environment):
    # lanes are the same kernels: to compile them once more for checked memory takes a minute and finds nothing else
    width = 2 if "NUMBA_DISABLE_JIT" in environment else 0
    cache = {"OSPACE_CACHE_DIR": str(tmp_path / "cache")} if "NUMBA_BOUNDSCHECK" in environment else {}
    (tmp_path / "plain").mkdir()
    (tmp_path / "other").mkdir()
    plain = results(tmp_path / "plain", width, NUMBA_DISABLE_JIT="0", NUMBA_BOUNDSCHECK="0")
    other = results(tmp_path / "other", width, **environment, **cache)
    for one, two in zip(plain, other, strict=True):
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-11 * np.abs(two).max())
