"""Python and the editor: the console inside, scripts, and coif.studio() from outside."""

import os
import pathlib
import shutil
import sys
import time

import numpy as np
import pytest
from studio_window import BIN, Studio, needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")
pytestmark = needs_window

MODULE = str(pathlib.Path(coif.__file__).parents[1])


@pytest.fixture(autouse=True)
def python_of_the_console(monkeypatch):
    monkeypatch.setenv("COIF_PYTHON", sys.executable)
    monkeypatch.setenv("PYTHONPATH", MODULE)
    monkeypatch.setenv("COIF_STUDIO", str(BIN / "coif-studio"))


@pytest.fixture
def scripted(display, bob, tmp_path):
    """Opens the document with a script and returns when the script has written `done`."""
    opened = []

    def run(source):
        for name in ("bob.coif", "head.obj"):
            shutil.copy(bob.parent / name, tmp_path / name)
        script = tmp_path / "script.py"
        script.write_text(source + "\nopen('done', 'w').close()\n")
        made = Studio(display, tmp_path, "bob.coif", "--script", script).opened("bob.coif")
        opened.append(made)
        made.wait((tmp_path / "done").exists, "the script to end")
        return made

    yield run
    for made in opened:
        made.end()


def test_a_script_works_on_the_open_document(scripted):
    studio = scripted(
        "editor.select_layer(layer=0, kind='face')\n"
        "before = editor.undo_count\n"
        "editor.select_all(kind='vertex')\n"
        "editor.translate(by=(0, 0.5, 0))\n"
        "assert editor.undo_count == before + 2 and editor.modified\n"
        "assert len(editor.selected_vertices) == len(editor.mesh.positions)\n"
        "editor.save('out.coif')"
    )
    before = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    after = coif.Scene.load(studio.folder / "out.coif").hair_mesh
    assert np.allclose(after.positions - before.positions, (0, 0.5, 0), atol=1e-9)
    assert any("translate(by=(0, 0.5, 0))" in line for line in studio.lines())


def test_a_scripts_mesh_comes_back_as_one_step(scripted):
    studio = scripted(
        "mesh = editor.mesh\n"
        "mesh.extrude_faces(mesh.bundle_ids, 0.3)\n"
        "editor.mesh = mesh\n"
        "assert editor.steps == ['Take a mesh ...'], editor.steps\n"
        "layers = editor.mesh.layer_count\n"
        "editor.undo()\n"
        "assert editor.mesh.layer_count == layers - 1\n"
        "editor.redo()\n"
        "editor.save()"
    )
    assert not studio.title().startswith("*")


def test_refusals_and_faults_of_a_script_are_its_own(scripted):
    studio = scripted(
        "import coif\n"
        "told = []\n"
        "for call in (lambda: editor.extrude(), lambda: editor.extrude(length=1), lambda: editor.run('explode')):\n"
        "    try: call()\n"
        "    except coif.Error as error: told.append(str(error))\n"
        "assert 'select faces first' in told[0] and 'length' in told[1] and 'explode' in told[2], told\n"
        "assert editor.steps == []\n"
        "try: editor.nothing\n"
        "except AttributeError: pass\n"
        "else: raise SystemError"
    )
    assert studio.process.poll() is None and studio.lines() == []


def enter(studio, *lines):
    for line in lines:
        if line:
            studio.type(line)
        studio.key("Return")


def test_the_console_runs_what_is_typed(studio):
    studio.key("F4")  # the console opens with the keyboard, and keeps it from line to line
    enter(studio, "editor.select_all()", "editor.drape(seconds=2)")  # the second goes on beside the window
    studio.wait(lambda: any("drape" in line for line in studio.lines()), "the console's commands")
    enter(studio, "for i in range(2): editor.translate(by=(0, 0.25, 0))", "")
    studio.wait(lambda: sum("translate" in line for line in studio.lines()) == 2, "a loop of two moves")
    enter(studio, "import os; os._exit(3)")  # Python dies: the studio does not
    time.sleep(1)
    enter(studio, "editor.select_none()")
    studio.wait(lambda: any("select_none" in line for line in studio.lines()), "a new Python")


def test_lines_typed_faster_than_the_frames_follow_one_another(studio):
    lines = ["editor.select_all(kind='face')", "editor.select_none()", "editor.select_all(kind='vertex')"]
    with studio.frozen():
        studio.key("F4")
        enter(studio, *lines)
    studio.wait(lambda: len(studio.lines()) >= len(lines), "the console's commands")
    assert [line.split("(")[0] for line in studio.lines()] == [line.split("(")[0] for line in lines]


def test_a_scene_is_edited_from_python_and_comes_back(display, bob, monkeypatch):
    monkeypatch.setenv("DISPLAY", display)
    monkeypatch.setenv("XDG_STATE_HOME", str(bob.parent / "state"))
    scene = coif.Scene.load(bob)
    scene.strands.count = 321
    opened = coif.studio(scene, wait=False, arguments=["--size", "600x400"])
    try:
        assert opened.open
        opened.editor.select_layer(layer=2, kind="vertex")
        opened.editor.translate(by=(0, 0, 0.75))
        with pytest.raises(coif.Error, match="no such file|No such|folder|cannot|written"):
            opened.editor.save("/nowhere/at/all.coif")
        opened.editor.save()
        shot = bob.parent / "window.png"
        opened.editor.screenshot(shot)
        assert shot.read_bytes().startswith(b"\x89PNG")
        opened.editor.translate(by=(0, 0, 9))  # not saved, so lost
    finally:
        back = opened.close()
    moved = back.hair_mesh.positions - scene.hair_mesh.positions
    chosen = scene.hair_mesh.layers == 2
    assert np.allclose(moved[chosen], (0, 0, 0.75), atol=1e-9)
    assert np.allclose(moved[scene.hair_mesh.layers == 0], 0)
    assert back.strands.count == 321 and os.path.samefile(back.head, bob.parent / "head.obj")


def test_no_editor_and_no_display_are_sentences(bob, monkeypatch):
    scene = coif.Scene.load(bob)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(coif.Error, match="no window can be opened"):
        coif.studio(scene)
    monkeypatch.setenv("COIF_STUDIO", "")
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(coif.Error, match="coif-studio is not on the PATH"):
        coif.studio(scene)
