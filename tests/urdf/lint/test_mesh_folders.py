"""Where meshes are found without an option: beside the file and in its package, and nowhere else."""

from pathlib import Path

import pytest

from ospace.urdf.lint.meshes import MeshError, locate

CUBE = (
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n"
)


@pytest.fixture
def laid(tmp_path):
    """Lay out files below a folder; each is a mesh but for those whose content is given."""

    def lay(*meshes, **contents):
        for name in meshes:
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(CUBE)
        for name, content in contents.items():
            (tmp_path / name).mkdir(parents=True, exist_ok=True)
            (tmp_path / name / "package.xml").write_text(content)
        return tmp_path

    return lay


def found(filename, urdf, package_dirs=()):
    """Return where a mesh lies, or the code of why it is not used."""
    try:
        return locate(filename, urdf, package_dirs).resolve()
    except MeshError as error:
        return error.code


def test_a_mesh_in_the_folder_beside_that_of_the_file_is_found(laid):
    folder = laid("arm/meshes/a.stl", "arm/urdf/b.stl")
    assert found("../meshes/a.stl", folder / "arm/urdf/arm.urdf") == folder / "arm/meshes/a.stl"
    assert found("b.stl", folder / "arm/urdf/arm.urdf") == folder / "arm/urdf/b.stl"
    assert found("../meshes/none.stl", folder / "arm/urdf/arm.urdf") == "mesh-missing"


def test_a_relative_path_of_the_file_finds_the_same(laid, monkeypatch):
    folder = laid("arm/meshes/a.stl", "arm/urdf/b.stl")
    monkeypatch.chdir(folder / "arm/urdf")
    for urdf in ("arm.urdf", "./arm.urdf", "../urdf/arm.urdf"):
        assert found("../meshes/a.stl", Path(urdf)) == folder / "arm/meshes/a.stl"


def test_nothing_outside_the_package_is_opened(laid):
    folder = laid("arm/urdf/a.stl", "secret.stl", "hand/meshes/h.stl")
    urdf = folder / "arm/urdf/arm.urdf"
    assert found("../../secret.stl", urdf) == "mesh-outside"
    assert found("../../hand/meshes/h.stl", urdf) == "mesh-outside"
    assert found(str(folder / "secret.stl"), urdf) == "mesh-outside"
    assert found("package://arm/../secret.stl", urdf) == "mesh-outside"
    (folder / "arm/urdf/link.stl").symlink_to(folder / "secret.stl")
    assert found("link.stl", urdf) == "mesh-outside"
    assert found("../../hand/meshes/h.stl", urdf, [folder / "hand"]) == folder / "hand/meshes/h.stl"


def test_a_package_reaches_as_far_as_its_manifest(laid):
    folder = laid(
        "src/arm-main/meshes/a.stl", "src/arm-main/robots/urdf/six/b.stl", "src/other/c.stl",
        **{"src/arm-main": '<package format="3">\n <name> arm_description </name></package>'},
    )  # fmt: skip
    urdf = folder / "src/arm-main/robots/urdf/six/arm.urdf"
    mesh = folder / "src/arm-main/meshes/a.stl"
    assert found("../../../meshes/a.stl", urdf) == mesh
    assert found("package://arm_description/meshes/a.stl", urdf) == mesh  # its name in package.xml
    assert found("package:///arm-main/meshes/a.stl", urdf) == mesh  # and that of its folder
    assert found("package://arm_description/meshes/none.stl", urdf) == "mesh-missing"
    assert found("package://hand_description/meshes/a.stl", urdf) == "mesh-not-looked-up"
    assert found("../../../../other/c.stl", urdf) == "mesh-outside"
    assert found("package://arm_description/../other/c.stl", urdf) == "mesh-outside"


def test_a_name_that_climbs_out_of_a_package_is_outside_without_any_folder(laid):
    urdf = laid("arm/urdf/a.stl") / "arm/urdf/arm.urdf"
    assert found("package://p/../../../../../etc/hostname", urdf) == "mesh-outside"
    assert found("package://p/meshes/../../q/a.stl", urdf) == "mesh-outside"
    assert found("package://p/meshes/../a.stl", urdf) == "mesh-not-looked-up"


def test_the_home_folder_is_no_package(laid, monkeypatch):
    folder = laid("home/robots/a.stl", "home/private.stl", "other/b.stl", "home/ws/arm/c.stl", home="<package/>")
    monkeypatch.setenv("HOME", str(folder / "home"))
    assert found("../private.stl", folder / "home/robots/arm.urdf") == "mesh-outside"
    assert found("package://home/private.stl", folder / "home/robots/arm.urdf") == "mesh-not-looked-up"
    assert found("../other/b.stl", folder / "home/arm.urdf") == "mesh-outside"
    assert found("a.stl", folder / "home/robots/arm.urdf") == folder / "home/robots/a.stl"


def test_a_file_that_is_a_link_lies_in_both_packages(laid):
    folder = laid("src/arm/meshes/a.stl", "src/arm/urdf/b.stl", "install/arm/urdf/c.stl", "install/arm/extra/d.stl")
    urdf = folder / "install/arm/urdf/arm.urdf"
    (folder / "src/arm/urdf/arm.urdf").write_text("")
    urdf.symlink_to(folder / "src/arm/urdf/arm.urdf")
    (folder / "install/arm/meshes").symlink_to(folder / "src/arm/meshes")
    assert found("../meshes/a.stl", urdf) == folder / "src/arm/meshes/a.stl"
    assert found("../extra/d.stl", urdf) == folder / "install/arm/extra/d.stl"
    assert found("package://arm/meshes/a.stl", urdf) == folder / "src/arm/meshes/a.stl"
