#!/usr/bin/env python3
"""What a mouse move costs in the editor: the bob with 100 000 strands, a vertex dragged, a long brush stroke; and how
soon the example's first picture stands. Prints milliseconds beyond drawing, from the editor's own trace.

Usage: PYTHONPATH=build/release/python:tests/python COIF_BIN_DIR=build/release/bin \\
       build/venv/bin/python scripts/studio_trace.py
Needs Xvfb and xdotool. Nothing else should run meanwhile.
"""
import json
import os
import pathlib
import subprocess
import tempfile

import numpy as np
from studio_window import Studio

import coif

BEYOND_DRAWING = ("drag", "project mesh", "move strands", "style strands")


def start_server():
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1300x820x24", "-nolisten", "tcp"],
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


def report(what, trace):
    """Milliseconds a frame in which the tool ran, by part, and of the worst frame's sum."""
    drags = [e for e in trace if e["name"] == "drag" and e["dur"] > 100]
    first, last = min(e["ts"] for e in drags), max(e["ts"] for e in drags)
    frames = [e for e in trace if e["name"] == "frame" and first <= e["ts"] + e["dur"] and e["ts"] <= last]
    of = {name: [e for e in trace if e["name"] == name] for name in BEYOND_DRAWING}
    for name, found in of.items():
        lengths = np.array([e["dur"] / 1e3 for e in found if first <= e["ts"] <= last])
        if len(lengths):
            print(f"{what}: {name}: {np.median(lengths):.2f} median, {lengths.max():.2f} greatest of {len(lengths)}")
    sums = []
    for frame in frames:
        inside = lambda e, f=frame: f["ts"] <= e["ts"] < f["ts"] + f["dur"]  # noqa: E731
        mine = sum(e["dur"] for name in ("drag", "project mesh") for e in of[name] if inside(e))
        if any(inside(e) for e in drags):
            sums.append(mine / 1e3)
    print(f"{what}: tool, placement and projection a frame: {np.median(sums):.2f} median, {max(sums):.2f} greatest")


def main():
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
            for what in ("vertex", "brush"):
                trace = folder / f"{what}.json"
                studio = Studio(display, folder, "bob.coif", "--trace", trace, size="1280x800").opened("bob.coif")
                middle = np.array((585, 390))
                studio.point(*middle)
                studio.rest()
                if what == "vertex":
                    mesh = coif.Scene.load(folder / "bob.coif").hair_mesh
                    studio.select(f"v {mesh.bundles[0].vertices[-1][0]}")
                    studio.key("g")
                else:
                    studio.key("shift+5")
                    studio.point(*(middle + (-120, -80)))
                    studio.press()
                for i in range(120):
                    studio.tool("mousemove", "--window", studio.window, int(middle[0] - 120 + 2 * i),
                                int(middle[1] - 80 + 60 * np.sin(i / 9)))
                studio.did("translate", "Return") if what == "vertex" else studio.release()
                studio.rest()
                report(what, events(studio, trace))
                studio.end()
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
