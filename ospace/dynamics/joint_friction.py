"""Damping and Coulomb friction of the joints: the one law that simulation applies and the controller compensates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ospace.exceptions import OspaceError
from ospace.kernels import joint_friction as kernel
from ospace.kernels.joint_friction import FRICTION_VELOCITY
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot

__all__ = ["FRICTION_VELOCITY", "JointFriction"]


@dataclass(frozen=True, eq=False)
class JointFriction:
    """Passive torque of all joints, τ = −d φ̇ − f tanh(φ̇ / s) with s = `FRICTION_VELOCITY`.

    Attributes
    ----------
    damping : (n,)
        d of each joint velocity; N m s/rad, or N s/m.
    coulomb : (2, n)
        f for negative, then for positive rates; N m, or N.
    """

    damping: Floats
    coulomb: Floats

    @classmethod
    def of(cls, robot: SpaceRobot) -> JointFriction:
        """Take damping and friction from the robot's model, that is, from `<dynamics>` of its URDF.

        Raises
        ------
        OspaceError
            A value is negative or not finite.
        """
        model = robot.model
        if hasattr(model, "upperDryFrictionLimit"):
            backward, forward = -model.lowerDryFrictionLimit[6:], np.array(model.upperDryFrictionLimit[6:])
        else:  # an older Pinocchio
            backward = forward = np.array(model.friction[6:])
        made = cls(np.array(model.damping[6:]), np.array([backward, forward]))
        for what, values in (("damping", made.damping), ("friction", backward), ("friction", forward)):
            for k in np.flatnonzero(~(np.isfinite(values) & (values >= 0.0))):
                joint = robot.joint_of_link(int(k) + 1)
                raise OspaceError(f"joint '{joint}': {what} is {values[k]}: give a finite one from 0 on")
        return made

    @property
    def any(self) -> bool:
        """True where any joint has damping or friction."""
        return bool(self.damping.any() or self.coulomb.any())

    def torque(self, rate: Floats, out: Floats | None = None) -> Floats:
        """Return the passive torque (n,) at joint rates `rate` (n,), rad/s or m/s; written to `out` (n,) if given."""
        torque = np.empty(len(self.damping)) if out is None else out
        kernel.friction_torques(self.damping, self.coulomb, rate, torque)
        return torque

    def slope(self, rate: Floats) -> Floats:
        """Return −∂τ/∂φ̇ (n,) ≥ 0 at `rate` (n,): with the inertia, how fast friction acts; N m s/rad, or N s/m."""
        coulomb = np.where(rate > 0.0, self.coulomb[1], self.coulomb[0])
        return np.asarray(self.damping + coulomb / FRICTION_VELOCITY * (1.0 - np.tanh(rate / FRICTION_VELOCITY) ** 2))
