"""A chin-length bob: parted in the middle, combed down around the head, cut along one line."""

import numpy as np

import coif
from combing import finish, lay, push_out, resample, settle, unit

LAYERS, CUT, STEP = 7, 3.2, 0.4  # layers of the mesh, height of the cut above the chin's base and comb step in cm

scalp = coif.Scalp(coif.example_head())
cage = scalp.cage(160)
mesh = coif.HairMesh.from_scalp(scalp, cage)
for _ in range(LAYERS):
    mesh.extrude_faces(mesh.bundle_ids)


def clearance(travelled):
    """Hair lifts off at the root and lies over the hair that it passes, and over the ears."""
    return 0.4 + 0.9 * np.clip(travelled / 3, 0, 1) + 0.05 * np.minimum(travelled, 14)


def comb(roots, side):
    """Paths from the roots down to the cut: sideways from the parting, past the face, then straight down."""
    points, paths, going = roots.copy(), [roots.copy()], np.ones(len(roots), bool)
    travelled = np.zeros(len(roots))
    direction = unit(roots - scalp.frame().centre)
    for _ in range(120):
        _, normal, _ = scalp.surface.project(points)
        front = np.clip((points[:, 2] - 1) / 5, 0, 1) * np.clip((8.2 - np.abs(points[:, 0])) / 3, 0, 1)
        wish = np.zeros_like(points)
        wish[:, 1] = -1
        top = np.clip((points[:, 1] - 15) / 6, 0, 1)
        wish[:, 0] = side * (0.25 * top + 2.5 * front)
        wish[:, 2] = -1.2 * front - 0.4 * top * np.clip((3 - points[:, 2]) / 3, 0, 1)
        wish -= normal * np.clip((wish * normal).sum(axis=1), None, 0)[:, None]
        direction = unit(0.55 * direction + unit(wish))
        step = np.where(going, STEP, 0)[:, None]
        moved = push_out(scalp.surface, points + step * direction, clearance(travelled))
        points = np.where(going[:, None], moved, points)
        travelled += np.where(going, STEP, 0)
        paths.append(points.copy())
        going &= points[:, 1] > CUT
    return np.stack([resample(path, LAYERS) for path in np.stack(paths, axis=1)])


# The parting runs from the forehead to the crown: the middle line of the mesh comes apart there, above the root.
middle, crown = cage.columns // 2, cage.rows // 3
left = []
for b in mesh.bundle_ids.tolist():
    face = mesh.bundle(b).vertices[0].tolist()
    if max(cage.grid[v, 0] for v in face) <= middle:
        left.append(b)
        for side in range(4):
            a, c = face[side], face[(side + 1) % 4]
            if cage.grid[a, 0] == cage.grid[c, 0] == middle and max(cage.grid[[a, c], 1]) <= crown:
                mesh.separate_edge((b, 1, side))
right = sorted(set(mesh.bundle_ids.tolist()) - set(left))

x = cage.positions[:, 0]
front = cage.grid[:, 1] < crown  # where the slit ends, one vertex stays
for bundles, sign in ((left, 1), (right, -1)):
    # Behind the parting the middle line belongs to both sides and falls straight.
    lay(mesh, comb(cage.positions, np.where(np.abs(x) < 0.1, np.where(front, sign, 0), np.sign(x))), bundles)
settle(mesh, scalp.surface, clearance=0.25)
finish("bob", scalp, mesh, count=50000, points=48, azimuths=(0, 50, 160))
