"""Scene: the .coif document, its round trip and its lazy evaluation."""

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")


@pytest.fixture
def scene(tuft):
    scene = coif.Scene(tuft, name="tuft")
    scene.strands.count = 400
    scene.strands.points = 9
    scene.strands.seed = 5
    return scene


def test_a_scene_survives_its_file(scene, tmp_path):
    path = tmp_path / "tuft.coif"
    scene.azimuth, scene.elevation, scene.hair_color = 45, -3, (0.5, 0.25, 0.125)
    scene.save(path)
    again = coif.Scene.load(path)
    assert (again.azimuth, again.elevation, again.hair_color.tolist()) == (45, -3, [0.5, 0.25, 0.125])
    assert again.hair_mesh == scene.hair_mesh and again.name == "tuft" and again.file == path
    assert (again.strands.count, again.strands.points, again.strands.seed) == (400, 9, 5)
    again.save(tmp_path / "again.coif")
    assert (tmp_path / "again.coif").read_bytes() == path.read_bytes()


def test_evaluating_gives_what_the_steps_give(scene, tuft):
    strands = scene.evaluate(use_head=False)
    coif.place(tuft)
    expected = coif.grow(tuft, count=400, points=9, seed=5)
    assert np.array_equal(strands.points, expected.points) and np.array_equal(strands.ids, expected.ids)


def test_what_has_not_changed_is_not_computed_again(scene):
    first = scene.evaluate(use_head=False)
    states = {r.name: r.state for r in scene.reports}
    assert states["strands"] is coif.StageState.RAN
    second = scene.evaluate(use_head=False)
    states = {r.name: r.state for r in scene.reports}
    assert states["strands"] is coif.StageState.REUSED
    assert np.array_equal(first.points, second.points)
    first.points[:] = 0  # a set of its own: the scene's result stays
    assert np.array_equal(scene.evaluate(use_head=False).points, second.points)
    forced = scene.evaluate(use_head=False, force={"all"})
    assert {r.name: r.state for r in scene.reports}["strands"] is coif.StageState.RAN
    assert np.array_equal(forced.points, second.points)
    scene.strands.seed = 6
    assert not np.array_equal(scene.evaluate(use_head=False).points, second.points)
    assert "strands" in scene.explain()


def test_the_hair_mesh_is_assigned_back(scene):
    mesh = scene.hair_mesh
    mesh.extrude_faces(mesh.bundle_ids, 1.0)
    assert scene.hair_mesh != mesh
    scene.hair_mesh = mesh
    assert scene.hair_mesh == mesh
    # The straight tuft is four units high now, float32.
    assert scene.evaluate(use_head=False).points[:, 1].max() == pytest.approx(4, abs=1e-6)


def test_the_head_follows_the_document(tmp_path):
    coif.example_head(16).save(tmp_path / "head.obj")
    scalp = coif.Scalp.load(tmp_path / "head.obj")
    mesh = coif.HairMesh.from_scalp(scalp, scalp.region().faces)
    mesh.extrude_faces(mesh.bundle_ids, 2.0)
    scene = coif.Scene(mesh, head=tmp_path / "head.obj")
    scene.strands.count = 200
    (tmp_path / "deeper").mkdir()
    scene.save(tmp_path / "deeper" / "style.coif")
    strands = coif.Scene.load(tmp_path / "deeper" / "style.coif").evaluate()
    roots = strands.points[strands.offsets[:-1].astype(int)]
    # Roots lie on the head: float32 positions of size 24 are good to 2e-6.
    assert np.abs(scalp.surface.signed_distance(roots)).max() < 1e-5


@pytest.mark.parametrize("text", ["", "{", "[]", '{"coif": 1}', '{"coif": 99}'])
def test_broken_files_are_errors(tmp_path, text):
    path = tmp_path / "broken.coif"
    path.write_text(text)
    with pytest.raises(coif.Error) as caught:
        coif.Scene.load(path)
    assert caught.value.file == str(path)


def test_saving_where_nothing_can_be_written_is_an_error(scene, tmp_path):
    with pytest.raises(coif.Error):
        scene.save(tmp_path / "no folder" / "tuft.coif")


def test_exporting_writes_the_same_strands(scene, tmp_path):
    scene.export(tmp_path / "tuft.hair", use_head=False)
    assert np.array_equal(coif.StrandSet.load(tmp_path / "tuft.hair").points, scene.evaluate(use_head=False).points)


def test_ready_hairstyles_are_a_start():
    scalp = coif.Scalp(coif.example_head())
    assert "bob" in coif.hairstyle_names()
    mesh = coif.model_hairstyle("bob", scalp)
    assert mesh.faults() == [] and mesh.layer_count > 2
    strands = coif.grow(mesh, count=300)
    # Hair lies outside the head; a strand between the columns may graze it by a fraction of its bend.
    assert (scalp.surface.signed_distance(strands.points) > -0.3).mean() > 0.99
    with pytest.raises(ValueError, match="beehive"):
        coif.model_hairstyle("beehive", scalp)
