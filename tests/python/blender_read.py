"""Run by Blender's own Python (bpy): imports a file and writes what arrived to an .npz for test_blender.py.

Usage: python blender_read.py IN.usdc|IN.glb OUT.npz
"""

import sys

import bpy
import numpy as np


def read(attribute_data, field, width, dtype):
    values = np.empty(len(attribute_data) * width, dtype)
    attribute_data.foreach_get(field, values)
    return values.reshape(-1, width) if width > 1 else values


FIELDS = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
}


def attributes_of(data, prefix, out):
    for attribute in data.attributes:
        if attribute.data_type not in FIELDS:
            continue
        field, width, dtype = FIELDS[attribute.data_type]
        out[f"{prefix}{attribute.name}@{attribute.domain}"] = read(attribute.data, field, width, dtype)


def main(source, target):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if source.endswith(".glb"):
        bpy.ops.import_scene.gltf(filepath=source)
    else:
        bpy.ops.wm.usd_import(filepath=source)
    out = {"version": np.array(bpy.app.version)}
    counts = {}
    for thing in bpy.data.objects:
        kind = thing.type
        number = counts[kind] = counts.get(kind, 0) + 1
        prefix = f"{kind}{number - 1}:"
        out[prefix + "name"] = np.array(thing.name)
        out[prefix + "world"] = np.array(thing.matrix_world)
        if kind == "CURVES":
            out[prefix + "sizes"] = np.array([len(c.points) for c in thing.data.curves])
            attributes_of(thing.data, prefix, out)
        elif kind == "MESH":
            out[prefix + "vertices"] = read(thing.data.vertices, "co", 3, np.float32)
            out[prefix + "edges"] = np.array([tuple(e.vertices) for e in thing.data.edges]).reshape(-1, 2)
            out[prefix + "polygons"] = np.array([p.loop_total for p in thing.data.polygons])
            attributes_of(thing.data, prefix, out)
    np.savez(target, **out)


main(sys.argv[1], sys.argv[2])
