"""coif-studio at work: what a drag costs, when nothing is drawn, hair in motion."""

import json
import shutil
import time

import numpy as np
import pytest
from studio_window import VIEW, Studio, needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")
pytestmark = needs_window


def close(studio):
    """Saves where something changed, and quits."""
    if studio.title().startswith("*"):
        studio.key("ctrl+s")
        studio.wait(lambda: not studio.title().startswith("*"), "the document to be saved")
    studio.key("ctrl+q")
    studio.wait(lambda: studio.process.poll() is not None, "the end")
    assert studio.process.returncode == 0


@pytest.fixture
def traced(display, bob, tmp_path):
    for name in ("bob.coif", "head.obj"):
        shutil.copy(bob.parent / name, tmp_path / name)
    made = Studio(display, tmp_path, "bob.coif", "--trace", tmp_path / "trace.json").opened("bob.coif")
    made.point(450, 300)
    yield made
    made.end()


def events(studio):
    close(studio)
    return json.loads((studio.folder / "trace.json").read_text())["traceEvents"]


def test_dragging_uploads_the_mesh_and_not_the_strands(traced):
    traced.key("3")
    traced.does(lambda: traced.drag((230, 200), (560, 560)), "faces=")
    traced.key("g")
    for x in range(450, 490, 4):
        traced.point(x, 300)
    time.sleep(1)
    traced.did("translate", "Return")
    time.sleep(1)
    trace = events(traced)
    first = next(e for e in trace if e["name"] == "drag")["ts"]
    pictures = [e for e in trace if e["name"] == "draft picture"]
    before = [e for e in pictures if e["ts"] < first]
    during = [e for e in pictures if e["ts"] > first]
    assert sum(e["args"]["strand bytes"] for e in before) > 0
    assert during and all(e["args"]["strand bytes"] == 0 for e in during), "the strands went to the GPU again"
    assert any(e["args"]["hair mesh bytes"] > 0 for e in during), "the strands did not follow"
    assert sum(e["name"] == "grow strands" for e in trace) == 1


def test_a_style_is_planned_once_a_drag_and_laid_on_again(traced):
    for kind in ("clump", "curl"):
        traced.palette(f"add_{kind}", f'add_operator(kind="{kind}")')
    traced.key("3", "KP_1", "Home", "z", "z", "z")
    traced.does(lambda: traced.drag((230, 200), (560, 560)), "faces=")
    before = traced.settled("style-drag-before")[VIEW]
    traced.key("g")
    pictures = []
    for x in range(450, 506, 8):
        traced.point(x, 300)
        time.sleep(0.4)
        pictures.append(traced.shot("style-dragged")[VIEW])
    assert np.abs(pictures[-1] - pictures[0]).mean() > 1, "styled strands follow"
    traced.did("translate", "Return")
    after = traced.settled("style-drag-after")[VIEW]
    assert np.abs(after - before).mean() > 1
    trace = events(traced)
    drags = [e["ts"] for e in trace if e["name"] == "drag"]
    during = [e for e in trace if drags[0] < e["ts"] < drags[-1]]
    drafts = [e["args"] for e in during if e["name"] == "draft picture"]
    assert len(drafts) >= 4 and sum(e["name"] == "move strands" for e in during) >= 3
    assert not any(e["name"] == "plan style" for e in during), "what was planned at rest is laid on again"
    assert all(d["strand bytes"] == d["style bytes"] == 0 for d in drafts), "the mesh alone goes to the GPU"


def test_an_idle_window_draws_nothing(traced):
    quiet = 2.5  # seconds without an event; a clock that redraws would wake within them

    traced.rest()
    before = traced.ticks()
    time.sleep(quiet)
    assert traced.ticks() - before <= 1, "an idle window took processor time"
    starts = sorted(e["ts"] for e in events(traced) if e["name"] == "frame")
    assert max(np.diff(starts)) > 1e6 * quiet, "frames were drawn while nothing happened"


def test_the_example_opens_when_nothing_is_given(display, tmp_path):
    studio = Studio(display, tmp_path).opened("not saved yet")
    try:
        studio.did("select_all", "a")
        assert studio.title().startswith("*")
    finally:
        studio.end()


def test_draping_is_one_step_that_undo_takes_back(studio):
    before = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    studio.did("drape", "shift+d")
    after = studio.saved()
    assert len(after.positions) == len(before.positions)
    moved = np.linalg.norm(after.positions - before.positions, axis=1)
    assert moved.max() > 1e-3 * np.ptp(before.positions)
    studio.did("undo", "ctrl+z")
    assert studio.saved() == before


def test_the_motion_plays_and_its_pose_is_kept(studio):
    before = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    studio.key("space")
    # Until the head is measured and a frame is there, keeping it is refused.
    studio.wait(lambda: studio.key("ctrl+k") or any("displace" in line for line in studio.lines()), "a pose to keep")
    after = studio.saved()
    roots = before.layers == 0
    assert np.array_equal(after.positions[roots], before.positions[roots])
    assert np.abs(after.positions - before.positions).max() > 0
    studio.did("undo", "ctrl+z")
    assert studio.saved() == before
