"""coif-studio where something is missing, full, gone, empty or tiny: a sentence, and the work goes on."""

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import x11
from studio_window import BIN, PATIENCE, SAME_PICTURE, VIEW, Studio, linear, needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")
pytestmark = needs_window


@pytest.fixture
def opened(display, bob, tmp_path):
    """Opens bob.coif, or what is named, as it lies in a folder of its own; more environment by keyword."""
    made = []
    for name in ("bob.coif", "head.obj"):
        shutil.copy(bob.parent / name, tmp_path / name)

    def open_(*arguments, prepare=lambda folder: None, title="bob.coif", **environment):
        prepare(tmp_path)
        for name, value in environment.items():
            os.environ[name] = value
        try:
            studio = Studio(display, tmp_path, *(arguments or ("bob.coif",)))
        finally:
            for name in environment:
                del os.environ[name]
        made.append(studio)
        return studio.opened(title)

    yield open_
    for studio in made:
        studio.end()


def alive(studio):
    time.sleep(0.5)
    assert studio.process.poll() is None
    return studio


def test_a_window_without_opengl_is_a_sentence(display):
    environment = dict(os.environ, DISPLAY=display, MESA_GL_VERSION_OVERRIDE="3.0", MESA_GLSL_VERSION_OVERRIDE="130")
    done = subprocess.run([BIN / "coif-studio"], env=environment, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 1 and "OpenGL" in done.stderr and "3.3" in done.stderr, done.stderr


def test_without_the_strands_opengl_the_mesh_is_edited_all_the_same(opened):
    studio = opened(MESA_GL_VERSION_OVERRIDE="3.3")
    studio.did("select_all", "a")
    studio.did("smooth", "shift+r")
    alive(studio)


def test_a_head_that_vanished_leaves_the_hair(opened):
    studio = opened(prepare=lambda folder: (folder / "head.obj").unlink())
    studio.did("select_all", "a")
    studio.did("smooth", "shift+r")
    studio.saved()


def test_a_file_that_vanished_is_written_again(opened):
    studio = opened()
    studio.did("select_all", "a")
    studio.did("smooth", "shift+r")
    (studio.folder / "bob.coif").unlink()
    studio.saved()


def test_a_full_disk_leaves_the_old_file(opened):
    studio = opened()
    before = (studio.folder / "bob.coif").read_bytes()
    studio.did("select_all", "a")
    studio.did("smooth", "shift+r")
    resource.prlimit(studio.process.pid, resource.RLIMIT_FSIZE, (4096, resource.RLIM_INFINITY))
    studio.key("ctrl+s")
    alive(studio)
    assert (studio.folder / "bob.coif").read_bytes() == before and studio.title().startswith("*")
    resource.prlimit(studio.process.pid, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    studio.saved()
    assert (studio.folder / "bob.coif").read_bytes() != before


def test_a_state_folder_that_cannot_be_made_is_done_without(display, bob, tmp_path):
    for name in ("bob.coif", "head.obj"):
        shutil.copy(bob.parent / name, tmp_path / name)
    (tmp_path / "state").write_text("a file where the folder should be")
    studio = Studio(display, tmp_path, "bob.coif").opened("bob.coif")
    try:
        studio.did("select_all", "a")
        time.sleep(3)  # the first autosave is tried, and fails
        studio.did("smooth", "shift+r")
        studio.saved()
    finally:
        studio.end()


def test_an_empty_scene_is_no_crash(opened):
    studio = opened("empty.coif", title="empty.coif",
                    prepare=lambda folder: coif.Scene(name="empty").save(folder / "empty.coif"))
    for key in ("a", "3", "e", "Escape", "g", "Escape", "space", "shift+d", "Home", "shift+l", "ctrl+m", "ctrl+k"):
        studio.key(key)
    alive(studio)


def test_a_window_made_tiny_hidden_and_large_again(opened):
    studio = opened()
    for size in ((200, 100), (900, 600)):
        studio.tool("windowsize", studio.window, *size)
        time.sleep(0.4)
    studio.tool("windowunmap", studio.window)
    time.sleep(0.4)
    studio.tool("windowmap", studio.window)
    time.sleep(0.4)
    studio.point(*studio.middle())
    studio.did("select_all", "a")


def test_a_lost_context_is_made_anew_and_the_document_stays(opened):
    # No driver here is ever reset, so a signal stands for it: window, context and all that they held are destroyed.
    studio = opened(COIF_STUDIO_LOSABLE="1")
    studio.did("select_all", "a")
    studio.did("inflate", "alt+s")
    studio.key("KP_1", "Home", "alt+a")
    before = studio.settled("lost-before")
    for _ in range(2):
        old = studio.window
        studio.process.send_signal(signal.SIGUSR1)
        studio.point(*studio.middle())  # an event: an idle window looks at nothing
        studio.wait(lambda old=old: studio.tool(*studio.search) not in ("", old), "a new window")
        studio.find_window()
    assert list((studio.folder / "state/coif/autosave").glob("*.coif")), "the work was kept at once"
    studio.point(*studio.middle())
    after = studio.settled("lost-after")
    assert coif.flip(linear(after[VIEW]), linear(before[VIEW]))[0] < SAME_PICTURE, "strands, head and mesh are back"
    # Panels too; but for the last line, which says what happened.
    assert np.abs(after[:570, :180] - before[:570, :180]).mean() < 1, "the tools"
    studio.did("undo", "ctrl+z")
    studio.did("redo", "ctrl+shift+z")
    studio.did("select_all", "a")
    studio.did("smooth", "shift+r")
    studio.saved()


NO_MORE_WINDOWS = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <unistd.h>
typedef unsigned long Window;
/* Xlib's, until a file named "full" lies in the working folder: then as a display that gives no more windows. */
Window XCreateWindow(void *d, Window p, int x, int y, unsigned w, unsigned h, unsigned b, int depth, unsigned c, void *v,
                     unsigned long m, void *a) {
  Window (*real)(void *, Window, int, int, unsigned, unsigned, unsigned, int, unsigned, void *, unsigned long, void *) =
      dlsym(RTLD_NEXT, "XCreateWindow");
  return access("full", F_OK) == 0 ? 0 : real(d, p, x, y, w, h, b, depth, c, v, m, a);
}
"""


@pytest.mark.skipif(not shutil.which("cc"), reason="needs a C compiler for a display that gives no window")
def test_a_context_that_cannot_be_made_anew_ends_with_a_sentence_and_loses_nothing(opened, display):
    def shim(folder):
        (folder / "shim.c").write_text(NO_MORE_WINDOWS)
        subprocess.run(["cc", "-shared", "-fPIC", "-o", "shim.so", "shim.c", "-ldl"], cwd=folder, check=True)

    # The program starts in the folder of the document.
    studio = opened(prepare=shim, COIF_STUDIO_LOSABLE="1", LD_PRELOAD="./shim.so")
    studio.did("select_all", "a")
    studio.did("inflate", "alt+s")
    (studio.folder / "full").touch()
    studio.process.send_signal(signal.SIGUSR1)
    studio.point(*studio.middle())
    assert studio.process.wait(PATIENCE) == 1
    said = studio.process.stderr.read().decode()
    assert "the driver was reset, and" in said and "offered at the next start" in said, said
    again = Studio(display, studio.folder)
    try:
        # The dialog's first answer is to recover.
        again.wait(lambda: again.key("Return") or "*bob.coif" in again.title(), "the work to come back")
    finally:
        again.end()


def test_a_minimised_window_is_not_drawn_and_goes_on_with_its_work(display, bob, tmp_path, monkeypatch):
    monkeypatch.setenv("COIF_PYTHON", sys.executable)
    monkeypatch.setenv("PYTHONPATH", os.path.dirname(os.path.dirname(coif.__file__)))
    for name in ("bob.coif", "head.obj"):
        shutil.copy(bob.parent / name, tmp_path / name)
    (tmp_path / "script.py").write_text(
        "import os, time\n"
        "editor.select_all()\n"
        "while not os.path.exists('stop'):\n"
        "    editor.translate(by=(0, 0.01, 0))\n"
        "    time.sleep(0.1)\n"
        "editor.save()\n")
    studio = Studio(display, tmp_path, "bob.coif", "--script", tmp_path / "script.py", "--trace",
                    tmp_path / "trace.json").opened("bob.coif")
    moves = lambda: sum("translate" in line for line in studio.lines())  # noqa: E731
    try:
        studio.wait(moves, "the script's first move")
        x11.set_minimised(display, int(studio.window), True)
        studio.tool("windowunmap", studio.window)
        first = moves()
        studio.wait(lambda: moves() > first + 10, "ten moves of a window that is not seen")
        x11.set_minimised(display, int(studio.window), False)
        studio.tool("windowmap", studio.window)
        (tmp_path / "stop").touch()
        studio.wait(lambda: not studio.title().startswith("*"), "the script to save")
        studio.point(*studio.middle())
        studio.did("select_none", "alt+a")
        studio.saved()
        studio.key("ctrl+q")
        studio.wait(lambda: studio.process.poll() == 0, "the end")
        events = json.loads((tmp_path / "trace.json").read_text())["traceEvents"]
        drawn = [e["args"]["drawn before"] for e in events if e["name"] == "frame"]
        runs = np.diff(np.flatnonzero(np.diff([-1, *drawn, -1])))
        assert runs.max() > 10, "more than ten frames in a row that nobody could have seen were not drawn"
    finally:
        studio.end()


def test_on_a_fine_display_all_is_larger_and_the_gizmo_too(display, bob, tmp_path):
    for name in ("bob.coif", "head.obj"):
        shutil.copy(bob.parent / name, tmp_path / name)
    (tmp_path / "state/coif").mkdir(parents=True)
    (tmp_path / "state/coif/studio.json").write_text('{"leftPanel": 180, "rightPanel": 180}')
    with x11.dots_per_inch(display, 192):
        studio = Studio(display, tmp_path, "bob.coif", size="1200x800").opened("bob.coif")
    try:
        bar = 2 * 19
        middle = np.array([360 + (1200 - 720) / 2, bar + (800 - 2 * bar) / 2])
        studio.point(*middle)
        mesh = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
        studio.key("KP_1", "1")
        studio.select(f"v {mesh.bundles[0].vertices[-1][0]}")
        studio.key("f", "shift+2")
        shot = studio.settled("fine-display")
        # A column at the right of the menus: the bar's own colour, down to the panel below it.
        height = np.argmax(np.abs(shot[:80, 1100] - shot[8, 1100]).max(axis=1)[8:] > 4) + 8
        assert abs(height - bar) <= 4, f"the menu bar is {height} pixels high"
        # Twice as far out as its arm reaches on a coarse display.
        line = studio.does(lambda: studio.drag(middle + (140, 0), middle + (200, 4)), "translate")
        assert ", 0, 0)" in line, "the handle along x was held"
    finally:
        studio.end()


def test_rubbish_is_refused_and_the_document_stays(opened):
    def rubbish(folder):
        (folder / "state/coif").mkdir(parents=True)
        (folder / "state/coif/studio.json").write_text('{"recent": 3, "keys": [[[')
        (folder / "state/coif/autosave").mkdir()

    studio = opened(prepare=rubbish)
    broken = studio.folder / "broken.coif"
    broken.write_bytes(os.urandom(2000))
    studio.path(broken, "ctrl+o")
    alive(studio)
    assert "bob.coif" in studio.title()
    studio.did("select_all", "a")


def large_head(path, rows, columns):
    """A ball of quads as large as a head."""
    theta = np.linspace(0.01, np.pi - 0.01, rows + 1)[:, None]
    phi = np.linspace(0, 2 * np.pi, columns, endpoint=False)[None, :]
    points = 12 * np.stack([np.sin(theta) * np.sin(phi), np.cos(theta) + 0 * phi, np.sin(theta) * np.cos(phi)], -1)
    index = np.arange((rows + 1) * columns).reshape(rows + 1, columns) + 1
    right = np.roll(index, -1, axis=1)
    faces = np.stack([index[:-1], index[1:], right[1:], right[:-1]], -1).reshape(-1, 4)
    with open(path, "w") as file:
        np.savetxt(file, points.reshape(-1, 3), "v %.5f %.5f %.5f")
        np.savetxt(file, faces, "f %d %d %d %d")


def percent(studio):
    """How far it says it is in its title; none when nothing runs."""
    first = studio.title().split(" ")
    return int(first[0]) if len(first) > 1 and first[1] == "%" else None


def stopped_on_the_way(studio):
    """How far it got is told, and it can be stopped."""
    seen = set()

    def more():
        seen.add(percent(studio))
        return len(seen - {None}) > 1

    studio.wait(more, "some progress")
    studio.key("ctrl+period")
    studio.wait(lambda: percent(studio) is None, "the opening to stop")
    return "(not saved yet)" not in studio.title()


@pytest.mark.parametrize("rows, columns", [(500, 1000), pytest.param(1000, 2000, marks=pytest.mark.slow)])
def test_a_large_head_opens_with_progress_and_cancel(display, bob, tmp_path, rows, columns):
    large_head(tmp_path / "big.obj", rows, columns)
    shutil.copy(bob, tmp_path / "bob.coif")
    shutil.copy(bob.parent / "head.obj", tmp_path / "head.obj")
    studio = Studio(display, tmp_path, "big.obj", "--style", "")
    try:
        assert stopped_on_the_way(studio)
        studio.path(tmp_path / "bob.coif", "ctrl+o")  # the window is good for another
        studio.opened("bob.coif")
        studio.path(tmp_path / "big.obj", "ctrl+o")
        studio.wait(lambda: percent(studio) is not None, "the head to be read")
        studio.key("F3")  # the palette opens while it is
        studio.type("python console")
        studio.key("Return")
        settings = studio.folder / "state/coif/studio.json"
        studio.wait(lambda: '"console": true' in settings.read_text(), "the console to be opened")
        studio.opened("big (not saved yet)")
        studio.click(230, 60)  # out of the console's field
        studio.key("3")
        studio.did("select_all", "a")
        studio.key("e")
        studio.type("3")
        studio.did("extrude(distance=3)", "Return")
        studio.settled(f"large-head-{rows * columns}")
    finally:
        studio.end()
