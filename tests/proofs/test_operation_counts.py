"""Operations that the sweeps take, counted by the numbers themselves, beside the orders that their inventors publish.

Sathya et al. give O(n + m² d) for PV-OSIM and O(n + m²) for PV-OSIMr, n joints, m rows, d links from base to tip.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from operations import Counter
from proven import row
from robots.mujoco_robot import example_robot

import ospace

FEET = ("left_sole_link", "right_sole_link")
HANDS = ("gripper_left_base_link", "gripper_right_base_link")


def counter(robot, frames):
    """Of a random configuration, whose Γ_e⁻¹ and J_m* the counted numbers must give."""
    rng = np.random.default_rng(2)
    angles = dict(zip(robot.joint_names, rng.uniform(-1.0, 1.0, robot.n_joints), strict=True))
    q = robot.configuration(angles, pin.SE3(pin.exp3(rng.normal(size=3)), np.zeros(3)))
    counted, state = Counter(robot, frames, q), robot.state(q)
    operations = counted.kinematics(), counted.pv_osimr(), counted.composite_bodies()
    points = [robot.point(frame) for frame in frames]
    for table, exact in (
        ("inertia_inverse", ospace.operational_space(state, points).inertia_inverse),
        ("generalized_jacobian", ospace.generalized_jacobian(state, points).generalized_jacobian),
    ):
        np.testing.assert_allclose(counted.table(table), exact, rtol=0, atol=1e-12 * np.abs(exact).max())
    return operations


def arms(stem, points, joints):
    """A stem of revolute joints on the base, and arms of `joints` each at its end, with a point at every tip."""
    rng, body, model = np.random.default_rng(1), pin.Inertia.FromBox(3.0, 0.3, 0.4, 0.5), pin.Model()
    model.name = "arms"

    def hang(parent, count, name):
        for k in range(count):
            placement = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))
            parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"{name}_{k}")
            model.appendBodyToJoint(parent, body, pin.SE3.Identity())
        return parent

    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, body, pin.SE3.Identity())
    end = hang(root, stem, "stem")
    for k in range(points):
        model.addBodyFrame(f"tip_{k}", hang(end, joints, f"arm_{k}"), pin.SE3.Identity(), 0)
    return ospace.SpaceRobot.from_model(model), [f"tip_{k}" for k in range(points)]


@pytest.mark.parametrize(
    ("points", "frames"), [("a foot", FEET[:1]), ("both feet", FEET), ("feet and hands", FEET + HANDS)]
)
def test_operations_of_a_humanoid(points, frames):
    robot = ospace.SpaceRobot.from_urdf(example_robot("talos_data/robots/talos_reduced.urdf"))
    row(f"operations on Talos, {points}: links, Γ_e⁻¹, J_m\\*").counts(*counter(robot, frames))


def test_operations_of_the_chaser():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    found = counter(robot, ("right_hand", "left_hand", "head"))
    row("operations on the chaser, hands and head: links, Γ_e⁻¹, J_m\\*").counts(*found)


def test_operations_grow_with_joints_and_with_the_square_of_points():
    """238 + 425 n + 726 p + 198 p² for p arms on the base, to the last operation."""
    sizes = [(p, k) for p in (1, 2, 3, 5) for k in (2, 5, 9)]
    counted = [counter(*arms(0, p, k))[1] for p, k in sizes]
    terms = np.array([[1, p * k, p, p * p] for p, k in sizes])
    found = np.rint(np.linalg.lstsq(terms, np.array(counted), rcond=None)[0]).astype(int)
    np.testing.assert_array_equal(terms @ found, counted)
    row("operations of Γ_e⁻¹ with n joints and p points, on p arms").counts(*found)


def test_operations_do_not_grow_with_depth_times_points():
    """What a joint adds that is on the way to one, two, four or six points."""
    more = []
    for points in (1, 2, 4, 6):
        few, many = (counter(*arms(stem, points, 2))[1] for stem in (10, 20))
        more.append((many - few) / 10)
    assert len(set(more)) == 1
    row("operations of Γ_e⁻¹ of a joint below 1, 2, 4 or 6 points").counts(int(more[0]))
