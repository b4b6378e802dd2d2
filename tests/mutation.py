"""Of mistakes in the kernels, how many `ospace check` notices.

Changes one ``+`` to ``-``, or the reverse, in a kernel that computes a public quantity; runs `ospace check` on a copy
of the package with that mistake, interpreted; and counts:

- *noticed*: the check fails, in a row of its table or by an error;
- *equivalent*: it does not, and no public result differs from the original's by more than 1e-9 of its size;
- *survived*: it does not, and a result differs.

    python tests/mutation.py --count 40 --seed 0
    python tests/mutation.py --count 20 --file analysis/rates.py
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import random
import shutil
import subprocess
import sys
import tempfile
import tokenize
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

TESTS = Path(__file__).resolve().parent
PACKAGE = TESTS.parent / "ospace"
KERNELS = (
    ("kinematics", "points", "pv_osimr", "composite_body", "response", "spd_inverse", "articulated_body", "spatial")
    + ("evaluation", "batch", "forward_chain", "inverted_chain", "singular_values")
)  # fmt: skip
OTHERS = ("dynamics/paper_sweeps.py", "model/layout.py", "analysis/rates.py", "analysis/bias_derivative.py")
FILES = (*(f"kernels/{name}.py" for name in KERNELS), *OTHERS)
CHECKS = (
    (str(TESTS / "validation/every_joint.urdf"), "--point", "hand", "--point", "tip", "--samples", "4"),
    ("chaser_24dof", "--point", "right_hand", "--point", "head", "--samples", "3"),
)
SECONDS = 40  # of the processor, of which the original takes 4: a mistake may end no loop
SMALLEST_CHANGE = 1e-9


class Mutation(NamedTuple):
    """One operator in one file."""

    file: str
    line: int
    column: int
    source: str

    def __str__(self) -> str:
        marked = f"{self.source[: self.column]}[{self.source[self.column]}]{self.source[self.column + 1 :]}"
        return f"ospace/{self.file}:{self.line}: {marked.strip()}"

    def apply(self, package: Path) -> None:
        lines = (package / self.file).read_text().splitlines(keepends=True)
        text = lines[self.line - 1]
        other = {"+": "-", "-": "+"}[text[self.column]]
        lines[self.line - 1] = text[: self.column] + other + text[self.column + 1 :]
        (package / self.file).write_text("".join(lines))


def mutations() -> list[Mutation]:
    """Return every binary + and - of the kernels."""
    found = []
    for file in FILES:
        before = None
        with (PACKAGE / file).open("rb") as stream:
            for token in tokenize.tokenize(stream.readline):
                if token.type == tokenize.OP and token.string in "+-" and _ends_an_operand(before):
                    found.append(Mutation(file, *token.start, token.line.rstrip()))
                if token.type not in (tokenize.NL, tokenize.COMMENT):
                    before = token
    return found


def _ends_an_operand(token: tokenize.TokenInfo) -> bool:
    if token.type == tokenize.NAME:
        return token.string not in ("return", "in", "and", "or", "not", "if", "else", "yield", "is")
    return token.type == tokenize.NUMBER or token.string in (")", "]", "}")


# -- in a process with the mistake ------------------------------------------------------------------------------


def outcome(file: str) -> None:
    """Run the checks; write whether they notice something, and all public results."""
    import resource

    import numpy as np

    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    noticed, said = 0, io.StringIO()
    try:
        from ospace.cli.main import main

        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            noticed = any(main(["check", *given]) for given in CHECKS) or tree_is_unsound()
    except Exception:
        noticed = 2
    results = {}
    if not noticed:
        with contextlib.suppress(Exception):  # no results are other results
            results = public_results()
    np.savez(file, noticed=int(noticed), **results)


def tree():
    """Return a robot with what no URDF holds: spherical and helical joints, the inertia of drives."""
    import trees

    robot = trees.tree(3, len(trees.JOINT_TYPES))
    return robot, [robot.point("link_6"), robot.point(robot.leaf_links[-1])]


def tree_is_unsound() -> bool:
    """Run the check of `tree` from Python."""
    from ospace.validation import report

    robot, points = tree()
    return report.check(robot, points, samples=3).errors > 0


def public_results():
    """Return every public quantity of some states, points that take a part of their rows among them."""
    import numpy as np

    import ospace
    from ospace import analysis
    from ospace.dynamics import batch, evaluator
    from ospace.dynamics.joint_space import inverse_dynamics
    from ospace.validation.sampling import random_state

    results = {}

    def take(name, result, names):
        for one in names:
            results[f"{name}.{one}"] = np.array(getattr(result, one))

    robots = [tree()]
    for file, _, first, _, second, *_ in CHECKS:
        robot = ospace.SpaceRobot.from_urdf(file if file.endswith(".urdf") else ospace.models.path(file))
        robots.append((robot, [robot.point(first), robot.point(second)]))
    for robot, points in robots:
        first, second = (point.frame for point in points)
        rng = np.random.default_rng(7)
        states = [random_state(robot, rng, far=k == 1) for k in range(3)]
        partly = [robot.point(first, "linear"), robot.point(robot.frame_names[1]), robot.point(second, "angular")]
        for taken in (points, partly):
            label = f"{robot.name} {len(taken)} points"
            for k, state in enumerate(states):
                for method in ("pv_osimr", "forward"):
                    now = ospace.operational_space(state, taken, method)
                    names = ("inertia", "inertia_inverse", "bias_force", "bias_acceleration", "jacobian", "response")
                    take(f"{label} {k} {method}", now, names)
                inverted = ospace.operational_space(state, taken[0], "inverted")
                take(f"{label} {k} inverted", inverted, ["inertia", "inertia_inverse", "bias_force"])
                joint_space = ospace.joint_space_dynamics(state)
                take(f"{label} {k}", joint_space, vars(joint_space))
                take(f"{label} {k}", ospace.generalized_dynamics(state), ["generalized_inertia", "generalized_bias"])
                moved = ospace.generalized_jacobian(state, taken)
                take(f"{label} {k} moved", moved, vars(moved))
                floating = ospace.free_floating(state, taken)
                take(f"{label} {k} floating", floating, vars(floating))
                run = ospace.OperationalSpaceEvaluator(robot, taken, evaluator.QUANTITIES).update(state.q, state.v)
                take(f"{label} {k} evaluator", run, [*evaluator.QUANTITIES, "response"])
                way = np.r_[state.v, np.cos(np.arange(robot.nv))]
                results[f"{label} {k} rate"] = analysis.generalized_jacobian_rate(state, taken)
                results[f"{label} {k} derivative"] = analysis.inertia_inverse_derivative(state, taken, way[robot.nv :])
                results[f"{label} {k} bias derivative"] = analysis.bias_force_derivative(state, taken[0], way)
                results[f"{label} {k} momentum"] = ospace.momentum(state)
                results[f"{label} {k} forces"] = inverse_dynamics(state, np.sin(np.arange(robot.nv)))
            Q, V = (np.array([getattr(state, name) for state in states]) for name in "qv")
            many = ospace.operational_space_batch(robot, taken, Q, V, batch.QUANTITIES, threads=1)
            take(f"{label} batch", many, batch.QUANTITIES)
    return results


# -- in the process that counts -----------------------------------------------------------------------------------


def run(mutation: Mutation | None, folder: Path):
    """Run the checks on a copy of the package with the mistake; return what they wrote."""
    import numpy as np

    with tempfile.TemporaryDirectory(dir=folder) as scratch:
        package, file = Path(scratch) / "ospace", Path(scratch) / "outcome.npz"
        shutil.copytree(folder / "ospace", package)
        if mutation is not None:
            mutation.apply(package)
        (Path(scratch) / "models").symlink_to(PACKAGE.parent / "models")
        environment = {**os.environ, "PYTHONPATH": scratch, "NUMBA_DISABLE_JIT": "1", "OPENBLAS_NUM_THREADS": "1"}
        command = ["nice", sys.executable, "-W", "ignore", str(Path(__file__).resolve()), "--outcome", str(file)]
        subprocess.run(command, env=environment, capture_output=True, check=False)
        if not file.exists():
            return {"noticed": np.array(3)}
        with np.load(file) as saved:
            return {name: saved[name] for name in saved.files}


def same(results, original) -> bool:
    import numpy as np

    if results.keys() != original.keys():
        return False
    return all(
        results[name].shape == value.shape
        and np.abs(results[name] - value).max(initial=0.0) <= SMALLEST_CHANGE * np.abs(value).max(initial=1e-300)
        for name, value in original.items()
    )


def main() -> None:
    """Count."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=40, help="mutations (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--file", action="append", choices=FILES, help="mutations of this file; repeatable (default: all)"
    )
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--outcome", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.outcome:
        outcome(given.outcome)
        return
    every = [one for one in mutations() if one.file in (given.file or FILES)]
    chosen = random.Random(given.seed).sample(every, min(given.count, len(every)))
    kinds: dict[str, list[Mutation]] = {"noticed": [], "equivalent": [], "survived": []}
    errors = 0
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(given.workers) as pool:
        shutil.copytree(PACKAGE, Path(folder) / "ospace", ignore=shutil.ignore_patterns("__pycache__"))
        original = run(None, Path(folder))
        if original["noticed"]:
            sys.exit("the check fails on the package as it is")
        for mutation, results in zip(chosen, pool.map(lambda one: run(one, Path(folder)), chosen), strict=True):
            noticed = int(results["noticed"])
            kind = "noticed" if noticed else "equivalent" if same(results, original) else "survived"
            errors += noticed > 1
            kinds[kind].append(mutation)
            say(f"{kind:10} {mutation}")
    noticed, survived = len(kinds["noticed"]), len(kinds["survived"])
    share = f"noticed {noticed} of {noticed + survived} that change a result, {errors} of them by an exception"
    say(f"\nseed {given.seed}: {len(chosen)} of {len(every)} operators changed")
    say(f"{share}; {len(kinds['equivalent'])} change none")
    for mutation in kinds["survived"]:
        say(f"survived: {mutation}")


def say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
