"""Choosing what a command acts on, by mouse and keys."""

import ast

import numpy as np
import pytest
from studio_window import needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

pytestmark = needs_window


def arguments(line):
    return {k.arg: ast.literal_eval(k.value) for k in ast.parse(line, mode="eval").body.keywords}


def faces(line):
    given = arguments(line).get("faces", [])
    return {(int(b), int(layer)) for b, layer in zip(given[::2], given[1::2], strict=True)}


def on_the_hair(studio):
    return studio.middle() + (95, -20)


def test_a_click_takes_a_whole_bundle_or_layer(studio):
    mesh = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    studio.key("4")
    found = faces(studio.does(lambda: studio.click(*on_the_hair(studio)), "select("))
    bundle = {b for b, _ in found}
    assert len(bundle) == 1
    height = mesh.bundle(bundle.pop()).height
    assert {layer for _, layer in found} == set(range(height + 1)), "from the root to the tip"
    studio.shot("select-bundle")
    studio.key("5")
    found = faces(studio.does(lambda: studio.click(*on_the_hair(studio)), "select("))
    assert len({layer for _, layer in found}) == 1 and len(found) > 20
    studio.key("6")
    assert len({b for b, _ in faces(studio.does(lambda: studio.click(*on_the_hair(studio)), "select("))}) == 60


def test_alt_click_takes_the_loop_and_control_the_ring(studio):
    studio.key("2")

    def click():
        studio.click(*on_the_hair(studio))

    with studio.held("alt"):
        loop = arguments(studio.does(click, "select("))["edges"]
    with studio.held("alt"), studio.held("ctrl"):
        ring = arguments(studio.does(click, "select("))["edges"]
    assert len(loop) % 3 == 0 and len(ring) >= 6 and loop != ring


def test_a_lasso_and_a_box_add_and_take_away(studio):
    c = studio.middle()
    studio.key("1")
    with studio.held("ctrl"):
        line = studio.does(
            lambda: studio.drag(c + (-120, -200), c + (120, -200), c + (120, 60), c + (-120, 60), c + (-120, -190)),
            "select(")
    lasso = set(arguments(line)["vertices"])
    assert len(lasso) > 10 and arguments(line)["mode"] == "set"
    with studio.held("shift"):
        line = studio.does(lambda: studio.drag(c + (-200, 60), c + (200, 250)), "select(")
    assert arguments(line)["mode"] == "add" and set(arguments(line)["vertices"]) - lasso
    with studio.held("shift"), studio.held("alt"):
        line = studio.does(lambda: studio.drag(c + (-200, -250), c + (200, 250)), "select(")
    assert arguments(line)["mode"] == "remove"


def test_a_circle_paints_a_selection(studio):
    c = on_the_hair(studio)
    studio.key("1", "c")
    line = studio.does(lambda: studio.drag(c + (-40, -60), c + (10, 0), c + (20, 60)), "select(")
    painted = arguments(line)
    assert painted["mode"] == "add" and len(painted["vertices"]) > 3
    studio.shot("select-paint")
    with studio.held("ctrl"):
        assert arguments(studio.does(lambda: studio.drag(c, c + (5, 5)), "select("))["mode"] == "remove"
    studio.key("Escape")
    assert arguments(studio.does(lambda: studio.click(*(c + (0, -200))), "select("))["mode"] == "set"


def test_by_id_and_a_wrong_id_is_a_sentence(studio):
    assert studio.select("v 3 4, f 0/1 b 2").startswith("editor.select(")
    given = arguments(studio.lines()[-1])
    assert given["vertices"] == [3, 4] and given["faces"][:2] == [0, 1] and given["faces"][2:4] == [2, 0]
    studio.does_nothing(lambda: (studio.key("ctrl+shift+i"), studio.type("f 1"), studio.key("Return")))
    studio.key("Escape")


def test_what_is_under_the_mouse_is_meant_when_nothing_is_selected(studio):
    studio.key("1")
    studio.point(*on_the_hair(studio))
    studio.point(*(on_the_hair(studio) + (3, 2)))
    with studio.held("shift"):
        pass
    lines = len(studio.lines())
    studio.key("4")
    studio.did("select_linked", "ctrl+l")
    assert studio.lines()[lines].startswith("editor.select(")


def test_grow_shrink_similar_and_columns(studio):
    studio.key("3")
    studio.select("f 0/7")
    studio.did("select_more", "ctrl+KP_Add")
    studio.did("select_less", "ctrl+KP_Subtract")
    studio.did("select_columns", "shift+c")
    studio.did("select_similar", "shift+s")
    studio.did("select_invert", "ctrl+i")
    editor = coif.Editor.open(studio.folder / "bob.coif")
    exec(studio.log.read_text(), {"editor": editor})
    assert len(editor.steps) >= 5


def test_hide_isolate_and_freeze(studio):
    studio.key("4")
    studio.does(lambda: studio.click(*on_the_hair(studio)), "select(")
    shown = studio.shot("isolate-before")
    studio.did("isolate", "shift+h")
    isolated = studio.shot("isolate-after")
    assert np.abs(shown - isolated)[60:540, 200:590].max() > 40
    studio.did("show_all", "alt+h")
    studio.did("freeze", "ctrl+f")
    before = studio.saved()
    studio.key("g", "y")
    studio.type("1")
    studio.key("Return")
    assert (studio.saved().positions == before.positions).all(), "frozen vertices stay"
