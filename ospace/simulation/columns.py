"""A trajectory as one table: a column for each number, named after joints, with its unit."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.joint_positions import joint_units
from ospace.model.robot import SpaceRobot

_AXES = ("x", "y", "z")
_TIMES_LENGTH = {"rad": "N m", "m": "N"}
_FIXED = {
    "base_wrench": [f"base force {axis} [N]" for axis in _AXES] + [f"base torque {axis} [N m]" for axis in _AXES],
    "wheel_torque": [f"wheel torque {axis} [N m]" for axis in _AXES],
    "wheel_momentum": [f"wheel momentum {axis} [kg m^2/s]" for axis in _AXES],
    "momentum": [f"momentum {axis} [kg m/s]" for axis in _AXES]
    + [f"angular momentum {axis} [kg m^2/s]" for axis in _AXES],
    "kinetic_energy": ["kinetic energy [J]"],
    "work": ["work [J]"],
    "dissipated": ["dissipated [J]"],
}


class Records(Protocol):
    """The part of a trajectory that makes columns."""

    @property
    def robot_name(self) -> str: ...  # noqa: D102
    @property
    def time(self) -> Floats: ...  # noqa: D102
    @property
    def q(self) -> Floats: ...  # noqa: D102
    @property
    def v(self) -> Floats: ...  # noqa: D102
    def __len__(self) -> int: ...


class Names(NamedTuple):
    """Names of the numbers of a robot, with their units."""

    q: list[str]
    v: list[str]
    torque: list[str]

    @classmethod
    def of(cls, robot: SpaceRobot) -> Names:
        """Name those of a robot."""
        model, units = robot.model, joint_units(robot.model)
        q = [f"base {axis} [m]" for axis in _AXES] + [f"base q{letter}" for letter in "xyzw"]
        v = [f"base v{axis} [m/s]" for axis in _AXES] + [f"base w{axis} [rad/s]" for axis in _AXES]
        torque = []
        for j in range(2, model.njoints):
            name, count, rates = str(model.names[j]), int(model.nqs[j]), int(model.nvs[j])
            if rates == 0:
                continue
            if count == 1:
                q.append(f"{name} [{units[name]}]")
            else:
                parts = ("cos", "sin") if (count, rates) == (2, 1) else map(str, range(count))
                q += [f"{name} {part}" for part in parts]
        for rate in robot.rate_names:
            unit = units.get(rate) or ("m" if rate.rpartition(".")[2] in _AXES else "rad")
            v.append(f"{rate} rate [{unit}/s]")
            torque.append(f"{rate} torque [{_TIMES_LENGTH[unit]}]")
        return cls(q, v, torque)


def quoted(text: str) -> str:
    """Return a cell of a CSV file, in quotes where it holds what separates cells."""
    return '"' + text.replace('"', '""') + '"' if set(text) & set(',"\n\r') else text


def columns(run: Records, robot: SpaceRobot | None = None) -> dict[str, Floats]:
    """Return the columns of a table: time, then all that a trajectory has for each record.

    Parameters
    ----------
    run : Trajectory
        N records.
    robot : SpaceRobot, optional
        Its robot, for names of joints; they are numbered without it.

    Returns
    -------
    dict of str to (N,) array
        By heading, with its unit: ``joint_1 [rad]``.

    Raises
    ------
    OspaceError
        The trajectory is another robot's.
    """
    found = {"time [s]": run.time}
    for quantity, headings in headings_of(run, robot).items():
        values = getattr(run, quantity).reshape(len(run), -1)
        found |= dict(zip(headings, values.T, strict=True))
    return found


def headings_of(run: Records, robot: SpaceRobot | None = None) -> dict[str, list[str]]:
    """Return the headings of each quantity of a trajectory, by its name."""
    if robot is None:
        named = {name: [f"{name}[{k}]" for k in range(getattr(run, name).shape[1])] for name in Names._fields}
    else:
        if (run.robot_name, run.q.shape[1], run.v.shape[1]) != (robot.name, robot.nq, robot.nv):
            raise OspaceError(f"the trajectory is of '{run.robot_name}' (nv={run.v.shape[1]}), not of {robot!r}")
        named = Names.of(robot)._asdict()
    return {**named, **_FIXED}
