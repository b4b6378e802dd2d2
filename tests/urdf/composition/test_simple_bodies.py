"""Bodies in a few words: boxes, cylinders, spheres, meshes, masses with moments; and what makes no sense of them."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
import trimesh

from ospace import OspaceError, compose

EXACT = {"rtol": 1e-12, "atol": 1e-15}


def inertia_of(text, tmp_path):
    """Pinocchio's inertia of the one body, and the note on it."""
    out = tmp_path / "body.urdf"
    composed = compose(text, out=out)
    model = pin.buildModelFromUrdf(str(out), pin.JointModelFreeFlyer())
    return model.inertias[1], composed


def assert_inertia(given, mass, centre, tensor):
    np.testing.assert_allclose(given.mass, mass, **EXACT)
    np.testing.assert_allclose(given.lever, centre, **EXACT)
    np.testing.assert_allclose(given.inertia, tensor, rtol=1e-12, atol=1e-15 + 1e-13 * np.abs(tensor).max())


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("box:1x2x3m,6kg", pin.Inertia.FromBox(6.0, 1.0, 2.0, 3.0)),
        ("box:100x200x300cm,1kg/m3", pin.Inertia.FromBox(6.0, 1.0, 2.0, 3.0)),
        ("box: 1000×2000×3000 mm, 1 kg/m³", pin.Inertia.FromBox(6.0, 1.0, 2.0, 3.0)),
        ("box:6kg,1x2x3m", pin.Inertia.FromBox(6.0, 1.0, 2.0, 3.0)),
        ("cylinder:0.5x2m,250kg", pin.Inertia.FromCylinder(250.0, 0.5, 2.0)),
        ("cylinder:0.5x2m,100kg/m3", pin.Inertia.FromCylinder(50.0 * np.pi, 0.5, 2.0)),
        ("sphere:0.5m,8kg", pin.Inertia.FromSphere(8.0, 0.5)),
    ],
)
def test_a_shape_has_the_inertia_that_pinocchio_gives_it(text, expected, tmp_path):
    given, _ = inertia_of(text, tmp_path)
    assert_inertia(given, expected.mass, expected.lever, expected.inertia)


def test_a_body_of_mass_moments_and_centre(tmp_path):
    given, _ = inertia_of("body:5kg,0.1x0.2x0.15kgm2,0x-0.1x.2m", tmp_path)
    assert_inertia(given, 5.0, [0.0, -0.1, 0.2], np.diag([0.1, 0.2, 0.15]))
    given, _ = inertia_of("body:0.1kg·m²,5kg", tmp_path)
    assert_inertia(given, 5.0, np.zeros(3), 0.1 * np.eye(3))


def moved_box():
    mesh = trimesh.creation.box((1.0, 2.0, 3.0))
    mesh.apply_translation((0.5, -1.0, 2.0))
    return mesh


@pytest.mark.parametrize("kind", ["stl", "obj", "STL"])
@pytest.mark.parametrize("mass", ["6kg", "1kg/m3"])
def test_a_closed_mesh_has_the_inertia_of_what_it_encloses(kind, mass, tmp_path):
    file = tmp_path / f"bus.{kind}"
    moved_box().export(file, file_type=kind.lower())
    given, composed = inertia_of(f"{file},{mass}", tmp_path)
    expected = pin.Inertia.FromBox(6.0, 1.0, 2.0, 3.0)
    assert_inertia(given, 6.0, [0.5, -1.0, 2.0], expected.inertia)
    assert composed.parts[0].note == "mesh of 1 x 2 x 3 m, closed"
    assert composed.parts[0].source == f"bus.{kind},{mass}"
    assert f'filename="bus.{kind}"' in composed.content.decode()


def test_a_mesh_in_millimetres(tmp_path):
    mesh = moved_box()
    mesh.apply_scale(1000.0)
    mesh.export(tmp_path / "bus.stl")
    given, composed = inertia_of(f"{tmp_path}/bus.stl,6kg,mm", tmp_path)
    assert_inertia(given, 6.0, [0.5, -1.0, 2.0], pin.Inertia.FromBox(6.0, 1.0, 2.0, 3.0).inertia)
    assert 'scale="0.001 0.001 0.001"' in composed.content.decode()


