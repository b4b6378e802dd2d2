"""Verdicts on sound robots, however nearly their rows depend on each other: never "differs", and still sharp."""

from __future__ import annotations

import dataclasses
import site
from pathlib import Path

import numpy as np
import pytest

import ospace
from ospace.validation import report, sample

FOLDER = next(
    (
        robots
        for folder in site.getsitepackages()
        if (robots := Path(folder) / "cmeel.prefix/share/example-robot-data/robots").is_dir()
    ),
    Path(),
)


REAL = (
    "tiago_description/robots/tiago_no_hand.urdf",
    "tiago_pro_description/robots/tiago_pro.urdf",
    "kinova_description/robots/kinova.urdf",
    "human_description/robots/human.urdf",
    "iris_description/robots/iris.urdf",
)

CUTOFF = 1e-12  # squares of singular values below it count as zero


def body(name, mass, *moments):
    tensor = " ".join(f'i{axis}{axis}="{moment}"' for axis, moment in zip("xyz", moments, strict=True))
    return (
        f'<link name="{name}"><inertial><mass value="{mass}"/>'
        f'<inertia {tensor} ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def fixed(name, child, xyz, rpy, kind="fixed"):
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="{" ".join(map(str, xyz))}" rpy="{" ".join(map(str, rpy))}"/>'
        f'<parent link="bus"/><child link="{child}"/><axis xyz="0 0 1"/></joint>'
    )


def satellite(rng, inertia, wheels=2, tilt=0.0):
    """A bus with wheels about (nearly) the same axis, and sensors fixed to it."""
    parts = [body("bus", rng.uniform(1.0, 5.0), 1.0, 1.0, 1.0)]
    for k in range(wheels):
        parts.append(body(f"wheel_{k}", 0.05, 0.55 * inertia, 0.55 * inertia, inertia))
        turn = (-1.57 + tilt * rng.normal(), 0, 0)
        parts.append(fixed(f"spin_{k}", f"wheel_{k}", rng.normal(scale=0.2, size=3), turn, "continuous"))
    for k in range(5):
        parts.append(f'<link name="sensor_{k}"/>')
        parts.append(fixed(f"at_{k}", f"sensor_{k}", rng.normal(scale=0.1, size=3), rng.choice([0.0, 1.57, -1.57], 3)))
    return f'<robot name="satellite">{"".join(parts)}</robot>'


def checked(robot, names, seed, samples=2):
    return report.check(robot, [robot.point(name) for name in names], samples=samples, seed=seed)


def verdicts(result):
    return {row.quantity: row.verdict for row in result.agreement}


def read(text, tmp_path):
    file = tmp_path / "robot.urdf"
    file.write_text(text)
    return ospace.SpaceRobot.from_urdf(file)


@pytest.mark.parametrize("seed", range(40))
def test_a_satellite_with_small_wheels_is_not_unsound(tmp_path, seed):
    rng = np.random.default_rng(seed)
    inertia = 10.0 ** rng.uniform(-13.0, -2.0)
    robot = read(satellite(rng, inertia, rng.integers(1, 4), rng.choice([0.0, 1e-7, 1e-5, 1e-3])), tmp_path)
    names = rng.choice([name for name in robot.leaf_links if name != "bus"], 5, replace=False)
    result = checked(robot, names, seed)
    assert "differs" not in verdicts(result).values()
    assert result.verdict == ("undecided" if "undecided" in verdicts(result).values() else "sound")


@pytest.mark.parametrize("seed", range(40))
def test_a_rank_at_its_cutoff_is_undecided(tmp_path, seed):
    """A wheel of 1e-12 kg m² moves a bus of 1 kg m² as little as counts as nothing."""
    rng = np.random.default_rng(seed)
    robot = read(satellite(rng, CUTOFF * (1.0 + rng.choice([-1, 1]) * 10.0 ** rng.uniform(-9.0, -4.0))), tmp_path)
    result = checked(robot, ["sensor_0", "sensor_1"], seed)
    assert "differs" not in verdicts(result).values()
    assert verdicts(result)["floating inertia"] == "undecided"
    assert result.verdict == "undecided"


@pytest.mark.parametrize("name", REAL)
def test_a_real_robot_is_never_unsound_whatever_the_points(name):
    robot = ospace.SpaceRobot.from_urdf(FOLDER / name, free_mimic=True)
    for seed in range(40):
        rng = np.random.default_rng(seed)
        names = rng.choice(robot.leaf_links, rng.integers(1, min(len(robot.leaf_links), 8) + 1), replace=False)
        assert "differs" not in verdicts(checked(robot, names, seed)).values(), (seed, names)


INVERSES = [
    ("operational_space", "inertia", "operational inertia"),
    ("operational_space", "bias_force", "bias force"),
    ("operational_space", "response", "dynamically consistent inverse J_e+"),
    ("free_floating", "floating_inertia", "floating inertia"),
    ("free_floating", "torque_map", "torque map J_m* H_m*^-1"),
]


@pytest.mark.parametrize("size", [1e-6, -1e-6])
@pytest.mark.parametrize(("function", "field", "row"), INVERSES, ids=[f"{one[0]}.{one[1]}" for one in INVERSES])
def test_a_millionth_is_found_on_real_robots(monkeypatch, function, field, row, size):
    robots = [ospace.SpaceRobot.from_urdf(FOLDER / name, free_mimic=True) for name in REAL]
    cases = [(robot, [robot.leaf_links[-1]]) for robot in robots]
    honest = [checked(robot, names, 0) for robot, names in cases]
    compute = getattr(sample, function)

    def dishonest(*given, **options):
        result = dataclasses.replace(compute(*given, **options))
        vars(result)[field] = getattr(result, field) * (1.0 + size)
        return result

    monkeypatch.setattr(sample, function, dishonest)
    decided = 0
    for (robot, names), before in zip(cases, honest, strict=True):
        assert "differs" not in verdicts(before).values()
        if verdicts(before)[row] == "agrees":
            decided += 1
            assert verdicts(checked(robot, names, 0))[row] == "differs", robot.name
    assert decided >= 2
