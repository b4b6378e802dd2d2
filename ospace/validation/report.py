"""Report of `ospace check`: facts of the model, findings, agreement table, verdict; also as one JSON document."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import numpy as np
import pinocchio as pin

import ospace
from ospace.exceptions import OspaceError, SingularInertiaError
from ospace.model.points import OperationalPoint, points_of
from ospace.model.robot import SpaceRobot
from ospace.urdf.lint.findings import Finding, by_severity, make_finding
from ospace.validation.agreement import Agreement, AgreementTable, summary
from ospace.validation.extremes import Extremes
from ospace.validation.mesh_boxes import of_meshes
from ospace.validation.overlaps import of_shapes
from ospace.validation.placements import IndependentReader
from ospace.validation.sample import Sample, condition
from ospace.validation.sampling import random_state

Verdict = Literal["sound", "undecided", "unsound"]

SCHEMA_VERSION = 3
UNITS = "SI: m, kg, s, rad, N, N m; six-vectors linear part first"
_PLACEMENT_BOUND = 1e-12
_INTERPRETED, _COMPILED = 3, 64  # states of the batch: an odd number, so that the last lane is filled up


@dataclass(frozen=True)
class ModelFacts:
    """Facts of a robot at zero joint positions; lengths and axes from the base-link frame."""

    name: str
    bodies: int
    joints: dict[str, int]
    degrees_of_freedom: int
    total_mass: float
    base_mass: float
    arm_to_base_mass_ratio: float
    principal_inertias: list[float]
    mass_centre: list[float]
    condition_H_b: float
    gravity: float
    units: str
    points: list[dict[str, Any]]

    @property
    def length(self) -> float:
        """Characteristic length: the radius of gyration about the mass centre, m; 1 where all mass is in one place."""
        return float(np.sqrt(0.5 * sum(self.principal_inertias) / self.total_mass)) or 1.0


@dataclass(frozen=True)
class Report:
    """All that `ospace check` says of a robot."""

    model: ModelFacts | None
    findings: tuple[Finding, ...]
    agreement: list[Agreement] = field(default_factory=list)
    samples: int = 0
    seed: int = 0

    @property
    def errors(self) -> int:
        """Findings of level error, and rows of the table that differ."""
        wrong = sum(finding.severity == "error" for finding in self.findings)
        return wrong + sum(row.verdict == "differs" for row in self.agreement)

    @property
    def undecided(self) -> int:
        """Rows of the table of which no state could tell whether they agree."""
        return sum(row.verdict == "undecided" for row in self.agreement)

    @property
    def verdict(self) -> Verdict:
        """Return "unsound" with any error, else "undecided" with any row undecided, else "sound"."""
        return "unsound" if self.errors else "undecided" if self.undecided else "sound"

    def as_dict(self) -> dict[str, Any]:
        """Return the document that ``--json`` prints; ``report.schema.json`` beside this file describes it."""
        return {
            "schema": SCHEMA_VERSION,
            "ospace": ospace.__version__,
            "pinocchio": pin.__version__,
            "model": None if self.model is None else _finite(asdict(self.model)),
            "findings": [finding.as_dict() for finding in self.findings],
            "agreement": [_finite({**asdict(row), "verdict": row.verdict}) for row in self.agreement],
            "samples": self.samples,
            "seed": self.seed,
            "verdict": self.verdict,
        }


def _finite(told: dict[str, Any]) -> dict[str, Any]:
    """Put null for what is not finite: no number stands for it in JSON."""
    return {key: None if isinstance(value, float) and not np.isfinite(value) else value for key, value in told.items()}


def model_facts(robot: SpaceRobot, points: Sequence[OperationalPoint]) -> ModelFacts:
    """Gather the facts of `robot` and its operational points."""
    model = robot.model
    kinds: dict[str, int] = {}
    for joint in list(model.joints)[2:]:
        kinds[_kind(joint)] = kinds.get(_kind(joint), 0) + 1
    upper = np.triu(pin.crba(model, model.createData(), robot.configuration())[:6, :6])  # of a singular base as well
    H_b = upper + np.triu(upper, 1).T
    mass = robot.total_mass
    centre = np.array([H_b[5, 1], H_b[3, 2], H_b[4, 0]]) / mass
    about_centre = H_b[3:, 3:] - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    base_mass = float(model.inertias[1].mass)
    return ModelFacts(
        name=robot.name,
        bodies=model.njoints - 1,
        joints=kinds,
        degrees_of_freedom=robot.nv,
        total_mass=mass,
        base_mass=base_mass,
        arm_to_base_mass_ratio=(mass - base_mass) / base_mass,
        principal_inertias=np.linalg.eigvalsh(about_centre).tolist(),
        mass_centre=centre.tolist(),
        condition_H_b=condition(H_b),
        gravity=0.0,
        units=UNITS,
        points=[{"frame": point.frame, "rows": point.n_rows} for point in points],
    )


def _kind(joint: pin.JointModel) -> str:
    """Name of a joint's type as URDF calls it."""
    name = joint.shortname().removeprefix("JointModel")
    known = {"Planar": "planar", "FreeFlyer": "floating", "Mimic": "mimic"}
    if name in known:
        return known[name]
    if joint.nq == 2 and joint.nv == 1:
        return "continuous"
    return "prismatic" if name.startswith("P") else "revolute" if name.startswith("R") else name


