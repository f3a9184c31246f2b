"""HairMesh: reading, the operations, undo and placement."""

import numpy as np
import pytest

from conftest import grid_root

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")


def shared_edge(mesh, layer):
    """An edge (bundle, layer, side) that two bundles share, and the other bundle's name for it."""
    seen = {}
    for bundle in mesh.bundles:
        face = bundle.vertices[layer]
        for side in range(bundle.corners):
            key = frozenset((int(face[side]), int(face[(side + 1) % bundle.corners])))
            if key in seen:
                return seen[key], (bundle.id, layer, side)
            seen[key] = (bundle.id, layer, side)
    raise AssertionError("no shared edge")


def test_a_root_is_read_back():
    positions, faces = grid_root()
    mesh = coif.HairMesh.from_root(positions, faces)
    assert (mesh.bundle_count, mesh.vertex_count, mesh.layer_count) == (12, 20, 1)
    np.testing.assert_array_equal(mesh.positions, np.array(positions, float))
    assert [tuple(b.vertices[0]) for b in mesh.bundles] == [tuple(mesh.vertex_ids[list(f)]) for f in faces]
    assert (mesh.parents == -1).all() and (mesh.layers == 0).all() and mesh.external.all()
    assert mesh.faults() == []


def test_a_root_may_be_an_array_of_quads():
    positions, faces = grid_root()
    assert coif.HairMesh.from_root(np.array(positions), np.array(faces)) == coif.HairMesh.from_root(positions, faces)


@pytest.mark.parametrize("faces", [[(0, 1)], [(0, 1, 1)], [(0, 1, 99)], [(0, 1, 2), (0, 1, 3)]])
def test_bad_roots_are_refused_with_a_reason(faces):
    with pytest.raises(coif.Error) as caught:
        coif.HairMesh.from_root(np.eye(4, 3), faces)
    assert caught.value.message


def test_extruding_adds_a_layer(tuft):
    assert (tuft.layer_count, tuft.vertex_count, tuft.bundle_count) == (4, 80, 12)
    assert all(b.height == 3 and b.vertices.shape == (4, 4) for b in tuft.bundles)
    heights = tuft.positions[:, 1]
    # One unit a layer along the flat root's normal: exact but for the normal's rounding.
    np.testing.assert_allclose(heights, tuft.layers, rtol=0, atol=1e-14)
    above = tuft.layers > 0
    parents = tuft.indices(tuft.parents[above])
    assert (tuft.layers[parents] == tuft.layers[above] - 1).all()


def test_extruding_by_direction_and_by_offsets():
    mesh = coif.HairMesh.from_root(*grid_root(1, 2))
    made = mesh.extrude_faces(mesh.bundle_ids, direction=(1, 2, 3))
    assert made.faces == [(int(b), 1) for b in mesh.bundle_ids] and len(made.vertices) == 6
    new = mesh.indices(made.vertices)
    np.testing.assert_array_equal(mesh.positions[new], mesh.positions[mesh.indices(mesh.parents[new])] + [1, 2, 3])
    offsets = np.random.default_rng(3).normal(size=(mesh.vertex_count, 3))
    made = mesh.extrude_faces([(int(mesh.bundle_ids[0]), 1)], offsets=offsets)
    rows = mesh.indices(made.vertices)
    parents = mesh.indices(mesh.parents[rows])
    np.testing.assert_allclose(mesh.positions[rows], mesh.positions[parents] + offsets[parents], rtol=0, atol=1e-15)


