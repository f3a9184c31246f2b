"""A braid: hair gathered at the back of the head and plaited from three parts, from root to tip without a seam."""

import numpy as np

import coif
from combing import Gather, finish, lay, settle, sweep, unit

GATHER, BRAID = 4, 20  # layers over the skull, and in the braid
CROSSINGS = 3.0        # periods of the weave

scalp = coif.Scalp(coif.example_head())
cage = scalp.cage(72)
mesh = coif.HairMesh.from_scalp(scalp, cage)
for _ in range(GATHER + BRAID):
    mesh.extrude_faces(mesh.bundle_ids)

gather = Gather(scalp, cage, towards=(0, 0.05, -1), lift=1.3)
over_the_skull = gather.paths(GATHER, radius=1.6)

# Three parts by their angle around the knot; the mesh comes apart between them from the knot on.
turn = np.arctan2(gather.uv[:, 1], gather.uv[:, 0])
part = {}
for b in mesh.bundle_ids.tolist():
    middle = gather.uv[mesh.bundle(b).vertices[0]].mean(axis=0)
    part[b] = int((np.arctan2(middle[1], middle[0]) + np.pi / 6) // (2 * np.pi / 3)) % 3
seen = {}
for b in mesh.bundle_ids.tolist():
    face = mesh.bundle(b).vertices[0].tolist()
    for side in range(4):
        edge = frozenset((face[side], face[(side + 1) % 4]))
        if edge in seen and part[seen[edge]] != part[b]:
            mesh.separate_edge((b, GATHER + 1, side))
        seen[edge] = b

# The braid hangs from the knot; its parts weave about the centreline.
s = np.linspace(0, 1, BRAID)
drop = gather.knot + (np.minimum(1.5 * s * 3, 1.5))[:, None] * gather.axis * [0, 0, 1] + np.outer(s, (0, -21, -2.5))
radii = 1.0 * np.interp(s, [0, 0.1, 0.85, 0.93, 1], [1.1, 1, 0.75, 0.45, 0.7])
for k in range(3):
    phase = 2 * np.pi * (CROSSINGS * s + k / 3)
    weave = np.stack([1.25 * np.sin(phase), 0 * s, 0.75 * np.sin(2 * phase)], axis=1) * (radii / radii.max())[:, None]
    mine = [b for b in part if part[b] == k]
    roots = np.unique(np.concatenate([mesh.bundle(b).vertices[0] for b in mine]))
    local = gather.uv - gather.uv[roots].mean(axis=0)
    local = 1.15 * local / np.abs(local[roots]).max()
    strand = sweep(drop + weave, gather.right, radii, local)
    lay(mesh, np.concatenate([over_the_skull, strand], axis=1), mine)

settle(mesh, scalp.surface)
finish("braid", scalp, mesh, count=40000, points=128, azimuths=(30, 110, 180), color=(0.35, 0.2, 0.08))
