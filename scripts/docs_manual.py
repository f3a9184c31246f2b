#!/usr/bin/env python3
"""Makes the pictures of docs/manual from the running editor, by the steps that its pages describe.

Usage: PYTHONPATH=build/release/python build/venv/bin/python scripts/docs_manual.py [--bin build/release/bin] [-o docs/manual/pictures]
Needs Xvfb. A few minutes on two cores.
"""
import argparse
import os
import pathlib
import subprocess
import tempfile

import numpy as np
from PIL import Image

import coif

SIZE, MOST_BYTES = "1120x700", 200_000


class Book:
    """An editor on a display of its own, and the pictures taken of it."""

    def __init__(self, program, out, folder):
        self.program, self.out, self.folder = program, out, folder

    def open(self, scene):
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


def outward(positions, up=1):
    """Unit vectors from the middle of the roots, level."""
    out = positions - positions.mean(axis=0)
    out[:, up] = 0
    return out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-9)


def first(book):
    editor = book.open(book.scene(None, azimuth=35))
    editor.act("kind_face")
    editor.select_all(kind="face")
    book.shot("first-1-roots")
    for distance, droop in ((1.2, 0), (2.0, -1.6), (2.5, -2.4), (2.5, -2.5)):
        editor.extrude(distance=distance)
        if droop:
            editor.translate(by=(0, droop, 0))
    editor.smooth(strength=0.5, steps=2)
    book.shot("first-2-extruded")
    editor.push_out(margin=0.02)
    editor.drape(seconds=3)
    editor.push_out(margin=0.02)
    editor.select_none()
    book.shot("first-3-draped")
    book.close()


def bun(book):
    editor = book.open(book.scene("bun", azimuth=120))
    book.shot("bun-1")
    editor.act("kind_face")
    mesh = editor.mesh
    editor.select_layer(layer=mesh.layer_count - 1, kind="face")
    editor.inflate(distance=0.35)
    editor.select_none()
    book.shot("bun-2")
    book.close()


def fringe(book):
    editor = book.open(book.scene("bob", azimuth=10))
    mesh = editor.mesh
    # The columns over the forehead: their roots lie in front and high.
    roots = mesh.layers == 0
    front = roots & (mesh.positions[:, 2] > np.percentile(mesh.positions[roots, 2], 75))
    editor.act("kind_vertex")
    editor.select(vertices=mesh.vertex_ids[front])
    editor.select_columns()
    book.shot("fringe-1-selected")
    chosen = np.isin(mesh.vertex_ids, editor.selected_vertices) & (mesh.layers > 2)
    editor.select(vertices=mesh.vertex_ids[chosen])
    editor.scale(factors=(1, 0.55, 1), about_pivot=True, pivot=mesh.positions[chosen].max(axis=0))
    editor.push_out(margin=0.01)
    editor.select_none()
    book.shot("fringe-2-cut")
    book.close()


def curls(book):
    scene = book.scene("long", azimuth=30)
    editor = book.open(scene)
    mesh = editor.mesh
    layers = mesh.layer_count
    book.shot("curls-1-straight")
    column = mesh.positions.copy()
    for layer in range(3, layers):
        here = mesh.layers == layer
        turn = 1.9 * (layer - 3)
        out = outward(column[here])
        side = np.cross(out, (0, 1, 0))
        grow = 0.35 * min(1, (layer - 2) / 3)
        offsets = grow * (np.cos(turn) * side + np.sin(turn) * out)
        editor.displace(vertices=mesh.vertex_ids[here], offsets=offsets)
    editor.select_none()
    book.shot("curls-2-waves")
    book.close()


def motion(book):
    editor = book.open(book.scene("long", strands=15000, azimuth=60))
    editor.set_dynamics(droop=0.6, wind="constant", wind_velocity=(4, 0, -2))
    editor.act("play")
    import time

    time.sleep(12)
    editor.act("play")
    book.shot("motion-1-wind")
    editor.act("motion_reset")
    editor.set_dynamics(droop=1.5)
    editor.drape(seconds=4)
    book.shot("motion-2-draped")
    book.close()


def exporting(book):
    editor = book.open(book.scene("pixie", azimuth=40))
    editor.act("export")
    import time

    time.sleep(1)
    book.shot("export-1-dialog")
    book.close()


def python(book):
    editor = book.open(book.scene("mohawk", azimuth=50))
    editor.act("console")
    script = book.folder / "taper.py"
    script.write_text(
        "mesh = editor.mesh\n"
        "for layer in range(1, mesh.layer_count):\n"
        "    editor.select_layer(layer=layer, kind='face')\n"
        "    editor.scale(factors=(1 - 0.04 * layer, 1, 1))\n"
        "print(editor.undo_count, 'steps')\n")
    editor.act("key_map")
    import time

    time.sleep(1)
    book.shot("python-1-keys")
    book.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/release/bin"))
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("docs/manual/pictures"))
    parser.add_argument("--only", help="the name of one chapter")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    chapters = {f.__name__: f for f in (first, bun, fringe, curls, motion, exporting, python)}
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        read, write = os.pipe()
        server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1300x820x24", "-nolisten", "tcp"],
                                  pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as numbers:
            os.environ["DISPLAY"] = f":{numbers.readline().strip()}"
        os.environ["XDG_STATE_HOME"] = str(folder / "state")
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
