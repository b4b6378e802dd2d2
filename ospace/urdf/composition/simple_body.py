"""A body in a few words, such as ``box:1x1x1m,250kg`` or ``bus.stl,120kg/m3``, written as a URDF of one link."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from xml.sax.saxutils import quoteattr

import numpy as np

from ospace.exceptions import OspaceError, printable
from ospace.kernels.tree import Floats
from ospace.urdf.numbers import LARGEST, NumberError, number

if TYPE_CHECKING:
    import trimesh

_SHAPED = re.compile(r"(box|cylinder|sphere|body):(.*)", re.DOTALL)
_MESH = re.compile(r"(.+?\.(?:stl|obj))(?:,(.*))?", re.DOTALL | re.IGNORECASE)
_OTHER_MESH = re.compile(r".+\.(dae|ply|glb|gltf|off|step|stp|3mf)(,.*)?", re.DOTALL | re.IGNORECASE)
_ITEM = re.compile(r"([-+0-9.eEx]*?)(kg/m3|kgm2|kg|mm|cm|m)")
_SPELLINGS = {ord("²"): "2", ord("³"): "3", ord("×"): "x", **dict.fromkeys(map(ord, "^·* "))}
_METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
_SIZES = {"box": 3, "cylinder": 2, "sphere": 1, "body": 3}
_LARGEST_MESH = 200_000_000  # bytes
_FORMS = {
    "box": "box:1x1x0.8m,250kg",
    "cylinder": "cylinder:0.5x2m,250kg (radius, length along z)",
    "sphere": "sphere:0.5m,250kg (radius)",
    "body": "5kg,0.1x0.1x0.1kgm2,0x0x0.2m (mass, principal moments, centre of mass)",
    "mesh": "bus.stl,250kg, bus.stl,120kg/m3, or bus.stl,250kg,mm where it is drawn in millimetres",
}


class _Items(NamedTuple):
    """Length (m), or the metres of a unit alone; mass (kg), density (kg/m³), moments (kg m²); None where not given."""

    length: Floats | None = None
    unit: float | None = None
    mass: float | None = None
    density: float | None = None
    moments: Floats | None = None


class SimpleBody(NamedTuple):
    """A URDF of one link, the file of its mesh if it has one, and what is to know of it."""

    urdf: bytes
    mesh: Path | None
    note: str


def is_simple_body(text: str) -> bool:
    """Return whether a text describes a body, rather than name a robot's file.

    Returns
    -------
    bool
    """
    return any(pattern.fullmatch(text) for pattern in (_SHAPED, _MESH, _OTHER_MESH))


def mesh_file(text: str) -> Path | None:
    """Return the mesh that the text of a body names, None where it names none.

    Returns
    -------
    Path or None
    """
    match = _MESH.fullmatch(text)
    return None if match is None or _SHAPED.fullmatch(text) else Path(match[1])


def simple_body(text: str, name: str) -> SimpleBody:
    """Make a body: uniform, but for ``body:``, which has the moments given.

    Parameters
    ----------
    text : str
        ``box:``, ``cylinder:`` or ``sphere:`` with size and mass or density; a mesh with mass or density; ``body:``
        with mass, principal moments and centre of mass.
    name : str
        Of its link.

    Raises
    ------
    OspaceError
        A number or unit is missing or makes no sense, or the mesh has no volume.
    """
    if shaped := _SHAPED.fullmatch(text):
        kind, items = shaped[1], shaped[2]
        return _of_shape(text, kind, _read(text, kind, items), name)
    mesh = _MESH.fullmatch(text)
    if mesh is None:
        raise OspaceError(f"'{text}': a mesh is read as .stl or .obj: export it as .stl")
    return _of_mesh(text, Path(mesh[1]), _read(text, "mesh", mesh[2] or ""), name)


def _of_shape(text: str, kind: str, items: _Items, name: str) -> SimpleBody:
    if items.unit is not None:
        raise _error(text, kind, "a length has no number")
    if kind == "body":
        return _of_moments(text, items, name)
    if items.moments is not None:
        raise _error(text, kind, f"the moments of a {kind} follow from its size")
    size = items.length
    if size is None or len(size) != _SIZES[kind] or min(size) <= 0.0:
        count = ("one length", "two lengths", "three lengths")[_SIZES[kind] - 1]
        raise _error(text, kind, f"a {kind} has {count} above zero")
    if kind == "box":
        volume, moments = math.prod(size), (size @ size - size**2) / 12.0
        shape = f'<box size="{_joined(size)}"/>'
    elif kind == "cylinder":
        radius, length = size.tolist()
        volume, across = math.pi * radius**2 * length, (3.0 * radius**2 + length**2) / 12.0
        moments, shape = np.array([across, across, radius**2 / 2.0]), f'<cylinder radius="{radius}" length="{length}"/>'
    else:
        (radius,) = size.tolist()
        volume, moments = 4.0 / 3.0 * math.pi * radius**3, np.full(3, 0.4 * radius**2)
        shape = f'<sphere radius="{radius}"/>'
    mass = _mass(text, kind, items, volume)
    return SimpleBody(_urdf(name, mass, np.zeros(3), mass * np.diag(moments), shape), None, "")


def _of_moments(text: str, items: _Items, name: str) -> SimpleBody:
    """Take mass and moments as they are given; without moments it is a point."""
    if items.mass is None or items.mass <= 0.0 or items.density is not None:
        raise _error(text, "body", "it needs a mass above zero")
    moments = np.zeros(3) if items.moments is None else items.moments
    if len(moments) not in (1, 3) or min(moments) < 0.0:
        raise _error(text, "body", "it has three principal moments, or one for all axes, none below zero")
    centre = np.zeros(3) if items.length is None else items.length
    if len(centre) != _SIZES["body"]:
        raise _error(text, "body", "a centre of mass has three coordinates")
    return SimpleBody(_urdf(name, items.mass, centre, np.diag(np.broadcast_to(moments, 3)), ""), None, "")


def _of_mesh(text: str, file: Path, items: _Items, name: str) -> SimpleBody:
    if items.moments is not None or items.length is not None:
        raise _error(text, "mesh", "a mesh has its own size, and its moments follow from it")
    mesh = _load(file)
    scale = 1.0 if items.unit is None else items.unit
    mesh.apply_scale(scale)
    if mesh.is_watertight and mesh.volume < 0.0:
        mesh.invert()
    closed = bool(mesh.is_volume)
    if not closed and items.density is not None:
        raise OspaceError(
            f"'{text}': the mesh is not closed, so it has no volume and a density gives no mass: give the mass, as "
            f"{file.name},250kg, or close the mesh"
        )
    solid = mesh if closed else _hull(file, mesh)
    volume = float(solid.volume)
    if not (math.isfinite(volume) and volume > 0.0):
        raise OspaceError(f"'{text}': the mesh is flat: give a body as {_FORMS['box']}")
    mass = _mass(text, "mesh", items, volume)
    factors = "" if scale == 1.0 else f' scale="{scale} {scale} {scale}"'
    shape = f"<mesh filename={quoteattr(str(file.resolve()))}{factors}/>"
    centre, tensor = np.asarray(solid.center_mass), np.asarray(solid.moment_inertia) * (mass / volume)
    extents = " x ".join(f"{length:.4g}" for length in mesh.extents)
    state = "closed" if closed else "not closed, so centre of mass and tensor are those of its convex hull"
    note = f"mesh of {extents} m, {state}"
    return SimpleBody(_urdf(name, mass, centre, tensor, shape), file, note)


def _load(file: Path) -> trimesh.Trimesh:
    import trimesh

    try:
        if file.stat().st_size > _LARGEST_MESH:
            raise OspaceError(f"{file}: has more than {_LARGEST_MESH} bytes: reduce the mesh")
        mesh = trimesh.load(file, force="mesh", skip_materials=True)
    except OspaceError:
        raise
    except OSError as error:
        raise OspaceError(f"{file}: cannot be read: {error.strerror or error}") from None
    except Exception as error:  # a parser of files from anywhere raises what it meets
        raise OspaceError(f"{file}: is no mesh that can be read: {type(error).__name__}") from None
    if not len(mesh.faces) or not np.isfinite(mesh.vertices).all():
        raise OspaceError(f"{file}: has no faces that can be read")
    return mesh


def _hull(file: Path, mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    try:
        return mesh.convex_hull
    except Exception:  # of SciPy's Qhull, which takes no flat mesh
        raise OspaceError(f"{file}: the mesh is flat: give a body as {_FORMS['box']}") from None


def _mass(text: str, kind: str, items: _Items, volume: float) -> float:
    if (items.mass is None) == (items.density is None):
        raise _error(text, kind, "it needs a mass in kg, or a density in kg/m3, not both")
    mass = items.mass if items.mass is not None else float(items.density * volume)  # type: ignore[operator]
    if not 0.0 < mass <= LARGEST:
        raise _error(text, kind, f"its mass is {mass:g} kg")
    return mass


def _read(text: str, kind: str, items: str) -> _Items:
    """Read numbers by their units, in any order."""
    read: dict[str, Floats | float] = {}
    plain = items.translate(_SPELLINGS)
    for item in filter(None, plain.split(",")):
        match = _ITEM.fullmatch(item)
        if match is None:
            raise _error(text, kind, f"'{item}' is not a number with a unit: kg, kg/m3, kgm2, m, cm or mm")
        digits, unit = match.groups()
        try:
            values = np.array([number(word, LARGEST) for word in digits.split("x")]) if digits else np.zeros(0)
        except NumberError as error:
            raise _error(text, kind, f"'{item}' {error}") from None
        if unit in _METRES:
            key, value = ("length", values * _METRES[unit]) if digits else ("unit", _METRES[unit])
        elif unit == "kgm2" and digits:
            key, value = "moments", values
        elif len(values) == 1:
            key, value = {"kg": "mass", "kg/m3": "density"}.get(unit, unit), float(values[0])
        else:
            raise _error(text, kind, f"'{item}' is not one number")
        if key in read:
            raise _error(text, kind, f"it has a second {key}, '{item}'")
        read[key] = value
    return _Items(**read)  # type: ignore[arg-type]


def _error(text: str, kind: str, reason: str) -> OspaceError:
    return OspaceError(printable(f"'{text}': {reason}; write it as {_FORMS[kind]}"))


def _urdf(name: str, mass: float, centre: Floats, tensor: Floats, shape: str) -> bytes:
    keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    moments = " ".join(
        f'{key}="{value!r}"' for key, value in zip(keys, (tensor + 0.0)[np.triu_indices(3)].tolist(), strict=True)
    )
    drawn = "".join(
        f"\n    <{role}>\n      <geometry>{shape}</geometry>\n    </{role}>" for role in ("visual", "collision")
    )
    return (
        f"<robot name={quoteattr(name)}>\n  <link name={quoteattr(name)}>\n    <inertial>\n"
        f'      <origin xyz="{_joined(centre)}"/>\n      <mass value="{mass!r}"/>\n      <inertia {moments}/>\n'
        f"    </inertial>{drawn if shape else ''}\n  </link>\n</robot>\n"
    ).encode()


def _joined(values: Floats) -> str:
    return " ".join(map(repr, (values + 0.0).tolist()))
