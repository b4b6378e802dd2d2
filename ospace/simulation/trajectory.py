"""Trajectory of a run."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Self

import numpy as np
import pinocchio as pin

from ospace.exceptions import OspaceError, printable
from ospace.extras import require
from ospace.files import replacing
from ospace.kernels.tree import Floats
from ospace.model.joint_positions import in_unit
from ospace.model.robot import SpaceRobot
from ospace.simulation.certificate import Certificate, certify
from ospace.simulation.columns import columns, headings_of, quoted
from ospace.stored import WRONG_KIND, arrays, fit, fit_times, made


@dataclass(frozen=True)
class Excess:
    """Largest distance of a joint beyond a limit.

    Attributes
    ----------
    amount : float
        Above the limit, in `unit`.
    unit : str
    time : float
        When, s.
    """

    amount: float
    unit: str
    time: float

    def __str__(self) -> str:
        return f"{in_unit(self.amount, self.unit)} at {self.time:.6g} s"


@dataclass(frozen=True)
class Trajectory:
    """A simulated motion in N records; base quantities in inertial axes.

    Momentum, energy, work and impulses are those seen from the inertial frame that starts at the base and moves with
    `frame_velocity`, in which they keep their digits wherever the robot is; `momentum_in_user_frame` has the others.

    Attributes
    ----------
    robot_name : str
    time : (N,)
        s.
    q, v : (N, nq), (N, nv)
        Configurations and velocities in the user's frame, as of `SpaceRobot.state`.
    torque, base_wrench, wheel_torque : (N, n), (N, 6), (N, 3)
        What acts from each record on; as of `Command`.
    wheel_momentum : (N, 3)
        Angular momentum that reaction wheels store; kg m²/s.
    momentum : (N, 6)
        Linear (kg m/s), and angular about the centre of mass (kg m²/s), wheels not included.
    mass_centre : (N, 3)
        Seen from the moving frame, m.
    kinetic_energy, work, dissipated : (N,)
        Energy of links and drives; work of all forces but friction since the start; energy that damping and friction
        of the joints took since then; J.
    impulse : (N, 6)
        ∫ of thrusters and external wrenches since the start, moments about the moving frame's origin; N s, N m s.
    rotation_drift : (N,)
        How far the quaternions and (cos, sin) pairs of q are from unit length.
    frame_velocity : (3,)
        m/s.
    total_mass, largest_inertia : float
        Mass (kg) and largest principal inertia of the locked robot at the start (kg m²): scales of the certificate.
    integrator : str
        Which one ran; it sets the limits of the certificate.
    outside_limits : mapping of joint name to Excess
        Joints whose position was beyond the limits of the model at any record, and how far at most; rad, or m. Nothing
        stops a joint at its limit.
    interrupted : bool
        Ctrl-C ended the run.
    """

    robot_name: str
    time: Floats
    q: Floats
    v: Floats
    torque: Floats
    base_wrench: Floats
    wheel_torque: Floats
    wheel_momentum: Floats
    momentum: Floats
    mass_centre: Floats
    kinetic_energy: Floats
    work: Floats
    dissipated: Floats
    impulse: Floats
    rotation_drift: Floats
    frame_velocity: Floats
    total_mass: float
    largest_inertia: float
    integrator: str
    outside_limits: Mapping[str, Excess]
    interrupted: bool = False

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        ended = ", interrupted" if self.interrupted else ""
        span = f"{self.time[0]:.6g} to {self.time[-1]:.6g} s"
        return f"Trajectory('{self.robot_name}', {span} in {len(self)} records, {self.integrator}{ended})"

    def __str__(self) -> str:
        beyond = ", ".join(f"'{joint}' by {excess}" for joint, excess in self.outside_limits.items())
        ended = ", interrupted" if self.interrupted else ""
        what = (
            f"{self.robot_name}: {self.time[-1] - self.time[0]:.6g} s in {len(self)} records, {self.integrator}{ended}"
        )
        return f"{what}\n{self.certificate()}\noutside limits of joints: {beyond or 'none'}"

    @property
    def momentum_in_user_frame(self) -> Floats:
        """Momentum (N, 6) as the user's frame sees it: linear (kg m/s), angular about the centre of mass (kg m²/s)."""
        momentum = self.momentum.copy()
        momentum[:, :3] += self.total_mass * self.frame_velocity
        return momentum

    def certificate(self) -> Certificate:
        """Check what the laws of motion conserve; see `ospace.simulation.certificate`.

        Returns
        -------
        Certificate
        """
        return certify(self)

    def at(self, robot: SpaceRobot, time: float) -> tuple[Floats, Floats]:
        """Return (q, v) on the geodesic between the records on either side, exact on a record.

        The geodesic is that of the moving frame, so that a base in orbit is placed as well as one at rest.

        Parameters
        ----------
        robot : SpaceRobot
            Of the trajectory.
        time : float
            s.

        Returns
        -------
        q : (nq,)
            m, rad.
        v : (nv,)
            Base twist in base axes; m/s, rad/s.

        Raises
        ------
        OspaceError
            The trajectory does not reach to `time`, or is another robot's.
        """
        if (self.robot_name, self.q.shape[1], self.v.shape[1]) != (robot.name, robot.nq, robot.nv):
            raise OspaceError(f"the trajectory is of '{self.robot_name}' (nv={self.v.shape[1]}), not of {robot!r}")
        slack = 1e-9 * max(1.0, abs(time))
        if not self.time[0] - slack <= time <= self.time[-1] + slack:
            raise OspaceError(f"time {time} s: the trajectory reaches from {self.time[0]} s to {self.time[-1]} s")
        nearest = int(np.argmin(np.abs(self.time - time)))
        if abs(self.time[nearest] - time) <= slack:
            return self.q[nearest].copy(), self.v[nearest].copy()
        k = int(np.searchsorted(self.time, time)) - 1
        share = (time - self.time[k]) / (self.time[k + 1] - self.time[k])
        before, after = self.q[k].copy(), self.q[k + 1].copy()
        before[:3] += (time - self.time[k]) * self.frame_velocity  # both as seen from the moving frame, in which
        after[:3] += (time - self.time[k + 1]) * self.frame_velocity  # a base that turns goes no way of kilometres
        q = np.asarray(pin.interpolate(robot.model, before, after, share))
        return q, (1.0 - share) * self.v[k] + share * self.v[k + 1]

    # -- files -----------------------------------------------------------------------------------------------

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write everything to a file, compressed, which appears when it is whole.

        Parameters
        ----------
        path : path-like
            Its suffix is replaced with ``.npz``.

        Returns
        -------
        Path
            Of the file.
        """
        file = Path(path).with_suffix(".npz")
        content = {one.name: getattr(self, one.name) for one in fields(self)}
        beyond = {joint: asdict(excess) for joint, excess in self.outside_limits.items()}
        with replacing(file) as part:
            np.savez_compressed(part, **content | {"outside_limits": json.dumps(beyond)})
        return file

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read what `save` wrote.

        Parameters
        ----------
        path : path-like

        Returns
        -------
        Trajectory

        Raises
        ------
        OspaceError
            The file cannot be read, or holds something else.
        """
        stored = arrays(path, "trajectory")
        content = {name: value.item() if value.ndim == 0 else value for name, value in stored.items()}
        missing = [one.name for one in fields(cls) if one.name not in stored]
        why = f"; missing: {', '.join(missing)}" if missing else ""
        try:
            read: Self = made(cls, content | {"outside_limits": json.loads(content["outside_limits"])})
            read.check_arrays()
            return read
        except OspaceError as error:
            why = f": {error}"
        except (*WRONG_KIND, RecursionError):
            pass
        raise OspaceError(printable(f"{os.fspath(path)}: holds no trajectory of this version of ospace{why}"))

    def check_arrays(self, name: str = "") -> None:
        """Check that arrays have a row for each record, and numbers that a run can leave.

        Parameters
        ----------
        name : str
            Of the trajectory, before those of its arrays.

        Raises
        ------
        OspaceError
            An array does not.
        """
        records = fit_times(f"{name}time", self.time)
        if records == 0:
            raise OspaceError(printable(f"array '{name}time' is empty"))
        fit(f"{name}frame_velocity", self.frame_velocity, 3)
        for array, row in _SHAPES.items():
            fit(f"{name}{array}", getattr(self, array), records, *row)
        fit(f"{name}q", self.q, records, None, least=7)
        fit(f"{name}v", self.v, records, None, least=6)
        if not (0.0 <= self.total_mass < math.inf and 0.0 <= self.largest_inertia < math.inf):
            raise OspaceError(printable(f"{name}: its mass or inertia is none"))

    def as_dict(self, robot: SpaceRobot | None = None) -> dict[str, Floats]:
        """Return its records as the columns of one table.

        Parameters
        ----------
        robot : SpaceRobot, optional
            Its robot, for names of joints and units; without it they are numbered.

        Returns
        -------
        dict of str to (N,) array
            By heading, as ``joint_1 [rad]``, ``joint_1 rate [rad/s]``, ``joint_1 torque [N m]``.

        Raises
        ------
        OspaceError
            The trajectory is another robot's.
        """
        return columns(self, robot)

    def to_dataframe(self, robot: SpaceRobot | None = None) -> Any:
        """Return its records as a data frame of pandas, which has to be installed.

        Parameters
        ----------
        robot : SpaceRobot, optional
            As of `as_dict`.

        Returns
        -------
        pandas.DataFrame
            A row for each record, the columns of `as_dict`.

        Raises
        ------
        OspaceError
            pandas is not installed, or the trajectory is another robot's.
        """
        require("pandas", "a data frame")
        import pandas

        return pandas.DataFrame(self.as_dict(robot))

    def to_csv(self, folder: str | os.PathLike[str], robot: SpaceRobot | None = None) -> list[Path]:
        """Write each quantity to a file ``<quantity>.csv``: a line of names, then time and numbers.

        Parameters
        ----------
        folder : path-like
            Made where it is not there.
        robot : SpaceRobot, optional
            Its robot, for names of joints and units; without it they are numbered.

        Returns
        -------
        list of Path
            Of the files.
        """
        to = Path(folder)
        to.mkdir(parents=True, exist_ok=True)
        written = []
        for name, headings in headings_of(self, robot).items():
            values = getattr(self, name).reshape(len(self), -1)
            heading = ",".join(quoted(one) for one in ["time [s]", *headings])
            file = to / f"{name}.csv"
            with replacing(file) as part:
                np.savetxt(
                    part,
                    np.c_[self.time, values],
                    fmt="%.17g",
                    delimiter=",",
                    header=heading,
                    comments="",
                    encoding="utf-8",
                )
            written.append(file)
        return written


_SHAPES: dict[str, tuple[int | None, ...]] = {
    "torque": (None,),
    "base_wrench": (6,),
    "wheel_torque": (3,),
    "wheel_momentum": (3,),
    "momentum": (6,),
    "mass_centre": (3,),
    "kinetic_energy": (),
    "work": (),
    "dissipated": (),
    "impulse": (6,),
    "rotation_drift": (),
}
"""Of arrays with a row for each record."""
