"""PolygonMesh, Surface and Scalp."""

import gc

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

CUBE = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
CUBE_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


@pytest.fixture(scope="module")
def head():
    return coif.Scalp(coif.example_head())


def test_a_mesh_is_read_back_through_a_file(tmp_path):
    mesh = coif.PolygonMesh(CUBE, CUBE_FACES)
    mesh.save(tmp_path / "cube.obj")
    again = coif.PolygonMesh.load(tmp_path / "cube.obj")
    np.testing.assert_array_equal(again.positions, CUBE)
    assert again.faces == CUBE_FACES and again.face_offsets.tolist() == list(range(0, 25, 4))


def test_positions_are_a_view_that_outlives_the_mesh():
    mesh = coif.PolygonMesh(CUBE, CUBE_FACES)
    positions = mesh.positions
    assert np.shares_memory(positions, mesh.positions) and positions.flags.writeable
    positions[7] = (2, 2, 2)
    assert mesh.bounds[1].tolist() == [2, 2, 2]
    del mesh
    gc.collect()
    assert positions[7].tolist() == [2, 2, 2]


def test_surface_queries_on_a_cube():
    surface = coif.Surface(coif.PolygonMesh(CUBE, CUBE_FACES))
    assert surface.size == pytest.approx(np.sqrt(3), rel=1e-15)
    hit = surface.nearest((0.5, 0.5, 3))
    assert hit.face == 5 and hit.position.tolist() == [0.5, 0.5, 1] and hit.distance == 2
    points = np.random.default_rng(0).uniform(-1, 2, size=(400, 3))
    outside = np.maximum(np.abs(points - 0.5) - 0.5, 0)
    inside = np.minimum((0.5 - np.abs(points - 0.5)).min(axis=1), 1)
    expected = np.where((outside == 0).all(axis=1), -inside, np.linalg.norm(outside, axis=1))
    # Distances of order 1 in double: a few roundings.
    np.testing.assert_allclose(surface.signed_distance(points), expected, rtol=0, atol=1e-14)
    feet, normals, distances = surface.project(points)
    np.testing.assert_array_equal(distances, surface.signed_distance(points))
    np.testing.assert_allclose(np.linalg.norm(points - feet, axis=1), np.abs(distances), rtol=0, atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, rtol=0, atol=1e-14)
    winding = surface.winding_number(points)
    assert ((winding > 0.5) == (expected < 0)).all()
    ray = surface.intersect((0.25, 0.5, -1), (0, 0, 2))
    assert ray.face == 4 and ray.position.tolist() == [0.25, 0.5, 0]
    assert surface.intersect((0.25, 0.5, -1), (0, 0, -1)) is None


def test_report_names_what_is_odd():
    holes = coif.Scalp(coif.PolygonMesh(np.vstack([CUBE, CUBE[:1]]), CUBE_FACES[:5]))
    faults = {finding.fault for finding in holes.report().findings}
    assert {coif.MeshFault.OPEN_SHELL, coif.MeshFault.UNREFERENCED_VERTEX} <= faults
    assert "vert" in str(holes.report())


def test_welding_joins_split_vertices():
    corners = [CUBE[i] for face in CUBE_FACES for i in face]
    split = coif.PolygonMesh(corners, np.arange(24).reshape(6, 4))
    assert split.vertex_count == 24
    assert coif.weld(split).vertex_count == 8
    with pytest.raises(ValueError):
        coif.weld(split, -1)


def test_the_example_head_is_what_its_text_says(head):
    mesh = head.mesh
    report = head.report()
    assert [s.closed and s.manifold and s.genus == 0 for s in report.shells] == [True]
    assert {"scalp", "face", "base"} <= set(mesh.group_names)
    assert all(len(face) == 4 for face in mesh.faces)
    assert mesh.meters_per_unit == 0.01 and mesh.up_axis is coif.UpAxis.Y
    frame = head.frame()
    assert frame.face_found and frame.up[1] > 0.99 and frame.forward[2] > 0.9


def test_regions_by_every_choice(head):
    mesh = head.mesh
    groups = head.region(groups=["scalp"])
    expected = np.flatnonzero(mesh.face_groups == mesh.group_names.index("scalp"))
    assert np.array_equal(groups.faces, expected) and groups.count == len(expected)
    assert head.region(faces=[5, 3]).faces.tolist() == [3, 5]
    centre = mesh.positions.mean(axis=0)
    upper = head.region(half_space=(centre, (0, 1, 0)))
    ball = head.region(sphere=(centre, 6.0))
    assert np.array_equal((upper & ball).faces, np.intersect1d(upper.faces, ball.faces))
    assert np.array_equal((upper | ball).faces, np.union1d(upper.faces, ball.faces))
    assert np.array_equal((upper - ball).faces, np.setdiff1d(upper.faces, ball.faces))
    crown = mesh.positions[mesh.positions[:, 1].argmax()]
    assert 0 < head.region(disc=(crown, 3.0)).count < upper.count
    cap = head.region()
    assert cap.frame is not None and 0 < cap.count < mesh.face_count
    with pytest.raises(ValueError):
        head.region(groups=["scalp"], faces=[1])
    with pytest.raises(coif.Error, match="scalp"):
        head.region(groups=["beard"])


def test_a_real_head_has_a_cap(shared_data):
    scalp = coif.Scalp.load(shared_data / "heads" / "lee-perry-smith.obj")
    cap = scalp.region()
    assert cap.frame.face_found
    areas = 0.05 < cap.count / scalp.mesh.face_count < 0.6
    assert areas, "hair covers a part of a head"


def test_an_unusable_mesh_is_refused(tmp_path):
    path = tmp_path / "bad.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n")
    with pytest.raises(coif.Error) as caught:
        coif.Scalp.load(path)
    assert caught.value.file == str(path)
