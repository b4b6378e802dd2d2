"""The triangles of a mesh file, in metres: the same for what is drawn and for what is measured."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from trimesh import Trimesh

FORMATS = (".stl", ".obj", ".dae", ".ply", ".glb", ".gltf", ".off")


def read_parts(path: Path, *, colours: bool) -> list[Trimesh]:
    """Read the parts of a mesh that have triangles.

    Parameters
    ----------
    path : Path
    colours : bool
        Read materials as well, which other files may hold.

    Returns
    -------
    list of trimesh.Trimesh
        Vertices in m, in the axes of the file.

    Raises
    ------
    ValueError
        The file is of no format of `FORMATS`, cannot be read, or has no triangles.
    """
    import trimesh

    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"'{path.name}' is none of {', '.join(FORMATS)}")
    try:
        scene = trimesh.load_scene(path, process=False, skip_materials=not colours)
        if scene.units not in (None, "meters", "meter"):
            scene = scene.convert_units("meters")
        parts = [one for one in scene.dump() if isinstance(one, trimesh.Trimesh) and _has_triangles(one)]
    except Exception as error:  # a parser of files from anywhere raises what it meets
        kind = f"{type(error).__name__}: "
        raise ValueError(f"'{path.name}' cannot be read: {kind}{str(error).removeprefix(kind)}") from None
    if not parts:
        reason = _faults_of_collada(path) if path.suffix.lower() == ".dae" else ""
        raise ValueError(f"'{path.name}' has no triangles that can be read{reason}")
    return parts


def _has_triangles(part: Any) -> bool:
    return len(part.faces) > 0 and bool(np.isfinite(part.vertices).all())


def _faults_of_collada(path: Path) -> str:
    """Return what is wrong with a COLLADA file whose scene came out empty."""
    from collada import Collada
    from collada.common import DaeError

    errors = Collada(str(path), ignore=[DaeError]).errors
    return f": {', '.join(str(getattr(error, 'msg', error)) for error in errors)}" if errors else ""