def check(
    robot: SpaceRobot,
    points: Sequence[OperationalPoint],
    *,
    samples: int = 20,
    seed: int = 0,
    batch: bool = False,
    progress: Callable[[int], None] = lambda done: None,
) -> Report:
    """Compare every quantity of the paper with Pinocchio's over random states of `robot`.

    Every second state is 7e6 m from the origin. `progress` is called with the number of states done. With `batch`, the
    kernels of `operational_space_batch` are compiled, which takes seconds, and compared in all states; else they run
    interpreted, of three states and two points.
    """
    points = points_of(robot, points)
    rng = np.random.default_rng(seed)
    facts = model_facts(robot, points)
    table, extremes, findings = AgreementTable(robot), Extremes(robot, points, facts.length), list(robot.findings)
    if robot.description is not None and robot.source is not None:
        findings += of_meshes(robot.description, robot.source, robot.package_dirs, robot.findings)
    findings += of_shapes(robot)
    reader = _second_reader(robot, findings)
    placed: list[tuple[float, float]] = []
    rows: list[Agreement] = []
    done = 0
    together: list[Sample] = []
    try:
        for done in range(1, samples + 1):
            sample = Sample(robot, random_state(robot, rng, far=done % 2 == 0), points, rng)
            table.add(sample)
            extremes.add(sample)
            if reader is not None:
                placed.append((reader.compare(rng), _PLACEMENT_BOUND))
            if batch or done <= _INTERPRETED:
                together.append(sample)
            if together and (done == samples or len(together) == (_COMPILED if batch else _INTERPRETED)):
                table.add_batch(together, compiled=batch)
                together.clear()
            progress(done)
        rows = table.rows()
        if reader is not None:
            name = f"placements of {reader.compared} links"
            rows.append(summary(name, "14", "Pinocchio", "yourdfpy", placed))
    except SingularInertiaError as error:
        message = "carries no inertia in a sampled state, so the joint-space inertia is singular to working precision"
        subject = f"joint '{error.joint}'"
        if error.joint is None:
            subject = f"link '{robot.description.root}'" if robot.description is not None else "base"
            message = "the base has no inertia about some axis in a sampled state, beside that of what it carries"
        findings.append(make_finding("singular-inertia", subject, message))
    except (OspaceError, np.linalg.LinAlgError) as error:
        findings.append(make_finding("not-computable", f"robot '{robot.name}'", str(error)))
    findings += extremes.findings(robot.name)
    return Report(facts, by_severity(findings), rows, done, seed)


def _second_reader(robot: SpaceRobot, findings: list[Finding]) -> IndependentReader | None:
    """Return the independent reader; None, with a finding, where it rejects the file, or there is none."""
    if robot.description is None:
        return None
    try:
        return IndependentReader(robot)
    except OspaceError as error:
        findings.append(make_finding("second-reader", f"robot '{robot.name}'", str(error)))
        return None
