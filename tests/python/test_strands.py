"""StrandSet: views without copies, files, and growing."""

import gc
import threading

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")


def some_strands():
    rng = np.random.default_rng(1)
    lengths = [4, 2, 7]
    offsets = np.concatenate([[0], np.cumsum(lengths)])
    return coif.StrandSet(rng.normal(size=(offsets[-1], 3)).astype(np.float32), offsets)


def address(array):
    return array.__array_interface__["data"][0]


def test_points_are_a_view():
    strands = some_strands()
    points = strands.points
    assert points.dtype == np.float32 and points.shape == (13, 3) and not points.flags.owndata
    assert points.flags.writeable and points.flags.c_contiguous
    assert address(points) == address(strands.points) and np.shares_memory(points, strands.points)
    points[3] = (1, 2, 3)
    assert strands.points[3].tolist() == [1, 2, 3]
    assert np.shares_memory(strands[0], points) and strands[0][3].tolist() == [1, 2, 3]


def test_offsets_are_a_read_only_view():
    offsets = some_strands().offsets
    assert offsets.dtype == np.uint64 and offsets.tolist() == [0, 4, 6, 13]
    assert not offsets.flags.writeable
    with pytest.raises(ValueError):
        offsets[0] = 1


def test_views_outlive_their_strand_set():
    strands = some_strands()
    points, offsets, strand = strands.points, strands.offsets, strands[2]
    expected = points.copy()
    del strands
    gc.collect()
    filler = [np.random.default_rng(i).normal(size=(13, 3)).astype(np.float32) for i in range(200)]  # reuse memory
    assert np.array_equal(points, expected) and offsets.tolist() == [0, 4, 6, 13]
    assert np.array_equal(strand, expected[6:])
    assert len(filler) == 200


def test_optional_arrays_keep_their_memory_when_assigned():
    strands = some_strands()
    assert strands.widths is None
    strands.widths = np.arange(13)
    widths = strands.widths
    assert widths.dtype == np.float32 and widths.tolist() == list(range(13))
    before = address(widths)
    strands.widths = np.ones(13)
    assert address(strands.widths) == before and widths[5] == 1
    strands.widths = None
    assert strands.widths is None
    strands.widths = np.full(13, 2.0)
    assert widths[5] == 2


@pytest.mark.parametrize(
    "name, shape", [("widths", 13), ("ids", 3), ("root_uvs", (3, 2)), ("colors", (13, 3)), ("guides", 3)]
)
def test_assigning_the_wrong_shape_is_a_value_error(name, shape):
    strands = some_strands()
    setattr(strands, name, np.ones(shape, dtype=int))
    assert getattr(strands, name).shape == (shape if isinstance(shape, tuple) else (shape,))
    with pytest.raises(ValueError, match=name):
        setattr(strands, name, np.ones(5, dtype=int))


def test_strands_from_a_regular_array():
    points = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
    strands = coif.StrandSet(points)
    assert len(strands) == 2 and strands.offsets.tolist() == [0, 4, 8]
    assert np.array_equal(strands.points.reshape(2, 4, 3), points)
    assert not np.shares_memory(strands.points, points)
    assert [s.shape for s in strands] == [(4, 3), (4, 3)]
    assert np.array_equal(strands[-1], points[1])
    with pytest.raises(IndexError):
        strands[2]


def test_an_empty_set_is_a_set():
    strands = coif.StrandSet(np.zeros((0, 3)), [0])
    assert len(strands) == 0 and strands.points.shape == (0, 3) and strands.offsets.tolist() == [0]


@pytest.mark.parametrize(
    "points, offsets",
    [
        (np.zeros((4, 2)), [0, 4]),
        (np.zeros((4, 3)), []),
        (np.zeros((4, 3)), [[0, 4]]),
        (np.zeros(12), None),
        (np.zeros((4, 3)), None),
    ],
)
def test_wrong_shapes_are_value_errors(points, offsets):
    with pytest.raises(ValueError):
        coif.StrandSet(points, offsets)


@pytest.mark.parametrize("offsets", [[0, 5], [0, 3], [1, 4], [0, 3, 2, 4]])
def test_offsets_that_do_not_fit_are_errors(offsets):
    with pytest.raises(coif.Error):
        coif.StrandSet(np.zeros((4, 3)), offsets)


