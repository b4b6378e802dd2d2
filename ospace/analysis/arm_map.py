"""Maps of an arm: what it does in many postures, and the extremes of that over its workspace.

The base is level and without momentum. A map holds cells, not postures: its memory does not grow with their number.
Quantities, with J_m*, J_b* and H_m* of the joints that vary, lengths in the arm's L where metres meet radians:

    reach            |ρ|, the hand from the mass centre
    singular_value   the smallest singular value of J_m* that is not zero everywhere
    manipulability   dynamic, √det(J_m* H_m*⁻² J_m*ᵀ), of as many singular values (Yoshikawa, 1985)
    base_turn        of the base while the joints go straight from `arm.home` to the posture
    disturbance      the largest singular value of the angular rows of J_b* (Torres and Dubowsky, 1992)
    wheel_x, _y, _z  Σ_j |K_aj| φ̇_j with each joint at its rate limit, h = K φ̇ what wheels store while the base keeps
                     its attitude: K = −I_c J_b*, I_c the robot's inertia about its mass centre
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from ospace.analysis.arm import Arm, Posture
from ospace.analysis.cells import Cells
from ospace.analysis.straight_turns import steps_for, turned
from ospace.checks import check_kind, check_whole, checked_names
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats, Ints


@dataclass(frozen=True)
class Quantity:
    """A number that an arm has in a posture.

    Attributes
    ----------
    name, title : str
        As a key, and for people.
    unit : str
        "m", "rad", …; empty for a ratio.
    """

    name: str
    title: str
    unit: str


WHAT: dict[str, tuple[Quantity, ...]] = {
    "reach": (
        Quantity("hand_x", "hand, x of the base", "m"),
        Quantity("hand_y", "hand, y of the base", "m"),
        Quantity("hand_z", "hand, z of the base", "m"),
        Quantity("reach", "hand from the mass centre", "m"),
    ),
    "singularity": (
        Quantity("singular_value", "smallest singular value of J*", ""),
        Quantity("manipulability", "dynamic manipulability", ""),
    ),
    "base-turn": (Quantity("base_turn", "turn of the base", "rad"),),
    "level-base": (
        Quantity("reach", "hand from the mass centre", "m"),
        Quantity("base_turn", "turn of the base", "rad"),
    ),
    "disturbance": (Quantity("disturbance", "turn of the base per joint rate", "rad/rad"),),
    "wheels": tuple(Quantity(f"wheel_{a}", f"momentum of wheels about {a}", "N m s") for a in "xyz"),
}
"""Groups of quantities that a map can have."""
GRADES = tuple(np.deg2rad([1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0, 180.0]).tolist())
"""Turns of the base that a level-base envelope is graded by, rad."""
CHUNK = 8192
_ACROSS, _SHELLS, _PLANE, _FINEST = 28, 48, 72, 360
"""Voxels along the diameter of an arm, shells of its reach, cells of the range of a joint, and the most of these."""
_PILOT = 64
_EDGE = 1e-9
"""Of a cell: a posture of a grid that stands on its edge is in it, rounded or not."""
_AXES = ("hand_x", "hand_y", "hand_z")


@dataclass(frozen=True)
class ArmMap:
    """Extremes of quantities over the postures of an arm; `with_postures` returns a map of more.

    Attributes
    ----------
    arm : Arm
    what : tuple of str
        Of `WHAT`.
    quantities : tuple of Quantity
        The m columns of all cells but voxels and shells, which leave out where the hand is.
    count : int
        Of postures.
    total : (m,)
        Sum of each quantity.
    whole : Cells
        One cell, of all postures.
    voxels : Cells
        By where the hand is in the base frame: cubes of the size `voxel`, about its multiples.
    shells : Cells
        By the distance of the hand from the mass centre: layers of thickness `shell` from 0 on.
    grades : Cells
        By the least of `GRADES` that the turn of the base stays within; none without the turn.
    plane : Cells
        By the two joints that vary, `plane_cells` of each range; none where more or fewer do.
    voxel, shell : float
        m.
    plane_cells : int
    turn_steps : int
        Of the integrator of turns.
    turn_error : float
        By which turns of half the steps differ, rad.
    """

    arm: Arm
    what: tuple[str, ...]
    quantities: tuple[Quantity, ...]
    count: int
    total: Floats
    whole: Cells
    voxels: Cells
    shells: Cells
    grades: Cells
    plane: Cells
    voxel: float
    shell: float
    plane_cells: int = _PLANE
    turn_steps: int = 0
    turn_error: float = 0.0

    @classmethod
    def empty(cls, arm: Arm, what: Iterable[str], plane_cells: int = _PLANE) -> ArmMap:
        """Return a map of no posture.

        Parameters
        ----------
        arm : Arm
        what : iterable of str
            Of `WHAT`.
        plane_cells : int
            Of the range of each joint, where two joints vary; as many as values of a grid, and 360 at most.

        Returns
        -------
        ArmMap

        Raises
        ------
        OspaceError
            There is no such quantity, or none.
        """
        check_kind(arm, Arm, "make it with analysis.Arm(robot, point)")
        names = _groups(what)
        quantities = quantities_of(names)
        steps, error = 0, 0.0
        if any(one.name == "base_turn" for one in quantities):
            steps, error = steps_for(arm, arm.draw(np.random.default_rng(0), _PILOT))
        m, n = len(quantities), len(arm.joints)
        fields = len([one for one in quantities if one.name not in _AXES])
        return cls(
            arm,
            names,
            quantities,
            0,
            np.zeros(m),
            Cells.empty(1, m, n),
            Cells.empty(3, fields, n),
            Cells.empty(1, fields, n),
            Cells.empty(1, m, n),
            Cells.empty(2, fields, n),
            2.0 * arm.span / _ACROSS,
            arm.span / _SHELLS,
            min(plane_cells, _FINEST),
            steps,
            error,
        )

    @property
    def fields(self) -> tuple[Quantity, ...]:
        """Quantities of voxels, shells and the plane: all but the place of the hand."""
        return tuple(one for one in self.quantities if one.name not in _AXES)

    @property
    def mean(self) -> Floats:
        """Mean of each quantity over the postures, (m,)."""
        return np.asarray(self.total / max(self.count, 1))

    @property
    def voxel_centres(self) -> Floats:
        """Middles of the voxels in the base frame, (C, 3), m."""
        return np.asarray(self.voxel * self.voxels.index)

    @property
    def shell_radii(self) -> Floats:
        """Middles of the shells, (C,), m."""
        return np.asarray(self.shell * (self.shells.index[:, 0] + 0.5))

    def with_postures(self, x: Floats) -> tuple[ArmMap, Floats]:
        """Return this map with postures more, and the quantities there.

        Parameters
        ----------
        x : (N, n)
            Of the joints that vary; rad, m.

        Returns
        -------
        arm_map : ArmMap
        values : (N, m)
            Columns as of `quantities`.
        """
        posture = self.arm.posture(x)
        known = _measure(self, posture, x)
        values = np.column_stack([known[one.name] for one in self.quantities])
        fields = np.column_stack([np.zeros((len(x), 0)), *(known[one.name] for one in self.fields)])
        radius = np.linalg.norm(posture.from_centre, axis=1)
        grades, plane = self.grades, self.plane
        if "base_turn" in known:
            grades = grades.with_postures(np.searchsorted(GRADES, known["base_turn"])[:, None], values, x)
        if x.shape[1] == 2:
            share = (x - self.arm.lower) / (self.arm.upper - self.arm.lower)
            index = _whole(share * self.plane_cells + _EDGE).clip(0, self.plane_cells - 1)
            plane = plane.with_postures(index, fields, x)
        return replace(
            self,
            count=self.count + len(x),
            total=self.total + values.sum(axis=0),
            whole=self.whole.with_postures(np.zeros((len(x), 1), dtype=np.int64), values, x),
            voxels=self.voxels.with_postures(_whole(posture.hand / self.voxel + 0.5), fields, x),
            shells=self.shells.with_postures(_whole(radius / self.shell)[:, None], fields, x),
            grades=grades,
            plane=plane,
        ), values


def quantities_of(what: Iterable[str]) -> tuple[Quantity, ...]:
    """Return the quantities of groups, each once.

    Parameters
    ----------
    what : iterable of str
        Of `WHAT`.

    Returns
    -------
    tuple of Quantity

    Raises
    ------
    OspaceError
        There is no such group, or none is given.
    """
    return tuple({one.name: one for name in _groups(what) for one in WHAT[name]}.values())


def _groups(what: Iterable[str]) -> tuple[str, ...]:
    """Return groups in the order of `WHAT`; raise `OspaceError` for none, or one that is not there."""
    names = checked_names(what, WHAT, "quantity of a map")
    if not names:
        raise OspaceError(f"a map of nothing: give some of {', '.join(WHAT)}")
    return tuple(name for name in WHAT if name in names)


def map_arm(
    arm: Arm,
    what: Iterable[str] = ("reach", "singularity"),
    *,
    random: int = 20_000,
    grid: int | None = None,
    seed: int = 0,
    progress: Callable[[int], None] | None = None,
) -> ArmMap:
    """Map an arm over random postures, or over a grid of them.

    Parameters
    ----------
    arm : Arm
    what : iterable of str
        Groups of quantities, of `WHAT`.
    random : int
        Postures, even over the ranges of the joints.
    grid : int, optional
        Values of each joint, from end to end of its range; instead of random postures.
    seed : int
        Of random postures; the same seed gives the same map.
    progress : function, optional
        Called with the number of postures that are done, after each chunk of them; it may raise.

    Returns
    -------
    ArmMap

    Raises
    ------
    OspaceError
        There is no such quantity, or a number makes no sense.
    """
    found = ArmMap.empty(arm, what) if grid is None else ArmMap.empty(arm, what, grid)
    for x in random_postures(arm, random, seed) if grid is None else grid_postures(arm, grid):
        found, _ = found.with_postures(x)
        if progress is not None:
            progress(found.count)
    return found


def random_postures(arm: Arm, count: int, seed: int) -> Iterator[Floats]:
    """Yield postures (≤ CHUNK, n), `count` in all; chunks or not, a seed gives the same."""
    check_whole("random", count, 1)
    check_whole("seed", seed, 0)
    rng = np.random.default_rng(seed)
    for first in range(0, count, CHUNK):
        yield arm.draw(rng, min(CHUNK, count - first))


def grid_postures(arm: Arm, each: int) -> Iterator[Floats]:
    """Yield all postures of a grid with so many values of each joint, from end to end of its range; (≤ CHUNK, n)."""
    check_whole("grid", each, 2)
    shape = (each,) * len(arm.joints)
    for first in range(0, each ** len(shape), CHUNK):
        places = np.array(np.unravel_index(np.arange(first, min(first + CHUNK, each ** len(shape))), shape)).T
        yield arm.lower + (arm.upper - arm.lower) * places / (each - 1)


def _whole(numbers: Floats) -> Ints:
    return np.asarray(np.floor(numbers).astype(np.int64))


# -- what a posture has ----------------------------------------------------------------------------------------------


def _measure(of: ArmMap, posture: Posture, x: Floats) -> dict[str, Floats]:
    """Return quantities by name, (N,) each."""
    arm, wanted = of.arm, {one.name for one in of.quantities}
    known = dict(zip(_AXES, posture.hand.T, strict=True))
    known["reach"] = np.linalg.norm(posture.from_centre, axis=1)
    J_b_star = posture.J_b_star[:, 3:]
    if "singular_value" in wanted:
        known["singular_value"], known["manipulability"] = _singularity(arm, posture, x)
    if "base_turn" in wanted:
        known["base_turn"] = turned(arm, x, of.turn_steps).magnitude()
    if "disturbance" in wanted:
        known["disturbance"] = np.sqrt(np.linalg.eigvalsh(J_b_star @ J_b_star.transpose(0, 2, 1))[:, -1].clip(0.0))
    if "wheel_x" in wanted:
        K = -arm.inertia(x, posture.centre) @ J_b_star
        most = np.einsum("kan,n->ka", np.abs(K), arm.rates / arm.scale)
        known |= {f"wheel_{axis}": most[:, a] for a, axis in enumerate("xyz")}
    return known


def _singularity(arm: Arm, posture: Posture, x: Floats) -> tuple[Floats, Floats]:
    """Return σ_min and the dynamic manipulability; zeros where the joints do not move these rows at all."""
    if arm.rank == 0:
        return np.zeros(len(x)), np.zeros(len(x))
    accelerated = posture.J_m_star[:, list(arm.rows)] @ np.linalg.inv(arm.generalized_inertia(x))
    if arm.rank == len(arm.rows):
        squared = np.linalg.det(accelerated @ accelerated.transpose(0, 2, 1))
        manipulability = np.sqrt(squared.clip(0.0))
    else:
        manipulability = np.prod(np.linalg.svd(accelerated, compute_uv=False)[:, : arm.rank], axis=1)
    return arm.singular_values(x)[:, arm.rank - 1], manipulability