def test_each_operation_is_one_exact_step(tuft):
    """All eleven operations and the two inverses, then back to the start and forth to the end."""
    edge, other = shared_edge(tuft, 2)
    states = [tuft.copy()]

    def step(operation, *arguments, **options):
        made = operation(*arguments, **options)
        assert tuft.faults() == [], operation
        assert tuft != states[-1]
        states.append(tuft.copy())
        return made

    bundle = tuft.bundles[0]
    step(tuft.extrude_faces, [bundle.id], 0.5)
    step(tuft.delete_faces, [bundle.id])
    step(tuft.insert_layer, (bundle.id, 2), 0.25)
    step(tuft.remove_layer, (bundle.id, 2))
    step(tuft.separate_edge, edge)
    step(tuft.weld_edges, edge, other)
    vertex = int(tuft.bundle(edge[0]).vertices[3, edge[2]])
    made = step(tuft.separate_vertex, vertex)
    new = tuft.positions[tuft.indices(made.vertices)]
    twin = (new == tuft.positions[tuft.indices([vertex])]).all(axis=1)
    step(tuft.weld_vertices, vertex, int(made.vertices[twin][0]))
    made = step(tuft.divide_edge, (bundle.id, 0, 0), 0.5)
    step(tuft.dissolve_vertex, int(made.vertices[0]))
    made = step(tuft.divide_face, bundle.id, 0, 2)
    part = tuft.bundle(made.bundles[-1])
    first, second = shared_edge_between(tuft, bundle.id, part.id)
    step(tuft.dissolve_edge, first)
    step(tuft.subdivide, [bundle.id])
    assert second

    for state in reversed(states[:-1]):
        tuft.undo()
        assert tuft == state
    for state in states[1:]:
        tuft.redo()
        assert tuft == state


def shared_edge_between(mesh, a, b):
    faces = {i: mesh.bundle(i).vertices[0].tolist() for i in (a, b)}
    for side, vertex in enumerate(faces[a]):
        following = faces[a][(side + 1) % len(faces[a])]
        for other_side, other in enumerate(faces[b]):
            if {other, faces[b][(other_side + 1) % len(faces[b])]} == {vertex, following}:
                return (a, 0, side), (b, 0, other_side)
    raise AssertionError("no shared edge")


@pytest.mark.parametrize(
    "operation",
    [
        lambda m, b: m.extrude_faces([(b, 1)], 1.0),  # no tip
        lambda m, b: m.extrude_faces([], 1.0),
        lambda m, b: m.extrude_faces([b], float("nan")),
        lambda m, b: m.extrude_faces([12345], 1.0),
        lambda m, b: m.delete_faces([(b, 0)]),
        lambda m, b: m.insert_layer((b, 0)),
        lambda m, b: m.insert_layer((b, 1), 1.5),
        lambda m, b: m.remove_layer((b, 0)),
        lambda m, b: m.separate_edge((b, 0, 0)),
        lambda m, b: m.separate_vertex(int(m.bundle(b).vertices[0, 0])),
        lambda m, b: m.weld_edges((b, 1, 0), (b, 1, 2)),
        lambda m, b: m.weld_vertices(*[int(v) for v in m.bundle(b).vertices[1, :2]]),
        lambda m, b: m.divide_face(b, 0, 1),
        lambda m, b: m.divide_edge((b, 0, 0), 0.0),
        lambda m, b: m.dissolve_vertex(int(m.bundle(b).vertices[0, 2])),  # of four root edges
        lambda m, b: m.subdivide(scheme=coif.SubdivisionScheme.LOOP),
        lambda m, b: m.subdivide([]),
        lambda m, b: m.bundle(999),
    ],
)
def test_refusals_give_the_reason_and_change_nothing(tuft, operation):
    before, steps = tuft.copy(), tuft.undo_count
    with pytest.raises(coif.Error) as caught:
        operation(tuft, int(tuft.bundle_ids[0]))
    assert len(caught.value.message.split()) >= 3, "a sentence"
    assert tuft == before and tuft.undo_count == steps


def test_wrong_types_are_type_errors(tuft):
    with pytest.raises(TypeError):
        tuft.extrude_faces("faces")
    with pytest.raises(TypeError):
        tuft.separate_edge((1, 2))
    with pytest.raises(ValueError, match="direction"):
        tuft.extrude_faces(tuft.bundle_ids, direction=(1, 2))


def test_positions_are_assigned_whole_and_undone(tuft):
    before = tuft.positions
    tuft.positions = before * 2
    np.testing.assert_array_equal(tuft.positions, before * 2)
    tuft.undo()
    np.testing.assert_array_equal(tuft.positions, before)
    with pytest.raises(ValueError, match="positions"):
        tuft.positions = before[:-1]
    with pytest.raises(coif.Error, match="finite"):
        tuft.positions = np.where(np.arange(len(before))[:, None] == 7, np.nan, before)
    np.testing.assert_array_equal(tuft.positions, before)