def test_growing_makes_what_was_asked_for(tuft):
    strands = coif.grow(tuft, count=500, points=9, seed=4)
    assert len(strands) == 500 and strands.points.shape == (4500, 3)
    assert np.array_equal(strands.offsets, np.arange(501) * 9)
    assert strands.widths.shape == (4500,) and (strands.widths > 0).all()
    assert len(set(strands.ids.tolist())) == 500
    assert strands.report.barren_bundles == 0
    curves = strands.points.reshape(500, 9, 3)
    # The tuft is straight: strands are vertical lines from y = 0 to y = 3, float32.
    np.testing.assert_allclose(curves[:, :, 1], np.broadcast_to(np.linspace(0, 3, 9), (500, 9)), atol=1e-6)
    np.testing.assert_allclose(curves[:, :, [0, 2]], np.broadcast_to(curves[:, :1, [0, 2]], (500, 9, 2)), atol=1e-6)
    roots = curves[:, 0, [0, 2]]
    assert (roots > 0).all() and (roots < [4, 3]).all()


def test_growing_is_the_same_for_any_number_of_threads(tuft):
    one, four = (coif.grow(tuft, count=3000, points=12, seed=9, threads=n) for n in (1, 4))
    assert one.points.tobytes() == four.points.tobytes()
    assert one.ids.tobytes() == four.ids.tobytes() and one.widths.tobytes() == four.widths.tobytes()
    assert coif.grow(tuft, count=3000, points=12, seed=10).points.tobytes() != one.points.tobytes()


def test_fewer_strands_are_a_part_of_more(tuft):
    many = coif.grow(tuft, count=2000, points=4, seed=2)
    few = coif.grow(tuft, count=500, points=4, seed=2)
    where = {i: s for s, i in enumerate(many.ids.tolist())}
    assert set(few.ids.tolist()) <= set(where)
    for s, i in enumerate(few.ids.tolist()):
        assert np.array_equal(few[s], many[where[i]])


def test_density_says_where_strands_grow(tuft):
    density = np.zeros(tuft.bundle_count)
    density[[2, 5]] = (1, 3)
    strands = coif.grow(tuft, count=400, points=4, density=density)
    faces, counts = np.unique(strands.root_faces, return_counts=True)
    assert faces.tolist() == tuft.bundle_ids[[2, 5]].tolist()
    # Bundles of one area: counts follow the weights up to the rounding of a share.
    assert abs(counts[1] - 300) <= 1
    with pytest.raises(ValueError, match="density"):
        coif.grow(tuft, count=10, density=[1, 2, 3])


def test_growing_releases_the_lock(tuft):
    """Python code runs while grow() computes: a counting thread advances during the call."""
    ticks, done = [0], threading.Event()

    def count():
        while not done.is_set():
            ticks[0] += 1
            done.wait(0.0005)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        coif.grow(tuft, count=1000, points=8)  # starts the worker threads
        before = ticks[0]
        report = coif.grow(tuft, count=200_000, points=32).report
        during = ticks[0] - before
    finally:
        done.set()
        thread.join()
    if report.seconds < 0.05:
        pytest.skip("too quick here to tell")
    assert during >= 5


@pytest.mark.parametrize("extension", ["hair", "usda", "usdc", "glb"])
def test_saving_and_loading_give_the_strands_back(tuft, tmp_path, extension):
    strands = coif.grow(tuft, count=300, points=10)
    path = tmp_path / f"strands.{extension}"
    report = strands.save(path)
    assert report.bytes == path.stat().st_size > 0
    again = coif.StrandSet.load(path)
    assert np.array_equal(again.offsets, strands.offsets)
    # All of these formats hold float32: nothing is lost. (USD text prints nine digits, which give the float back.)
    assert np.array_equal(again.points, strands.points)
    assert np.array_equal(again.widths, strands.widths)
    if extension != "hair":
        assert np.array_equal(again.ids, strands.ids)


def test_saving_to_an_unknown_extension_is_refused(tuft, tmp_path):
    with pytest.raises(coif.Error) as caught:
        coif.grow(tuft, count=3).save(tmp_path / "strands.docx")
    assert caught.value.code is coif.ErrorCode.UNSUPPORTED and not (tmp_path / "strands.docx").exists()


def test_broken_files_are_errors(shared_data):
    for name in ("bad_magic", "empty", "huge_counts", "nan_points", "no_points_bit", "seg_sum_too_big", "truncated_points"):
        path = shared_data / "torture" / "hair" / f"{name}.hair"
        with pytest.raises(coif.Error) as caught:
            coif.StrandSet.load(path)
        assert caught.value.file == str(path)


def test_real_hair_files_load(shared_data):
    strands = coif.StrandSet.load(shared_data / "strands" / "mohawk.hair")
    assert len(strands) == 2228 and (np.diff(strands.offsets.astype(int)) == 32).all()
