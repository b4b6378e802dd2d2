"""Of proofs, which turn red where a formula is off by one part in a million.

Each mutation multiplies one term of one file by 1.000001, in a copy of the package; all proofs then run on the copy.

    python tests/proofs/mutations.py                          every mutation, a minute or so each
    python tests/proofs/mutations.py pv_osimr -- -k mujoco    those of files so called, on the proofs that pytest takes

A mutated kernel is compiled anew; with NUMBA_DISABLE_JIT=1 kernels run interpreted, which is quicker for few proofs.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]


class Mutation(NamedTuple):
    """A term of a file, and what it becomes."""

    file: str
    term: str
    mutant: str


MUTATIONS = (
    Mutation(
        "kernels/kinematics.py",
        "d = rotate(R, load3(joints.b, i))\n            R = mat3_mul(R, turned",
        "d = scale3(rotate(R, load3(joints.b, i)), 1.000001)\n            R = mat3_mul(R, turned",
    ),
    Mutation("kernels/points.py", "(w.r, link), arm)", "(w.r, link), (arm[0] + 1e-6, arm[1], arm[2]))"),
    Mutation(
        "kernels/spatial.py",
        "A[20] * s[5]),\n    )\n\n\n@inlined\ndef sym6_mul_angular",
        "1.000001 * A[20] * s[5]),\n    )\n\n\n@inlined\ndef sym6_mul_angular",
    ),
    Mutation("kernels/articulated_body.py", "scale6(U, beta_inv)", "scale6(U, 1.000001 * beta_inv)"),
    Mutation("kernels/pv_osimr.py", "sym6_outer(f, g)", "sym6_outer(f, scale6(g, 1.000001))"),
    Mutation("kernels/pv_osimr.py", "scale6(g, -u)", "scale6(g, -1.000001 * u)"),
    Mutation("kernels/composite_body.py", "load6(w.H_bm, k)), -1.0)", "load6(w.H_bm, k)), -1.000001)"),
    Mutation("kernels/composite_body.py", "add6(x_b, sym6", "add6(scale6(x_b, 1.000001), sym6"),
    Mutation("kernels/composite_body.py", ", x_b), of_joints)", ", x_b), scale6(of_joints, 1.000001))"),
    Mutation(
        "kernels/response.py",
        "s += w.response[k + 6, i] * w.generalized_jacobian",
        "s += 1.000001 * w.response[k + 6, i] * w.generalized_jacobian",
    ),
    Mutation("kernels/spd_inverse.py", "x = -scratch", "x = -1.000001 * scratch"),
    Mutation("kernels/coupled_joints.py", "s + Y[k + 6, i] *", "s + 1.000001 * Y[k + 6, i] *"),
    Mutation("kernels/forward_chain.py", "(S / body.beta[i])", "(1.000001 * S / body.beta[i])"),
    Mutation("kernels/inverted_chain.py", "body.I[i] += I_L", "body.I[i] += 1.000001 * I_L"),
    Mutation("kernels/runge_kutta.py", "v[i] += h / 6.0 *", "v[i] += 1.000001 * h / 6.0 *"),
    Mutation("analysis/base_motion.py", "omega = by_joints", "omega = 1.000001 * by_joints"),
    Mutation("analysis/base_motion.py", "= (J_b_star @ rate)[3:], H_b,", "= (J_b_star @ rate)[3:], 1.000001 * H_b,"),
    Mutation("analysis/null_spaces.py", "(rows[:, None] * A)[2]", "(rows[:, None] * (A + 1e-6))[2]"),
    Mutation("simulation/variational.py", "w: Floats = plant", "w: Floats = 1.000001 * plant"),
    Mutation("simulation/dormand_prince.py", "change = (h *", "change = (1.000001 * h *"),
    Mutation("simulation/grasp.py", "of_c.inertia_inverse + of_t", "of_c.inertia_inverse + 1.000001 * of_t"),
)


def proofs(mutation: Mutation | None, cache: str, options: list[str]) -> tuple[set[str], set[str]]:
    """Return the proofs that hold, and those that are red, on a copy of the package with the mutation."""
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / "ospace"
        shutil.copytree(ROOT / "ospace", package, ignore=shutil.ignore_patterns("__pycache__"))
        (Path(folder) / "models").symlink_to(ROOT / "models")
        if mutation is not None:
            text = (package / mutation.file).read_text()
            if text.count(mutation.term) != 1:
                sys.exit(f"{mutation.file} has {mutation.term!r} {text.count(mutation.term)} times, not once")
            (package / mutation.file).write_text(text.replace(mutation.term, mutation.mutant))
        environment = {**os.environ, "PYTHONPATH": folder, "OSPACE_CACHE_DIR": cache}
        command = [sys.executable, "-m", "pytest", "-q", "-rA", "-p", "no:cacheprovider", f"--rootdir={ROOT}"]
        command += [f"--config-file={ROOT / 'pyproject.toml'}", "--tb=no", str(ROOT / "tests/proofs"), *options]
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
        if " passed" not in done.stdout and " failed" not in done.stdout:
            sys.exit(done.stdout + done.stderr)
        outcomes = re.findall(r"^(PASSED|FAILED|ERROR) \S+?::(.+?)(?: - .*)?$", done.stdout, re.MULTILINE)
        sets: dict[bool, set[str]] = {True: set(), False: set()}
        for outcome, name in outcomes:
            sets[outcome == "PASSED"].add(name)
        return sets[True], sets[False]


def main() -> None:
    """Run the mutations that are asked for, and list the proofs that none of them turns red."""
    names, options = sys.argv[1:], []
    if "--" in names:
        names, options = names[: names.index("--")], names[names.index("--") + 1 :]
    chosen = [one for one in MUTATIONS if not names or any(name in one.file for name in names)]
    with tempfile.TemporaryDirectory() as cache:
        unmoved, broken = proofs(None, cache, options)
        if broken:
            sys.exit(f"red on the package as it is: {', '.join(sorted(broken))}")
        for mutation in chosen:
            _, red = proofs(mutation, cache, options)
            unmoved -= red
            say(f"{len(red):3} red  {mutation.file}: {' '.join(mutation.mutant.split())}")
            say(f"         {', '.join(sorted(red))}")
    say(f"red with none of these {len(chosen)}: {', '.join(sorted(unmoved)) or 'no proof'}")


def say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
