#!/usr/bin/env python3
"""Makes the pictures of docs/style.md: each kind of operator by itself, and a stack growing.

Usage: build/venv/bin/python scripts/docs_style.py [--bin build/release/bin] [-o docs/pictures]
"""
import argparse
import pathlib
import tempfile

from docs_gallery import Studio, sheet

KINDS = [["wave", "curl", "noise"], ["clump", "braid", "flyaways"]]
STACK = [[], ["clump"], ["clump", "curl"], ["clump", "curl", "frizz", "flyaways"]]
LIGHT = ["--lod", "off", "--no-ground"]


def styled(studio, style, kinds):
    studio.run("style", studio.folder / f"{style}.coif", *[a for kind in kinds for a in ("--add", kind)],
               "-o", studio.folder / "styled.coif")
    return studio.picture(*LIGHT, scene="styled")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, default="build/release/bin")
    parser.add_argument("-o", "--output", type=pathlib.Path, default="docs/pictures")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        studio = Studio(arguments.bin.resolve() / "coif", pathlib.Path(folder))
        studio.run("new", "--scalp", studio.folder / "head.obj", "--style", "long", "-o", studio.folder / "long.coif")
        sheet([[(kind, styled(studio, "long", [kind])) for kind in row] for row in KINDS],
              arguments.output / "style-kinds.jpg")
        sheet([[(" + ".join(kinds) or "no operator", styled(studio, "bob", kinds)) for kinds in STACK]],
              arguments.output / "style-stack.jpg")


if __name__ == "__main__":
    main()
