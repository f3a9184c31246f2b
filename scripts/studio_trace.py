#!/usr/bin/env python3
"""What a mouse move costs in the editor: the bob with 100 000 strands, a vertex dragged, a long brush stroke, the same
with operators (clump, curl and frizz), one of their sliders; how soon the example's first picture stands; and with
--head FILE how long a large head takes. Prints milliseconds beyond drawing, from the editor's own trace.

Usage: PYTHONPATH=build/release/python:tests/python COIF_BIN_DIR=build/release/bin \\
       build/venv/bin/python scripts/studio_trace.py
Needs Xvfb and xdotool. Nothing else should run meanwhile.
"""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile

import numpy as np
from studio_window import RIGHT, Studio

import coif

WHATS = ("vertex", "brush", "styled vertex", "slider")
SLIDER = 240  # of the last operator's first number, in the panel Style
WINDOW = ("drag", "project mesh")
PICTURES = ("move strands", "style strands", "plan style", "grow strands")  # on the pictures' thread


def start_server():
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1300x820x24", "-nolisten", "tcp", "-noreset"],
                              pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as numbers:
        return server, f":{numbers.readline().strip()}"


def events(studio, trace):
    studio.key("ctrl+s")
    studio.wait(lambda: not studio.title().startswith("*"), "the document to be saved")
    studio.key("ctrl+q")
    studio.wait(lambda: studio.process.poll() == 0, "the end")
    return json.loads(trace.read_text())["traceEvents"]


def between(trace, names, first, last):
    return [e for e in trace if e["name"] in names and first <= e["ts"] <= last]


def report(what, trace, first, last):
    """Milliseconds: of each part, of a frame's sum in the window, and from picture to picture."""
    for name in (*WINDOW, *PICTURES):
        lengths = [e["dur"] / 1e3 for e in between(trace, [name], first, last)]
        if lengths:
            print(f"{what}: {name}: {np.median(lengths):.2f} median, {max(lengths):.2f} greatest of {len(lengths)}")
    sums = []
    for frame in between(trace, ["frame"], first, last):
        inside = between(trace, WINDOW, frame["ts"], frame["ts"] + frame["dur"])
        if any(e["name"] == "drag" for e in inside):
            sums.append(sum(e["dur"] for e in inside) / 1e3)
    if sums:
        print(f"{what}: the window's parts a frame: {np.median(sums):.2f} median, {max(sums):.2f} greatest of {len(sums)}")
    shown = [e["ts"] / 1e3 for e in between(trace, ["draft picture"], first, last)]
    if len(shown) > 1:
        print(f"{what}: from draft to draft: {np.median(np.diff(shown)):.0f} median of {len(shown)}")


def dragged(trace):
    drags = [e for e in trace if e["name"] == "drag" and e["dur"] > 100]
    return min(e["ts"] for e in drags), max(e["ts"] for e in drags)


def move(studio, middle, moves):
    for i in range(moves):
        studio.tool("mousemove", "--window", studio.window, int(middle[0] - 120 + 240 * i / moves),
                    int(middle[1] - 80 + 60 * np.sin(18 * i / moves)))


def play_with(what, display, folder, moves):
    document = "styled.coif" if what in ("styled vertex", "slider") else "bob.coif"
    trace = folder / f"{what}.json"
    studio = Studio(display, folder, document, "--trace", trace, size="1280x800").opened(document)
    middle = np.array((585, 390))
    studio.point(*middle)
    studio.rest()
    if what.endswith("vertex"):
        mesh = coif.Scene.load(folder / document).hair_mesh
        studio.select(f"v {mesh.bundles[0].vertices[-1][0]}")
        studio.key("g")
        move(studio, middle, moves)
        studio.did("translate", "Return")
    elif what == "brush":
        studio.key("shift+5")
        studio.point(*(middle + (-120, -80)))
        studio.press()
        move(studio, middle, moves)
        studio.release()
    else:
        studio.panel("Style")
        studio.point(1280 - RIGHT + 30, SLIDER)
        studio.press()
        for i in range(moves):
            studio.tool("mousemove", "--window", studio.window, 1280 - RIGHT + 30 + i % 120, SLIDER)
        studio.does(lambda: studio.release(), "set_operator")
    studio.rest()
    found = events(studio, trace)
    if what == "slider":
        shown = [e["ts"] for e in found if e["name"] == "command"]
        report(what, found, shown[-2] if len(shown) > 1 else 0, shown[-1])
    else:
        report(what, found, *dragged(found))
    studio.end()


def open_head(head, display, folder):
    trace = folder / "head.json"
    studio = Studio(display, folder, head, "--style", "", "--trace", trace, size="1280x800").opened("not saved yet")
    studio.rest()
    studio.key("ctrl+q")
    studio.wait(lambda: studio.process.poll() == 0, "the end")
    found = json.loads(trace.read_text())["traceEvents"]
    for name in ("open", "draft picture", "fine picture"):
        lengths = [e["dur"] / 1e6 for e in found if e["name"] == name]
        print(f"{head.name}: {name}: {', '.join(f'{x:.2f}' for x in lengths)} s")
    frames = [e["dur"] / 1e3 for e in found if e["name"] == "frame"]
    print(f"{head.name}: first picture after {min(e['ts'] for e in found if e['name'] == 'upload picture') / 1e6:.2f} s; "
          f"slowest frame of {len(frames)} {max(frames):.0f} ms")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", action="append", choices=WHATS)
    parser.add_argument("--moves", type=int, default=120)
    parser.add_argument("--head", type=pathlib.Path)
    arguments = parser.parse_args()
    server, display = start_server()
    program = pathlib.Path(os.environ["COIF_BIN_DIR"]) / "coif"
    try:
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            subprocess.run([program, "-q", "example-head", "-o", folder / "head.obj"], check=True)
            subprocess.run([program, "-q", "new", "--scalp", folder / "head.obj", "--style", "bob", "-o",
                            folder / "bob.coif"], check=True)
            editor = coif.Editor.open(folder / "bob.coif")
            editor.set_strands(count=100000)
            editor.save(folder / "bob.coif")
            for kind in ("clump", "curl", "frizz"):
                editor.add_operator(kind=kind, fit_points=False)
            editor.save(folder / "styled.coif")
            if arguments.head:
                open_head(arguments.head.resolve(), display, folder)
            for what in arguments.only or WHATS:
                play_with(what, display, folder, arguments.moves)
            if arguments.only:
                return
            for what in ("cold", "warm"):
                trace = folder / f"{what}.json"
                os.environ["MESA_SHADER_CACHE_DIR"] = str(folder / "shaders")
                studio = Studio(display, folder, "--trace", trace, size="1280x800").opened("not saved yet")
                studio.rest()
                studio.key("ctrl+q")
                studio.wait(lambda s=studio: s.process.poll() == 0, "the end")
                found = json.loads(trace.read_text())["traceEvents"]
                first = min(e["ts"] for e in found if e["name"] == "upload picture")
                print(f"first picture, {what} shader cache: {first / 1e6:.2f} s")
    finally:
        server.terminate()


if __name__ == "__main__":
    main()
