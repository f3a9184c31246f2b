"""The plain functions against independent answers."""

import json

import numpy as np
import pytest

coif = pytest.importorskip("coif", reason="the Python module is not built, or PYTHONPATH does not name it")


def test_mean_value_coordinates_match_the_reference_values(shared_data):
    data = json.loads((shared_data / "reference_values" / "mean_value_coordinates.json").read_text())
    assert len(data["cases"]) == 130
    for case in data["cases"]:
        polygon = np.array(data["polygons"][case["poly"]])
        weights = coif.mean_value_coordinates(polygon, case["x"])
        assert weights.dtype == np.float64 and weights.shape == (len(polygon),)
        # 1e-13 is the bound that mean_value.h states, relative to the greatest weight of concave polygons.
        scale = max(1.0, np.abs(case["w"]).max())
        np.testing.assert_allclose(weights, case["w"], rtol=0, atol=1e-13 * scale)


def test_mean_value_coordinates_in_space_reproduce_the_point():
    rng = np.random.default_rng(5)
    basis, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    angles = np.sort(rng.uniform(0, 2 * np.pi, 7))
    polygon = np.c_[np.cos(angles), np.sin(angles)] @ basis[:2] + [3, -2, 8]
    point = polygon.mean(axis=0)
    weights = coif.mean_value_coordinates(polygon, point)
    # Linear precision holds to rounding; coordinates of size 10 lose one digit of the 1e-15.
    assert abs(weights.sum() - 1) < 1e-14
    np.testing.assert_allclose(weights @ polygon, point, rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    "polygon, point",
    [
        ([(0, 0), (1, 0)], (0, 0)),
        ([(0, 0), (1, 0), (0, 1)], (0, 0, 0)),
        ([(0, 0), (1, 0), (0, np.nan)], (0, 0)),
        ([(0, 0), (1, 0), (0, 1)], (np.inf, 0)),
        ([0, 1, 2], (0, 0)),
        (np.zeros((3, 4)), (0, 0, 0)),
    ],
)
def test_mean_value_coordinates_refuse_bad_arguments(polygon, point):
    with pytest.raises(ValueError):
        coif.mean_value_coordinates(polygon, point)


def test_mean_value_coordinates_refuse_a_polygon_without_area():
    with pytest.raises(coif.Error):
        coif.mean_value_coordinates(np.ones((3, 3)), (1, 1, 1))


def numpy_catmull_rom(points, samples):
    """The printed formula of the uniform spline, with phantom end points."""
    points = np.asarray(points, float)
    p = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
    out = []
    for u in np.linspace(0, len(points) - 1, samples):
        k = min(int(u), len(points) - 2)
        t = u - k
        p0, p1, p2, p3 = p[k : k + 4]
        out.append(
            0.5
            * (2 * p1 + (p2 - p0) * t + (2 * p0 - 5 * p1 + 4 * p2 - p3) * t**2 + (3 * p1 - p0 - 3 * p2 + p3) * t**3)
        )
    return np.array(out)


@pytest.mark.parametrize("count, samples", [(2, 2), (2, 7), (3, 5), (5, 33), (9, 1000)])
def test_catmull_rom_matches_the_formula(count, samples):
    points = np.random.default_rng(count).normal(size=(count, 3))
    curve = coif.catmull_rom(points, samples)
    assert curve.shape == (samples, 3) and curve.dtype == np.float64
    # Values of order 1, a handful of roundings of 1e-16 each, and the parameter's own: 1e-13 holds all of them.
    np.testing.assert_allclose(curve, numpy_catmull_rom(points, samples), rtol=0, atol=1e-13)
    assert np.array_equal(curve[0], points[0]) and np.array_equal(curve[-1], points[-1])


def test_catmull_rom_of_two_points_is_a_line():
    curve = coif.catmull_rom([(0, 0, 0), (2, 4, 6)], 5)
    np.testing.assert_allclose(curve, np.linspace(0, 1, 5)[:, None] * [2, 4, 6], rtol=0, atol=1e-15)


@pytest.mark.parametrize("points, samples", [([(0, 0, 0)], 4), ([(0, 0, 0), (1, 1, 1)], 1), ([(0, 0), (1, 1)], 4)])
def test_catmull_rom_refuses_bad_arguments(points, samples):
    with pytest.raises(ValueError):
        coif.catmull_rom(points, samples)
