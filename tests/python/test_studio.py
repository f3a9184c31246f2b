"""coif-studio as a person drives it: a real window under Xvfb, real mouse and key events.

What happened is read from the log of commands that the studio appends to (--python-log), from the files it saves, and
from the pixels of the screen.
"""

import os
import pathlib
import shutil
import signal
import subprocess
import time

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

BIN = pathlib.Path(os.environ.get("COIF_BIN_DIR", pathlib.Path(__file__).parents[2] / "build/release/bin"))
PATIENCE = 60  # seconds: software OpenGL on a busy machine; nothing is judged by how long it takes

pytestmark = pytest.mark.skipif(
    not (BIN / "coif-studio").exists() or not shutil.which("Xvfb") or not shutil.which("xdotool"),
    reason="needs coif-studio, Xvfb and xdotool",
)


@pytest.fixture(scope="module")
def display():
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "1000x700x24", "-nolisten", "tcp", "-noreset"],
        pass_fds=[write], stderr=subprocess.DEVNULL,
    )
    os.close(write)
    with os.fdopen(read) as numbers:
        number = numbers.readline().strip()
    yield f":{number}"
    server.terminate()
    server.wait()


@pytest.fixture(scope="module")
def bob(tmp_path_factory):
    """A document with a small bob on the generated head."""
    folder = tmp_path_factory.mktemp("bob")
    run = lambda *a: subprocess.run([BIN / "coif", "-q", *a], cwd=folder, check=True)  # noqa: E731
    run("example-head", "-o", "head.obj")
    run("new", "--scalp", "head.obj", "--style", "bob", "--cage", "60", "-o", "bob.coif")
    return folder / "bob.coif"


class Studio:
    def __init__(self, display, folder, *arguments, size="900x600"):
        self.folder, self.log = folder, folder / "log.py"
        self.environment = dict(os.environ, DISPLAY=display, XDG_STATE_HOME=str(folder / "state"))
        self.log.touch()
        self.process = subprocess.Popen(
            [BIN / "coif-studio", *map(str, arguments), "--size", size, "--python-log", self.log],
            env=self.environment, cwd=folder, stderr=subprocess.PIPE,
        )
        self.window = self.wait(lambda: self.tool("search", "--onlyvisible", "--name", "Coif Studio"), "a window")

    def tool(self, *arguments):
        done = subprocess.run(["xdotool", *map(str, arguments)], env=self.environment, capture_output=True, text=True)
        return done.stdout.strip()

    def wait(self, test, what):
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            if self.process.poll() not in (None, 0):
                raise AssertionError(f"the studio ended: {self.process.stderr.read().decode()}")
            if result := test():
                return result
            time.sleep(0.05)
        raise AssertionError(f"waited for {what}; the log is {self.lines()}")

    def title(self):
        return self.tool("getwindowname", self.window)

    def lines(self):
        return self.log.read_text().splitlines()

    def opened(self, name):
        self.wait(lambda: name in self.title(), f"{name} in the title")
        return self

    def key(self, *keys):
        for key in keys:
            self.tool("key", "--delay", "40", key)
            time.sleep(0.15)  # a frame for each: a person does not press two in one

    def type(self, text):
        self.tool("type", "--delay", "25", text)

    def did(self, command, key=None):
        """Presses a key until the command stands in the log: the one that the key belongs to."""
        before = len(self.lines())
        if key:
            self.key(key)
        self.wait(lambda: any(command in line for line in self.lines()[before:]), command)

    def point(self, x, y):
        self.tool("mousemove", "--window", self.window, x, y)
        time.sleep(0.15)

    def drag(self, start, end, button=1):
        self.point(*start)
        self.tool("mousedown", button)
        time.sleep(0.15)
        for t in (0.3, 0.7, 1):
            self.point(*(np.array(start) + t * (np.array(end) - start)).astype(int))
        self.tool("mouseup", button)

    def end(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()


@pytest.fixture
def studio(display, bob, tmp_path):
    document = tmp_path / "bob.coif"
    shutil.copy(bob, document)
    shutil.copy(bob.parent / "head.obj", tmp_path / "head.obj")
    made = Studio(display, tmp_path, document).opened("bob.coif")
    made.point(450, 300)
    yield made
    made.end()


def saved(studio):
    studio.key("ctrl+s")
    studio.wait(lambda: not studio.title().startswith("*"), "the document to be saved")
    return coif.Scene.load(studio.folder / "bob.coif").hair_mesh


def test_the_head_and_the_hair_are_seen(studio):
    from PIL import Image

    shot = studio.folder / "shot.png"
    studio.key("F12")
    studio.key("ctrl+a")
    studio.type(str(shot))
    studio.key("Return")
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
        time.sleep(1)
        again.key("Return")  # the dialog's first answer is to recover
        again.opened("*bob.coif")
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
