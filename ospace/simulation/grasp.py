"""Grasp and release: a link of the target is fixed to a link of the chaser, as an inelastic impact.

Both points move at the same velocity afterwards. The impulse λ that the chaser gives the target, by Newton's law in
operational space (Γ_e⁻¹ = J_e H⁻¹ J_eᵀ of either, (9)), with Δẋ = ẋ_chaser − ẋ_target,

    λ = (Γ_c⁻¹ + Γ_t⁻¹)⁻¹ Δẋ,    Δv_c = −H_c⁻¹ J_cᵀ λ,    Δv_t = H_t⁻¹ J_tᵀ λ,    energy lost = ½ Δẋᵀ λ

It is an internal one: linear and angular momentum of both together are kept.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.checks import check_kind
from ospace.dynamics.operational_space import operational_space
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint, check_owner
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.results import Result
from ospace.simulation.combined_model import CombinedModel, join
from ospace.simulation.moving_frame import MovingFrame

_ALL = (True,) * 6


@dataclass(frozen=True)
class Grasp(Result):
    """A target in the hand of a chaser.

    Attributes
    ----------
    state : State
        Of the combined robot just after the grasp.
    impulse : (6,)
        λ, from chaser to target, inertial axes, at the chaser's point; N s, N m s.
    energy_lost : float
        J, not negative.
    position_error, angle_error : float
        From the target's point to the chaser's at the grasp, m, rad. They stay as they are: nothing is pulled together.
    velocity_error : (6,)
        Δẋ before the impact, at the chaser's point, inertial axes; m/s, rad/s.
    chaser, target : State
        Just after the grasp, each by itself.
    """

    state: State
    impulse: Floats
    energy_lost: float
    position_error: float
    angle_error: float
    velocity_error: Floats
    chaser: State
    target: State
    _joined: CombinedModel = field(repr=False)
    _hand: int = field(repr=False)
    _held: int = field(repr=False)
    _T_HT: pin.SE3 = field(repr=False)

    @property
    def robot(self) -> SpaceRobot:
        """The combined robot."""
        return self._joined.robot

    def release(self, q: npt.ArrayLike, v: npt.ArrayLike) -> tuple[State, State]:
        """Return the states of chaser and target that let go of each other.

        Parameters
        ----------
        q : (nq,)
            Of the combined robot; m, rad.
        v : (nv,)
            Of the combined robot; m/s, rad/s.

        Returns
        -------
        chaser, target : State
            Of the robots that they were before the grasp.
        """
        return release(self, q, v)


def grasp(chaser: State, hand: OperationalPoint, target: State, fixture: OperationalPoint) -> Grasp:
    """Fix the link of the target that carries `fixture` to the link of the chaser that carries `hand`.

    Parameters
    ----------
    chaser, target : State
        Just before; in the same inertial frame.
    hand, fixture : OperationalPoint
        Of chaser and target; all six rows are fixed, whatever rows they take.

    Returns
    -------
    Grasp
        The combined robot in the state after the impact, the impulse, and what was lost.

    Raises
    ------
    OspaceError
        A point is another robot's, or the target is held beyond a joint that cannot be reversed.

    Notes
    -----
    The links are fixed at the pose that they have. How far the fixture was from the hand is in `position_error` and
    `angle_error`. The combined robot keeps the chaser's base, joints and frames; names of the target that
    clash are prefixed with ``<target>/``.
    """
    for state in (chaser, target):
        check_kind(state, State, "make it with robot.state(q, v)")
    check_owner(chaser.robot, hand)
    check_owner(target.robot, fixture)
    frame = MovingFrame.of(chaser)
    before_c, before_t = (State(one.robot, *frame.from_user_frame(one.q, one.v)) for one in (chaser, target))
    T_hand, T_fixture = before_c.placement(hand), before_t.placement(fixture)
    mismatch = T_hand.actInv(T_fixture)

    # The target's material point at the hand, and both links as they stand there.
    at_hand = replace(fixture, axes=_ALL, placement=fixture.placement * mismatch.inverse())
    impulse, velocity_error, changes = _impact(before_c, replace(hand, axes=_ALL), before_t, at_hand)
    after_c, after_t = (
        State(one.robot, one.q, one.v + _in_base_axes(one, change))
        for one, change in zip((before_c, before_t), changes, strict=True)
    )

    T_HT = hand.placement * at_hand.placement.inverse()
    joined = join(chaser.robot, hand.joint, target.robot, fixture.joint, T_HT)
    q, v = np.zeros(joined.robot.nq), np.zeros(joined.robot.nv)
    for rows, one in ((joined.first, after_c), (joined.second, after_t)):
        q[rows.joined_q], v[rows.joined_v] = one.q[rows.own_q], one.v[rows.own_v]
    return Grasp(
        state=joined.robot.state(*frame.to_user_frame_at(0.0, q, v)),
        impulse=impulse,
        energy_lost=0.5 * float(velocity_error @ impulse),
        position_error=float(np.linalg.norm(T_fixture.translation - T_hand.translation)),
        angle_error=float(np.linalg.norm(pin.log3(mismatch.rotation))),
        velocity_error=velocity_error,
        chaser=State(after_c.robot, *frame.to_user_frame_at(0.0, after_c.q, after_c.v)),
        target=State(after_t.robot, *frame.to_user_frame_at(0.0, after_t.q, after_t.v)),
        _joined=joined,
        _hand=joined.first_joints[hand.joint],
        _held=fixture.joint,
        _T_HT=T_HT,
    )


def release(held: Grasp, q: npt.ArrayLike, v: npt.ArrayLike) -> tuple[State, State]:
    """Return the states of chaser and target that let go of each other in the combined robot's state.

    Parameters
    ----------
    held : Grasp
    q, v : (nq,), (nv,)
        State of the combined robot.

    Returns
    -------
    chaser, target : State
        Without any impulse between them.
    """
    joined = held._joined
    combined = joined.robot.state(q, v)
    frame = MovingFrame.of(combined)
    q, v = combined.base_frame_state()
    parts = []
    for robot, rows in ((held.chaser.robot, joined.first), (held.target.robot, joined.second)):
        part_q, part_v = pin.neutral(robot.model), np.zeros(robot.nv)
        part_q[rows.own_q], part_v[rows.own_v] = q[rows.joined_q], v[rows.joined_v]
        parts.append((robot, part_q, part_v))

    # The target's base, from the link that is held: X = held link as seen from the base, moving by itself.
    model, data = joined.robot.model, joined.robot.data
    pin.forwardKinematics(model, data, q, v)
    robot, part_q, part_v = parts[1]
    own = robot.data
    pin.forwardKinematics(robot.model, own, part_q, part_v)
    X = own.oMi[held._held]
    part_q[:7] = pin.SE3ToXYZQUAT(data.oMi[held._hand] * held._T_HT * X.inverse())
    part_v[:6] = X.act(held._T_HT.actInv(data.v[held._hand]) - own.v[held._held]).vector
    chaser, target = (State(one, *frame.to_user_frame_at(0.0, a, b)) for one, a, b in parts)
    return chaser, target


def _impact(
    chaser: State, hand: OperationalPoint, target: State, fixture: OperationalPoint
) -> tuple[Floats, Floats, tuple[Floats, Floats]]:
    """Return λ (6,), Δẋ (6,), and the changes of [ẋ_b; φ̇] of chaser and target."""
    of_c, of_t = operational_space(chaser, hand), operational_space(target, fixture)
    difference = of_c.jacobian @ _velocity(chaser) - of_t.jacobian @ _velocity(target)
    impulse = np.asarray(np.linalg.solve(of_c.inertia_inverse + of_t.inertia_inverse, difference))
    return impulse, difference, (-of_c.response @ impulse, of_t.response @ impulse)


def _velocity(state: State) -> Floats:
    return np.concatenate([state.base_twist, state.v[6:]])


def _in_base_axes(state: State, change: Floats) -> Floats:
    """Return Pinocchio's v of a change of [ẋ_b; φ̇]."""
    R_BW = state.T_WB.rotation.T
    return np.concatenate([R_BW @ change[:3], R_BW @ change[3:6], change[6:]])
