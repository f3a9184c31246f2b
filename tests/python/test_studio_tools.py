"""The tools in the hand: gizmo, numbers, snapping, brushes."""

import ast
import shutil

import numpy as np
import pytest
from studio_window import Studio, needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

pytestmark = needs_window

ARM = 84  # pixels, of the gizmo


def arguments(line):
    """A line of the log as a dict of its arguments."""
    call = ast.parse(line, mode="eval").body
    return {k.arg: ast.literal_eval(k.value) for k in call.keywords}


def in_the_middle(studio, corners=1):
    """Selects one or two of a tip's corners, seen from the front, and brings their middle to the view's; indices."""
    mesh = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    chosen = mesh.bundles[0].vertices[-1][: 2 * corners - 1 : 2]
    studio.key("KP_1")
    studio.select("v " + " ".join(map(str, chosen)))
    studio.key("f")
    return mesh.indices(chosen)


def test_the_gizmo_moves_along_its_axis(studio):
    in_the_middle(studio)
    studio.key("shift+2")
    c = studio.middle()
    by = arguments(studio.does(lambda: studio.drag(c + (60, 0), c + (110, 4)), "translate"))["by"]
    assert by[0] > 0 and by[1] == 0 and by[2] == 0
    by = arguments(studio.does(lambda: studio.drag(c + (50, -60), c + (50, -120)), "translate"))["by"]
    assert by[1] > 0 and by[0] == 0 and by[2] == 0, "the arm went along with the selection"
    studio.shot("gizmo-move")


def test_the_gizmo_moves_in_a_plane(studio):
    in_the_middle(studio)
    studio.key("shift+2")
    c = studio.middle()
    inside = 0.39 * ARM
    by = arguments(
        studio.does(lambda: studio.drag(c + (inside, -inside), c + (inside + 40, -inside - 25)), "translate"))["by"]
    assert by[0] > 0 and by[1] > 0 and by[2] == 0


def test_the_gizmo_turns_and_scales(studio):
    in_the_middle(studio, 2)
    studio.key("shift+3")
    c = studio.middle()
    radius = 1.15 * ARM  # the outer ring turns in the plane of the view
    line = arguments(studio.does(lambda: studio.drag(c + (radius, 0), c + (0, -radius)), "rotate"))
    assert abs(line["angle"] - 90) < 8, "a quarter, anticlockwise as it is seen"
    assert np.allclose(line["axis"], (0, 0, 1), atol=1e-6)
    studio.key("shift+4")
    factors = arguments(studio.does(lambda: studio.drag(c + (ARM, 0), c + (2 * ARM, 0)), "scale"))["factors"]
    assert abs(factors[0] - 2) < 0.15 and factors[1] == factors[2] == 1


def test_handles_and_axes_follow_the_hair(studio):
    corner = in_the_middle(studio)[0]
    mesh = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    parents = {int(v): int(p) for bundle in mesh.bundles
               for upper, lower in zip(bundle.vertices[1:], bundle.vertices[:-1], strict=True)
               for v, p in zip(upper, lower, strict=True)}
    vertex = int(mesh.vertex_ids[corner])
    link = mesh.positions[corner] - mesh.positions[mesh.indices([parents[vertex]])[0]]
    along = link / np.linalg.norm(link)
    studio.key("comma", "g", "y")
    studio.type("0.5")
    by = np.array(arguments(studio.did("translate", "Return"))["by"])
    assert np.allclose(by, 0.5 * along, atol=1e-9)
    studio.did("undo", "ctrl+z")
    in_the_middle(studio, 2)
    studio.key("comma", "r", "y")  # along the normal: y is still the hair's, as near as that leaves
    studio.type("30")
    axis = np.array(arguments(studio.did("rotate", "Return"))["axis"])
    assert axis @ along > 0.8 and abs(np.linalg.norm(axis) - 1) < 1e-9
    studio.did("undo", "ctrl+z")
    studio.key("s", "z")
    studio.type("2")
    given = arguments(studio.did("scale", "Return"))
    axes = np.reshape(given["axes"], (3, 3))
    assert given["factors"] == (1, 1, 2) and np.allclose(axes @ axes.T, np.eye(3), atol=1e-9)
    studio.key("shift+2")
    studio.settled("gizmo-normal")
    studio.key("comma")
    in_the_middle(studio)
    c = studio.middle()
    by = arguments(studio.does(lambda: studio.drag(c + (60, 0), c + (110, 4)), "translate"))["by"]
    assert by[0] > 0 and by[1] == 0 and by[2] == 0, "the scene's axes again"


