// A mannequin's head to try things on when no scan is at hand.
#pragma once

#include "coif/scalp/polygon_mesh.h"

namespace coif {

/// A stylised head with ears, neck and the beginning of the shoulders, closed by a flat base.
/// Quads only, one closed surface of genus 0, wound outward, the half x < 0 the mirror image of x > 0 to the
/// bit; y up, facing +z, metersPerUnit 0.01, chin near y = 0, crown near y = 24. Groups "scalp" (where hair
/// grows), "face" (everything else above the base) and "base". UVs: the whole surface but the base is one
/// chart in [0, 0.875]², unfolded around the crown, so a scalp has no seam; the base is a chart of its own.
/// `resolution`: quads around half the head, clamped to 16 … 256 and rounded up to a multiple of four; the
/// mesh has 2.5 · resolution² quads: 5760 for 48. A fixed formula: the same bytes on every call with one
/// build. Cost: about 0.7 s of processor time for 48, growing with the cube of the resolution.
PolygonMesh makeExampleHead(int resolution = 48);

}  // namespace coif
