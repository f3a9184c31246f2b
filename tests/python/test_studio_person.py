"""A hairstyle from the head to the exported file, as one person makes it in one sitting, a crash included."""

import signal

import numpy as np
import pytest
from studio_window import SAME_PICTURE, SIZE, Studio, linear, needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")
pytestmark = needs_window


def front(studio, name):
    """The hair from the front, above the guided tour's window; as linear colours."""
    studio.key("4", "KP_1", "Home", "alt+a")
    return linear(studio.settled(name)[60:440, 200:590])


def shared_edge(mesh):
    """An edge of the last layer between two bundles that both reach it."""
    seen = {}
    for bundle in mesh.bundles:
        face = list(bundle.vertices[-1])
        for side, pair in enumerate(zip(face, face[1:] + face[:1], strict=True)):
            key = frozenset(int(v) for v in pair)
            if key in seen:
                return seen[key]
            seen[key] = f"e {bundle.id}/{bundle.height}/{side}"
    raise AssertionError("no two bundles share an edge")


def undo_and_redo(studio, steps):
    """Both ways; the mesh as it was saved before and after."""
    for _ in range(steps):
        studio.did("undo", "ctrl+z")
    undone = studio.saved("style.coif")
    for _ in range(steps):
        studio.did("redo", "ctrl+shift+z")
    return undone, studio.saved("style.coif")


def test_a_hairstyle_from_the_head_to_the_file(display, bob, tmp_path):
    head = bob.parent / "head.obj"
    document, exported = tmp_path / "style.coif", tmp_path / "style.usdc"
    studio = Studio(display, tmp_path, "--style", "").opened("not saved yet")  # the example, and the guided tour
    try:
        # Open a head with bare roots.
        studio.path(head, "ctrl+o")
        studio.opened("head (not saved yet)")
        studio.path(document, "ctrl+s")
        studio.opened("style.coif")
        roots = coif.Scene.load(document).hair_mesh
        studio.point(*studio.middle())

        # Extrude three layers, part an edge, move a tip.
        studio.key("3")
        studio.did('select_all(kind="face")', "a")
        for length in ("1.5", "1.25", "1"):
            studio.key("e")
            studio.type(length)
            studio.did(f"extrude(distance={length})", "Return")
        grown = studio.saved("style.coif")
        assert grown.layer_count == roots.layer_count + 3
        studio.key("2")
        studio.select(shared_edge(grown))
        studio.key("y")
        studio.did("separate_edges", "Return")
        parted = studio.saved("style.coif")
        assert len(parted.positions) > len(grown.positions)
        studio.key("3")
        tip = parted.bundles[0]
        studio.select(f"f {tip.id}/{tip.height}")
        studio.key("g", "y")
        studio.type("-0.75")
        studio.did("translate(by=(0, -0.75, 0))", "Return")

        # A crash in the middle, and the next start.
        copies = tmp_path / "state/coif/autosave"
        studio.wait(lambda: list(copies.glob("*.coif")), "an autosave")
        studio.process.send_signal(signal.SIGKILL)
        studio.process.wait()
        studio = Studio(display, tmp_path, "--style", "")
        studio.wait(lambda: studio.key("Return") or "*style.coif" in studio.title(), "the work to come back")
        recovered = studio.saved("style.coif")
        moved = recovered.positions - parted.positions
        assert np.allclose(moved[recovered.indices(tip.vertices[-1])], (0, -0.75, 0), atol=1e-9)
        studio.point(*studio.middle())

        # Style it: its outside, its colour.
        before = front(studio, "person-1-recovered")
        studio.key("3")
        studio.did('select_all(kind="face")', "a")
        studio.key("s")
        studio.type("0.8")
        studio.did("scale", "Return")
        studio.did("smooth", "shift+r")
        studio.did("inflate", "alt+s")
        studio.key("r", "y")
        studio.type("20")
        studio.did("rotate", "Return")
        studio.did("push_out", "p")
        studio.did("select_invert", "ctrl+i")
        studio.key("4")
        studio.did('select_all(kind="bundle")', "a")
        studio.did("pin", "shift+p")
        studio.panel("Hair colour")
        studio.does(lambda: studio.click(SIZE[0] - 250, 205), "set_look")
        studio.point(*studio.middle())
        styled = studio.saved("style.coif")
        after = front(studio, "person-2-styled")
        assert coif.flip(after, before)[0] > 2 * SAME_PICTURE, "the picture shows what was done"

        # Undo ten times, redo.
        steps = 10
        undone, redone = undo_and_redo(studio, steps)
        assert undone != styled and redone == styled
        assert coif.flip(front(studio, "person-3-redone"), after)[0] < SAME_PICTURE

        # Save, export through the dialog, close.
        studio.path(exported, "ctrl+shift+e", "Return")
        studio.wait(lambda: exported.exists() and "exported" not in studio.title(), "the exported file")
        studio.key("ctrl+q")
        studio.wait(lambda: studio.process.poll() == 0, "the end")
        strands = coif.StrandSet.load(exported)
        assert len(strands) == coif.Scene.load(document).strands.count

        # Open it again.
        studio = Studio(display, tmp_path, document).opened("style.coif")
        studio.point(*studio.middle())
        again = front(studio, "person-4-again")
        assert coif.flip(again, after)[0] < SAME_PICTURE, "the same picture as before it was closed"
        studio.did("select_all", "a")
        assert studio.saved("style.coif") == styled
    finally:
        studio.end()
