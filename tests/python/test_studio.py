"""coif-studio as a person drives it: files, keys, undo, recovery."""

import os
import shutil
import signal
import subprocess
import time

import numpy as np
import pytest
from studio_window import BIN, PATIENCE, Studio, needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

pytestmark = needs_window


def saved(studio):
    return studio.saved()


def test_the_head_and_the_hair_are_seen(studio):
    from PIL import Image

    shot = studio.folder / "shot.png"
    studio.path(shot, "F12")
    studio.wait(shot.exists, "the screenshot")
    pixels = np.asarray(Image.open(shot).convert("RGB"), float)
    view = pixels[60:540, 220:560]
    assert view.std() > 15, "the view is one colour"
    assert np.abs(view - np.median(view, axis=(0, 1))).max() > 60


def test_keys_select_and_undo(studio):
    studio.key("3")
    studio.did('select_all(kind="face")', "a")
    studio.did("select_none", "alt+a")
    studio.did('select_layer(kind="face")', "shift+l")
    studio.did("select_columns", "shift+c")
    studio.did("undo", "ctrl+z")
    studio.did("redo", "ctrl+shift+z")
    assert studio.title().startswith("*")


def test_a_box_selects_faces_and_e_extrudes_them(studio):
    before = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    studio.key("3")
    studio.drag((230, 200), (560, 560))
    studio.wait(lambda: any("faces=" in line for line in studio.lines()), "faces in the box")
    studio.key("e")
    studio.type("0.05")
    studio.did("extrude(distance=0.05)", "Return")
    after = saved(studio)
    assert len(after.positions) > len(before.positions)
    studio.did("undo", "ctrl+z")
    assert saved(studio) == before
    studio.did("redo", "ctrl+shift+z")
    assert saved(studio) == after


def test_moving_along_an_axis_by_a_typed_number(studio):
    before = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    studio.did("select_all", "a")
    studio.key("g", "y")
    studio.type("0.25")
    studio.did("translate(by=(0, 0.25, 0))", "Return")
    after = saved(studio)
    assert np.allclose(after.positions - before.positions, (0, 0.25, 0), atol=1e-9)


def test_escape_drops_a_tool_and_nothing_is_done(studio):
    studio.did("select_all", "a")
    studio.key("g")
    studio.point(500, 360)
    studio.key("Escape")
    studio.key("g")
    studio.key("Escape")
    time.sleep(0.5)
    assert len(studio.lines()) == 1


def test_a_person_turns_the_camera_and_the_document_stays(studio):
    studio.drag((400, 300), (470, 330), button=2)
    time.sleep(0.5)
    assert studio.lines() == [] and not studio.title().startswith("*")


def test_the_log_plays_back_to_what_was_saved(studio):
    start = studio.folder / "start.coif"
    shutil.copy(studio.folder / "bob.coif", start)
    studio.key("3")
    studio.drag((230, 200), (560, 560))
    studio.wait(lambda: any("faces=" in line for line in studio.lines()), "faces in the box")
    studio.key("e")
    studio.type("0.04")
    studio.did("extrude", "Return")
    studio.did("smooth", "shift+r")
    mesh = saved(studio)
    editor = coif.Editor.open(start)
    exec(studio.log.read_text(), {"editor": editor})
    assert editor.mesh == mesh


def test_the_palette_finds_a_command_by_its_name(studio):
    studio.did("select_all", "a")
    studio.key("F3")
    studio.type("pin")
    time.sleep(0.3)
    studio.did("pin", "Return")


def test_a_killed_studio_gives_the_work_back(display, studio):
    studio.did("select_all", "a")
    studio.key("g", "x")
    studio.type("0.5")
    studio.did("translate", "Return")
    copies = studio.folder / "state/coif/autosave"
    studio.wait(lambda: list(copies.glob("*.coif")), "an autosave")
    studio.process.send_signal(signal.SIGKILL)
    studio.process.wait()
    before = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    again = Studio(display, studio.folder)
    try:
        # The dialog's first answer is to recover.
        again.wait(lambda: again.key("Return") or "*bob.coif" in again.title(), "the work to come back")
        again.key("ctrl+s")
        again.wait(lambda: not again.title().startswith("*"), "the document to be saved")
        after = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
        assert np.allclose(after.positions - before.positions, (0.5, 0, 0), atol=1e-9)
    finally:
        again.end()


def test_a_head_is_opened_with_bare_roots(display, bob, tmp_path):
    shutil.copy(bob.parent / "head.obj", tmp_path / "head.obj")
    studio = Studio(display, tmp_path, "head.obj", "--style", "").opened("head (not saved yet)")
    try:
        studio.point(450, 300)
        studio.key("3")
        studio.did("select_all", "a")
        studio.key("e")
        studio.type("0.1")
        studio.did("extrude(distance=0.1)", "Return")
    finally:
        studio.end()


def test_a_small_window_and_a_missing_file_are_no_crash(display, tmp_path):
    studio = Studio(display, tmp_path, "missing.coif", size="200x100")
    try:
        time.sleep(1)
        assert studio.process.poll() is None
    finally:
        studio.end()


def test_no_display_is_a_sentence():
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run([BIN / "coif-studio"], env=environment, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 1 and done.stderr.startswith("coif-studio: no window can be opened")
