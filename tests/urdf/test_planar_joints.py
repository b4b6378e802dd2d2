"""Planar joints move across the axis that the file gives, and every frame and inertia stands where the file says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from urdf.corpus.parts import LIMIT, inertial, joint, link, robot

import ospace
from ospace.urdf import build, parity, reader
from ospace.urdf.bodies import bodies_of, plane_axes
from ospace.validation import report

TURNED = 'rpy="0.4 -0.2 0.7"'
NORMALS = {
    "": (1.0, 0.0, 0.0),
    "1 0 0": (1.0, 0.0, 0.0),
    "0 1 0": (0.0, 1.0, 0.0),
    "0 0 1": (0.0, 0.0, 1.0),
    "0 0 -1": (0.0, 0.0, -1.0),
    "0.48 -0.6 0.64": (0.48, -0.6, 0.64),
}


def table(axis):
    """A base, a table on a planar joint with a link fixed to it, a second planar joint on it, and an arm on that."""
    across = f'<axis xyz="{axis}"/>' if axis else ""
    return robot(
        link("base"),
        link("table", inertial("3", products=("0.001", "-0.002", "0.003"))),
        link("camera", inertial("0.5")),
        link("second", inertial("1.5")),
        link("arm", inertial("0.7")),
        joint("slide", "planar", "base", "table", across).replace('xyz="0.3 0 0"', f'xyz="0.3 0 0" {TURNED}'),
        joint("mount", "fixed", "table", "camera", "", "0 0.1 0.2").replace('0.2"', f'0.2" {TURNED}', 1),
        joint("again", "planar", "table", "second", across, "0.2 0.1 0").replace('0.1 0"', f'0.1 0" {TURNED}', 1),
        joint("hinge", "revolute", "second", "arm", '<axis xyz="0 0.6 0.8"/>' + LIMIT, "0 0 0.4"),
    )


def read(content):
    return reader.read_content(Path("made.urdf"), content.encode())


def about(axis, angle):
    return pin.exp3(np.array(axis) * angle)


def expected(normal, moved):
    """Place all links in the base as the text of URDF has it, from (x, y, θ) of both joints and the hinge's angle."""
    (first, second, angle), turn = moved, pin.rpy.rpyToMatrix(0.4, -0.2, 0.7)
    axes = plane_axes(normal)

    def plane(x, y, theta):
        return pin.SE3(about(normal, theta), axes[:, :2] @ (x, y))

    table = pin.SE3(turn, np.array([0.3, 0.0, 0.0])) * plane(*first)
    second = table * pin.SE3(turn, np.array([0.2, 0.1, 0.0])) * plane(*second)
    return {
        "base": pin.SE3.Identity(),
        "table": table,
        "camera": table * pin.SE3(turn, np.array([0.0, 0.1, 0.2])),
        "second": second,
        "arm": second * pin.SE3(about((0.0, 0.6, 0.8), angle), np.array([0.0, 0.0, 0.4])),
    }


@pytest.mark.parametrize("axis", NORMALS)
def test_links_and_masses_lie_where_the_file_says(tmp_path, axis):
    file = tmp_path / "robot.urdf"
    file.write_text(table(axis))
    made = ospace.SpaceRobot.from_urdf(file)
    moved = (0.3, -0.2, 0.9), (-0.1, 0.4, -1.3), 0.6
    state = made.state(made.configuration(dict(zip(("slide", "again", "hinge"), moved, strict=True))))
    places = expected(NORMALS[axis], moved)
    for name, placed in places.items():
        assert state.placement(made.point(name)).isApprox(placed, 1e-13), name
    for name, of_link in {"slide": "table", "again": "second", "hinge": "arm"}.items():
        assert state.placement(made.point(name)).isApprox(places[of_link], 1e-13), name
    total = pin.Inertia.Zero()
    for one in made.description.links:
        xx, xy, xz, yy, yz, zz = one.inertial.tensor
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        total += places[one.name].act(pin.Inertia(one.inertial.mass, np.array(one.inertial.pose.xyz), tensor))
    H_b = ospace.joint_space_dynamics(state).base_inertia
    np.testing.assert_allclose(H_b, total.matrix(), atol=1e-13)


