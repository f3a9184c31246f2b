"""Run by Blender's own Python (bpy): imports hair in motion and writes what it is on each frame to an .npz.

Usage: python blender_motion.py IN.usdc|IN.abc OUT.npz FRAME...
"""

import sys

import bpy
import numpy as np


def positions(data, field):
    values = np.empty(len(data) * 3, np.float32)
    data.foreach_get(field, values)
    return values.reshape(-1, 3)


def main(source, target, frames):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = 24
    if source.endswith(".abc"):
        bpy.ops.wm.alembic_import(filepath=source, as_background_job=False)
    else:
        bpy.ops.wm.usd_import(filepath=source)
    out = {}
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for thing in graph.objects:
            if thing.type in ("CURVES", "MESH"):
                data = thing.data
                local = positions(data.attributes["position"].data, "vector")
                world = np.array(thing.matrix_world)
                kind = "hair" if thing.type == "CURVES" else "head" if "ead" in thing.name else "other"
                out[f"{kind}{frame}"] = local @ world[:3, :3].T + world[:3, 3]
                if thing.type == "CURVES":
                    out["sizes"] = np.array([len(c.points) for c in data.curves])
    np.savez(target, **out)


main(sys.argv[1], sys.argv[2], [int(f) for f in sys.argv[3:]])
