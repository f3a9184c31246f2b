"""What the window looks like is the artist's, and stays so from run to run."""

import json

import numpy as np
import pytest
import x11
from studio_window import BAR, LEFT, RIGHT, SIZE, Studio, needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")
pytestmark = needs_window


def kept(studio):
    """What the studio keeps for the next run, as it stands now."""
    path = studio.folder / "state/coif/studio.json"
    return json.loads(path.read_text()) if path.exists() else {}


def end(studio):
    studio.key("ctrl+q")
    studio.wait(lambda: studio.process.poll() == 0, "the end")


def test_panels_are_dragged_wider_and_stay_so(studio):
    width, height = SIZE
    narrow = studio.settled("panels-narrow")

    def drag(start, to, edge, wanted):
        studio.drag((start, 300), (to, 300))  # widths are kept when the edge is let go
        studio.wait(lambda: abs(kept(studio).get(edge, 0) - wanted) < 2, f"{edge} of {wanted}")

    drag(LEFT, LEFT + 60, "leftPanel", LEFT + 60)
    drag(width - RIGHT, width - RIGHT + 70, "rightPanel", RIGHT - 70)
    drag(LEFT + 60, 20, "leftPanel", 180)  # an edge stops before its panel is gone
    drag(180, LEFT + 40, "leftPanel", LEFT + 40)
    studio.click(width - RIGHT + 110, 85)
    studio.wait(lambda: kept(studio).get("open", {}).get("Hair colour"), "the panel to be open")
    studio.point(*studio.middle())
    wide = studio.settled("panels-wide")
    end(studio)
    again = Studio(studio.environment["DISPLAY"], studio.folder, "bob.coif").opened("bob.coif")
    try:
        again.point(*again.middle())
        restored = again.settled("panels-restored")
        panels = np.r_[0 : LEFT + 30, width - RIGHT + 80 : width]
        body = slice(BAR, height - 40)
        assert np.abs(narrow - wide)[body][:, panels].mean() > 2, "other widths look another"
        # Nothing but the mouse, which hovers elsewhere.
        assert np.abs(restored - wide)[body][:, panels].mean() < 0.5, "the panels are as they were left"
    finally:
        again.end()


def place(studio):
    text = studio.tool("getwindowgeometry", "--shell", studio.window)
    values = dict(line.split("=") for line in text.splitlines())
    return tuple(int(values[key]) for key in ("X", "Y", "WIDTH", "HEIGHT"))


def test_the_window_opens_where_and_as_large_as_it_was(studio):
    wanted = (120, 70, 840, 560)
    studio.tool("windowsize", studio.window, *wanted[2:])
    studio.tool("windowmove", studio.window, *wanted[:2])
    studio.wait(lambda: place(studio) == wanted, "the window to be there")
    studio.point(*studio.middle())
    end(studio)
    assert tuple(kept(studio)[key] for key in ("x", "y", "width", "height")) == wanted
    again = Studio(studio.environment["DISPLAY"], studio.folder, "bob.coif", size=None).opened("bob.coif")
    try:
        assert place(again) == wanted
    finally:
        again.end()


def test_a_maximised_window_opens_maximised_and_keeps_what_it_was_before(display, bob, tmp_path):
    with x11.window_manager(display):
        studio = Studio(display, tmp_path, bob).opened("bob.coif")
        try:
            x11.set_maximised(display, int(studio.window))
            studio.point(*studio.middle())
            end(studio)
            assert kept(studio)["maximised"]
            assert (kept(studio)["width"], kept(studio)["height"]) == SIZE, "what it goes back to"
            again = Studio(display, tmp_path, bob, size=None).opened("bob.coif")
            try:
                assert x11.is_maximised(display, int(again.window))
            finally:
                again.end()
        finally:
            studio.end()
