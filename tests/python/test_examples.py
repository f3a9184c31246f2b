"""The examples run and model what they say."""

import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

EXAMPLES = sorted((pathlib.Path(__file__).resolve().parents[2] / "examples").glob("[0-9]*.py"))
# What sets each style apart, as bounds on (lowest, highest, hindmost) of the hair: the head reaches from 0 (chin) to
# 24 (crown), its back is at z = -11.
SHAPES = {
    "bob": lambda lo, hi: 1 < lo[1] < 4 and hi[1] < 27,
    "bun": lambda lo, hi: lo[1] > 5 and -19 < lo[2] < -13,
    "mohawk": lambda lo, hi: hi[1] > 30,
    "braid": lambda lo, hi: lo[1] < -3 and lo[2] > -20,
}


def test_there_is_a_check_for_every_example():
    assert sorted(SHAPES) == sorted(path.stem.split("_", 1)[1] for path in EXAMPLES)


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_models_its_style(path, tmp_path):
    name = path.stem.split("_", 1)[1]
    environment = os.environ | {"PYTHONPATH": str(pathlib.Path(coif.__file__).parents[1])}
    done = subprocess.run([sys.executable, path, "-o", tmp_path, "--size", "64"], env=environment, capture_output=True,
                          text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    scene = coif.Scene.load(tmp_path / f"{name}.coif")
    mesh = scene.hair_mesh
    assert mesh.faults() == [] and (tmp_path / f"{name}.coif").stat().st_size < 300_000
    strands = coif.StrandSet.load(tmp_path / f"{name}.usdc")
    assert len(strands) == scene.strands.count
    points = strands.points
    assert SHAPES[name](points.min(axis=0), points.max(axis=0)), (points.min(axis=0), points.max(axis=0))
    surface = coif.Surface(coif.PolygonMesh.load(tmp_path / "head.obj"))
    inside = surface.signed_distance(points[:: max(1, len(points) // 20000)]) < -0.1
    assert inside.mean() < 0.01, "hair lies outside the head (a millimetre for the bend between columns)"
    if hasattr(coif, "render"):
        assert (tmp_path / f"{name}.png").stat().st_size > 1000
