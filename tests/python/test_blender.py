"""Blender reads what Coif writes. Needs Blender as a module (bpy 5.0) in an environment of its own:
build/venv-blender, or the interpreter that COIF_BLENDER_PYTHON names.
"""

import os
import pathlib
import subprocess

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLENDER = pathlib.Path(os.environ.get("COIF_BLENDER_PYTHON", ROOT / "build" / "venv-blender" / "bin" / "python"))


@pytest.fixture(scope="module")
def blender():
    if not BLENDER.exists():
        pytest.skip(f"no Blender module: {BLENDER} does not exist (scripts/setup.sh --tests installs it)")

    def read(path):
        # Blender's glTF importer fills custom attributes in the order of a Python set and stops with an exception
        # where types differ and the order is not the file's; 0 is a seed by which they agree here.
        target = path.with_name(path.name + ".npz")
        done = subprocess.run([BLENDER, pathlib.Path(__file__).with_name("blender_read.py"), path, target],
                              capture_output=True, text=True, timeout=300, env=os.environ | {"PYTHONHASHSEED": "0"})
        assert done.returncode == 0, done.stderr[-2000:]
        log = done.stdout + done.stderr
        return dict(np.load(target)), log

    return read


@pytest.fixture(scope="module")
def model():
    """Hair on the example head, in two lengths: strands of different numbers of points too."""
    scalp = coif.Scalp(coif.example_head(32))
    mesh = coif.HairMesh.from_scalp(scalp, scalp.cage(60))
    for _ in range(3):
        mesh.extrude_faces(mesh.bundle_ids, 2.0)
    bent = mesh.positions
    bent[:, 1] -= mesh.layers.astype(float) ** 2 * 0.5
    mesh.positions = bent
    strands = coif.grow(mesh, count=250, tolerance=0.002)
    assert len(set(np.diff(strands.offsets.astype(int)))) > 1, "adaptive sampling gives several numbers of points"
    return scalp, mesh, strands


@pytest.fixture(scope="module", params=["usda", "usdc"])
def usd(request, blender, model, tmp_path_factory):
    scalp, mesh, strands = model
    path = tmp_path_factory.mktemp("blender") / f"hair.{request.param}"
    strands.save(path, hair_mesh=mesh, head=scalp.mesh)
    return blender(path)


def test_usd_curves_arrive_whole(usd, model):
    found, _ = usd
    _, _, strands = model
    np.testing.assert_array_equal(found["CURVES0:sizes"], np.diff(strands.offsets.astype(int)))
    np.testing.assert_array_equal(found["CURVES0:position@POINT"], strands.points)
    # Blender keeps radii: half a diameter is exact in float.
    np.testing.assert_array_equal(found["CURVES0:radius@POINT"], strands.widths / 2)
    assert "CURVES1:name" not in found


LINEAR = """#usda 1.0
def BasisCurves "curve" {
    uniform token type = "linear"
    int[] curveVertexCounts = [3]
    point3f[] points = [(0, 0, 0), (0, 1, 0), (1, 1, 0)]
}
"""


def test_usd_curves_are_catmull_rom(usd, blender, tmp_path):
    """Kind 0 passes through its points, where a B-spline is only near them. Blender stores no kinds where all are 0;
    a linear curve shows that it stores others."""
    (tmp_path / "linear.usda").write_text(LINEAR)
    assert blender(tmp_path / "linear.usda")[0]["CURVES0:curve_type@CURVE"].tolist() == [1]
    assert not usd[0].get("CURVES0:curve_type@CURVE", np.zeros(1)).any()


def test_usd_attributes_arrive_where_blender_looks_for_them(usd, model):
    found, _ = usd
    _, _, strands = model
    np.testing.assert_array_equal(found["CURVES0:surface_uv_coordinate@CURVE"], strands.root_uvs)
    np.testing.assert_array_equal(found["CURVES0:st@CURVE"], strands.root_uvs)
    np.testing.assert_array_equal(found["CURVES0:groom_id@CURVE"], np.arange(len(strands)))
    np.testing.assert_array_equal(found["CURVES0:coif:rootFace@CURVE"], strands.root_faces)


def test_usd_units_and_axis_arrive(usd, model):
    """World positions are metres with z up, whatever the file's unit and axis."""
    found, _ = usd
    _, _, strands = model
    world = strands.points @ found["CURVES0:world"][:3, :3].T + found["CURVES0:world"][:3, 3]
    expected = strands.points[:, [0, 2, 1]] * [0.01, -0.01, 0.01]
    # Float matrices: 1e-7 of the 0.3 m that a head measures.
    np.testing.assert_allclose(world, expected, rtol=0, atol=1e-7)


def test_usd_head_arrives_as_quads(usd, model):
    found, _ = usd
    scalp, _, _ = model
    heads = [k for k in found if k.endswith(":polygons") and len(found[k]) == scalp.mesh.face_count]
    assert len(heads) == 1
    prefix = heads[0][: -len("polygons")]
    assert (found[heads[0]] == 4).all()
    np.testing.assert_array_equal(found[prefix + "vertices"], scalp.mesh.positions.astype(np.float32))


def test_usd_import_says_nothing_bad(usd):
    _, log = usd
    lines = [line for line in log.splitlines() if "Warning" in line or "Error" in line]
    # Blender has no 64-bit integers: the stable id stays in the file for others, groom_id is its stand-in.
    assert [line for line in lines if "coif:id" not in line] == []


def test_glb_lines_arrive_whole(blender, model, tmp_path):
    scalp, mesh, strands = model
    path = tmp_path / "hair.glb"
    strands.save(path, hair_mesh=mesh, mesh=coif.StrandMesh.CARDS)
    found, _ = blender(path)
    lines = [k[: -len("polygons")] for k in found if k.endswith(":polygons") and len(found[k]) == 0]
    assert len(lines) == 1
    prefix = lines[0]
    np.testing.assert_array_equal(found[prefix + "vertices"], strands.points[:, [0, 2, 1]] * np.float32([1, -1, 1]))
    np.testing.assert_array_equal(found[prefix + "_RADIUS@POINT"], strands.widths / 2)
    strand_of_point = np.repeat(np.arange(len(strands)), np.diff(strands.offsets.astype(int)))
    np.testing.assert_array_equal(found[prefix + "_STRAND_ID@POINT"], strand_of_point)
    np.testing.assert_array_equal(found[prefix + "_ROOT_UV@POINT"][:, 0], strands.root_uvs[strand_of_point, 0])
    # An edge joins each point to the next of its strand, and nothing else.
    inner = np.flatnonzero(np.diff(strand_of_point) == 0)
    edges = np.sort(found[prefix + "edges"], axis=1)
    assert set(map(tuple, edges.tolist())) == set(zip(inner.tolist(), (inner + 1).tolist()))
    world = found[prefix + "world"]
    np.testing.assert_allclose(world[:3, :3], np.eye(3) * 0.01, atol=1e-9)
    meshes = [k for k in found if k.endswith(":polygons") and len(found[k]) > 0]
    assert len(meshes) == 2, "the hair mesh and the cards"
