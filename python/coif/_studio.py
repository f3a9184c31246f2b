"""The editor and Python: coif.studio() opens it, and the console inside it runs here.

Both ends talk in lines of JSON over a socket; apps/studio/channel.h lists the messages.
"""

from __future__ import annotations

import code
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import sysconfig
import tempfile

import numpy as np

from . import _coif, _commands


class _Link:
    """The socket: one request at a time, its answer waited for."""

    def __init__(self, connection):
        self._connection = connection
        self._lines = connection.makefile("r", encoding="utf-8", errors="replace")
        self._asked = 0
        self.waiting = []  # what came while an answer was waited for

    def tell(self, **message):
        self._connection.sendall((json.dumps(message) + "\n").encode())

    def hear(self):
        if self.waiting:
            return self.waiting.pop(0)
        line = self._lines.readline()
        return json.loads(line) if line else None

    def ask(self, **message):
        self._asked += 1
        try:
            self.tell(id=self._asked, **message)
            while line := self._lines.readline():
                answer = json.loads(line)
                if answer.get("id") == self._asked:
                    break
                self.waiting.append(answer)
            else:
                raise BrokenPipeError
        except OSError:
            raise _coif.Error("the editor was closed") from None
        if "error" in answer:
            raise _coif.Error(answer["error"])
        return answer.get("value")


def _plain(value):
    """An argument as JSON has it."""
    if isinstance(value, (bool, str)):
        return value
    if isinstance(value, (int, float, np.number)):
        return float(value)
    return np.asarray(value, float).ravel().tolist()


