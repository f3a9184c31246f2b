"""Styles as plain data: in a scene, in an editor, on strands."""
import numpy as np
import pytest

import coif


@pytest.fixture
def lawn():
    """4 × 4 quads of one unit, 12 high; y is up."""
    xs, zs = np.meshgrid(np.arange(5.0), -np.arange(5.0))
    positions = np.stack([xs.ravel(), np.zeros(25), zs.ravel()], axis=1)
    faces = [(a, a + 1, a + 6, a + 5) for y in range(4) for a in range(5 * y, 5 * y + 4)]
    mesh = coif.HairMesh.from_root(positions, faces)
    for _ in range(4):
        mesh.extrude_faces(mesh.bundle_ids, direction=(0, 3, 0))
    return mesh


def plain(kind, **parameters):
    return {"kind": kind, "parameters": parameters, "ramp": [(0, 1)], "amount": 1}


def test_kinds_say_what_they_take():
    kinds = {k["kind"]: k for k in coif.style_kinds()}
    assert {"curl", "wave", "frizz", "clump", "trim", "push_out"} <= set(kinds)
    radius = next(p for p in kinds["curl"]["parameters"] if p["name"] == "radius")
    assert radius["unit"] == "cm" and radius["least"] <= radius["standard"] <= radius["most"] and radius["help"]


def test_a_scene_keeps_its_style(lawn, tmp_path):
    scene = coif.Scene(lawn)
    scene.strands.count = 500
    assert scene.styles == []
    straight = scene.evaluate(use_head=False)
    scene.styles = [plain("curl", radius=0.5, wavelength=3, size_variation=0, hand="left")]
    assert scene.styles[0]["name"] == "Curl" and scene.styles[0]["parameters"]["hand"] == "left"
    scene.save(tmp_path / "curly.coif")
    again = coif.Scene.load(tmp_path / "curly.coif")
    assert again.styles == scene.styles
    curled = again.evaluate(use_head=False)
    off = np.linalg.norm(curled.points - straight.points, axis=1).reshape(500, -1)
    assert np.all(off[:, 0] == 0)
    np.testing.assert_allclose(off[:, 1:], 0.5, atol=3e-6)  # floats near 12
    assert next(r for r in again.reports if r.name == "style").state == coif.StageState.RAN
    same = coif.style_strands(straight, lawn, again.styles)
    np.testing.assert_array_equal(same.points, curled.points)
    np.testing.assert_array_equal(straight.points, scene_points(lawn))


def scene_points(mesh):
    scene = coif.Scene(mesh)
    scene.strands.count = 500
    return scene.evaluate(use_head=False).points


@pytest.mark.parametrize(
    "styles, error",
    [
        ([{"kind": "perm"}], coif.Error),
        ([{"kind": "curl", "parameters": {"radius": float("nan")}}], coif.Error),
        ([{"kind": "curl", "ramp": [(1, 0), (0, 1)]}], coif.Error),
        ([{"kind": "curl", "name": "A"}, {"kind": "wave", "name": "A"}], coif.Error),
        ([{"name": "A"}], TypeError),
        ([{"kind": "curl", "colour": 1}], TypeError),
        ([5], TypeError),
        (5, TypeError),
    ],
)
def test_what_is_no_style_is_refused(lawn, styles, error):
    scene = coif.Scene(lawn)
    with pytest.raises(error):
        scene.styles = styles
    assert scene.styles == []


def test_the_log_of_an_editor_plays_back(lawn, tmp_path):
    coif.Scene(lawn).save(tmp_path / "lawn.coif")
    editor = coif.Editor.open(tmp_path / "lawn.coif", use_head=False)
    editor.add_operator(kind="clump")
    editor.add_operator(kind="curl", name="Ringlets")
    editor.set_operator(operator="Ringlets", parameter="radius", value=0.75)
    editor.set_ramp(operator="Clump", points=[0, 0, 1, 0.5], shape="linear")
    editor.set_mask(operator="Clump", vertices=lawn.vertex_ids[lawn.layers == 0][:3], values=[0.25])
    again = coif.Editor.open(tmp_path / "lawn.coif", use_head=False)
    exec(editor.python_log, {"editor": again})
    assert again.styles == editor.styles and len(again.styles) == 2
    assert again.styles[0]["ramp"] == [(0, 0), (1, 0.5)] and not again.styles[0]["smooth"]
    with pytest.raises(coif.Error, match="Ringlets"):
        editor.remove_operator(operator="Waves")
