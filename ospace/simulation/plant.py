"""The robot as integrators see it: (t, q, v) to accelerations, and to the rates of work and of momentum.

    H v̇ + c = τ + [0; τ_f] + Σ J_eᵀ F_e,      τ = [R_WBᵀ F_b; torques]           by `pin.aba`; by `pin.crba` and
                                                       `pin.rnea` of the free joints where joints mimic others
    work        Ẇ = τᵀ v + Σ F_eᵀ ẋ_e
    friction    Ḋ = −τ_fᵀ φ̇ ≥ 0,       τ_f of `ospace.dynamics.joint_friction`
    momentum    ṗ = f_b + Σ f_e,    L̇ = p_b × f_b + n_b + Σ (p_e × f_e + n_e)

L is the angular momentum about the origin of the frame in which q stands.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.checks import checked_vector, real_numbers
from ospace.dynamics.joint_friction import JointFriction
from ospace.exceptions import OspaceError
from ospace.kernels.base_wrench import push_base, push_point
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint, check_owner
from ospace.model.robot import SpaceRobot
from ospace.simulation.actuation import CommandLike

Wrench = npt.ArrayLike | Callable[[float], npt.ArrayLike]
"""(6,) force and torque, inertial axes, linear first (N, N m), or a function of time (s) that returns it."""


class Plant:
    """Forward dynamics of a robot under what is held and what pushes it.

    Attributes
    ----------
    torque, base_wrench, wheel_torque : (n,), (6,), (3,) arrays
        Held until the next `hold`.
    friction : JointFriction or None
        Of the joints; None where the model has none.
    bodies : pin.Model
        The robot's model; of free joints where joints mimic others.
    rates : (7,) array
        ṗ and L̇, inertial axes, which is `impulse_rate`, and Ḋ; overwritten by `accelerate`.
    """

    def __init__(self, robot: SpaceRobot, wrenches: Mapping[OperationalPoint, Wrench] | None = None) -> None:
        self.robot, self.model = robot, robot.model
        self._free = robot.free
        self.bodies = robot.model if robot.free is None else robot.free.model
        self.data = self.bodies.createData()
        self.tau = np.zeros(robot.nv)
        self.torque = self.tau[6:]
        self._base = np.zeros((2, 6))
        self._flat = self._base.ravel()
        self.base_wrench, self.wheel_torque = self._base[0], self._base[1, 3:]
        self.rates = np.zeros(7)
        self.impulse_rate = self.rates[:6]
        friction = JointFriction.of(robot)
        self.friction = friction if friction.any else None
        self._resisted, self._resistance = np.empty(robot.nv), np.empty(robot.n_joints)
        self._pushed = False
        functions = {point: _function(robot, point, wrench) for point, wrench in _pairs(wrenches)}
        self._external = bool(functions)
        self._joints = sorted({point.joint for point in functions})
        self._on_joints = np.zeros((len(self._joints), 6))
        self._pushes = [
            (
                point.joint,
                point.placement.translation.copy(),
                self._on_joints[self._joints.index(point.joint)],
                function,
            )
            for point, function in functions.items()
        ]
        self._fext = pin.StdVec_Force()
        self._fext.extend([pin.Force.Zero()] * self.model.njoints)
        self._rotor = self.bodies.armature.copy()
        self._bare = self.bodies
        if self._rotor.any():
            self._bare = pin.Model(self.bodies)
            self._bare.armature = np.zeros(self.bodies.nv)

    @property
    def isolated(self) -> bool:
        """Return whether nothing from outside acts on the robot now."""
        return not self._pushed and not self._external

    def hold(self, command: CommandLike, time: float) -> None:
        """Take over a command; raises `OspaceError` for a wrong shape or numbers that are not finite."""
        n = self.robot.n_joints
        for name, held, given in (
            ("torque", self.torque, command.torque),
            ("base_wrench", self.base_wrench, command.base_wrench),
            ("wheel_torque", self.wheel_torque, command.wheel_torque),
        ):
            try:
                numbers = real_numbers(given)
            except (TypeError, ValueError):
                what = f"{name} of the controller at {time:.6g} s"
                raise OspaceError(f"{what} is not an array of real numbers: {given!r}") from None
            if numbers.shape != held.shape:
                raise OspaceError(
                    f"{name} of the controller at {time:.6g} s has shape {numbers.shape}; robot '{self.robot.name}' "
                    f"with {n} joint axes needs {held.shape}"
                )
            held[:] = numbers
        on_base = float(self._flat @ self._flat)
        if not math.isfinite(on_base + float(self.torque @ self.torque)):
            self._refuse(command, time)
        pushed = on_base > 0.0
        if self._pushed and not pushed:
            self.tau[:6] = self.impulse_rate[:] = 0.0
        self._pushed = pushed

    def _refuse(self, command: CommandLike, time: float) -> None:
        for name in ("torque", "base_wrench", "wheel_torque"):
            wrong = np.flatnonzero(~np.isfinite(getattr(command, name)))
            if wrong.size:
                value = getattr(command, name)[wrong[0]]
                self.tau[:] = self._base[:] = 0.0
                raise OspaceError(
                    f"{name}[{wrong[0]}] of the controller at {time:.6g} s is {value}: all numbers must be finite"
                )

    def accelerate(self, time: float, q: Floats, v: Floats, acceleration: Floats) -> float:
        """Write v̇ (nv,) to `acceleration` and ṗ, L̇, Ḋ to `rates`; return Ẇ, the power without friction's, W."""
        if self._pushed:
            push_base(q, self._base, self.tau, self.impulse_rate)
        tau = self.tau if self.friction is None else self._resist(self.friction, v)
        if self._free:
            return self._accelerate_coupled(time, q, v, tau, acceleration)
        if not self._external:
            acceleration[:] = pin.aba(self.model, self.data, q, v, tau, pin.Convention.LOCAL)
            return float(self.tau @ v)
        self._push_points(time, q)
        acceleration[:] = pin.aba(self.model, self.data, q, v, tau, self._fext, pin.Convention.LOCAL)
        return float(self.tau @ v) + self._power_of_points()

    def _power_of_points(self) -> float:
        """Return Σ F_eᵀ ẋ_e of the last pass with velocities."""
        moving = self.data.v
        return sum(float(row @ moving[j].vector) for j, row in zip(self._joints, self._on_joints, strict=True))

    def _accelerate_coupled(self, time: float, q: Floats, v: Floats, tau: Floats, acceleration: Floats) -> float:
        if self._external:
            self._push_points(time, q)
        own_q, own_v = self.bodies_at(q, v)
        force = pin.rnea(self.bodies, self.data, own_q, own_v, np.zeros(len(own_v)), self._fext)
        on_points = self._power_of_points() if self._external else 0.0
        acceleration[:] = np.linalg.solve(self.inertia(q), tau - self.coupled(force))
        return float(self.tau @ v) + on_points

    def inertia(self, q: Floats) -> Floats:
        """Return H (nv, nv) at `q`, base rows in base axes, with the drives' inertia."""
        own_q = q if self._free is None else self._free.configuration(q)
        upper = np.triu(pin.crba(self.bodies, self.data, own_q))
        H: Floats = upper + np.triu(upper, 1).T
        return H if self._free is None else self._free.G.T @ H @ self._free.G

    def bodies_at(self, q: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Return q and v of `bodies`."""
        return (q, v) if self._free is None else (self._free.configuration(q), self._free.G @ v)

    def coupled(self, force: Floats) -> Floats:
        """Return forces along v of those along the rates of `bodies`."""
        return force if self._free is None else self._free.G.T @ force

    def _resist(self, friction: JointFriction, v: Floats) -> Floats:
        """Return τ with friction at velocity `v`; write Ḋ to `rates`."""
        tau, rate = self._resisted, v[6:]
        friction.torque(rate, self._resistance)
        tau[:] = self.tau
        tau[6:] += self._resistance
        self.rates[6] = -float(self._resistance @ rate)
        return tau

    def friction_rate(self, q: Floats) -> float:
        """Return how fast friction may change joint rates at `q`: the largest eigenvalue of K H⁻¹, K = −∂τ_f/∂φ̇; 1/s.

        K is that at rest, where friction is steepest.
        """
        if self.friction is None:
            return 0.0
        root = np.sqrt(self.friction.slope(np.zeros(self.robot.n_joints)))
        responses = np.linalg.inv(self.inertia(q))[6:, 6:]
        return float(np.linalg.eigvalsh(root[:, None] * responses * root)[-1])

    def generalized_force(self, time: float, q: Floats) -> Floats:
        """Return τ + Σ J_eᵀ F_e (nv,) without friction, base rows in base axes; write ṗ, L̇ to `impulse_rate`."""
        if self._pushed:
            push_base(q, self._base, self.tau, self.impulse_rate)
        if not self._external:
            return self.tau.copy()
        self._push_points(time, q)
        own_q, still = self.bodies_at(q, np.zeros(self.robot.nv))
        force: Floats = self.tau - self.coupled(pin.rnea(self.bodies, self.data, own_q, still, still, self._fext))
        return force

    def _push_points(self, time: float, q: Floats) -> None:
        """Fill Pinocchio's external forces, each in its joint's frame, and add to `impulse_rate`."""
        pin.forwardKinematics(self.bodies, self.data, q if self._free is None else self._free.configuration(q))
        if not self._pushed:
            self.impulse_rate[:] = 0.0
        on_joints, placements = self._on_joints, self.data.oMi
        on_joints[:] = 0.0
        for j, p, row, wrench in self._pushes:
            push_point(placements[j].homogeneous, p, wrench(time), row, self.impulse_rate)
        for j, row in zip(self._joints, on_joints, strict=True):
            self._fext[j] = pin.Force(row)

    def momentum(self, q: Floats, v: Floats) -> tuple[Floats, Floats, float]:
        """Return momentum (6,), linear and about the centre of mass; that centre (3,); kinetic energy (J).

        Inertial axes. The drives' inertia has its part in the energy, none in the momentum. Pinocchio 4.1 counts it
        wrongly for revolute joints about any axis, so it is counted here.
        """
        q, v = self.bodies_at(q, v)
        momentum = pin.computeCentroidalMomentum(self.bodies, self.data, q, v).vector
        energy = pin.computeKineticEnergy(self._bare, self.data)
        if self._bare is not self.bodies:
            energy += 0.5 * float(self._rotor @ (v * v))
        return momentum, self.data.com[0], float(energy)

    def largest_inertia(self, q: Floats) -> float:
        """Return the largest principal inertia of the robot with its joints locked, about its centre of mass, kg m²."""
        q, still = self.bodies_at(q, np.zeros(self.robot.nv))
        pin.ccrba(self.bodies, self.data, q, still)
        return float(np.linalg.eigvalsh(self.data.Ig.inertia)[-1])


def _pairs(wrenches: Mapping[OperationalPoint, Wrench] | None) -> Iterable[tuple[OperationalPoint, Wrench]]:
    if wrenches is not None and not isinstance(wrenches, Mapping):
        raise OspaceError(f"wrenches {wrenches!r}: give a mapping of points to wrenches")
    return (wrenches or {}).items()


def _function(robot: SpaceRobot, point: OperationalPoint, wrench: Wrench) -> Callable[[float], Floats]:
    """Return the wrench as a function of time; raises `OspaceError` for another robot's point, or what is no wrench."""
    check_owner(robot, point)
    what, name = f"wrench at point '{point.frame}'", robot.name
    if not callable(wrench):
        constant = checked_vector(wrench, 6, what, name)
        return lambda time: constant
    return lambda time: checked_vector(wrench(time), 6, f"{what} at {time:.6g} s", name)
