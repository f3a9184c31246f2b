"""What the examples share: paths of hair over a head, columns of a hair mesh laid along them, and pictures."""

import argparse
import pathlib

import numpy as np

import coif


def unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)


def resample(path, count):
    """`count` points at equal arc length along a path N×3, without its first point."""
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    at = np.linspace(0, length[-1], count + 1)[1:]
    return np.stack([np.interp(at, length, path[:, axis]) for axis in range(3)], axis=1)


def push_out(surface, points, clearance):
    """Points nearer to the head than `clearance` (a number, or one a point) go out to it."""
    _, normals, distances = surface.project(points)
    return points + np.maximum(clearance - distances, 0)[:, None] * normals


def lay(mesh, curves, bundles=None):
    """Lays columns along curves: a vertex of layer k goes to curves[root, k - 1], with the root vertex's row in
    mesh.layer_vertices(0). `bundles`: ids; None: all."""
    row_of_root = {int(v): row for row, v in enumerate(mesh.layer_vertices(0))}
    positions = mesh.positions
    for bundle in [mesh.bundle(int(b)) for b in (mesh.bundle_ids if bundles is None else bundles)]:
        roots = [row_of_root[int(v)] for v in bundle.vertices[0]]
        for layer in range(1, bundle.height + 1):
            positions[mesh.indices(bundle.vertices[layer])] = curves[roots, layer - 1]
    mesh.positions = positions


def settle(mesh, surface, clearance=0.1, farthest=0.6):
    """Places the inner vertices by least energy; those that would leave their path or enter the head are pinned."""
    laid = mesh.positions
    for _ in range(8):
        coif.place(mesh)
        moved = np.linalg.norm(mesh.positions - laid, axis=1) > farthest
        inside = (surface.signed_distance(mesh.positions) < clearance) & ~mesh.external
        if not (moved | inside).any():
            break
        mesh.undo()
        mesh.set_pinned(mesh.vertex_ids[moved | inside])


class Gather:
    """Hair drawn together at a point of the head: every root gets its place (u, v) in the cross-section of the rope,
    by angle and distance around the point, and a path over the skull to it."""

    def __init__(self, scalp, cage, towards, lift=1.0):
        self.centre, self.surface = scalp.frame().centre, scalp.surface
        hit = self.surface.intersect(self.centre, towards)
        self.axis = unit(np.asarray(towards, float))
        self.knot = hit.position + lift * self.axis
        self.right = unit(np.cross((0, 1, 0), self.axis))
        self.up = np.cross(self.axis, self.right)
        seen = unit(cage.positions - self.centre)
        self.angle = np.arccos(np.clip(seen @ self.axis, -1, 1))
        side = unit(np.stack([seen @ self.right, seen @ self.up], axis=1))
        self.uv = side * (self.angle / self.angle.max())[:, None]
        self.side = side[:, :1] * self.right + side[:, 1:] * self.up

    def paths(self, count, radius, clearance=0.35):
        """`count` points from each root to the rope's cross-section of `radius` at the knot: V×count×3."""
        out = np.empty((len(self.angle), count, 3))
        end = self.knot + radius * (self.uv[:, :1] * self.right + self.uv[:, 1:] * self.up)
        for k in range(1, count + 1):
            t = k / count
            angle = self.angle * (1 - t)
            seen = np.cos(angle)[:, None] * self.axis + np.sin(angle)[:, None] * self.side
            feet = np.array([self.surface.intersect(self.centre, d).position for d in seen])
            # Hair from farther away lies over hair that joins later.
            over = push_out(self.surface, feet, clearance + 0.5 * t * self.angle / self.angle.max())
            out[:, k - 1] = over + (end - over) * t**4
        return out


def sweep(centreline, right, radii, uv):
    """Rope of round cross-sections along a centreline N×3: points at (u, v) of each, V×N×3."""
    tangents = unit(np.gradient(centreline, axis=0))
    points = []
    for centre, tangent, radius in zip(centreline, tangents, radii):
        right = unit(right - tangent * (right @ tangent))  # parallel transport
        up = np.cross(tangent, right)
        points.append(centre + radius * (uv[:, :1] * right + uv[:, 1:] * up))
    return np.stack(points, axis=1)


def finish(name, scalp, mesh, count=30000, points=32, density=None, azimuths=(20, 90, 180), color=(0.23, 0.115, 0.055)):
    """Grows strands and writes NAME.coif, NAME.usdc and NAME.png (views side by side) into the folder of -o."""
    parser = argparse.ArgumentParser(description=f"Models a {name} on the example head.")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("out"), help="folder to write to")
    parser.add_argument("--size", type=int, default=512, help="height of the picture in pixels")
    out = parser.parse_args()
    out.output.mkdir(parents=True, exist_ok=True)
    scalp.mesh.save(out.output / "head.obj")
    scene = coif.Scene(mesh, head=out.output / "head.obj", name=name)
    scene.strands.count, scene.strands.points = count, points
    scene.save(out.output / f"{name}.coif")
    strands = coif.grow(mesh, count=count, points=points, density=density)
    strands.save(out.output / f"{name}.usdc", hair_mesh=mesh, head=scalp.mesh)
    if hasattr(coif, "render"):
        lo, hi = scalp.mesh.bounds
        lo, hi = np.minimum(lo + (0, 4, 0), strands.points.min(axis=0)), np.maximum(hi, strands.points.max(axis=0))
        preview, size = coif.Preview(), (out.size * 4 // 5, out.size)
        views = []
        for azimuth in azimuths:
            camera = coif.Camera.frame(lo, hi, azimuth, 8, size[0] / size[1])
            views.append(coif.render(strands, scalp, size=size, camera=camera, hair_color=color,
                                     background=(0.1, 0.105, 0.115), preview=preview))
        coif.save_png(out.output / f"{name}.png", np.concatenate(views, axis=1))
    print(f"{mesh}\n{strands}\nwrote {out.output / name}.coif, .usdc and .png")
