"""Operations on the mesh: seen before they are done, refused with a sentence."""

import ast

import numpy as np
import pytest
from studio_window import needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

pytestmark = needs_window


def arguments(line):
    return {k.arg: ast.literal_eval(k.value) for k in ast.parse(line, mode="eval").body.keywords}


def tip(studio, number=0):
    """Selects a bundle's last face."""
    mesh = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    studio.key("3")
    bundle = mesh.bundles[number]
    studio.select(f"f {bundle.id}/{bundle.height}")
    return bundle.id, bundle.height


def test_an_operation_is_shown_and_dropped_or_done(studio):
    bundle, height = tip(studio)
    studio.key("f")
    before = studio.shot("delete-before")
    studio.does_nothing(lambda: studio.key("x"))
    shown = studio.shot("delete-shown")
    assert np.abs(shown - before)[60:540, 200:590].max() > 60, "what would go is marked"
    studio.does_nothing(lambda: studio.key("Escape"))
    studio.key("x")
    studio.did("delete()", "Return")
    mesh = studio.saved()
    assert mesh.bundle(bundle).height == height - 1


def test_a_layer_is_inserted_where_a_number_says(studio):
    bundle, height = tip(studio)
    studio.key("i")
    studio.type("0.25")
    studio.did("insert_layer(t=0.25)", "Return")
    mesh = studio.saved()
    assert mesh.bundle(bundle).height == height + 1
    studio.key("ctrl+x")
    studio.did("remove_layer", "Return")


def test_gravity_bends_an_extrusion(studio):
    bundle, height = tip(studio)
    studio.key("e", "g")
    studio.wheel(2)
    studio.type("2")
    given = arguments(studio.did("extrude", "Return"))
    assert given == {"distance": 2, "layers": 6, "bend": 0.35}
    mesh = studio.saved()
    assert mesh.bundle(bundle).height == height + 6


def test_an_extrusion_follows_a_drawn_curve(studio):
    bundle, height = tip(studio)
    studio.key("f")
    c = studio.middle()
    studio.key("e", "c")
    line = studio.does(lambda: studio.drag(c, c + (60, 40), c + (120, 20)), "extrude")
    given = arguments(line)
    assert given["layers"] == 4 and len(given["curve"]) >= 9
    studio.shot("extrude-curve")
    mesh = studio.saved()
    assert mesh.bundle(bundle).height == height + 4


def test_edges_are_parted_and_welded_again(studio):
    mesh = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    studio.key("2")
    for side in range(4):
        studio.select(f"e {mesh.bundles[0].id}/{mesh.bundles[0].height}/{side}")
        before = len(studio.lines())
        studio.key("y")
        studio.key("Return")
        if any("separate_edges" in line for line in studio.lines()[before:]):
            break
    else:
        pytest.fail("no side of the tip could be parted")
    assert len(studio.saved().positions) > len(mesh.positions)
    studio.did("undo", "ctrl+z")
    assert studio.saved() == mesh


def test_a_face_is_divided_and_put_together(studio):
    mesh = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    ids = mesh.bundles[0].vertices[0]
    studio.key("1")
    studio.select(f"v {ids[0]} {ids[2]}")
    studio.key("j")
    studio.did("divide_face", "Return")
    assert len(studio.saved().bundle_ids) == len(mesh.bundle_ids) + 1
    studio.key("ctrl+z")
    studio.select(f"b {mesh.bundles[0].id}")
    studio.key("ctrl+r")
    studio.did("subdivide", "Return")
    assert len(studio.saved().bundle_ids) == len(mesh.bundle_ids) + 3


def test_a_refusal_is_said_at_the_mouse_and_changes_nothing(studio):
    studio.key("1")
    studio.select("v 3")
    c = studio.middle()
    studio.point(*c)
    before = studio.shot("refusal-before")
    studio.does_nothing(lambda: studio.key("j"))
    said = studio.shot("refusal")
    x, y = (c + (20, 18)).astype(int)
    red = said[y : y + 12, x : x + 120] - before[y : y + 12, x : x + 120]
    assert np.abs(red).mean() > 20, "a sentence stands beside the mouse"
    assert not (studio.title().startswith("*") and "divide" in studio.lines()[-1])


def test_the_other_side_follows(studio):
    studio.did("symmetry", "ctrl+m")
    studio.key("3")
    tip(studio)
    studio.key("g", "y")
    studio.type("-1")
    studio.did("translate", "Return")
    mesh = studio.saved()
    before = coif.Editor.open(studio.folder / "bob.coif").mesh
    assert before == mesh
    studio.did("undo", "ctrl+z")
    still = studio.saved()
    moved = np.nonzero(np.linalg.norm(mesh.positions - still.positions, axis=1) > 0.5)[0]
    assert len(moved) >= 8, "a face and its partner"
    assert abs(mesh.positions[moved][:, 0].mean() - still.positions[still.layers == 0][:, 0].mean()) < 0.5


def test_hair_is_straightened_pinned_and_pushed_out(studio):
    studio.key("4")
    studio.did('select_all(kind="bundle")', "a")
    studio.did("straighten", "alt+t")
    studio.key("s")
    studio.type("0.6")
    studio.did("scale", "Return")
    studio.did("push_out", "p")
    studio.did("pin", "shift+p")
    mesh = studio.saved()
    assert mesh.pinned.all()
    editor = coif.Editor.open(studio.folder / "bob.coif")
    assert editor.mesh == mesh
