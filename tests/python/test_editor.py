"""Editor: the commands behind the menus, by name, with undo and a Python log that can be played back."""

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")


@pytest.fixture
def path(tuft, tmp_path):
    path = tmp_path / "tuft.coif"
    coif.Scene(tuft, name="tuft").save(path)
    return path


def sculpt(editor):
    editor.select_layer(layer=3, kind="face")
    editor.extrude(distance=0.5)
    editor.translate(by=(0.2, 0, -0.1), radius=1.5)
    editor.select(faces=[0, 4])
    editor.rotate(axis=(0, 1, 0), angle=30)
    editor.set_strands(count=500, points=12)


def test_commands_change_the_mesh_and_undo_takes_them_back(path):
    editor = coif.Editor.open(path)
    before = editor.mesh
    sculpt(editor)
    assert editor.mesh.layer_count == before.layer_count + 1
    assert editor.undo_count == 6 and editor.modified
    while editor.undo_count:
        editor.undo()
    assert editor.mesh == before and not editor.modified


def test_the_python_log_plays_back_to_the_same_mesh(path):
    editor = coif.Editor.open(path)
    sculpt(editor)
    again = coif.Editor.open(path)
    exec(editor.python_log, {"editor": again})
    assert again.mesh == editor.mesh
    assert np.array_equal(again.selected_bundles, editor.selected_bundles)


def test_saved_documents_hold_what_was_edited(path, tmp_path):
    editor = coif.Editor.open(path)
    sculpt(editor)
    editor.save(tmp_path / "out.coif")
    assert not editor.modified
    scene = coif.Scene.load(tmp_path / "out.coif")
    assert scene.hair_mesh == editor.mesh and scene.strands.count == 500 and scene.strands.points == 12


def test_commands_say_what_they_do(path):
    editor = coif.Editor.open(path)
    commands = {info["name"]: info for info in coif.editor_commands()}
    assert set(commands) <= set(dir(editor)) and "python_log" in dir(editor)
    for name, info in commands.items():
        method = getattr(editor, name)
        assert method.__name__ == name and method.__doc__.startswith(info["help"])
        assert all(f"{argument}: {text}" in method.__doc__ for argument, text in info["arguments"].items())


def test_refusals_are_sentences_and_change_nothing(path):
    editor = coif.Editor.open(path)
    before = editor.mesh
    with pytest.raises(coif.Error, match="select faces first"):
        editor.extrude()
    with pytest.raises(coif.Error, match="no argument 'length'"):
        editor.extrude(length=1)
    with pytest.raises(TypeError, match="scheme is of the wrong kind"):
        editor.subdivide(scheme=3)
    with pytest.raises(AttributeError, match="no command 'explode'"):
        editor.explode()
    with pytest.raises(coif.Error, match="nothing to redo"):
        editor.redo()
    assert editor.mesh == before and editor.steps == []


def test_every_command_is_listed_with_its_help():
    commands = coif.editor_commands()
    assert {"extrude", "undo", "translate", "select_loop"} <= {c["name"] for c in commands}
    assert all(c["help"] and c["menu"] for c in commands)
