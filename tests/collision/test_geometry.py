"""Shapes of links as solids: distances are those of Pinocchio's own geometry, and hulls hold their meshes."""

import copy
import gc
import pickle
import weakref

import coal
import numpy as np
import pinocchio as pin
import pytest
import solids
import trimesh

import ospace
from ospace.collision import CollisionGeometry, DistanceSolver
from ospace.collision.pairs import pair_table, solver_of_links
from ospace.exceptions import OspaceError
from ospace.validation.sampling import random_state


def of_pinocchio(robot, pairs, q):
    """Return the distance of each pair of links by Pinocchio's own reading of the file."""
    geometry = pin.buildGeomFromUrdf(robot.model, str(robot.source), pin.GeometryType.COLLISION)
    own, found = {}, []
    for k, one in enumerate(geometry.geometryObjects):
        own.setdefault(one.name.rpartition("_")[0], []).append(k)
    for a, b in pairs:
        alone = pin.GeometryModel(geometry)
        alone.removeAllCollisionPairs()
        for i in own[a]:
            for j in own[b]:
                alone.addCollisionPair(pin.CollisionPair(i, j))
        data = alone.createData()
        pin.computeDistances(robot.model, robot.model.createData(), alone, data, q)
        found.append(min(one.min_distance for one in data.distanceResults))
    return np.array(found)


@pytest.mark.parametrize("model", ["chaser_24dof", "chaser_7dof", "ets_vii"])
def test_distances_are_those_of_pinocchios_geometry(model):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(model))
    geometry = CollisionGeometry.of(robot)
    links = geometry.links
    pairs = [(a, b) for k, a in enumerate(links) for b in links[k + 1 :]]
    solver, places = solver_of_links(geometry, pairs)
    rng = np.random.default_rng(4)
    for _ in range(3):
        q = random_state(robot, rng).q.copy()
        solver.configure(q)
        ours = solver.distances()
        ours = np.array([ours[place].min() for place in places])
        theirs = of_pinocchio(robot, pairs, q)
        apart = theirs > 0.0
        assert apart.sum() > len(pairs) // 3
        np.testing.assert_allclose(ours[apart], theirs[apart], atol=1e-5)  # GJK of theirs is Coal's own
        assert (ours[~apart] < 1e-5).all()


def test_nearest_points_lie_at_the_distance_along_the_normal():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    geometry = CollisionGeometry.of(robot)
    pairs = [(0, k) for k in range(8, len(geometry.solids), 3)]
    solver = DistanceSolver(robot.model, geometry.solids, pairs)
    numbers = np.full((len(pairs), 10), np.nan)
    solver.configure(robot.configuration())
    chosen = np.arange(0, len(pairs), 2)
    solver.nearest(chosen, numbers)
    assert np.isfinite(numbers[chosen]).all()
    assert np.isnan(numbers[1]).all()  # those that were not asked for stay as they were
    np.testing.assert_allclose(numbers[chosen, 0], solver.distances()[chosen], rtol=1e-14)
    gap = numbers[chosen, 7:] - numbers[chosen, 4:7]
    np.testing.assert_allclose(numbers[chosen, 0, None] * numbers[chosen, 1:4], gap, atol=1e-9)


def test_results_are_the_same_where_they_cannot_be_seen_in_memory(monkeypatch):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof"))
    geometry = CollisionGeometry.of(robot)
    pairs, both = [(0, 6), (1, 7), (0, 8)], []
    for seen in (True, False):
        if not seen:
            monkeypatch.setattr(DistanceSolver, "_view", lambda self, model: None)
        solver = DistanceSolver(robot.model, geometry.solids, pairs)
        assert (solver._seen is not None) == seen
        solver.configure(robot.configuration())
        both.append(np.zeros((3, 10)))
        solver.nearest(np.arange(3), both[-1])
    np.testing.assert_allclose(*both, atol=1e-12)


def with_mesh(folder, mesh, name):
    mesh.export(folder / f"{name}.stl")
    return solids.body(folder, f'<mesh filename="{name}.stl" scale="1 2 0.5"/>', name=name)


