"""coif-studio in a real window under Xvfb, driven by real key and mouse events; fixtures for the tests of it.

What happened is read from the log of commands that the studio appends to (--python-log), from the files it saves, and
from the pixels of the screen.
"""

import contextlib
import os
import pathlib
import shutil
import signal
import subprocess
import time

import numpy as np
import pytest

BIN = pathlib.Path(os.environ.get("COIF_BIN_DIR", pathlib.Path(__file__).parents[2] / "build/release/bin"))
PATIENCE = float(os.environ.get("COIF_STUDIO_PATIENCE", 60))  # seconds: software OpenGL on a busy machine; nothing is judged by how long it takes
SIZE = (900, 600)
LEFT, RIGHT, BAR = 190, 300, 19  # pixels: the panels beside the view and the menu bar above it
STRANDS = 3000
PANELS = ("Strands", "Style", "Hair colour", "Light", "Motion", "Groups", "History", "Stages", "Python")  # at the right
VIEW = np.s_[60:540, 200:590]  # of a picture of the screen
# FLIP's mean between two pictures of one view of one document, above what their samples' sub-pixel offsets make.
SAME_PICTURE = 0.02

needs_window = pytest.mark.skipif(
    not (BIN / "coif-studio").exists() or not shutil.which("Xvfb") or not shutil.which("xdotool"),
    reason="needs coif-studio, Xvfb and xdotool",
)


@pytest.fixture(scope="session")
def display():
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "1300x820x24", "-nolisten", "tcp", "-noreset"],
        pass_fds=[write], stderr=subprocess.DEVNULL,
    )
    os.close(write)
    with os.fdopen(read) as numbers:
        number = numbers.readline().strip()
    yield f":{number}"
    server.terminate()
    server.wait()


@pytest.fixture(scope="session")
def bob(tmp_path_factory):
    """A document with a small bob on the generated head."""
    import coif

    folder = tmp_path_factory.mktemp("bob")
    run = lambda *a: subprocess.run([BIN / "coif", "-q", *a], cwd=folder, check=True)  # noqa: E731
    run("example-head", "-o", "head.obj")
    run("new", "--scalp", "head.obj", "--style", "bob", "--cage", "60", "-o", "bob.coif")
    editor = coif.Editor.open(folder / "bob.coif")
    editor.set_strands(count=STRANDS)
    editor.save(folder / "bob.coif")
    return folder / "bob.coif"


def linear(pixels):
    """Linear light of a picture of the screen, 0 … 255."""
    return np.where(pixels <= 0.04045 * 255, pixels / 255 / 12.92, ((pixels / 255 + 0.055) / 1.055) ** 2.4)


def operator_kinds():
    """Kinds of style operators, as the registry has them."""
    import coif

    return [kind["kind"] for kind in coif.style_kinds()]


