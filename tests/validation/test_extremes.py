"""Findings on the sampled states: where the dynamic singularity is nearest, in lengths of the robot's own."""

from __future__ import annotations

import json
import re

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace.cli.main import main
from ospace.cli.pose import joint_values
from ospace.validation import report


def nearest(robot, *frames, samples=6):
    found = report.check(robot, [robot.point(frame) for frame in frames], samples=samples).findings
    return [finding for finding in found if finding.code == "dynamic-singularity"]


def share_of(robot, finding, frame):
    """σ_min/σ_max of J_m* in the pose of the finding, with its length."""
    length = float(re.search(r"L = (\S+) m", finding.message)[1])
    state = robot.state(robot.configuration(joint_values(finding.pose, robot)))
    J = ospace.generalized_jacobian(state, robot.point(frame)).generalized_jacobian
    values = np.linalg.svd(np.r_[np.full(3, 1.0 / length), np.ones(3)][:, None] * J, compute_uv=False)
    return values[-1] / values[0]


def test_the_nearest_dynamic_singularity_is_where_the_finding_says():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    for frame, finding in zip(("right_hand", "head"), nearest(robot, "right_hand", "head"), strict=True):
        assert float(finding.value) == pytest.approx(share_of(robot, finding, frame), rel=2e-3)
        shown = re.findall(r"(\w+)=", finding.message)
        model, joint = robot.model, robot.point(frame).joint
        assert shown == [model.names[j] for j in model.supports[joint] if j > 1]
        assert finding.pose.count("=") == robot.n_joints


@pytest.mark.parametrize("factor", [1e-2, 1e2])
def test_the_nearest_dynamic_singularity_does_not_depend_on_the_unit_of_length(factor):
    robot = trees.tree(0, 7, ("revolute",), branching=0.0)
    model = robot.model.copy()
    for j in range(1, model.njoints):
        model.jointPlacements[j].translation *= factor
        body = model.inertias[j]
        model.inertias[j] = pin.Inertia(body.mass, factor * body.lever, factor**2 * body.inertia)
    model.armature = factor**2 * model.armature
    scaled = ospace.SpaceRobot.from_model(model)
    one, two = (nearest(which, "link_6")[0] for which in (robot, scaled))
    assert float(one.value) == pytest.approx(float(two.value), rel=1e-3)
    assert one.pose == two.pose


def test_a_sliding_joint_counts_in_the_same_length():
    robot = trees.tree(0, 7, ("revolute", "prismatic"), branching=0.0)
    point = robot.point("link_6")
    finding = nearest(robot, "link_6")[0]
    length = float(re.search(r"L = (\S+) m", finding.message)[1])
    state = robot.state(robot.configuration(joint_values(finding.pose, robot)))
    J = ospace.generalized_jacobian(state, point).generalized_jacobian
    slides = [robot.model.joints[j].shortname().startswith("JointModelP") for j in range(2, robot.model.njoints)]
    J = np.r_[np.full(3, 1.0 / length), np.ones(3)][:, None] * J * np.where(slides, length, 1.0)
    values = np.linalg.svd(J, compute_uv=False)
    assert float(finding.value) == pytest.approx(values[-1] / values[0], rel=2e-3)


def test_json_tells_the_pose(capsys):
    assert main(["check", "ets_vii", "--samples", "2", "--json"]) == 0
    findings = {finding["code"]: finding for finding in json.loads(capsys.readouterr().out)["findings"]}
    assert findings["base-condition"]["pose"] is None
    assert findings["dynamic-singularity"]["pose"].count("=") == 6