def test_numbers_and_planes_are_exact(studio):
    in_the_middle(studio, 2)
    studio.key("g")
    studio.type("1")
    studio.key("Tab")
    studio.type("-2")
    studio.key("Tab")
    studio.type("0.5")
    studio.did("translate(by=(1, -2, 0.5))", "Return")
    studio.key("g", "shift+y")
    studio.type("3")
    studio.key("Tab")
    studio.type("4")
    studio.did("translate(by=(3, 0, 4))", "Return")
    studio.key("s", "shift+x")
    studio.type("2")
    studio.did("scale(factors=(1, 2, 2))", "Return")


def test_control_snaps_to_the_grid(studio):
    corner = in_the_middle(studio)
    c = studio.middle()
    before = coif.Editor.open(studio.folder / "bob.coif").mesh
    studio.key("g")
    with studio.held("ctrl"):
        studio.point(*(c + (37, -23)))
        by = np.array(arguments(studio.does(lambda: (studio.press(), studio.release()), "translate"))["by"])
    to = before.positions[corner[0]] + by
    assert np.allclose(to / 0.5, np.round(to / 0.5), atol=1e-6), "steps of half a unit"


def test_vertices_snap_to_the_scalp(studio):
    in_the_middle(studio)
    studio.palette("snap", "snap(")
    mesh = studio.saved()
    studio.did("undo", "ctrl+z")
    assert mesh != studio.saved()


def test_a_brush_stroke_is_one_step_and_plays_back(studio):
    start = studio.folder / "start.coif"
    shutil.copy(studio.folder / "bob.coif", start)
    studio.key("shift+5")
    c = studio.middle()
    line = studio.does(lambda: studio.drag(c + (60, -60), c + (110, -20), c + (150, 40)), "brush(")
    assert arguments(line)["kind"] == "comb" and len(studio.lines()) == 1
    studio.shot("brush-comb")
    before, after = coif.Scene.load(start).hair_mesh, studio.saved()
    moved = np.linalg.norm(after.positions - before.positions, axis=1)
    assert moved.max() > 0.05 and (moved[before.layers == 0] == 0).all()
    editor = coif.Editor.open(start)
    exec(studio.log.read_text(), {"editor": editor})
    assert editor.mesh == after
    studio.did("undo", "ctrl+z")
    assert studio.saved() == before


def test_keys_change_the_brushes_size(studio):
    studio.key("shift+7")
    c = studio.middle()
    stroke = lambda: studio.drag(c + (70, -50), c + (90, -30))  # noqa: E731
    first = arguments(studio.does(stroke, "brush("))
    assert first["kind"] == "push" and first["strength"] == 0.5
    studio.key("bracketright")
    second = arguments(studio.does(stroke, "brush("))
    assert abs(second["radius"] / first["radius"] - 1.2) < 0.05
    studio.point(*(c + (0, 0)))
    studio.key("f")
    studio.point(*(c + (60, 0)))
    studio.click(*(c + (60, 0)))
    third = arguments(studio.does(stroke, "brush("))
    assert third["radius"] > 1.5 * second["radius"], "F and the mouse"


def test_keys_change_what_a_brush_does(studio):
    studio.key("shift+7")
    c = studio.middle()
    stroke = lambda: studio.drag(c + (70, -50), c + (90, -30))  # noqa: E731
    studio.point(*(c + (90, -30)))
    studio.key("shift+f")
    studio.point(*(c + (90 + 60, -30)))
    studio.key("Return")
    assert abs(arguments(studio.does(stroke, "brush("))["strength"] - 0.8) < 0.06
    with studio.held("ctrl"):
        assert arguments(studio.does(stroke, "brush("))["strength"] < 0, "the other way"
    with studio.held("shift"):
        assert arguments(studio.does(stroke, "brush("))["kind"] == "smooth"


def test_escape_drops_a_stroke(studio):
    studio.key("shift+6")
    c = studio.middle()

    def stroke_and_escape():
        studio.point(*(c + (60, -40)))
        studio.press()
        studio.point(*(c + (100, -40)))
        studio.key("Escape")
        studio.release()

    studio.does_nothing(stroke_and_escape)


@pytest.mark.parametrize("key, kind", [("shift+6", "grab"), ("shift+8", "pull"), ("shift+9", "inflate"),
                                       ("shift+0", "twist")])
def test_every_brush_moves_hair(studio, key, kind):
    studio.key(key)
    c = studio.middle()
    before = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    assert f'kind="{kind}"' in studio.does(lambda: studio.drag(c + (90, -60), c + (110, 0), c + (120, 40)), "brush(")
    moved = np.linalg.norm(studio.saved().positions - before.positions, axis=1)
    assert 1e-3 < moved.max() < 5, "what is under the brush, by about its size"


def test_soft_selection_takes_its_surroundings_along(studio):
    in_the_middle(studio)
    studio.key("o", "g")
    studio.wheel(2)
    studio.key("y")
    studio.type("1")
    line = arguments(studio.did("translate", "Return"))
    assert abs(line["radius"] - 2.5 * 1.15**2) < 1e-6 and line["by"] == (0, 1, 0)
