"""A mohawk: a ridge along the midline that fans out and ends in spikes, over shaved sides."""

import numpy as np

import coif
from combing import finish, unit

scalp = coif.Scalp(coif.example_head())
frame = scalp.frame()
cage = scalp.cage(14 * 18)
mesh = coif.HairMesh.from_scalp(scalp, cage)

# The two middle columns carry the ridge, the others stubble.
column = {tuple(sorted(face)): cage.grid[list(face), 0].min() for face in cage.faces}
rows = {tuple(sorted(face)): cage.grid[list(face), 1].min() for face in cage.faces}
by_bundle = dict(zip(mesh.bundle_ids.tolist(), map(tuple, map(sorted, cage.faces))))
middle = cage.columns // 2
ridge = [b for b, f in by_bundle.items() if column[f] in (middle - 1, middle)]
mesh.set_group(ridge, "ridge")
sides = [b for b in by_bundle if b not in ridge]
mesh.extrude_faces(sides, 0.35)
mesh.set_group(sides, "stubble")


def lift(position, layer, height):
    """Where a ridge vertex goes from its root: out from the skull, back a little, and together over the midline."""
    out = unit(position - frame.centre)
    out[:, 0] *= 0.2
    back = np.array([0, 0.12, -0.3]) * layer / 4
    return unit(out + back) * height[:, None]


for layer in range(1, 5):
    positions = mesh.positions
    where = (positions[:, 2] - cage.positions[:, 2].min()) / np.ptp(cage.positions[:, 2])  # 0 nape … 1 forehead
    height = 1.1 + 1.5 * np.clip(where, 0, 1) ** 0.7
    offsets = lift(positions, layer, height)
    offsets[:, 0] -= positions[:, 0] * (0.25 if layer < 3 else 0.1)
    mesh.extrude_faces(ridge, offsets=offsets)

# Spikes: the ridge comes apart between every second row on layer 2, and each part narrows to its tip.
for b in ridge:
    face = by_bundle[b]
    for side in range(4):
        vertices = mesh.bundle(b).vertices
        pair = vertices[0, [side, (side + 1) % 4]]
        if all(cage.grid[v, 1] == rows[face] for v in pair) and rows[face] % 2 == 0 and rows[face] > 0:
            try:
                mesh.separate_edge((b, 2, side))
            except coif.Error:
                pass  # the neighbour did it already
for first in range(0, cage.rows, 2):
    spike = [b for b in ridge if rows[by_bundle[b]] in (first, first + 1)]
    for layer, width in ((3, 0.6), (4, 0.12)):
        vertices = np.unique(np.concatenate([mesh.bundle_vertices(b, layer) for b in spike]))
        mesh.scale((width, width, width), vertices)
        mesh.translate(unit(mesh.positions[mesh.indices(vertices)].mean(axis=0) - frame.centre) * (width < 0.5), vertices)

finish("mohawk", scalp, mesh, count=60000, density=[8.0 if b in ridge else 1.0 for b in mesh.bundle_ids],
       color=(0.30, 0.02, 0.05))
