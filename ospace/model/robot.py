"""The robot: a Pinocchio model with a free-flying base, laid out for the recursions."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace import models
from ospace.checks import checked_numbers, checked_vector
from ospace.exceptions import OspaceError, closest
from ospace.kernels.tree import Floats
from ospace.model.joint_positions import ROUNDING, BoundedCoordinates, Position, from_q, in_si, to_q
from ospace.model.layout import BASE_NQ, BASE_NV, Layout
from ospace.model.mimic import FreeJoints, couplings_of
from ospace.model.points import ROW_NAMES, Axes, OperationalPoint, parse_axes
from ospace.model.state import State
from ospace.urdf import reader
from ospace.urdf.coupling import Following, couple
from ospace.urdf.description import Description
from ospace.urdf.errors import UnsoundModelError
from ospace.urdf.lint import inertia
from ospace.urdf.lint.findings import Finding, any_error
from ospace.urdf.source import Limits

_RATE_AXES = {
    "JointModelFreeFlyer": ROW_NAMES,
    "JointModelSpherical": ROW_NAMES[3:],
    "JointModelTranslation": ROW_NAMES[:3],
    "JointModelPlanar": (*ROW_NAMES[:2], ROW_NAMES[5]),
}


class SpaceRobot(Layout):
    """A space robot: any tree of links on a base that floats freely, without gravity.

    Make one with `from_urdf`, or from a Pinocchio model with `from_model`.

    Attributes
    ----------
    model : pin.Model
        Pinocchio's model; joint 1 is the free-flyer, gravity is zero.
    name : str
    findings : tuple of Finding
        What is odd about it: warnings and infos, as a robot with errors is refused.
    source : Path or None
        The URDF it was read from.
    description : Description or None
        Links, joints and shapes as the URDF has them.
    package_dirs : tuple of Path
        Where ``package://`` names of meshes are looked up.
    """

    def __init__(
        self,
        model: pin.Model,
        known: Iterable[Finding] = (),
        *,
        source: Path | None = None,
        description: Description | None = None,
        package_dirs: Iterable[Path] = (),
    ) -> None:
        super().__init__(model)
        self.model.gravity = pin.Motion.Zero()
        self.source = source
        self.description = description
        self.package_dirs = tuple(package_dirs)
        self.findings = tuple(known)

    @classmethod
    def from_urdf(
        cls,
        path: str | PathLike[str],
        package_dirs: Sequence[str | PathLike[str]] = (),
        *,
        xacro_args: Mapping[str, str] | None = None,
        free_mimic: bool = False,
        root: str | None = None,
        limits: Limits | None = None,
    ) -> SpaceRobot:
        """Read a robot from a URDF or xacro; its root link becomes the freely floating base.

        Parameters
        ----------
        path : path-like
            The file; a xacro is one whose name ends in ``.xacro``. Or the name of a robot that comes with ospace, as
            ``"chaser_24dof"``.
        package_dirs : sequence of path-like
            Folders in which ``package://`` mesh names are looked up, which dynamics do not need, and
            ``$(find package)`` of a xacro.
        xacro_args : mapping of str to str, optional
            Values of the ``<xacro:arg>`` of a xacro.
        free_mimic : bool
            Take joints that mimic others as independent ones, with a warning each; else they follow these and have no
            coordinate of their own.
        root : str, optional
            Link that becomes the base, with what hangs from it: of a file that holds several bodies, or a stand.
        limits : ospace.Limits, optional
            How large file and robot may be; 20 MB, 2000 links and 150 degrees of freedom without it.

        Returns
        -------
        SpaceRobot
            With the file's findings; gravity is zero.

        Raises
        ------
        UrdfError
            The file is missing, is no URDF, or its links are no tree.
        UnsoundModelError
            A number cannot be read, or the inertias make no physical sense, such as a base without mass.

        Notes
        -----
        Fixed joints are merged. Each code of a finding is explained in ``docs/findings.md``.
        """
        if not isinstance(path, str | PathLike):
            raise OspaceError(f"path {path!r}: give the path of a URDF")
        file, folders = models.find(path), [Path(folder) for folder in package_dirs]
        reading = reader.read(
            file, package_dirs=folders, xacro_args=xacro_args, limits=limits, free_mimic=free_mimic, root=root
        )
        if reading.model is None:
            raise UnsoundModelError(reading.description.name, reading.findings, reading.description)
        return cls(reading.model, reading.findings, source=file, description=reading.description, package_dirs=folders)

    @classmethod
    def from_model(cls, model: pin.Model) -> SpaceRobot:
        """Take a copy of a Pinocchio model whose first joint is a free-flyer.

        Parameters
        ----------
        model : pin.Model
            Its first joint is a free-flyer; its gravity is set to zero in the copy.

        Returns
        -------
        SpaceRobot

        Raises
        ------
        OspaceError
            The model has no free-flying base.
        UnsoundModelError
            The inertias make no physical sense.
        """
        _check_floating_base(model)
        free = FreeJoints(model, couplings) if (couplings := couplings_of(model)) else None
        findings = inertia.check_model(*((model, {}) if free is None else (free.model, free.followers)))
        if any_error(findings):
            raise UnsoundModelError(model.name, findings)
        return cls(pin.Model(model), findings)

    # -- what it is ------------------------------------------------------------------------------------------

    @cached_property
    def _moved(self) -> list[int]:
        """Pinocchio's numbers of the joints behind the base, but for those that mimic others."""
        return [j for j in range(2, self.model.njoints) if self.model.nvs[j] > 0]

    @property
    def joint_names(self) -> list[str]:
        """Names of the joints behind the base that have a rate of their own, in Pinocchio's order."""
        return [str(self.model.names[j]) for j in self._moved]

    @cached_property
    def rate_names(self) -> list[str]:
        """Names of the joint rates ``v[6:]``: a joint's own, with an axis or a number where it has several."""
        names = []
        for j in range(2, self.model.njoints):
            name, count = str(self.model.names[j]), int(self.model.nvs[j])
            axes = _RATE_AXES.get(self.model.joints[j].shortname(), [str(k) for k in range(count)])
            names += [name] if count == 1 else [f"{name}.{axis}" for axis in axes]
        return names

    @cached_property
    def turning_rates(self) -> npt.NDArray[np.bool_]:
        """Mask of the joint rates ``v[6:]`` that turn (n,), rad/s; the others shift, m/s."""
        columns = self.state(self.configuration()).table("S")[self.links.link_of]
        return np.asarray(np.abs(columns[:, 3:]).max(axis=1, initial=0.0) > 0.0)

    @cached_property
    def leaf_links(self) -> list[str]:
        """Links from which no joint goes on; the base alone where there is no joint."""
        frames = self.model.frames
        has_child = {frames[k].parentFrame for k in range(1, len(frames))}
        return [frame.name for k, frame in enumerate(frames) if frame.type == pin.FrameType.BODY and k not in has_child]

    # -- points and states -----------------------------------------------------------------------------------

    def point(self, frame: str, axes: Axes = "all", offset: pin.SE3 | None = None) -> OperationalPoint:
        """Make an operational point of a frame: a link, or a joint's frame.

        Parameters
        ----------
        frame : str
            Its name.
        axes : "all", "linear", "angular" or six booleans
            Rows that count: x, y, z, rotation about x, y, z; inertial axes.
        offset : pin.SE3, optional
            The point as seen from the frame; the frame's origin without it.

        Returns
        -------
        OperationalPoint

        Raises
        ------
        OspaceError
            The name is unknown, or belongs to several frames in different places; `axes` or `offset` make no sense.
        """
        carrier = self.frame(frame)
        if offset is not None and not isinstance(offset, pin.SE3):
            raise OspaceError(f"offset {offset!r}: give a pin.SE3, or None for the frame itself")
        placement = carrier.placement if offset is None else carrier.placement * offset
        if not np.isfinite(placement.homogeneous).all():
            raise OspaceError(f"offset of point '{frame}' is not finite")
        return OperationalPoint(self, frame, parse_axes(axes), int(carrier.parentJoint), placement)

    def state(self, q: npt.ArrayLike, v: npt.ArrayLike | None = None) -> State:
        """Take the robot at configuration `q` and velocity `v`.

        Parameters
        ----------
        q : (nq,)
            Base position, base quaternion (x, y, z, w), then joints, as Pinocchio orders them; `configuration`
            builds it. m, rad.
        v : (nv,), optional
            Base twist in base axes, linear first, then joint rates; zero without it. m/s, rad/s.

        Returns
        -------
        State
            With copies of `q` and `v`, read-only.

        Raises
        ------
        OspaceError
            Wrong length, a number that is not finite, or a quaternion that is not of unit length.
        """
        return State(self, q, v)

    # -- configurations by name ------------------------------------------------------------------------------

    def configuration(self, joints: Mapping[str, Position] | None = None, T_WB: pin.SE3 | None = None) -> Floats:
        """Build `q` from a base pose and joint positions by name; what is not named stays at zero.

        Parameters
        ----------
        joints : mapping of joint name to position
            Angle (rad) or displacement (m) for joints of one degree of freedom, continuous ones included, also as text
            with a unit, as ``"20 deg"``;
            (x, y, θ) for planar, `pin.SE3` for floating ones; Pinocchio's own numbers for any other type.
        T_WB : pin.SE3, optional
            Pose of the base in the inertial frame; identity without it.

        Returns
        -------
        (nq,) array

        Raises
        ------
        OspaceError
            A joint is unknown, or its value is not finite or of the wrong kind.
        """
        if T_WB is not None and not isinstance(T_WB, pin.SE3):
            raise OspaceError(f"T_WB {T_WB!r}: give a pin.SE3, or None for the identity")
        if joints is not None and not isinstance(joints, Mapping):
            raise OspaceError(f"joints {joints!r}: give a mapping of joint names to positions")
        q: Floats = pin.neutral(self.model)
        if T_WB is not None:
            q[:BASE_NQ] = pin.SE3ToXYZQUAT(T_WB)
        for name, value in (joints or {}).items():
            j = self.joint_number(name)
            start, count = self.model.idx_qs[j], self.model.nqs[j]
            q[start : start + count] = to_q(self.model.joints[j], name, value)
        if not np.isfinite(q[:BASE_NQ]).all():
            raise OspaceError("T_WB is not finite")
        return q

    def configurations(self, joints: Mapping[str, npt.ArrayLike], T_WB: pin.SE3 | None = None) -> Floats:
        """Build many `q` from a base pose and arrays of joint positions by name; what is not named stays at zero.

        Parameters
        ----------
        joints : mapping of joint name to (N,) array or number
            Angles (rad) or displacements (m) of joints with one degree of freedom, or text with a unit; one number
            stands for all rows.
        T_WB : pin.SE3, optional
            Pose of the base in the inertial frame, in all rows; identity without it.

        Returns
        -------
        (N, nq) array
            One row where no array is given.

        Raises
        ------
        OspaceError
            A joint is unknown or has several degrees of freedom, arrays differ in length, or a position is not finite.
        """
        if not isinstance(joints, Mapping):
            raise OspaceError(f"joints {joints!r}: give a mapping of joint names to arrays of positions")
        values = {
            name: checked_numbers(self._in_si(name, given), f"positions of joint '{name}'")
            for name, given in joints.items()
        }
        lengths = {name: len(value) for name, value in values.items() if value.ndim == 1}
        if any(value.ndim > 1 for value in values.values()) or len(set(lengths.values())) > 1:
            raise OspaceError(
                f"positions of joints have the shapes { {name: v.shape for name, v in values.items()} }: "
                f"give numbers, or arrays of one length"
            )
        Q = np.tile(self.configuration(T_WB=T_WB), (next(iter(lengths.values()), 1), 1))
        for name, value in values.items():
            j = self.joint_number(name)
            joint, k = self.model.joints[j], self.model.idx_qs[j]
            if joint.nv != 1:
                raise OspaceError(
                    f"joint '{name}' has {joint.nv} degrees of freedom: build its rows by `configuration`"
                )
            Q[:, k : k + joint.nq] = value[..., None] if joint.nq == 1 else np.stack([np.cos(value), np.sin(value)], -1)
        return Q

    def _in_si(self, name: str, given: Any) -> Any:
        return in_si(self.model.joints[self.joint_number(name)], name, given) if _has_text(given) else given

    def joint_positions(self, q: npt.ArrayLike) -> dict[str, Position]:
        """Read joint positions by name from `q`, the inverse of `configuration`; continuous joints in (−π, π].

        Parameters
        ----------
        q : (nq,)
            As of `state`.

        Returns
        -------
        dict of joint name to position
            rad, or m for prismatic joints; as `configuration` takes it for any other.

        Raises
        ------
        OspaceError
            Wrong length, or a number that is not finite.
        """
        q = checked_vector(q, self.nq, "q", self.name)
        return {
            name: from_q(self.model.joints[j], q[self.model.idx_qs[j] :][: self.model.nqs[j]])
            for j, name in zip(self._moved, self.joint_names, strict=True)
        }

    def neutral(self) -> Floats:
        """Return a `q` inside all joint limits: base at the origin, joints at zero where their limits allow it.

        Where they do not, the joint stands in the middle of its range, or at its limit if it has only one. A range
        whose lower limit exceeds the upper allows no position, and is ignored as in `outside_limits`.

        Returns
        -------
        (nq,) array
        """
        q: Floats = pin.neutral(self.model)
        q[self._bounded.index] = self._bounded.nearest_to_zero(self.model)
        return q

    def outside_limits(self, q: npt.ArrayLike) -> dict[str, float]:
        """Return the joints whose position in `q` lies outside their limits, and by how much.

        Parameters
        ----------
        q : (nq,)
            m, rad.

        Returns
        -------
        dict of joint name to excess
            Distance to the limit that is passed, above zero; rad, or m for prismatic joints; the largest one of a joint
            with several coordinates. Empty inside the limits, and within 1e-9 of them.

        Raises
        ------
        OspaceError
            Wrong length, or a number that is not finite.
        """
        excess = self._bounded.excess(self.model, checked_vector(q, self.nq, "q", self.name))
        beyond: dict[str, float] = {}
        for k in np.flatnonzero(excess > ROUNDING):
            name = str(self.model.names[int(self._bounded.joint[k])])
            beyond[name] = max(float(excess[k]), beyond.get(name, 0.0))
        return beyond

    @cached_property
    def _bounded(self) -> BoundedCoordinates:
        return BoundedCoordinates.of(self.model)

    def base_pose(self, q: npt.ArrayLike) -> pin.SE3:
        """Read the base pose T_WB from `q`.

        Parameters
        ----------
        q : (nq,)
            As of `state`.

        Returns
        -------
        pin.SE3
            The base-link frame as seen from the inertial frame, m.

        Raises
        ------
        OspaceError
            Wrong length, or a number that is not finite.
        """
        return pin.XYZQUATToSE3(checked_vector(q, self.nq, "q", self.name)[:BASE_NQ])

    def joint_number(self, name: str) -> int:
        """Return Pinocchio's number of a joint behind the base.

        Parameters
        ----------
        name : str

        Returns
        -------
        int
            Index into ``model.joints``; the free-flyer is 1.

        Raises
        ------
        OspaceError
            The joint is unknown; the message names the nearest.
        """
        if name not in self.joint_names:
            raise OspaceError(f"robot '{self.name}' has no joint '{name}'{closest(str(name), self.joint_names)}")
        return self._moved[self.joint_names.index(name)]

    def rates_of(self, name: str) -> slice:
        """Return the place of a joint's rates in ``v[6:]``.

        Parameters
        ----------
        name : str
            Of the joint.

        Returns
        -------
        slice

        Raises
        ------
        OspaceError
            The joint is unknown; the message names the nearest.
        """
        j = self.joint_number(name)
        return slice(self.model.idx_vs[j] - BASE_NV, self.model.idx_vs[j] + self.model.nvs[j] - BASE_NV)

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy by laying out a copy of the model: a thread's scratch memory and what is derived stay behind.

        Couplings go beside the model of the free joints: Pinocchio loses what they couple when it writes a model.
        """
        make = functools.partial(
            _coupled, type(self), source=self.source, description=self.description, package_dirs=self.package_dirs
        )
        model, followers = (self.model, {}) if self.free is None else (self.free.model, self.free.followers)
        return make, (model, followers, self.findings)

    def __repr__(self) -> str:
        return f"SpaceRobot('{self.name}', nv={self.nv}, total_mass={self.total_mass:.6g} kg)"


def _has_text(given: object) -> bool:
    return isinstance(given, str) or (isinstance(given, list | tuple) and any(isinstance(one, str) for one in given))


def _coupled(
    kind: type[SpaceRobot], model: pin.Model, followers: Mapping[str, Following], *known: Any, **given: Any
) -> SpaceRobot:
    """Make a robot of what `SpaceRobot.__reduce__` leaves."""
    return kind(couple(model, followers) if followers else model, *known, **given)


def _check_floating_base(model: pin.Model) -> None:
    if not isinstance(model, pin.Model):
        raise OspaceError(f"model {model!r}: give a pin.Model")
    roots = [j for j in range(1, model.njoints) if model.parents[j] == 0]
    if roots != [1] or model.joints[1].shortname() != "JointModelFreeFlyer":
        raise OspaceError(
            f"model '{model.name}' has no free-flying base: its one root joint must be a pin.JointModelFreeFlyer"
        )
    for j in range(1, model.njoints):
        if j > 1 and model.parents[j] not in model.supports[j - 1]:
            raise OspaceError(
                f"joint '{model.names[j]}' is out of order: Pinocchio's crba is wrong unless each subtree is added "
                f"before the next one begins; add it right after the joints below '{model.names[model.parents[j]]}'"
            )
