"""Result of mapping an arm: its map, its workspaces and its reach along rays, as a document."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ospace.analysis.arm import Arm
from ospace.analysis.arm_map import GRADES, ArmMap
from ospace.analysis.rays import Rays
from ospace.analysis.workspace_shells import Interval, Workspaces
from ospace.kernels.tree import Floats


@dataclass(frozen=True)
class Grade:
    """Postures in which the turn of the base stays within a bound.

    Attributes
    ----------
    turn : float
        rad.
    share : float
        Of all postures.
    reach : (low, high)
        Of the hand from the mass centre, m.
    volume : float
        Of the voxels in which there is such a posture, as a share of all voxels.
    """

    turn: float
    share: float
    reach: Interval
    volume: float


@dataclass(frozen=True)
class MapResult:
    """Map, workspaces and rays of an arm.

    Attributes
    ----------
    arm_map : ArmMap
    workspaces : Workspaces or None
        None where it was not computed.
    rays : Rays or None
        Likewise.
    wanted : int
        Postures; more than `arm_map.count` where the map was interrupted.
    postures : str
        How they were chosen.
    interrupted : bool
        Whether something that was wanted is missing.
    """

    arm_map: ArmMap
    workspaces: Workspaces | None
    rays: Rays | None
    wanted: int
    postures: str
    interrupted: bool = False

    @property
    def arm(self) -> Arm:
        """The arm that was mapped."""
        return self.arm_map.arm

    @property
    def grades(self) -> list[Grade]:
        """The level-base envelope by the turn of the base; empty where the map does not have it."""
        cells, names = self.arm_map.grades, [one.name for one in self.arm_map.quantities]
        if "level-base" not in self.arm_map.what or not len(cells.index):
            return []
        reach, turn = names.index("reach"), [one.name for one in self.arm_map.fields].index("base_turn")
        least = self.arm_map.voxels.low[:, turn]
        grades = []
        for k, bound in enumerate(GRADES):
            inside = cells.index[:, 0] <= k
            if inside.any():
                extent = float(cells.low[inside, reach].min()), float(cells.high[inside, reach].max())
                share = float(cells.count[inside].sum() / self.arm_map.count)
                grades.append(Grade(bound, share, extent, float((least <= bound).mean())))
                if inside.all():
                    break
        return grades

    def as_dict(self) -> dict[str, Any]:
        """Return the result as one document of numbers, names and lists; rad, m.

        Returns
        -------
        dict
        """
        arm, found = self.arm, self.arm_map
        document: dict[str, Any] = {
            "robot": arm.robot.name,
            "point": arm.point.frame,
            "rows": list(arm.rows),
            "length": arm.length,
            "joints": [
                {"name": name, "unit": unit, "lower": low, "upper": high, "home": home, "rate": rate}
                for name, unit, low, high, home, rate in zip(
                    arm.joints,
                    arm.units,
                    *(part.tolist() for part in (arm.lower, arm.upper, arm.home, arm.rates)),
                    strict=True,
                )
            ],
            "postures": {"chosen": self.postures, "wanted": self.wanted, "mapped": found.count},
            "interrupted": self.interrupted,
            "quantities": [self._quantity(c) for c in range(len(found.quantities))] if found.count else [],
            "voxels": {"size": found.voxel, "count": len(found.voxels.index)},
        }
        if self.workspaces is not None:
            document["workspaces"] = {
                "reach": list(self.workspaces.reach),
                "path_independent": [list(one) for one in self.workspaces.path_independent],
                "path_dependent": [list(one) for one in self.workspaces.path_dependent],
                "singular_share": self.workspaces.singular_share,
                "starts": self.workspaces.starts,
                "singular": self.workspaces.singular,
                "postures": self.workspaces.postures.tolist(),
                "singular_postures": self.workspaces.singular_postures.tolist(),
            }
        if self.rays is not None:
            document["rays"] = [
                {"direction": d.tolist(), "distance": float(far) if reached else None, "posture": x.tolist()}
                for d, reached, far, x in zip(
                    self.rays.directions, self.rays.reached, self.rays.distance, self.rays.postures, strict=True
                )
            ]
        if self.grades:
            document["level_base"] = [
                {"turn": one.turn, "share": one.share, "reach": list(one.reach), "volume": one.volume}
                for one in self.grades
            ]
        if found.turn_steps:
            document["turn_error"] = found.turn_error
        return document

    def _quantity(self, c: int) -> dict[str, Any]:
        found, whole = self.arm_map, self.arm_map.whole
        quantity = found.quantities[c]
        return {
            "name": quantity.name,
            "title": quantity.title,
            "unit": quantity.unit,
            "smallest": float(whole.low[0, c]),
            "mean": float(found.mean[c]),
            "largest": float(whole.high[0, c]),
            "at_smallest": whole.at_low[0, c].tolist(),
            "at_largest": whole.at_high[0, c].tolist(),
        }


def arrays_of(result: MapResult) -> dict[str, Floats]:
    """Return the result as named arrays, for an ``.npz`` file; rad, m.

    Parameters
    ----------
    result : MapResult

    Returns
    -------
    dict of str to array
        Extremes by voxel and by shell with the postures there, workspaces and rays where they were computed.
    """
    arm, found = result.arm, result.arm_map
    arrays = {
        "joints": np.array(arm.joints),
        "lower": arm.lower,
        "upper": arm.upper,
        "quantities": np.array([one.name for one in found.quantities]),
        "fields": np.array([one.name for one in found.fields]),
        "voxel_centres": found.voxel_centres,
        "shell_radii": found.shell_radii,
    }
    for name, cells in (("voxel", found.voxels), ("shell", found.shells), ("plane", found.plane)):
        if len(cells.index):
            arrays |= {f"{name}_{part}": getattr(cells, part) for part in ("index", "count", "low", "high")}
            arrays |= {f"{name}_{part}": getattr(cells, part) for part in ("at_low", "at_high")}
    if result.workspaces is not None:
        arrays |= {
            "reach": np.array(result.workspaces.reach),
            "path_independent": np.array(result.workspaces.path_independent).reshape(-1, 2),
            "path_dependent": np.array(result.workspaces.path_dependent).reshape(-1, 2),
        }
    if result.rays is not None:
        arrays |= {
            "ray_directions": result.rays.directions,
            "ray_reached": result.rays.reached,
            "ray_distance": result.rays.distance,
            "ray_postures": result.rays.postures,
        }
    return arrays
