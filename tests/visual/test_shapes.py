"""Solids have the sizes that the URDF gives them, whatever they are made of, and show their outer sides."""

import numpy as np
import pytest
import trimesh
from meshcat import geometry as g

from ospace.urdf.description import Pose, Shape
from ospace.visual.shapes import GREY, box_corners, homogeneous, material, shape_parts

POSE = Pose((0.3, -0.2, 0.7), (0.4, -0.9, 1.3))
TURN = trimesh.transformations.euler_matrix(0.4, -0.9, 1.3)  # roll, pitch, yaw about fixed axes
PLACE = trimesh.transformations.translation_matrix((0.3, -0.2, 0.7)) @ TURN


def shape(kind, size, **more):
    return Shape(None, "visual", POSE, kind, size, **more)


def as_mesh(solid):
    """Return what meshcat makes of a solid, in the frame of the link."""
    geometry = solid.geometry
    if isinstance(geometry, g.Box):
        made = trimesh.creation.box(geometry.lengths)
    elif isinstance(geometry, g.Sphere):
        made = trimesh.creation.uv_sphere(geometry.radius, count=[64, 64])
    elif isinstance(geometry, g.Cylinder):
        assert geometry.radiusTop == geometry.radiusBottom
        made = trimesh.creation.cylinder(geometry.radiusTop, geometry.height, sections=256)
        made.apply_transform(trimesh.transformations.rotation_matrix(-0.5 * np.pi, [1, 0, 0]))  # it stands along y
    else:
        made = trimesh.Trimesh(geometry.vertices, geometry.faces, process=False)
    return made.apply_transform(solid.T)


def bounds(parts):
    boxes = np.array([as_mesh(part).bounds for part in parts])
    return np.array([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])


@pytest.mark.parametrize(
    ("one", "expected"),
    [
        (shape("box", (0.2, 0.4, 0.6)), trimesh.creation.box((0.2, 0.4, 0.6))),
        (shape("sphere", (0.25,)), trimesh.creation.uv_sphere(0.25, count=[64, 64])),
        (shape("cylinder", (0.1, 0.9)), trimesh.creation.cylinder(0.1, 0.9, sections=256)),
        (shape("capsule", (0.1, 0.9)), None),
    ],
    ids=["box", "sphere", "cylinder", "capsule"],
)
def test_primitives_have_their_size(one, expected):
    parts = list(shape_parts(one, None))
    if expected is None:
        expected = trimesh.creation.capsule(0.9, 0.1, count=[64, 64])
        expected.apply_translation(-expected.bounds.mean(axis=0))
    np.testing.assert_allclose(bounds(parts), expected.apply_transform(PLACE).bounds, rtol=0, atol=2e-3)
    assert all(part.colour == GREY for part in parts)
    for part in parts:  # the box that is said to hold it does
        corners = box_corners(part.T, part.half)
        own = as_mesh(part).bounds
        assert (corners.min(axis=0) <= own[0] + 1e-9).all()
        assert (corners.max(axis=0) >= own[1] - 1e-9).all()


WEDGE = trimesh.Trimesh(
    [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], process=False
)
"""Unlike itself when mirrored; faces outwards."""


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "glb", "off"])
@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (0.1, 0.2, 0.3), (1.0, -1.0, 1.0), (-0.5, -0.5, -0.5), (-1, -2, 1)])
def test_meshes_have_their_size_and_face_outwards(tmp_path, suffix, scale):
    file = tmp_path / f"wedge.{suffix}"
    WEDGE.export(file)
    (part,) = shape_parts(shape("mesh", scale, filename=file.name), file)
    made = as_mesh(part)
    expected = trimesh.transform_points(WEDGE.vertices * scale, PLACE)
    np.testing.assert_allclose(made.bounds, [expected.min(axis=0), expected.max(axis=0)], rtol=0, atol=1e-6)
    assert made.volume == pytest.approx(WEDGE.volume * abs(np.prod(scale)), rel=1e-5)  # positive: faces look outwards
    corners = box_corners(part.T, part.half)
    assert (corners.min(axis=0) <= made.bounds[0] + 1e-6).all()
    assert (corners.max(axis=0) >= made.bounds[1] - 1e-6).all()


def test_a_mesh_of_parts_keeps_their_colours(tmp_path):
    red, blue = trimesh.creation.box((1, 1, 1)), trimesh.creation.box((1, 1, 1))
    red.visual = trimesh.visual.TextureVisuals(
        material=trimesh.visual.material.PBRMaterial(baseColorFactor=[255, 0, 0, 255])
    )
    blue.visual = trimesh.visual.TextureVisuals(
        material=trimesh.visual.material.PBRMaterial(baseColorFactor=[0, 0, 255, 128])
    )
    blue.apply_translation([3, 0, 0])
    file = tmp_path / "two.glb"
    trimesh.Scene([red, blue]).export(file)
    parts = list(shape_parts(shape("mesh", (1.0, 1.0, 1.0), filename=file.name), file))
    assert sorted(part.colour[:3] for part in parts) == [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0)]
    assert sorted(round(part.colour[3], 2) for part in parts) == [0.5, 1.0]
    coloured = shape("mesh", (1.0, 1.0, 1.0), filename=file.name, colour=(0.1, 0.2, 0.3, 1.0))
    assert {part.colour for part in shape_parts(coloured, file)} == {(0.1, 0.2, 0.3, 1.0)}  # the URDF's own goes first


@pytest.mark.parametrize("content", [b"", b"solid nothing\nendsolid nothing\n", b"\x00" * 84, b"not a mesh"])
def test_what_is_no_mesh_is_reported(tmp_path, content):
    file = tmp_path / "broken.stl"
    file.write_bytes(content)
    with pytest.raises(ValueError, match=r"broken\.stl"):
        list(shape_parts(shape("mesh", (1.0, 1.0, 1.0), filename=file.name), file))


def test_a_material_clips_colour_and_opacity():
    made = material((1.0, 0.5, -3.0, 7.0))
    assert (made.color, made.opacity) == (0xFF8000, 1.0)
    assert material((0.0, 0.0, 1.0, 0.25)).opacity == 0.25


def test_a_box_has_eight_corners_around_its_centre():
    corners = box_corners(homogeneous(np.eye(3), np.array([1.0, 2.0, 3.0])), np.array([0.1, 0.2, 0.3]))
    assert len({tuple(one) for one in corners}) == 8
    np.testing.assert_allclose([corners.min(axis=0), corners.max(axis=0)], [[0.9, 1.8, 2.7], [1.1, 2.2, 3.3]])