def test_the_hull_of_a_mesh_holds_it(tmp_path):
    ring = trimesh.creation.torus(0.5, 0.1)
    robot = with_mesh(tmp_path, ring, "ring")
    (solid,) = CollisionGeometry.of(robot).solids
    points = np.array(solid.geometry.points())
    scaled = ring.vertices * [1.0, 2.0, 0.5]
    np.testing.assert_allclose(points.max(axis=0), scaled.max(axis=0), atol=1e-6)
    np.testing.assert_allclose(points.min(axis=0), scaled.min(axis=0), atol=1e-6)


def test_a_flat_mesh_is_a_thin_box(tmp_path):
    sheet = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    (solid,) = CollisionGeometry.of(with_mesh(tmp_path, sheet, "sheet")).solids
    np.testing.assert_allclose(2.0 * solid.geometry.halfSide, [1.0, 2.0, 1e-5])
    np.testing.assert_allclose(solid.placement.translation, [0.5, 1.0, 0.0])


def test_visual_shapes_count_where_there_is_no_other(tmp_path):
    path = tmp_path / "seen.urdf"
    content = f'<robot name="seen">{solids.link("bus", solids.BOX, 9.0)}</robot>'
    path.write_text(content.replace("collision", "visual"))
    geometry = CollisionGeometry.of(ospace.SpaceRobot.from_urdf(path))
    assert geometry.links == ["bus"]
    assert geometry.visual == ("bus",)


def test_a_mesh_that_is_not_there_is_told(tmp_path):
    geometry = CollisionGeometry.of(solids.body(tmp_path, '<mesh filename="gone.stl"/>', name="gone"))
    assert geometry.links == []
    assert "gone.stl" in geometry.unread["gone_body"]


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_copy_has_the_same_solids(copied):
    geometry = CollisionGeometry.of(ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof")))
    twin = copied(geometry)
    assert [one.link for one in twin.solids] == [one.link for one in geometry.solids]
    assert all(a.placement == b.placement for a, b in zip(twin.solids, geometry.solids, strict=True))


def test_a_robot_is_let_go_though_its_shapes_were_read():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("ets_vii"))
    assert CollisionGeometry.of(robot).solids[0].geometry is CollisionGeometry.of(robot).solids[0].geometry  # read once
    pair_table(CollisionGeometry.of(robot))
    alive = weakref.ref(robot)
    del robot
    gc.collect()
    assert alive() is None


def test_a_robot_of_a_model_has_no_shapes():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    with pytest.raises(OspaceError, match="was made of a model, which has no shapes"):
        CollisionGeometry.of(ospace.SpaceRobot.from_model(robot.model))


def test_a_mesh_of_round_ends_is_a_solid_though_many_edges_meet_in_a_corner_of_its_triangles(tmp_path):
    trimesh.creation.cylinder(radius=0.1, height=0.4, sections=400).export(tmp_path / "can.stl")
    can = solids.body(tmp_path, '<mesh filename="can.stl"/>', "can")
    like = solids.body(tmp_path, '<cylinder radius="0.1" length="0.4"/>', "like")
    [of_mesh], [of_cylinder] = (CollisionGeometry.of(robot).solids for robot in (can, like))
    rng = np.random.default_rng(3)
    for _ in range(50):
        T = coal.Transform3s(np.eye(3), rng.uniform(-1.0, 1.0, 3))
        apart = [
            coal.distance(one.geometry, coal.Transform3s(), coal.Sphere(0.02), T, request(), coal.DistanceResult())
            for one in (of_mesh, of_cylinder)
        ]
        assert apart[0] == pytest.approx(apart[1], abs=1e-5)


def request():
    made = coal.DistanceRequest()
    made.gjk_tolerance = 1e-12
    return made


def test_a_cone_of_hundreds_of_edges_and_a_mesh_of_vast_size_are_unread_by_name(tmp_path):
    trimesh.creation.cone(radius=0.1, height=0.4, sections=400).export(tmp_path / "cone.stl")
    cone = solids.body(tmp_path, '<mesh filename="cone.stl"/>', "cone")
    why = "'cone.stl' has a corner with more than 255 edges, too many for Coal"
    assert CollisionGeometry.of(cone).unread == {"cone_body": why}
    (tmp_path / "vast.obj").write_text("v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3\n")
    vast = solids.body(tmp_path, '<mesh filename="vast.obj" scale="1e12 1 1"/>', "vast")
    assert CollisionGeometry.of(vast).unread == {"vast_body": "'vast.obj' reaches further than 1e+12 m"}
