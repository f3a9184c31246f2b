#!/usr/bin/env python3
"""Makes the gallery of docs/gallery.md: hair colours, shadow methods beside their difference to the truth, shadings.

Usage: build/venv/bin/python scripts/docs_gallery.py [--bin build/release/bin] [-o docs/pictures]
"""
import argparse
import pathlib
import subprocess
import tempfile

import numpy as np
from PIL import Image, ImageDraw

COLORS = ["black", "brown", "red", "blond", "grey", "dyed"]
SHADOWS = ["exact", "deep-opacity", "occupancy", "density-clustering", "opacity", "light-map", "none"]
SHADINGS = ["studio", "kajiya-kay", "marschner", "energy-conserving", "dual-scattering"]
SIZE, STRANDS = 220, 60000


class Studio:
    """Renders views of one scene and keeps nothing."""

    def __init__(self, coif, folder):
        self.coif, self.folder = coif, folder
        self.run("example-head", "-o", folder / "head.obj")
        self.run("new", "--scalp", folder / "head.obj", "--style", "bob", "-o", folder / "bob.coif")

    def run(self, *arguments):
        subprocess.run([self.coif, "-q", *map(str, arguments)], check=True)

    def picture(self, *options, scene="bob"):
        path = self.folder / "picture.png"
        self.run("render", self.folder / f"{scene}.coif", "-o", path, "--size", f"{SIZE}x{SIZE}",
                 "--strands", STRANDS, *options)
        return Image.open(path).convert("RGB").copy()


def sheet(rows, path):
    """Rows of (label, picture) as one picture."""
    columns = max(len(row) for row in rows)
    out = Image.new("RGB", (columns * (SIZE + 4), len(rows) * (SIZE + 20)), "white")
    draw = ImageDraw.Draw(out)
    for j, row in enumerate(rows):
        for i, (label, picture) in enumerate(row):
            out.paste(picture, (i * (SIZE + 4), j * (SIZE + 20) + 16))
            draw.text((i * (SIZE + 4) + 4, j * (SIZE + 20) + 2), label, fill="black")
    out.save(path, quality=88, optimize=True)  # a palette would grey the colours


def difference(a, b, gain=4):
    """|a − b| times the gain, and its mean in 8-bit steps."""
    delta = np.abs(np.asarray(a, int) - np.asarray(b, int))
    return Image.fromarray(np.clip(gain * delta, 0, 255).astype(np.uint8)), delta.mean()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, default="build/release/bin")
    parser.add_argument("-o", "--output", type=pathlib.Path, default="docs/pictures")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        studio = Studio(arguments.bin.resolve() / "coif", pathlib.Path(folder))
        colors = [(c, studio.picture("--shading", "dual-scattering", "--hair", c)) for c in COLORS]
        sheet([colors[:3], colors[3:]], arguments.output / "gallery-colors.jpg")
        shadows = {s: studio.picture("--visibility", s, "--hair", "blond") for s in SHADOWS}
        apart = {s: difference(shadows[s], shadows["exact"]) for s in SHADOWS}
        sheet([list(shadows.items()), [(f"difference x 4, mean {apart[s][1]:.2f}", apart[s][0]) for s in SHADOWS]],
              arguments.output / "gallery-shadows.jpg")
        sheet([[(s, studio.picture("--shading", s, "--hair", "red")) for s in SHADINGS]],
              arguments.output / "gallery-shadings.jpg")


if __name__ == "__main__":
    main()
