"""Hair modelling with hair meshes.

    import coif

    scalp = coif.Scalp.load("head.obj")
    mesh = coif.HairMesh.from_scalp(scalp)
    mesh.extrude_faces(mesh.bundle_ids, 3.0)
    coif.place(mesh)
    strands = coif.grow(mesh, count=100_000)
    strands.save("hair.usdc")

Arrays are NumPy arrays; lengths are in the scene's own unit (meters_per_unit says which). What Coif refuses is a
coif.Error whose text is one sentence naming the file, line or element at fault.
"""

from . import _coif
from ._coif import *  # noqa: F401,F403 - the extension's public names are the package's
from ._coif import __version__
from ._studio import studio

__all__ = sorted([name for name in vars(_coif) if not name.startswith("_")] + ["studio"])