def test_undoing_nothing_is_an_error():
    mesh = coif.HairMesh.from_root(*grid_root())
    with pytest.raises(coif.Error):
        mesh.undo()
    with pytest.raises(coif.Error):
        mesh.redo()


def energy(mesh, positions):
    """The placement energy, written again from its definition."""
    quads, _ = mesh.side_quads()
    a, b, c, d = (positions[mesh.indices(quads[:, i])] for i in range(4))
    return (((c - a) - (d - b)) ** 2).sum()


def test_side_quads_are_counted_once(tuft):
    quads, exposed = tuft.side_quads()
    # 3 layers of a 3×4 grid: 31 edges each, 14 of them on the outline.
    assert len(quads) == 3 * 31 and exposed.sum() == 3 * 14
    np.testing.assert_array_equal(tuft.parents[tuft.indices(quads[:, 2])], quads[:, 0])


@pytest.mark.parametrize("solver", list(coif.PlaceSolver))
def test_placing_finds_the_least_energy(tuft, solver):
    rng = np.random.default_rng(11)
    positions = tuft.positions + rng.normal(scale=0.3, size=(tuft.vertex_count, 3))
    tuft.positions = positions
    external = tuft.external
    assert 0 < external.sum() < len(external)
    report = coif.place(tuft, solver=solver)
    placed = tuft.positions
    assert report.converged and report.unknowns == (~external).sum()
    np.testing.assert_array_equal(placed[external], positions[external])
    assert coif.placement_energy(tuft) == pytest.approx(energy(tuft, placed), rel=1e-12)
    assert report.energy_after == pytest.approx(energy(tuft, placed), rel=1e-9)
    # At a minimum every small move raises the energy.
    for _ in range(20):
        step = np.where(external[:, None], 0, rng.normal(scale=1e-3, size=placed.shape))
        assert energy(tuft, placed + step) > energy(tuft, placed)
    tuft.undo()
    np.testing.assert_array_equal(tuft.positions, positions)


def test_the_drag_response_is_what_placing_gives(tuft):
    external = np.flatnonzero(tuft.external & (tuft.layers == 3))[:2]
    coif.place(tuft)
    before = tuft.positions
    response = coif.drag_response(tuft, tuft.vertex_ids[external])
    move = np.array([0.3, -0.2, 0.5])
    moved = before.copy()
    moved[external] += move
    tuft.positions = moved
    coif.place(tuft)
    # Both solves stop at an estimated error of 1e-9 of the diagonal, which is 6 here.
    np.testing.assert_allclose(before + response[:, None] * move, tuft.positions, rtol=0, atol=2e-8)


def test_moves_act_on_the_selection_only(tuft):
    before = tuft.positions
    tips = tuft.layer_vertices(3)
    rows = tuft.indices(tips)
    others = np.setdiff1d(np.arange(tuft.vertex_count), rows)
    tuft.translate((1, 2, 3), tips)
    np.testing.assert_allclose(tuft.positions[rows], before[rows] + [1, 2, 3], rtol=0, atol=1e-14)
    tuft.undo()
    tuft.scale((2, 1, 0.5), tips, pivot=(0, 0, 0))
    np.testing.assert_allclose(tuft.positions[rows], before[rows] * [2, 1, 0.5], rtol=0, atol=1e-14)
    tuft.undo()
    tuft.rotate((0, 1, 0), np.pi / 2, tips, pivot=(0, 0, 0))  # right-handed: z goes to x
    turned = before[rows] @ np.array([[0, 0, -1], [0, 1, 0], [1, 0, 0]])
    np.testing.assert_allclose(tuft.positions[rows], turned, rtol=0, atol=1e-14)
    np.testing.assert_array_equal(tuft.positions[others], before[others])
    tuft.undo()
    np.testing.assert_array_equal(tuft.positions, before)


