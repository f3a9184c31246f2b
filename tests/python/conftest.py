"""Fixtures that the Python tests share."""

import pathlib

import pytest
from studio_window import bob, display, studio  # noqa: F401  the studio's tests ask for them by name

SHARED_DATA = pathlib.Path(__file__).resolve().parents[3] / "shared" / "data"


@pytest.fixture(scope="session")
def shared_data():
    if not SHARED_DATA.is_dir():
        pytest.skip(f"no shared data at {SHARED_DATA}")
    return SHARED_DATA


def grid_root(rows=3, columns=4):
    """A flat root layer of rows×columns unit quads in the xz plane, wound to face +y."""
    positions = [(x, 0.0, z) for z in range(rows + 1) for x in range(columns + 1)]
    faces = []
    for z in range(rows):
        for x in range(columns):
            a = z * (columns + 1) + x
            faces.append((a, a + columns + 1, a + columns + 2, a + 1))
    return positions, faces


@pytest.fixture
def tuft():
    """A hair mesh of 3×4 bundles, three layers of one unit each above the root."""
    import coif

    mesh = coif.HairMesh.from_root(*grid_root())
    for _ in range(3):
        mesh.extrude_faces(mesh.bundle_ids, 1.0)
    return mesh
