#!/usr/bin/env python3
"""Makes the pictures of docs/manual from the running editor, by the steps that its pages describe.

Usage: PYTHONPATH=build/release/python build/venv/bin/python scripts/docs_manual.py [--bin build/release/bin] [-o docs/manual/pictures]
Needs Xvfb. A few minutes on two cores.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
from PIL import Image

import coif

SIZE, MOST_BYTES = "1120x700", 200_000
EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"


class Book:
    """An editor on a display of its own, and the pictures taken of it."""

    def __init__(self, program, out, folder):
        self.program, self.out, self.folder = program, out, folder

    def open(self, scene, *panels):
        """With these panels open at the right."""
        settings = {"open": {name: True for name in panels}, "tourSeen": True}
        (self.folder / "state/coif/studio.json").write_text(json.dumps(settings))
        self.opened = coif.studio(scene, wait=False, arguments=["--size", SIZE])
        return self.opened.editor

    def close(self):
        self.opened.close()

    def shot(self, name, box=None):
        editor = self.opened.editor
        editor.rest()
        path = self.folder / "shot.png"
        editor.screenshot(path)
        picture = Image.open(path).convert("RGB")
        if box:
            picture = picture.crop(box)
        target = self.out / f"{name}.jpg"
        for quality in (88, 78, 66):
            picture.save(target, quality=quality, optimize=True)
            if target.stat().st_size <= MOST_BYTES:
                print(target, target.stat().st_size, "bytes")
                return
        raise SystemExit(f"{target} stays larger than {MOST_BYTES} bytes")

    def scene(self, style, strands=30000, **look):
        scalp = coif.Scalp.load(self.folder / "head.obj")
        mesh = coif.model_hairstyle(style, scalp) if style else coif.HairMesh.from_scalp(scalp, scalp.cage(80))
        scene = coif.Scene(mesh, head=self.folder / "head.obj", name=style or "hair")
        scene.strands.count = strands
        for name, value in look.items():
            setattr(scene, name, value)
        return scene


def forehead(mesh, share):
    """Root vertices in front: that share of them that lies farthest to the front."""
    roots = mesh.layers == 0
    return mesh.vertex_ids[roots & (mesh.positions[:, 2] > np.percentile(mesh.positions[roots, 2], 100 - share))]


def first(book):
    editor = book.open(book.scene(None, strands=60000, azimuth=35), "Style")
    editor.act("kind_face")
    editor.select_all(kind="face")
    book.shot("first-1-roots")
    editor.extrude(distance=14, layers=10, bend=0.35)
    editor.push_out(margin=0.02)
    editor.smooth(strength=0.5, steps=2)
    editor.push_out(margin=0.02)
    editor.select_none()
    editor.act("frame_all")
    book.shot("first-2-extruded")
    editor.set_look(color=(0.28, 0.13, 0.06))
    editor.add_operator(kind="clump")
    editor.set_operator(operator="Clump", parameter="amount", value=0.5)
    editor.add_operator(kind="frizz")
    editor.add_operator(kind="length", name="Fringe")
    editor.set_operator(operator="Fringe", parameter="scale", value=0.5)
    mesh = editor.mesh
    editor.set_mask(operator="Fringe", vertices=mesh.vertex_ids[mesh.layers == 0], values=[0])
    editor.set_mask(operator="Fringe", vertices=forehead(mesh, 15), values=[1])
    editor.act("hand_mask")
    book.shot("first-3-mask")
    editor.act("hand_select")
    editor.act("mesh_hidden")
    book.shot("first-4-done")
    book.close()


def bun(book):
    editor = book.open(book.scene("bun", azimuth=120), "Strands", "History")
    book.shot("bun-1")
    editor.act("kind_face")
    mesh = editor.mesh
    editor.select_layer(layer=mesh.layer_count - 1, kind="face")
    editor.inflate(distance=0.35)
    book.shot("bun-2")
    knot = (mesh.layers > 0) & (mesh.positions[:, 2] < -12)
    editor.act("kind_vertex")
    editor.select(vertices=mesh.vertex_ids[knot])
    editor.translate(by=(0, 2, 0))
    editor.push_out(margin=0.02)
    editor.act("frame_all")
    book.shot("bun-3")
    book.close()


def braid(book):
    subprocess.run([sys.executable, EXAMPLES / "04_braid.py", "-o", book.folder], check=True)
    editor = book.open(coif.Scene.load(book.folder / "braid.coif"), "Strands", "Groups")
    editor.act("view_back")
    editor.act("frame_all")
    book.shot("braid-1")
    mesh = editor.mesh
    editor.act("kind_face")
    editor.select(faces=np.ravel([(mesh.bundle_ids[0], 10)]))
    editor.select_linked()
    editor.select_columns()
    book.shot("braid-2")
    book.close()


def fringe(book):
    editor = book.open(book.scene("bob", azimuth=10), "History")
    mesh = editor.mesh
    editor.act("kind_vertex")
    editor.select(vertices=forehead(mesh, 25))
    editor.select_columns()
    book.shot("fringe-1-selected")
    chosen = np.isin(mesh.vertex_ids, editor.selected_vertices) & (mesh.layers > 2)
    editor.select(vertices=mesh.vertex_ids[chosen])
    editor.scale(factors=(1, 0.55, 1), about_pivot=True, pivot=mesh.positions[chosen].max(axis=0))
    editor.push_out(margin=0.01)
    editor.select_none()
    book.shot("fringe-2-cut")
    book.close()

    editor = book.open(book.scene("pixie", azimuth=20), "History")
    mesh = editor.mesh
    edge, side = parting(mesh)
    editor.act("kind_edge")
    editor.select(edges=edge)
    editor.select_loop()
    book.shot("fringe-3-line")
    editor.separate_edges()
    editor.select_none()
    mesh = editor.mesh
    left = [id_ for id_ in mesh.bundle_ids if mesh.positions[mesh.bundle(id_).vertices[0], 0].mean() > side]
    editor.act("kind_face")
    editor.select(faces=np.ravel([(id_, 2) for id_ in left]))
    editor.select_columns()
    book.shot("fringe-4-parted")
    book.close()


def parting(mesh):
    """An edge just above the scalp that runs from front to back over the forehead, left of the middle; and its x."""
    best, found = np.inf, None
    for id_ in mesh.bundle_ids:
        face = mesh.bundle(id_).vertices[0]
        for side in range(4):
            a, b = mesh.positions[face[side]], mesh.positions[face[(side + 1) % 4]]
            along = abs(b[2] - a[2]) / np.linalg.norm(b - a)
            middle = (a + b) / 2
            wrong = 4 * (1 - along) + abs(middle[0] - 2.5) + 0.5 * abs(middle[2] - mesh.positions[:, 2].max())
            if wrong < best:
                best, found = wrong, ((id_, 1, side), middle[0])
    return found


def curls(book):
    editor = book.open(book.scene("long", azimuth=30), "Style")
    book.shot("curls-1-straight")
    editor.add_operator(kind="clump")
    editor.add_operator(kind="curl")
    editor.set_operator(operator="Curl", parameter="radius", value=0.9)
    editor.set_ramp(operator="Curl", points=[0.1, 0, 0.55, 1])
    editor.add_operator(kind="flyaways")
    editor.act("mesh_hidden")
    book.shot("curls-2-curls")
    book.close()


def motion(book):
    editor = book.open(book.scene("long", strands=15000, azimuth=60), "Motion")
    editor.set_dynamics(droop=0.6, wind="constant", wind_velocity=(4, 0, -2))
    editor.act("play")
    time.sleep(12)
    editor.act("play")
    book.shot("motion-1-wind")
    editor.act("motion_reset")
    editor.set_dynamics(droop=1.5)
    editor.drape(seconds=4)
    book.shot("motion-2-draped")
    book.close()


def exporting(book):
    editor = book.open(book.scene("pixie", azimuth=40), "Strands")
    editor.act("export")
    time.sleep(1)
    book.shot("export-1-dialog")
    book.close()


def python(book):
    editor = book.open(book.scene("mohawk", azimuth=50), "History", "Python")
    editor.act("console")
    mesh = editor.mesh
    for layer in range(1, mesh.layer_count):
        editor.select_layer(layer=layer, kind="face")
        editor.scale(factors=(1 - 0.04 * layer, 1, 1))
    editor.select_none()
    book.shot("python-1-console")
    editor.act("key_map")
    time.sleep(1)
    book.shot("python-2-keys")
    book.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/release/bin"))
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("docs/manual/pictures"))
    parser.add_argument("--only", help="the name of one chapter")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    chapters = {f.__name__: f for f in (first, bun, braid, fringe, curls, motion, exporting, python)}
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        read, write = os.pipe()
        server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1300x820x24", "-nolisten", "tcp"],
                                  pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as numbers:
            os.environ["DISPLAY"] = f":{numbers.readline().strip()}"
        os.environ["XDG_STATE_HOME"] = str(folder / "state")
        (folder / "state/coif").mkdir(parents=True)
        os.environ["COIF_STUDIO"] = str((arguments.bin / "coif-studio").resolve())
        try:
            subprocess.run([arguments.bin / "coif", "-q", "example-head", "-o", folder / "head.obj"], check=True)
            book = Book(arguments.bin, arguments.output, folder)
            for name, chapter in chapters.items():
                if arguments.only in (None, name):
                    chapter(book)
        finally:
            server.terminate()


if __name__ == "__main__":
    main()
