"""Pictures as arrays."""

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")
if not hasattr(coif, "render"):
    pytest.skip("built without the preview room", allow_module_level=True)


@pytest.fixture(scope="module")
def preview():
    try:
        return coif.Preview()
    except coif.Error as error:
        pytest.skip(f"no OpenGL here: {error}")


def test_a_picture_shows_the_strands_where_they_are(preview):
    """Many strands in the right half of the view only: coverage there, none on the left."""
    rng = np.random.default_rng(2)
    roots = np.c_[rng.uniform(0.2, 0.9, 4000), rng.uniform(-0.9, 0.9, 4000), np.zeros(4000)]
    points = roots[:, None, :] + np.array([[0, 0, 0], [0, 0.05, 0], [0, 0.1, 0]])
    strands = coif.StrandSet(points)
    strands.widths = np.full(strands.point_count, 0.02)
    camera = coif.Camera((0, 0, 5), (0, 0, 0), fov=2 * np.degrees(np.arctan(0.2)))  # sees y from -1 to 1
    image = coif.render(strands, size=(160, 80), camera=camera, transparent=True, preview=preview)
    assert image.shape == (80, 160, 4) and image.dtype == np.uint8
    alpha = image[..., 3] / 255
    assert alpha[:, :80].max() == 0
    assert alpha[8:72, 96:112].mean() > 0.5


def test_the_hair_has_the_colour_that_was_asked_for(preview, tuft):
    strands = coif.grow(tuft, count=3000, width=0.02)
    for channel in range(3):
        color = [0.02, 0.02, 0.02]
        color[channel] = 0.5
        image = coif.render(strands, size=(64, 64), hair_color=color, transparent=True, preview=preview)
        mean = image[image[..., 3] > 200][:, :3].mean(axis=0)
        assert mean.argmax() == channel


def test_a_session_moves_the_mesh_and_uploads_it_alone(preview, tuft):
    """The whole mesh moved by half the view: the picture is the old one, moved; only its vertices went to the GPU."""
    strands = coif.grow(tuft, count=3000, width=0.02)
    positions = np.array(tuft.positions)
    session = coif.PreviewSession(preview)
    session.set_hair(tuft, strands)
    lo, hi = positions.min(axis=0), positions.max(axis=0)
    wide = (hi[0] - lo[0]) * np.array([1.0, 0, 0])
    session.set_camera(coif.Camera.frame(lo - wide, hi + wide, azimuth=0, elevation=0))
    still = session.render(size=(120, 120), transparent=True, shadows=False)
    assert session.uploaded["strands"] >= 3000 * 48
    assert still[..., 3].sum() > 0
    raised = positions.copy()
    raised[raised[:, 1] > 0] *= (1.0, 0.5, 1.0)  # the hair half as long; roots stay
    session.move_hair(raised)
    moved = session.render(size=(120, 120), transparent=True, shadows=False)
    assert session.uploaded["strands"] == 0
    assert session.uploaded["hair_mesh"] == 16 * len(positions)
    rows = lambda image: np.flatnonzero(image[..., 3].sum(axis=1))
    assert np.ptp(rows(moved)) == pytest.approx(0.5 * np.ptp(rows(still)), abs=4)
    session.render(size=(120, 120), transparent=True, shadows=False)
    assert dict((n, s) for n, s, _ in session.stages)["strands for the eye"] == "reused"
    with pytest.raises(ValueError):
        session.move_hair(raised[:-1])


def test_pictures_are_written_as_png(preview, tuft, tmp_path):
    image = coif.render(hair_mesh=tuft, size=(32, 24), preview=preview)
    coif.save_png(tmp_path / "mesh.png", image)
    data = (tmp_path / "mesh.png").read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    assert int.from_bytes(data[16:20], "big") == 32 and int.from_bytes(data[20:24], "big") == 24


def test_bad_arguments_are_refused(preview, tuft, tmp_path):
    with pytest.raises(ValueError):
        coif.render(preview=preview)
    with pytest.raises(ValueError):
        coif.render(hair_mesh=tuft, size=(0, 10), preview=preview)
    with pytest.raises(ValueError):
        coif.save_png(tmp_path / "x.png", np.zeros((4, 4, 3), np.uint8))
    with pytest.raises(ValueError):
        coif.save_png(tmp_path / "x.png", np.full((4, 4, 4), 256))


def test_the_ways_of_the_command_are_those_of_the_module(preview, tuft):
    strands = coif.grow(tuft, count=400, points=8)
    common = dict(size=(48, 48), hair_color=(0.5, 0.3, 0.1), transparent=True, subframes=2, preview=preview)
    default = coif.render(strands, **common)
    for option, words in {
        "shading": ["kajiya-kay", "marschner", "energy-conserving", "dual-scattering"],
        "visibility": ["none", "light-map", "occupancy", "exact"],
        "transparency": ["opaque", "stochastic", "weighted-average", "half-angle-slices", "exact-lists"],
    }.items():
        pictures = [coif.render(strands, **common, **{option: word}) for word in words]
        for k, picture in enumerate(pictures):
            assert (picture[..., 3] > 0).any()
            assert not np.array_equal(picture, default), (option, words[k])
            assert all(not np.array_equal(picture, other) for other in pictures[:k]), (option, words[k])
        with pytest.raises(ValueError, match=f"{option} is one of .*{words[0]}.*not 'blue'"):
            coif.render(strands, **common, **{option: "blue"})
    assert not np.array_equal(coif.render(strands, **common, layers=3), default)
    session = coif.PreviewSession(preview)
    session.set_strands(strands)
    shown = session.render(size=(48, 48), shading="dual-scattering", transparency="half-angle-slices")
    assert any(stage == "half-angle slices" and state == "ran" for stage, state, _ in session.stages)
    assert shown.shape == (48, 48, 4)