class Studio:
    def __init__(self, display, folder, *arguments, size="{}x{}".format(*SIZE)):
        self.folder, self.log = folder, folder / "log.py"
        self.size = tuple(map(int, size.split("x"))) if size else SIZE
        self.environment = dict(os.environ, DISPLAY=display, XDG_STATE_HOME=str(folder / "state"))
        self.log.touch()
        self.process = subprocess.Popen(
            [BIN / "coif-studio", *map(str, arguments), *(["--size", size] if size else []), "--python-log", self.log],
            env=self.environment, cwd=folder, stderr=subprocess.PIPE,
        )
        self.find_window()

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
        self.shot("failed-" + "".join(c if c.isalnum() else "-" for c in what)[:60])
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
            time.sleep(0.12)  # a frame for each: a person does not press two in one

    def type(self, text):
        self.tool("type", "--delay", "25", "--", text)

    def did(self, command, key=None):
        """Presses a key until the command stands in the log; the line that it left."""
        before = len(self.lines())
        if key:
            self.key(key)
        found = lambda: [line for line in self.lines()[before:] if command in line]  # noqa: E731
        return self.wait(found, command)[-1]

    def does(self, action, command):
        """Does something with the mouse, and waits for the command that it must lead to; the line."""
        before = len(self.lines())
        action()
        found = lambda: [line for line in self.lines()[before:] if command in line]  # noqa: E731
        return self.wait(found, command)[-1]

    def does_nothing(self, action):
        before = self.lines()
        action()
        time.sleep(0.4)
        assert self.lines() == before

    @contextlib.contextmanager
    def held(self, key):
        self.tool("keydown", key)
        time.sleep(0.1)
        yield
        self.tool("keyup", key)
        time.sleep(0.1)

    @contextlib.contextmanager
    def frozen(self):
        """What is done in it comes to the studio all at once, as if a frame had taken that long."""
        self.process.send_signal(signal.SIGSTOP)
        yield
        self.process.send_signal(signal.SIGCONT)

    def point(self, x, y):
        self.tool("mousemove", "--window", self.window, int(x), int(y))
        time.sleep(0.1)

    def press(self, button=1):
        self.tool("mousedown", button)
        time.sleep(0.1)

    def release(self, button=1):
        self.tool("mouseup", button)
        time.sleep(0.1)

    def click(self, x, y, button=1):
        self.point(x, y)
        self.press(button)
        self.release(button)

    def drag(self, start, *ends, button=1):
        self.point(*start)
        self.press(button)
        at = np.array(start, float)
        for end in ends:
            for t in (0.3, 0.7, 1):
                self.point(*(at + t * (np.array(end) - at)))
            at = np.array(end, float)
        self.release(button)

    def wheel(self, steps):
        for _ in range(abs(steps)):
            self.tool("click", 4 if steps > 0 else 5)
            time.sleep(0.08)

    def panel(self, name):
        """Opens or closes a panel at the right, those above it being closed."""
        self.click(self.size[0] - RIGHT + 110, 37 + 24 * PANELS.index(name))
        time.sleep(0.2)

    def middle(self):
        """The middle of the view, where framing puts things."""
        width, height = SIZE
        return np.array([LEFT + (width - LEFT - RIGHT) / 2, BAR + (height - 2 * BAR) / 2])

    def select(self, ids):
        """Selects by id as a person does, through the dialog."""
        return self.does(lambda: (self.key("ctrl+shift+i"), self.type(ids), self.key("Return")), "select(")

    def palette(self, name, command):
        return self.does(lambda: (self.key("F3"), self.type(name), time.sleep(0.15), self.key("Return")), command)

    def shot(self, name):
        """A picture of the screen, kept among the tests' artifacts."""
        from PIL import ImageGrab

        out = pathlib.Path(os.environ.get("COIF_TEST_OUT", self.folder)) / "studio"
        out.mkdir(parents=True, exist_ok=True)
        picture = ImageGrab.grab(bbox=(0, 0, *self.size), xdisplay=self.environment["DISPLAY"])
        picture.save(out / f"{name}.png")
        return np.asarray(picture.convert("RGB"), float)

    def path(self, path, *keys):
        """Presses the keys that ask for a path, and answers."""
        self.key(*keys)
        time.sleep(0.6)  # until the field has the keyboard: a person looks up too
        self.key("ctrl+a")
        self.type(str(path))
        self.key("Return")
        time.sleep(0.4)

    def ticks(self):
        """Processor time that the studio took, in the kernel's ticks of 10 ms."""
        fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(") ", 1)[1].split()
        return int(fields[11]) + int(fields[12])

    def rest(self):
        """Waits until all is drawn: an idle window takes no time."""

        def rested():
            before = self.ticks()
            time.sleep(0.7)
            return self.ticks() - before <= 1

        self.wait(rested, "the pictures to be done")

    def settled(self, name):
        """A picture of the screen once all of it is drawn."""
        self.rest()
        return self.shot(name)

    def saved(self, name="bob.coif"):
        import coif

        def written():  # whole, as a file of its own: the title may still be of the frame before
            path = self.folder / name
            return path.exists() and (path.stat().st_ino, path.stat().st_mtime_ns)

        before = written()
        self.key("ctrl+s")
        self.wait(lambda: written() and written() != before, "the document to be saved")
        self.wait(lambda: not self.title().startswith("*"), "its title to say so")
        return coif.Scene.load(self.folder / name).hair_mesh

    def find_window(self):
        # By process: the window of one that was killed may still stand for a moment.
        self.search = ("search", "--all", "--onlyvisible", "--pid", self.process.pid, "--name", "Coif Studio")
        self.window = self.wait(lambda: self.tool(*self.search), "a window")

    def end(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()


@pytest.fixture
def studio(display, bob, tmp_path):
    shutil.copy(bob, tmp_path / "bob.coif")
    shutil.copy(bob.parent / "head.obj", tmp_path / "head.obj")
    made = Studio(display, tmp_path, tmp_path / "bob.coif").opened("bob.coif")
    made.point(*made.middle())
    time.sleep(0.2)
    yield made
    made.end()
