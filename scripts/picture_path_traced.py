#!/usr/bin/env python3
"""Path traced pictures of a ready hairstyle in several colours, side by side, as one PNG.

    picture_path_traced.py bob.coif head.obj -o docs/pictures/path-traced.png [--size 256] [--samples 64]
"""

import argparse

import numpy as np

import coif

COLOURS = {"black": (0.03, 0.02, 0.015), "brown": (0.18, 0.08, 0.04), "red": (0.42, 0.12, 0.04),
           "blond": (0.72, 0.52, 0.28)}
BACKGROUND = np.array([0.05, 0.055, 0.065, 1], np.float32)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("head")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--size", type=int, default=256, help="pixels a side")
    parser.add_argument("--samples", type=int, default=64, help="for each pixel")
    parser.add_argument("--strands", type=int, default=60000)
    options = parser.parse_args()
    scene = coif.Scene.load(options.scene)
    scene.strands.count = options.strands
    strands = scene.evaluate()
    head = coif.PolygonMesh.load(options.head)
    pictures = []
    for name, colour in COLOURS.items():
        picture = coif.path_trace(strands, head, size=(options.size, options.size), azimuth=35, elevation=8,
                                  hair_color=colour, samples=options.samples)
        million = (picture.rays + picture.shadow_rays) / 1e6
        print(f"{name}: {picture.seconds:.1f} s, {million:.1f} million rays, mean {picture.mean.round(4)} "
              f"± {picture.confidence95.round(4)}, a pixel's error {100 * picture.relative_error:.1f} %")
        pictures.append(picture.image + (1 - picture.image[..., 3:]) * BACKGROUND)
    coif.save_png(options.output, coif.to_srgb(np.concatenate(pictures, axis=1)))


if __name__ == "__main__":
    main()
