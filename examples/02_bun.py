"""A bun: all hair drawn back over the skull to a knot, twisted into a rope and coiled around it."""

import numpy as np

import coif
from combing import Gather, finish, lay, settle, sweep

GATHER, COIL = 5, 16  # layers over the skull, and in the coil

scalp = coif.Scalp(coif.example_head())
cage = scalp.cage(80)
mesh = coif.HairMesh.from_scalp(scalp, cage)
for _ in range(GATHER + COIL):
    mesh.extrude_faces(mesh.bundle_ids)

gather = Gather(scalp, cage, towards=(0, 0.55, -1), lift=1.2)
over_the_skull = gather.paths(GATHER, radius=1.2)

# The rope leaves the knot outwards and winds around it, two turns that climb inwards.
turn = np.linspace(0, 1, COIL)
psi = 2 * np.pi * 2.0 * turn
reach = 2.3 * np.minimum(1, 5 * turn) * (1 - 0.45 * turn)
height = 0.6 + 1.9 * turn
coil = (gather.knot + height[:, None] * gather.axis
        + reach[:, None] * (np.cos(psi)[:, None] * gather.right + np.sin(psi)[:, None] * gather.up))
radii = np.interp(turn, [0, 0.2, 0.8, 1], [1.2, 1.7, 1.6, 0.6])
rope = sweep(coil, gather.right, radii, gather.uv)

lay(mesh, np.concatenate([over_the_skull, rope], axis=1))
settle(mesh, scalp.surface)
finish("bun", scalp, mesh, count=40000, points=96, azimuths=(25, 100, 165))
