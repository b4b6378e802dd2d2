"""Shapes of links as convex solids, their distances by Coal, and which pairs of links are worth watching."""

from ospace.collision.geometry import CollisionGeometry, Solid
from ospace.collision.pairs import pair_table
from ospace.collision.solver import DistanceSolver

__all__ = ["CollisionGeometry", "DistanceSolver", "Solid", "pair_table"]
