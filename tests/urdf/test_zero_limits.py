"""Limits of joints: what is zero, what is unlimited, and where zero lies."""

from __future__ import annotations

import numpy as np
import pytest
from urdf.corpus.parts import AXIS, joint, link, robot

import ospace


@pytest.mark.parametrize("kind", ["revolute", "prismatic", "continuous"])
def test_an_effort_of_zero_is_zero_and_only_a_missing_one_is_unlimited(tmp_path, kind):
    file, moving = tmp_path / "robot.urdf", "" if kind == "continuous" else 'lower="-1" upper="1"'
    for limit, effort, code, severity in (
        (f'<limit {moving} effort="0" velocity="1"/>', 0.0, "effort-zero", "info"),
        (f'<limit {moving} effort="-0.0" velocity="1"/>', 0.0, "effort-zero", "info"),
        (f'<limit {moving} effort="3" velocity="1"/>', 3.0, None, None),
        (f'<limit {moving} velocity="1"/>', np.inf, "effort-missing", "warning"),
        ("", np.inf, "limits-missing", "info" if kind == "continuous" else "warning"),
    ):
        file.write_text(robot(link("base"), link("arm"), joint(kind=kind, more=AXIS + limit)))
        made = ospace.SpaceRobot.from_urdf(file)
        assert made.model.effortLimit[6] == effort
        assert [(one.code, one.severity) for one in made.findings] == ([(code, severity)] if code else [])


@pytest.mark.parametrize(("kind", "size"), [("revolute", "0.0698 rad (4 deg)"), ("prismatic", "0.0698 m")])
def test_zero_outside_limits_is_reported_in_the_unit_of_the_joint(tmp_path, kind, size):
    limit = '<limit lower="-3" upper="-0.0698131700797732" effort="1" velocity="1"/>'
    (tmp_path / "robot.urdf").write_text(robot(link("base"), link("arm"), joint(kind=kind, more=AXIS + limit)))
    made = ospace.SpaceRobot.from_urdf(tmp_path / "robot.urdf")
    (finding,) = made.findings
    assert (finding.code, finding.severity, finding.subject) == ("zero-outside-limits", "warning", "joint 'hinge'")
    assert size in finding.message
    assert made.outside_limits(made.configuration()).keys() == {"hinge"}
    assert made.outside_limits(made.neutral()) == {}