def test_soft_selection_falls_off_with_distance(tuft):
    corner = tuft.layer_vertices(3)[:1]
    weights = tuft.soft_selection(corner, radius=2.5)
    distance = np.linalg.norm(tuft.positions - tuft.positions[tuft.indices(corner)], axis=1)
    s = np.clip(1 - distance / 2.5, 0, 1)
    # 3s² − 2s³ of order 1, a few roundings.
    np.testing.assert_allclose(weights, 3 * s**2 - 2 * s**3, rtol=0, atol=1e-14)
    before = tuft.positions
    tuft.translate((0, 1, 0), corner, radius=2.5)
    np.testing.assert_allclose(tuft.positions - before, weights[:, None] * [0, 1, 0], rtol=0, atol=1e-14)


def test_selections_follow_the_structure(tuft):
    vertex = int(tuft.bundles[0].vertices[2, 0])
    column = tuft.column(vertex)
    assert sorted(tuft.layers[tuft.indices(column)].tolist()) == [0, 1, 2, 3]
    assert set(tuft.bundle_vertices(0, 1)) == set(tuft.bundle(0).vertices[1].tolist())
    assert len(tuft.connected_bundles(0)) == 12
    assert len(tuft.quad_strip((0, 0, 0))) in (3, 4)


def test_mirror_partners_and_symmetric_moves(tuft):
    mirror = tuft.find_mirror((2, 0, 0), (1, 0, 0), 1e-6)
    assert mirror.complete
    pair = tuft.with_mirrored(mirror, [0])
    assert len(pair) == 2 and tuft.mirrored_edge(mirror, tuft.mirrored_edge(mirror, (0, 1, 1))) == (0, 1, 1)
    by = np.zeros((tuft.vertex_count, 3))
    row = tuft.indices([int(tuft.bundle(0).vertices[3, 0])])[0]
    by[row] = (0.1, 0.2, 0.3)
    before = tuft.positions
    tuft.move_symmetrically(mirror, by)
    moved = np.flatnonzero((tuft.positions != before).any(axis=1))
    assert len(moved) == 2
    other = moved[moved != row][0]
    np.testing.assert_allclose(tuft.positions[other] - before[other], (-0.1, 0.2, 0.3), rtol=0, atol=1e-14)


def test_pins_and_groups(tuft):
    inner = tuft.vertex_ids[~tuft.external]
    tuft.set_pinned(inner)
    assert tuft.external.all() and coif.place(tuft).unknowns == 0
    tuft.set_pinned(inner, False)
    assert not tuft.pinned.any()
    tuft.set_group([0, 1], "fringe")
    assert tuft.bundle(1).group == "fringe" and "fringe" in tuft.group_names
    assert coif.grow(tuft, count=50).group_names == tuft.group_names


def test_a_mesh_from_a_scalp(tmp_path):
    scalp = coif.Scalp(coif.example_head(32))
    cage = scalp.cage(60)
    assert len(cage) == cage.columns * cage.rows and abs(len(cage) - 60) <= cage.rows
    mesh = coif.HairMesh.from_scalp(scalp, cage)
    np.testing.assert_array_equal(mesh.positions, cage.positions)
    # Every cage vertex lies on the head, to rounding of numbers of size 24.
    assert np.abs(scalp.surface.signed_distance(mesh.positions)).max() < 1e-12
    assert 150 < coif.HairMesh.from_scalp(scalp).bundle_count < 250
    faces = scalp.region(groups=["scalp"]).faces
    own = coif.HairMesh.from_scalp(scalp, faces)
    assert own.bundle_count == len(faces)
    mesh.extrude_faces(mesh.bundle_ids, 2.0)
    strands = coif.grow(mesh, count=100)
    roots = strands.points[strands.offsets[:-1].astype(int)]
    # grow() lays roots on the head that the mesh remembers: float32 of size 24 is good to 2e-6.
    assert np.abs(scalp.surface.signed_distance(roots)).max() < 1e-5
    on_cage = coif.grow(mesh, count=100, use_head=False)
    lifted = on_cage.points[on_cage.offsets[:-1].astype(int)]
    assert np.abs(scalp.surface.signed_distance(lifted)).max() > 1e-3
    with pytest.raises(coif.Error, match="face"):
        coif.HairMesh.from_scalp(scalp, [10**6])
