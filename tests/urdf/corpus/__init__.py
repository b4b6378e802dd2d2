"""Files that are odd in one way each, made by code, with the exit status and the codes that they must have."""

from urdf.corpus import files, foreign, inertias, joints, shapes, structure, values, xacros
from urdf.corpus.parts import VARIANTS

__all__ = ["VARIANTS", "files", "foreign", "inertias", "joints", "shapes", "structure", "values", "xacros"]
