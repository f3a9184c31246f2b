"""Files in and out of the editor: each format through the export dialog, files dropped on the window."""

import json
import shutil
import struct

import numpy as np
import pytest
import x11
from studio_window import PATIENCE, SAME_PICTURE, STRANDS, VIEW, Studio, linear, needs_window

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")
pytestmark = needs_window


def gltf_of(path):
    data = path.read_bytes()
    if path.suffix == ".gltf":
        return json.loads(data)
    assert data[:4] == b"glTF"
    (length,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + length])


def test_every_format_goes_out_through_the_dialog(studio):
    grown = {}
    for number, extension in enumerate((".usdc", ".usda", ".glb", ".gltf", ".hair")):  # as the dialog lists them
        studio.key("ctrl+shift+e")
        if number:
            studio.key("Down")
        studio.shot(f"export-{extension[1:]}")
        studio.key("Return")  # the file's name follows the format
        studio.key("Return")
        path = studio.folder / f"bob{extension}"
        studio.wait(path.exists, path.name)
        if extension in (".glb", ".gltf"):
            file = gltf_of(path)
            assert file["asset"]["version"] == "2.0" and file["meshes"]
        else:
            grown[extension] = coif.StrandSet.load(path)
            assert len(grown[extension]) == STRANDS
    size = np.ptp(grown[".usdc"].points)
    for extension, strands in grown.items():
        # The same hair; text and .hair hold floats, of up to seven digits.
        assert np.allclose(strands.points, grown[".usdc"].points, atol=1e-5 * size), extension
    assert studio.lines() == [], "exporting changes no document"


def test_a_folder_that_cannot_be_written_is_a_sentence(studio):
    studio.did("select_all", "a")
    studio.did("smooth", "shift+r")
    missing = studio.folder / "missing" / "out.usdc"
    studio.path(missing, "ctrl+shift+e", "Return")
    studio.did("smooth", "shift+r")
    assert not missing.parent.exists()
    # A document in a place where nothing can be written, for root neither.
    studio.path("/proc/hair.coif", "ctrl+shift+s")
    studio.did("smooth", "shift+r")
    assert studio.title().startswith("*bob.coif"), "still the old file, and not saved"
    studio.saved()


def dropped(studio, *paths):
    uris = "".join(f"file://{path}\r\n" for path in paths).encode()
    x, y = studio.middle().astype(int)
    x11.drop(studio.environment["DISPLAY"], int(studio.window), int(x), int(y), uris, PATIENCE)


def test_a_dropped_document_or_head_is_opened(studio, bob):
    other = studio.folder / "other name.coif"
    shutil.copy(studio.folder / "bob.coif", other)
    dropped(studio, str(other).replace(" ", "%20"))
    studio.opened("other name.coif")
    dropped(studio, studio.folder / "head.obj")
    studio.opened("(not saved yet)")
    studio.did("select_all", "a")
    dropped(studio, studio.folder / "log.py")  # no document: a sentence
    studio.did("select_none", "alt+a")


def test_another_document_shows_its_own_hair(studio, display):
    """Of the same topology, both opened just now: nothing but the vertices tells them apart."""
    studio.key("KP_3", "Home", "z", "z", "z")
    first = studio.settled("documents-first")[VIEW]
    scene = coif.Scene.load(studio.folder / "bob.coif")
    mesh = scene.hair_mesh
    mesh.positions = np.where(mesh.layers[:, None] > 0, mesh.positions * (1, 1, 1.6), mesh.positions)
    scene.hair_mesh = mesh
    scene.save(studio.folder / "wide.coif")
    studio.path(studio.folder / "wide.coif", "ctrl+o")
    studio.opened("wide.coif")
    studio.key("KP_3", "Home")
    second = studio.settled("documents-second")[VIEW]
    alone = Studio(display, studio.folder, "wide.coif").opened("wide.coif")
    try:
        alone.point(*alone.middle())
        alone.key("KP_3", "Home", "z", "z", "z")
        expected = alone.settled("documents-alone")[VIEW]
    finally:
        alone.end()
    assert coif.flip(linear(second), linear(expected))[0] < SAME_PICTURE
    assert coif.flip(linear(first), linear(expected))[0] > 3 * SAME_PICTURE


def test_unsaved_work_is_asked_for_before_a_dropped_file_takes_its_place(studio):
    other = studio.folder / "other.coif"
    shutil.copy(studio.folder / "bob.coif", other)
    before = coif.Scene.load(studio.folder / "bob.coif").hair_mesh
    studio.did("select_all", "a")
    studio.did("smooth", "shift+r")
    dropped(studio, other)
    studio.settled("drop-asks")
    assert studio.title().startswith("*bob.coif")
    studio.key("Escape")  # stays
    studio.did("smooth", "shift+r")
    dropped(studio, other)
    studio.settled("drop-asks")
    studio.key("Return")  # saves, and goes on
    studio.opened("other.coif")
    assert coif.Scene.load(studio.folder / "bob.coif").hair_mesh != before