class StudioEditor:
    """The document that is open in the editor: commands as methods, as of coif.Editor, and seen at once.

    editor.extrude(distance=0.5) is what the menu does: one step of undo, refused with a coif.Error.
    """

    def __init__(self, link):
        self._link = link

    def run(self, command, **arguments):
        """Runs a command by its name; coif.editor_commands() lists them."""
        self._link.ask(run=command, arguments={name: _plain(value) for name, value in arguments.items()})

    def __getattr__(self, name):
        return _commands.method(self, name)

    def __dir__(self):
        return _commands.listed(self)

    def _state(self, what):
        return self._link.ask(state=what)

    @property
    def scene(self):
        """A copy of the document (Scene)."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "scene.coif")
            self._link.ask(write=path)
            return _coif.Scene.load(path)

    @property
    def mesh(self):
        """A copy of the hair mesh; assigning one replaces it, as one step of undo."""
        return self.scene.hair_mesh

    @mesh.setter
    def mesh(self, mesh):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "mesh.coif")
            _coif.Scene(mesh).save(path)
            self.run("use_mesh", file=path)

    @property
    def selected_vertices(self):
        """Ids of the selected vertices (N,), ascending."""
        return np.array(self._state("selected_vertices"), np.uint32)

    @property
    def selected_bundles(self):
        """Ids of the bundles with a selected face (N,), ascending."""
        return np.array(self._state("selected_bundles"), np.uint32)

    @property
    def steps(self):
        """Labels of all steps, oldest first, undone ones included."""
        return self._state("steps")

    @property
    def undo_count(self):
        """How many steps are done."""
        return self._state("undo_count")

    @property
    def modified(self):
        """Whether something changed since opening or saving."""
        return self._state("modified")

    @property
    def python_log(self):
        """The steps that are done as lines of Python."""
        return self._state("python_log")

    def act(self, name):
        """Does what a menu entry of the window does: "view_front", "show_head", "play", "console"."""
        self._link.ask(act=name)

    def rest(self):
        """Waits until the window shows the document as it is now, finely drawn."""
        self._link.ask(rest=True)

    def open(self, path):
        """Opens a head or a .coif document in the editor."""
        self._link.ask(open=os.path.abspath(path))

    def save(self, path=""):
        """Writes the document; without a path where it was."""
        self._link.ask(save=os.path.abspath(path) if path else "")

    def export(self, path):
        """Writes strands as .usda, .usdc, .glb, .gltf or .hair."""
        self._link.ask(export=os.path.abspath(path))

    def screenshot(self, path):
        """Writes the window as a PNG."""
        self._link.ask(screenshot=os.path.abspath(path))


class Studio:
    """An open editor that this process started: editor is its document."""

    def __init__(self, process, link, path, head):
        self._process, self._path, self._head = process, path, head
        self.editor = StudioEditor(link)
        self._link = link

    @property
    def open(self):
        """Whether the window still is."""
        return self._process.poll() is None

    def close(self):
        """Closes the window without asking; what was not saved is lost."""
        if self.open:
            self._link.ask(close=True)
        return self.wait()

    def wait(self):
        """Waits until the window is closed, and returns the scene as it was last saved there."""
        code = self._process.wait()
        if code:
            raise _coif.Error(f"the editor ended with code {code}")
        scene = _coif.Scene.load(self._path)
        scene.head = self._head
        return scene


def _program():
    folder = os.environ.get("COIF_STUDIO") or shutil.which("coif-studio", path=sysconfig.get_path("scripts"))
    found = folder or shutil.which("coif-studio")
    if not found:
        raise _coif.Error("coif-studio is not on the PATH; name it in COIF_STUDIO")
    return found


def studio(scene, *, wait=True, arguments=()):
    """Opens the editor on a scene.

    scene: a Scene, of which a copy is edited. wait=True blocks until the window is closed and returns the scene as it
    was last saved there. wait=False returns at once, with an object whose `editor` works on what is open:
    studio.editor.extrude(distance=0.5). arguments: more for the command line of coif-studio. Raises Error where there
    is no coif-studio or no display.
    """
    program = _program()
    keep = tempfile.TemporaryDirectory(prefix="coif-studio-")
    path = pathlib.Path(keep.name) / ((scene.name or "scene") + ".coif")
    head = scene.head
    base = pathlib.Path(scene.file).parent if str(scene.file) not in ("", ".") else pathlib.Path()
    absolute = pathlib.Path(os.path.abspath(base / head)) if str(head) not in ("", ".") else head
    copy = _coif.Scene(scene.hair_mesh, head=absolute, name=scene.name)
    for name in ("count", "points", "tolerance", "seed", "knots", "width", "tip_width"):
        setattr(copy.strands, name, getattr(scene.strands, name))
    for name in ("azimuth", "elevation", "hair_color", "dynamics"):
        setattr(copy, name, getattr(scene, name))
    copy.save(path)
    ours, theirs = socket.socketpair()
    process = subprocess.Popen(
        [program, os.fspath(path), "--channel", str(theirs.fileno()), *arguments],
        pass_fds=[theirs.fileno()], stderr=subprocess.PIPE, text=True)
    theirs.close()
    opened = Studio(process, _Link(ours), path, absolute)
    opened._folder = keep  # lives as long as the editor may save into it
    try:
        opened._link.ask(state="title")  # answered once the document is open
    except _coif.Error:
        process.wait()
        raise _coif.Error(process.stderr.read().strip() or "the editor could not be opened") from None
    return opened.wait() if wait else opened


class _Output:
    """sys.stdout and sys.stderr of the console."""

    def __init__(self, link):
        self._link = link

    def write(self, text):
        if text:
            self._link.tell(output=text)
        return len(text)

    def flush(self):
        pass


def serve(descriptor):
    """The console's process: runs what the editor sends until it is gone."""
    connection = socket.socket(fileno=descriptor)
    link = _Link(connection)
    sys.stdout = sys.stderr = _Output(link)
    import coif

    names = {"__name__": "__console__", "coif": coif, "np": np, "editor": StudioEditor(link)}
    console = code.InteractiveConsole(names)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    while True:
        try:
            message = link.hear()
        except KeyboardInterrupt:  # came after the end of what it was meant for
            continue
        except OSError:
            return
        if message is None:
            return
        if "execute" not in message:
            continue
        more = False
        try:
            if message["name"]:
                names["__file__"] = message["name"]
                exec(compile(message["source"], message["name"], "exec"), names)
            else:
                more = console.push(message["source"])
        except SystemExit:
            pass
        except KeyboardInterrupt:
            console.resetbuffer()
            print("stopped")
        except BaseException:
            console.showtraceback()
        link.tell(done=message["execute"], more=bool(more))