def test_a_mesh_that_is_inside_out_is_turned(tmp_path):
    mesh = moved_box()
    mesh.invert()
    mesh.export(tmp_path / "bus.stl")
    given, composed = inertia_of(f"{tmp_path}/bus.stl,1kg/m3", tmp_path)
    assert_inertia(given, 6.0, [0.5, -1.0, 2.0], pin.Inertia.FromBox(6.0, 1.0, 2.0, 3.0).inertia)
    assert composed.parts[0].note.endswith("closed")


def opened(tmp_path):
    mesh = moved_box()
    mesh.faces = mesh.faces[1:]
    mesh.export(tmp_path / "open.stl")
    return tmp_path / "open.stl"


def test_an_open_mesh_has_its_mass_spread_over_its_hull_and_says_so(tmp_path):
    given, composed = inertia_of(f"{opened(tmp_path)},6kg", tmp_path)
    assert_inertia(given, 6.0, [0.5, -1.0, 2.0], pin.Inertia.FromBox(6.0, 1.0, 2.0, 3.0).inertia)
    assert "not closed" in composed.parts[0].note
    assert "hull" in composed.parts[0].note


def test_an_open_mesh_has_no_density(tmp_path):
    with pytest.raises(OspaceError, match=r"not closed.* give the mass, as open\.stl,250kg, or close the mesh"):
        compose(f"{opened(tmp_path)},100kg/m3")


def test_files_that_are_no_meshes(tmp_path):
    (tmp_path / "text.stl").write_text("solid nothing\nendsolid\n")
    (tmp_path / "bytes.obj").write_bytes(bytes(range(256)))
    flat = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    flat.export(tmp_path / "flat.stl")
    for name, words in {
        "none.stl": "cannot be read: No such file",
        "text.stl": "text.stl",
        "bytes.obj": "bytes.obj",
        "flat.stl": "the mesh is flat: give a body as box:",
        "bus.dae": "a mesh is read as .stl or .obj: export it as .stl",
    }.items():
        with pytest.raises(OspaceError, match=words):
            compose(f"{tmp_path}/{name},2kg")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("box:1x1m,2kg", "a box has three lengths above zero"),
        ("box:1x1x0m,2kg", "a box has three lengths above zero"),
        ("box:1x1x-1m,2kg", "a box has three lengths above zero"),
        ("box:1x1x1m", "needs a mass in kg, or a density in kg/m3"),
        ("box:1x1x1m,2kg,3kg/m3", "needs a mass in kg, or a density in kg/m3, not both"),
        ("box:1x1x1,2kg", "'1x1x1' is not a number with a unit"),
        ("box:1x1x1m,2", "'2' is not a number with a unit"),
        ("box:1x1x1m,2lb", "'2lb' is not a number with a unit"),
        ("box:1x1x1m,nankg", "'nankg' is not a number with a unit"),
        ("box:1x1x1m,1e400kg", "too large"),
        ("box:1x1x1m,0kg", "its mass is 0 kg"),
        ("box:1x1x1m,-2kg", "its mass is -2 kg"),
        ("box:1x1x1m,2kg,3kg", "a second mass"),
        ("box:1x1x1m,2kg,1x1x1m", "a second length"),
        ("box:1x1x1m,2kg,0.1kgm2", "the moments of a box follow from its size"),
        ("box:m,2kg", "a length has no number"),
        ("box:1x1x1m,kg", "'kg' is not one number"),
        ("cylinder:1m,2kg", "a cylinder has two lengths above zero"),
        ("sphere:1x1m,2kg", "a sphere has one length above zero"),
        ("body:0.1kgm2", "needs a mass above zero"),
        ("body:5kg,0.1x0.1kgm2", "three principal moments"),
        ("body:5kg,0.1x0.1x-0.1kgm2", "none below zero"),
        ("body:5kg,1m", "a centre of mass has three coordinates"),
        ("body:5kg/m3", "needs a mass above zero"),
        ("box:", "a box has three lengths above zero"),
    ],
)
def test_words_that_make_no_body_say_how_to_write_it(text, words):
    with pytest.raises(OspaceError, match=words) as error:
        compose(text)
    assert "write it as" in str(error.value)
