"""Findings on robots of example-robot-data whose faults are known."""

from __future__ import annotations

import site
from pathlib import Path

import pytest

import ospace


def robot_file(path):
    robots = "cmeel.prefix/share/example-robot-data/robots"
    return next(file for folder in site.getsitepackages() if (file := Path(folder) / robots / path).is_file())


def refused(path):
    with pytest.raises(ospace.UnsoundModelError) as caught:
        ospace.SpaceRobot.from_urdf(robot_file(path), free_mimic=True)
    return [finding for finding in caught.value.findings if finding.severity == "error"]


def test_romeo_moves_links_without_mass():
    errors = refused("romeo_description/urdf/romeo.urdf")
    assert {finding.code for finding in errors} == {"massless-subtree"}
    assert all(finding.subject.startswith("joint '") for finding in errors)
    assert "joint 'LFinger12'" in {finding.subject for finding in errors}


def test_romeo_laas_small_has_indefinite_inertias():
    errors = refused("romeo_description/urdf/romeo_laas_small.urdf")
    indefinite = [finding for finding in errors if finding.code == "inertia-indefinite"]
    assert indefinite
    assert all("negative principal moment -" in finding.message for finding in indefinite)


def test_icub_reduced_is_sound():
    findings = ospace.SpaceRobot.from_urdf(robot_file("icub_description/robots/icub_reduced.urdf")).findings
    odd = {finding.code for finding in findings if finding.severity != "info"}
    assert odd == {"zero-outside-limits", "gyration-small"}


def test_the_right_leg_of_icub_has_tensors_of_points():
    """Those of the left leg are some 1e15 times as large."""
    findings = ospace.SpaceRobot.from_urdf(robot_file("icub_description/robots/icub_reduced.urdf")).findings
    dense = {finding.subject: finding.severity for finding in findings if finding.code == "gyration-small"}
    legs = {"link 'r_upper_leg'": "warning", "link 'r_lower_leg'": "info", "link 'r_ankle_1'": "info"}
    assert dense == {"link 'base_link'": "warning", **legs}


def test_ur3_is_an_empty_remnant():
    with pytest.raises(ospace.UrdfError, match=r"ur3\.urdf.*has no <link>"):
        ospace.SpaceRobot.from_urdf(robot_file("ur_description/urdf/ur3.urdf"))
