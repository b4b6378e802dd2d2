"""Workspaces of a floating arm: reach about the mass centre, and where dynamic singularities depend on the path.

While no momentum and no force acts, the mass centre rests, and the hand is from it by R ρ(φ), R the base's attitude. R
depends on the path of the joints, |ρ| on their positions alone: in inertial space the hand reaches the shell between
the smallest and the largest |ρ|. Where J_m* loses rank depends on the joints alone, too. Papadopoulos and Dubowsky
(1993) call

    PDW  the path-dependent workspace, the radii |ρ| at which some posture is singular: whether the hand meets a
         singularity there depends on the path by which it comes;
    PIW  the path-independent workspace, the radii at which none is: the rest of the reach.

The singular postures are those with U₂ᵀ J_m* V₂ = 0, where U₁, V₁ belong to all singular values but the last of the
rank, and U₂, V₂ to the others. Near such a posture the same is said by the Schur complement S of the first block,

    S(φ) = U₂ᵀ J V₂ − U₂ᵀ J V₁ (U₁ᵀ J V₁)⁻¹ U₁ᵀ J V₂ = 0,   ∂S = U₂ᵀ ∂J V₂

Newton's method goes to singular postures from many starts, and ascents of ±|ρ| on S = 0 from there to the ends of each
interval, and from around these ends again: all radii between the ends of such a path are singular. What is found is
singular; that nothing else is rests on the number of starts.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ospace.analysis.arm import Arm
from ospace.analysis.constrained_ascent import Linear, ascend, restore
from ospace.checks import check_kind, check_whole
from ospace.kernels.tree import Floats, Ints

_SAMPLES, _BINS = 8192, 48
_STARTS, _TOPS = 240, 24
_SINGULAR = 1e-9
"""Of the largest singular value."""
_STEP = 1e-5
"""Of the differences that derive J_m*, rad or L."""
_AWAY = (0.3, 0.6, 0.3, 1.0)
"""How far neighbours of singular postures are sought, rad or L."""
_TRACE, _POLISH = 60, 400
_AGAIN, _TRIED, _ENDS = (0.5, 0.2, 0.1), 3, 10
"""Around the best ends, once more: how far, rad or L; how often from each; and how many ends."""
_SAME = 1e-6
"""Intervals that come nearer than this share of the reach are one."""

Interval = tuple[float, float]


@dataclass(frozen=True)
class Workspaces:
    """Workspaces about the mass centre: radii of shells in inertial space, m.

    Attributes
    ----------
    reach : (low, high)
        Of the hand, in any attitude of the base.
    path_dependent : tuple of (low, high)
        PDW: radii at which some posture within the ranges is dynamically singular.
    path_independent : tuple of (low, high)
        PIW: the rest of the reach.
    postures : (2, n)
        Of the joints at both ends of the reach.
    singular_postures : (k, 2, n)
        Of the joints at both ends of each interval of the PDW.
    starts, singular : int
        Searches for singular postures, and how many found one.
    planar : bool
        Whether hand and base move in a plane: shells are rings then.
    """

    reach: Interval
    path_dependent: tuple[Interval, ...]
    path_independent: tuple[Interval, ...]
    postures: Floats
    singular_postures: Floats
    starts: int
    singular: int
    planar: bool

    @property
    def singular_share(self) -> float:
        """Share of the volume reached in inertial space that is path-dependent; of the area where all is planar."""
        whole = self._size([self.reach])
        return self._size(self.path_dependent) / whole if whole > 0.0 else 0.0

    def _size(self, shells: Iterable[Interval]) -> float:
        power = 2 if self.planar else 3
        return float(sum(high**power - low**power for low, high in shells))


def workspaces(arm: Arm, *, starts: int = _STARTS, seed: int = 0) -> Workspaces:
    """Compute the reach about the mass centre, the path-dependent and the path-independent workspace.

    Parameters
    ----------
    arm : Arm
        Rows of its point decide what is singular: those of a position alone, or of a pose.
    starts : int
        Searches for singular postures.
    seed : int
        Of the starts; the same seed gives the same result.

    Returns
    -------
    Workspaces

    Raises
    ------
    OspaceError
        `starts` or `seed` is no such number.
    """
    check_kind(arm, Arm, "make it with analysis.Arm(robot, point)")
    check_whole("starts", starts, 1)
    check_whole("seed", seed, 0)
    rng = np.random.default_rng([seed, 1])
    x = np.vstack([arm.home[None].clip(arm.lower, arm.upper), _corners(arm, rng), arm.draw(rng, _SAMPLES)])
    posture = arm.posture(x)
    radius = np.linalg.norm(posture.from_centre, axis=1)
    order = np.argsort(radius, kind="stable")
    ends = [_extreme(arm, x[chosen], sign) for chosen, sign in ((order[:_TOPS], -1.0), (order[-_TOPS:], 1.0))]
    reach = (ends[0][1], ends[1][1])
    begun = x[_spread(radius, _last_singular_value(arm, posture.J_m_star), reach, starts)]
    singular, at = _singular_intervals(arm, begun, reach, starts, rng)
    return Workspaces(
        reach,
        tuple(interval for interval, _ in at),
        tuple(_rest(reach, [interval for interval, _ in at])),
        np.array([end[0] for end in ends]),
        np.array([ends for _, ends in at]).reshape(-1, 2, len(arm.joints)),
        len(begun),
        singular,
        arm.planar,
    )


def _corners(arm: Arm, rng: np.random.Generator) -> Floats:
    """Return postures with all joints at an end, or in the middle, of their ranges, or at zero."""
    middle = np.clip(0.0, arm.lower, arm.upper)
    choices = np.array([arm.lower, middle, arm.upper, 0.5 * (arm.lower + arm.upper)])
    return np.asarray(choices[rng.integers(0, 4, (512, len(arm.joints))), np.arange(len(arm.joints))])


def _last_singular_value(arm: Arm, J_m_star: Floats) -> Floats:
    if arm.rank == 0:
        return np.zeros(len(J_m_star))
    return np.asarray(np.linalg.svd(J_m_star[:, list(arm.rows)], compute_uv=False)[:, arm.rank - 1])


def _spread(radius: Floats, value: Floats, reach: Interval, starts: int) -> Ints:
    """Return which samples to start from: the nearest to singular of each radius, and some that are not."""
    low, high = reach
    bins = np.clip((_BINS * (radius - low) / max(high - low, 1e-300)).astype(int), 0, _BINS - 1)
    order = np.lexsort((value, bins))
    place = np.arange(len(order)) - np.searchsorted(bins[order], bins[order])
    count = np.bincount(bins, minlength=_BINS)[bins[order]]
    each = -(-starts // _BINS)
    nearest = order[place < -(-each // 2)]
    any_other = order[(place >= -(-each // 2)) & (place % np.maximum(1, 2 * count // max(each, 1)) == 0)]
    return np.unique(np.r_[nearest, any_other])[: max(starts, 1) * 2]


# -- the reach -----------------------------------------------------------------------------------------------------


class _Radius:
    """± ½ |ρ|², free."""

    def __init__(self, arm: Arm, sign: float) -> None:
        self.arm, self.sign = arm, sign

    def linear(self, x: Floats, which: Ints) -> Linear:
        n = x.shape[1]
        posture = self.arm.posture(x)
        rho = posture.from_centre / self.arm.length
        df = self.sign * np.einsum("ki,kin->kn", rho, posture.J_m_star[:, :3]) / self.arm.scale
        return Linear(self._f(rho), df, np.zeros((len(x), 0)), np.zeros((len(x), 0, n)), None)

    def at(self, x: Floats, frame: Any) -> tuple[Floats, Floats]:
        return self._f(self.arm.posture(x).from_centre / self.arm.length), np.zeros((len(x), 0))

    def _f(self, rho: Floats) -> Floats:
        return np.asarray(self.sign * 0.5 * np.einsum("ki,ki->k", rho, rho))


def _extreme(arm: Arm, x: Floats, sign: float) -> tuple[Floats, float]:
    """Return the posture of the largest radius, or of the smallest for a `sign` of −1, and that radius, m."""
    x, f = ascend(_Radius(arm, sign), x, arm.lower, arm.upper, iterations=_POLISH, tolerance=np.inf)
    best = int(np.argmax(f))
    return x[best], arm.length * float(np.sqrt(2.0 * max(sign * f[best], 0.0)))


# -- singular postures ---------------------------------------------------------------------------------------------


class _SingularRadius:
    """± ½ |ρ|² on singular postures."""

    def __init__(self, arm: Arm, sign: float) -> None:
        self.arm, self.sign = arm, sign
        self._radius = _Radius(arm, sign)

    def linear(self, x: Floats, which: Ints) -> Linear:
        K, n = x.shape
        around = x[:, None] + _STEP * self.arm.scale * np.vstack([np.zeros(n), np.eye(n), -np.eye(n)])[None]
        posture = self.arm.posture(around.reshape(-1, n))
        J_all = posture.J_m_star.reshape(K, 2 * n + 1, 6, n)
        J = J_all[:, 0][:, list(self.arm.rows)]
        dJ = (J_all[:, 1 : n + 1] - J_all[:, n + 1 :])[:, :, list(self.arm.rows)] / (
            2.0 * _STEP * self.arm.scale[:, None, None]
        )
        U, values, Vt = np.linalg.svd(J)
        k = self.arm.rank - 1
        frame = U, Vt.transpose(0, 2, 1), np.maximum(values[:, :1], 1e-300)
        A = (np.einsum("kra,kjrs,ksb->kabj", U[:, :, k:], dJ, frame[1][:, :, k:])).reshape(K, -1, n) / frame[2][
            :, :, None
        ]
        rho = posture.from_centre.reshape(K, -1, 3)[:, 0] / self.arm.length
        df = self.sign * np.einsum("ki,kin->kn", rho, J_all[:, 0, :3]) / self.arm.scale
        return Linear(self._radius._f(rho), df, _schur(J, frame, k), A, frame)

    def at(self, x: Floats, frame: Any) -> tuple[Floats, Floats]:
        posture = self.arm.posture(x)
        J = posture.J_m_star[:, list(self.arm.rows)]
        return self._radius._f(posture.from_centre / self.arm.length), _schur(J, frame, self.arm.rank - 1)


def _schur(J: Floats, frame: tuple[Floats, Floats, Floats], k: int) -> Floats:
    """Return S (K, m) of J seen in `frame`, over its largest singular value there."""
    U, V, size = frame
    S = U.transpose(0, 2, 1) @ J @ V
    with np.errstate(all="ignore"):
        block = S[:, k:, k:] - S[:, k:, :k] @ _inverse(S[:, :k, :k]) @ S[:, :k, k:]
    return np.asarray(np.nan_to_num(block.reshape(len(J), -1) / size, nan=1e9, posinf=1e9, neginf=-1e9))


def _inverse(S: Floats) -> Floats:
    try:
        return np.asarray(np.linalg.inv(S))
    except np.linalg.LinAlgError:  # one of many: that posture is no end of a path
        return np.asarray(np.linalg.pinv(S))


def _singular_intervals(
    arm: Arm, x: Floats, reach: Interval, starts: int, rng: np.random.Generator
) -> tuple[int, list[tuple[Interval, tuple[Floats, Floats]]]]:
    """Return how many searches from `x` found a singular posture, and the intervals of their radii with their ends."""
    if arm.rank == 0:
        return 0, []
    problem, near = _SingularRadius(arm, 1.0), _SAME * max(reach[1], arm.length)
    x, found = restore(problem, x, arm.lower, arm.upper, _SINGULAR)
    x, count = x[found], int(found.sum())
    if not len(x):
        return 0, []
    paths = _Paths.of(arm, _neighbours(problem, x, starts, rng))
    for away in _AGAIN:  # ascents end on hills of their own: again from around the best
        best = np.repeat(paths.ends(near), _TRIED, axis=0)
        around = np.clip(best + away * arm.scale * rng.normal(size=best.shape), arm.lower, arm.upper)
        around, found = restore(problem, around, arm.lower, arm.upper, _SINGULAR)
        paths = paths.and_those(_Paths.of(arm, around[found]))
    paths = paths.polished(near)
    return count, [
        ((float(paths.low[k]), float(paths.high[j])), (paths.first[k], paths.last[j])) for k, j in paths.extremes(near)
    ]


@dataclass(frozen=True)
class _Paths:
    """K paths of singular postures, each from one of small to one of large radius: all radii between are singular."""

    arm: Arm
    first: Floats
    last: Floats
    low: Floats
    high: Floats

    @classmethod
    def of(cls, arm: Arm, x: Floats, iterations: int = _TRACE) -> _Paths:
        """Go down and up from singular postures."""
        first, last = (_trace(_SingularRadius(arm, sign), x, iterations) for sign in (-1.0, 1.0))
        return cls(arm, first, last, _radii(arm, first), _radii(arm, last))

    def and_those(self, others: _Paths) -> _Paths:
        """Return both."""
        both = (np.concatenate([getattr(self, n), getattr(others, n)]) for n in ("first", "last", "low", "high"))
        return _Paths(self.arm, *both)

    def groups(self, near: float) -> list[Ints]:
        """Return paths whose radii overlap, or come nearer than `near`, by rising radius."""
        order = np.argsort(self.low, kind="stable")
        top = np.maximum.accumulate(self.high[order])
        return np.split(order, 1 + np.flatnonzero(self.low[order][1:] > top[:-1] + near))

    def extremes(self, near: float) -> list[tuple[int, int]]:
        """Return of each group the path that begins lowest, and the one that ends highest."""
        return [
            (int(group[np.argmin(self.low[group])]), int(group[np.argmax(self.high[group])]))
            for group in self.groups(near)
        ]

    def best(self, near: float) -> tuple[Ints, Ints]:
        """Return the paths that begin lowest in their groups, and those that end highest: some of each."""
        groups = self.groups(near)
        some = max(1, _ENDS // len(groups))
        lowest = [group[np.argsort(self.low[group], kind="stable")[:some]] for group in groups]
        highest = [group[np.argsort(-self.high[group], kind="stable")[:some]] for group in groups]
        return np.concatenate(lowest), np.concatenate(highest)

    def ends(self, near: float) -> Floats:
        """Return the postures at the ends of these."""
        lowest, highest = self.best(near)
        return np.vstack([self.first[lowest], self.last[highest]])

    def polished(self, near: float) -> _Paths:
        """Return these paths with their best ends followed to the last digits."""
        lowest, highest = self.best(near)
        first, last = self.first.copy(), self.last.copy()
        first[lowest] = _trace(_SingularRadius(self.arm, -1.0), first[lowest], _POLISH)
        last[highest] = _trace(_SingularRadius(self.arm, 1.0), last[highest], _POLISH)
        return _Paths(self.arm, first, last, _radii(self.arm, first), _radii(self.arm, last))


def _neighbours(problem: _SingularRadius, x: Floats, starts: int, rng: np.random.Generator) -> Floats:
    """Return singular postures (K, n) and others around them, of about as many as `starts` with radii of all sizes."""
    arm, found = problem.arm, [x]
    for away in _AWAY:
        nearby = np.vstack(found)[rng.integers(0, sum(map(len, found)), starts)]
        nearby = np.clip(nearby + away * arm.scale * rng.normal(size=nearby.shape), arm.lower, arm.upper)
        nearby, singular = restore(problem, nearby, arm.lower, arm.upper, _SINGULAR)
        found.append(nearby[singular])
    all_found = np.vstack(found)
    order = np.argsort(_radii(arm, all_found), kind="stable")
    return np.asarray(all_found[order[np.unique(np.linspace(0, len(order) - 1, starts).astype(int))]])


def _trace(problem: _SingularRadius, x: Floats, iterations: int) -> Floats:
    arm = problem.arm
    return ascend(problem, x, arm.lower, arm.upper, iterations=iterations, tolerance=_SINGULAR)[0]


def _radii(arm: Arm, x: Floats) -> Floats:
    return np.asarray(np.linalg.norm(arm.posture(x).from_centre, axis=1))


def _rest(reach: Interval, taken: Sequence[Interval]) -> list[Interval]:
    """Return what is left of the reach beside intervals in rising order."""
    rest, begin = [], reach[0]
    for low, high in taken:
        if low > begin + _SAME * reach[1]:
            rest.append((begin, low))
        begin = max(begin, high)
    if reach[1] > begin + _SAME * reach[1]:
        rest.append((begin, reach[1]))
    return rest
