"""Hair in motion as others read it: OpenUSD (usd-core) and Blender (bpy) put roots on the head on every frame."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

ROOT = pathlib.Path(__file__).resolve().parents[2]
COIF = pathlib.Path(os.environ.get("COIF_BIN_DIR", ROOT / "build/release/bin")) / "coif"
BLENDER = pathlib.Path(os.environ.get("COIF_BLENDER_PYTHON", ROOT / "build" / "venv-blender" / "bin" / "python"))
FRAMES = 4

if not COIF.exists():
    pytest.skip(f"{COIF} is not built", allow_module_level=True)


def pose(frame):
    """Where the head is: turned about the up axis and carried along."""
    angle = 0.3 * frame
    out = np.eye(4)
    out[:3, :3] = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    out[:3, 3] = [2.0 * frame, 0.5 * frame, -1.0 * frame]
    return out


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A scene, its head at rest and a function that simulates it into a file."""
    folder = tmp_path_factory.mktemp("motion")
    head, scene, motion = folder / "head.obj", folder / "s.coif", folder / "motion.txt"
    subprocess.run([COIF, "example-head", "-o", head], check=True, capture_output=True)
    subprocess.run([COIF, "new", "--scalp", head, "--meters-per-unit", "0.01", "--style", "bob", "-o", scene], check=True,
                   capture_output=True)
    lines = []
    for frame in range(FRAMES):
        x, y, z = pose(frame)[:3, 3]
        lines.append(f"{x} {y} {z} 0 {np.sin(0.15 * frame)} 0 {np.cos(0.15 * frame)}\n")
    motion.write_text("".join(lines))

    def write(name):
        done = subprocess.run([COIF, "simulate", scene, "--frames", str(FRAMES), "--head-motion", motion, "--strands",
                               "150", "--points", "8", "-o", folder / name], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return folder / name

    return coif.Scalp.load(head), write


def check(scalp, roots, head):
    """Roots and head's vertices by frame, in the scene's own axes."""
    for frame in range(FRAMES):
        to, back = pose(frame), np.linalg.inv(pose(frame))
        # The head is where its pose takes it; floats of up to 60 carried through two matrices.
        expected = scalp.mesh.positions @ to[:3, :3].T + to[:3, 3]
        assert np.abs(head[frame] - expected).max() < 2e-4, frame
        local = roots[frame] @ back[:3, :3].T + back[:3, 3]
        assert np.abs(local - roots[0]).max() < 2e-4, frame
        _, _, distances = scalp.surface.project(local)
        assert np.abs(distances).max() < 2e-4, frame


def test_usd_puts_roots_on_the_moving_head(made):
    pytest.importorskip("pxr", reason="usd-core is not installed")
    from pxr import Usd, UsdGeom

    scalp, write = made
    stage = Usd.Stage.Open(str(write("moving.usdc")))
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode(), stage.GetTimeCodesPerSecond()) == (0, FRAMES - 1, 24)
    roots, heads, tips = [], [], []
    for time in range(FRAMES):
        transforms = UsdGeom.XformCache(time)
        for prim in stage.Traverse():
            if not (prim.IsA(UsdGeom.BasisCurves) or (prim.IsA(UsdGeom.Mesh) and prim.GetName() == "Head")):
                continue
            world = np.array(transforms.GetLocalToWorldTransform(prim))  # rows
            points = np.array(UsdGeom.PointBased(prim).GetPointsAttr().Get(time)) @ world[:3, :3] + world[3, :3]
            if prim.IsA(UsdGeom.Mesh):
                heads.append(points)
            else:
                sizes = np.array(UsdGeom.BasisCurves(prim).GetCurveVertexCountsAttr().Get())
                starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
                roots.append(points[starts])
                tips.append(points[starts + sizes - 1])
    check(scalp, roots, heads)
    # Hair is not rigid with the head.
    back = np.linalg.inv(pose(FRAMES - 1))
    assert np.abs(tips[-1] @ back[:3, :3].T + back[:3, 3] - tips[0]).max() > 0.1


@pytest.mark.parametrize("form", ["usdc", "abc"])
def test_blender_puts_roots_on_the_moving_head(made, form, tmp_path):
    if not BLENDER.exists():
        pytest.skip(f"no Blender module: {BLENDER} does not exist (scripts/setup.sh --tests installs it)")
    scalp, write = made
    try:
        path = write(f"blender.{form}")
    except AssertionError as refused:
        if "built without Alembic" in str(refused):
            pytest.skip("this Coif was built without Alembic: its library was not found")
        raise
    frames = [str(f) for f in range(FRAMES)]
    done = subprocess.run([BLENDER, pathlib.Path(__file__).with_name("blender_motion.py"), path, tmp_path / "b.npz",
                           *frames], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    found = np.load(tmp_path / "b.npz")
    # Blender's z is up, and its unit of length a metre where the file says what the unit is.
    scale = 100 if form == "usdc" else 1
    axes = scale * np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    starts = np.concatenate([[0], np.cumsum(found["sizes"])[:-1]])
    check(scalp, [found[f"hair{f}"][starts] @ axes.T for f in frames], [found[f"head{f}"] @ axes.T for f in frames])