@pytest.mark.parametrize("axis", NORMALS)
def test_all_quantities_agree(tmp_path, axis):
    file = tmp_path / "robot.urdf"
    file.write_text(table(axis))
    made = ospace.SpaceRobot.from_urdf(file)
    checked = report.check(made, [made.point("arm"), made.point("camera")], samples=2)
    assert checked.verdict == "sound"
    told = [finding for finding in made.findings if finding.code == "planar-axis"]
    assert len(told) == (0 if axis == "0 0 1" else 2)
    assert all(finding.severity == "info" for finding in told)


@pytest.mark.parametrize("axis", NORMALS)
def test_the_frame_of_a_plane_is_a_rotation_with_the_normal_for_z(axis):
    axes = plane_axes(NORMALS[axis])
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(np.linalg.det(axes), 1.0, atol=1e-15)
    np.testing.assert_array_equal(axes[:, 2], NORMALS[axis])


@pytest.mark.parametrize(
    ("normal", "x", "y"),
    [
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
        ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    ],
)
def test_along_an_axis_the_plane_has_the_other_two_in_turn(normal, x, y):
    np.testing.assert_array_equal(plane_axes(normal)[:, :2].T, [x, y])


# -- the proof sees what goes wrong -----------------------------------------------------------------------------


def skipped(part):
    """Turn planes, and leave out one part of what must turn with them."""
    honest = build._turn_plane

    def turn(model, j, axes):
        before = [placement.copy() for placement in model.jointPlacements], model.inertias[j].copy()
        frames = [frame.placement.copy() for frame in model.frames]
        honest(model, j, axes)
        if part == "inertia":
            model.inertias[j] = before[1]
        for child in model.children[j] if part == "child joint" else ():
            model.jointPlacements[child] = before[0][child]
        if part == "joint":
            model.jointPlacements[j] = before[0][j]
        for frame, placement in zip(model.frames, frames, strict=True):
            if part == frame.name:
                frame.placement = placement

    return turn


@pytest.mark.parametrize("part", ["inertia", "child joint", "joint", "table", "camera", "second"])
def test_what_does_not_turn_with_the_plane_is_found(monkeypatch, part):
    monkeypatch.setattr(build, "_turn_plane", skipped(part))
    with pytest.raises(ospace.UrdfError) as caught:
        read(table("0.48 -0.6 0.64"))
    assert caught.value.code == "parity"


@pytest.mark.parametrize("wrong", [(0.0, 0.0, 1.0), (-1.0, 0.0, 0.0), (1.0, 1e-8, 0.0)])
def test_another_plane_is_found(monkeypatch, wrong):
    honest = build.plane_axes
    monkeypatch.setattr(build, "plane_axes", lambda normal: honest(wrong))
    with pytest.raises(ospace.UrdfError, match="axis") as caught:
        read(table("1 0 0"))
    assert caught.value.code == "parity"


def test_a_plane_that_is_shifted_is_found():
    reading = read(table("0 1 0"))
    j = reading.model.getJointId("slide")
    frame = reading.model.frames[reading.model.getFrameId("table")]
    shift = pin.SE3(np.eye(3), np.array([0.0, 0.0, 1e-3]))
    reading.model.jointPlacements[j] = reading.model.jointPlacements[j] * shift.inverse()
    frame.placement = shift * frame.placement
    with pytest.raises(ospace.UrdfError, match="table") as caught:
        parity.check_built(Path("made.urdf"), bodies_of(reading.description), reading.model)
    assert caught.value.code == "parity"


def test_what_pinocchio_reads_is_compared_but_for_the_axis(monkeypatch):
    """Its parser takes the x-y plane; all else must be the same."""
    assert read(table("1 0 0")).model is not None
    honest = reader.build_original

    def other(content, described, **options):
        return honest(content.replace(b'mass value="0.5"', b'mass value="0.6"'), described, **options)

    monkeypatch.setattr(reader, "build_original", other)
    assert "original-differs" in {finding.code for finding in read(table("1 0 0")).findings}
