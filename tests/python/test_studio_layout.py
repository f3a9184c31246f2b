"""What the window looks like is the artist's, and stays so from run to run."""

import json

import numpy as np
import pytest
from studio_window import BAR, LEFT, RIGHT, SIZE, Studio, needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")
pytestmark = needs_window


def test_panels_are_dragged_wider_and_stay_so(studio):
    width, height = SIZE
    narrow = studio.settled("panels-narrow")
    studio.drag((LEFT, 300), (LEFT + 60, 300))
    studio.drag((width - RIGHT, 400), (width - RIGHT + 70, 400))
    studio.drag((LEFT + 60, 200), (20, 200))  # an edge stops before its panel is gone
    studio.drag((180, 200), (LEFT + 40, 200))
    studio.click(width - RIGHT + 110, 85)  # opens a panel: hair colour
    wide = studio.settled("panels-wide")
    studio.key("ctrl+q")
    studio.wait(lambda: studio.process.poll() == 0, "the end")
    kept = json.loads((studio.folder / "state/coif/studio.json").read_text())
    assert abs(kept["leftPanel"] - (LEFT + 40)) < 2 and abs(kept["rightPanel"] - (RIGHT - 70)) < 2
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
