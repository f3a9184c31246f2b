#include <algorithm>
#include <cmath>

#include "coif/hairmesh/edit.h"
#include "hairmesh/select.h"

namespace coif {
namespace {

using namespace hairmesh;

std::uint32_t nearestRoot(const HairMesh& mesh, const std::vector<std::uint32_t>& roots, const Vec3& p,
                          double tolerance) {
  std::uint32_t best = kNone;
  double bestDistance = tolerance;
  for (const std::uint32_t v : roots) {
    const double distance = (mesh.position(v) - p).norm();
    if (distance > bestDistance || (distance == bestDistance && best != kNone)) continue;
    best = v, bestDistance = distance;
  }
  return best;
}

/// Partners of root vertices: each the nearest to the other's image.
void pairRoots(const HairMesh& mesh, double tolerance, Mirror& mirror) {
  const auto roots = verticesOfLayer(mesh, 0);
  std::vector<std::uint32_t> nearest(mesh.vertices().size(), kNone);
  for (const std::uint32_t v : roots)
    nearest[v] = nearestRoot(mesh, roots, mirror.image(mesh.position(v)), tolerance);
  for (const std::uint32_t v : roots) {
    if (nearest[v] != kNone && nearest[nearest[v]] == v) mirror.vertexPartner[v] = nearest[v];
  }
}

/// The bundle whose root corners are the partners of these in opposite order.
void pairBundle(const HairMesh& mesh, const Topology& t, std::uint32_t j, Mirror& mirror) {
  const auto face = mesh.bundles()[j].face(0);
  const std::uint32_t image = mirror.vertexPartner[face[0]];
  if (image == kNone) return;
  for (const std::uint32_t corner : t.around(image)) {
    const std::uint32_t m = t.bundleOf(corner), first = t.cornerOf(corner), n = mesh.bundles()[m].corners;
    if (n != face.size()) continue;
    bool matches = true;
    for (std::uint32_t i = 0; i < n; ++i) {
      matches = matches && mirror.vertexPartner[face[i]] == mesh.bundles()[m].face(0)[(first + n - i) % n];
    }
    if (!matches) continue;
    mirror.bundlePartner[j] = m;
    mirror.cornerPartner[j] = first;
    return;
  }
}

/// Higher vertices: partners when every corner that has the one maps to the other.
void pairUpper(const HairMesh& mesh, Mirror& mirror) {
  std::vector<std::uint8_t> spoilt(mesh.vertices().size(), 0);
  for (std::uint32_t j = 0; j < mesh.bundles().size(); ++j) {
    const Bundle& bundle = mesh.bundles()[j];
    const std::uint32_t m = mirror.bundlePartner[j], n = bundle.corners;
    for (std::uint32_t k = 1; k <= bundle.height(); ++k) {
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t v = bundle.face(k)[i];
        if (m == kNone || mesh.bundles()[m].height() < k) {
          spoilt[v] = 1;
          continue;
        }
        const std::uint32_t image = mesh.bundles()[m].face(k)[(mirror.cornerPartner[j] + n - i) % n];
        std::uint32_t& partner = mirror.vertexPartner[v];
        if (partner != kNone && partner != image) spoilt[v] = 1;
        partner = image;
      }
    }
  }
  for (std::uint32_t v = 0; v < spoilt.size(); ++v) {
    const std::uint32_t partner = mirror.vertexPartner[v];
    if (partner != kNone && (spoilt[v] || spoilt[partner])) spoilt[v] = spoilt[partner] = 1;
  }
  for (std::uint32_t v = 0; v < spoilt.size(); ++v) {
    if (spoilt[v]) mirror.vertexPartner[v] = kNone;
  }
  for (std::uint32_t v = 0; v < spoilt.size(); ++v) {
    const std::uint32_t partner = mirror.vertexPartner[v];
    if (partner != kNone && mirror.vertexPartner[partner] != v) mirror.vertexPartner[v] = kNone;
  }
}

Status checkMirror(const HairMesh& mesh, const Mirror& mirror) {
  if (mirror.vertexPartner.size() == mesh.vertices().size() &&
      mirror.bundlePartner.size() == mesh.bundles().size()) {
    return {};
  }
  return refuse("the mirror was found for another mesh", "mirror");
}

}  // namespace

bool Mirror::complete() const {
  return std::ranges::find(vertexPartner, kNone) == vertexPartner.end() &&
         std::ranges::find(bundlePartner, kNone) == bundlePartner.end();
}

Result<Mirror> findMirror(const HairMesh& mesh, const Vec3& point, const Vec3& normal, double tolerance) {
  const double length = normal.norm();
  if (!(length > 0) || !std::isfinite(length) || !point.allFinite()) {
    return refuse("the mirror plane has no direction or no place", "mirror");
  }
  if (!(tolerance > 0)) return refuse("the tolerance is not above zero", "mirror");
  COIF_ASSIGN(const Topology t, Topology::build(mesh.vertices().size(), mesh.bundles(), mesh.splits()));
  Mirror mirror;
  mirror.point = point;
  mirror.normal = normal / length;
  mirror.vertexPartner.assign(mesh.vertices().size(), kNone);
  mirror.bundlePartner.assign(mesh.bundles().size(), kNone);
  mirror.cornerPartner.assign(mesh.bundles().size(), kNone);
  pairRoots(mesh, tolerance, mirror);
  for (std::uint32_t j = 0; j < mesh.bundles().size(); ++j) pairBundle(mesh, t, j, mirror);
  pairUpper(mesh, mirror);
  return mirror;
}

Result<FaceRef> mirrored(const HairMesh& mesh, const Mirror& mirror, FaceRef face) {
  COIF_TRY(checkMirror(mesh, mirror));
  COIF_ASSIGN(const std::uint32_t j, selectFace(mesh, face));
  const std::uint32_t m = mirror.bundlePartner[j];
  if (m == kNone || mesh.bundles()[m].height() < face.layer) {
    return makeError(ErrorCode::NotFound, "the face has no mirror image", placeOf(face));
  }
  return FaceRef{mesh.bundles()[m].id, face.layer};
}

Result<EdgeRef> mirrored(const HairMesh& mesh, const Mirror& mirror, EdgeRef edge) {
  COIF_ASSIGN(const std::uint32_t j, selectEdge(mesh, edge));
  COIF_ASSIGN(const FaceRef face, mirrored(mesh, mirror, FaceRef{edge.bundle, edge.layer}));
  // Side i runs from corner i to i + 1; its image runs the other way, so it begins at the image of corner i
  // + 1.
  const std::uint32_t n = mesh.bundles()[j].corners;
  return EdgeRef{face.bundle, face.layer, (mirror.cornerPartner[j] + 2 * n - edge.side - 1) % n};
}

Result<std::optional<FaceRef>> partnerAfter(const HairMesh& before, const HairMesh& after,
                                            const Mirror& mirror, FaceRef ref) {
  COIF_ASSIGN(const FaceRef partner, mirrored(before, mirror, ref));
  const std::uint32_t was = before.indexOf(partner.bundle), is = after.indexOf(partner.bundle);
  const bool taken =
      partner == ref || is == kNone || before.bundles()[was].height() != after.bundles()[is].height();
  return taken ? std::nullopt : std::optional(partner);
}

Result<std::optional<EdgeRef>> partnerAfter(const HairMesh& before, const HairMesh& after,
                                            const Mirror& mirror, EdgeRef ref) {
  COIF_ASSIGN(EdgeRef partner, mirrored(before, mirror, ref));
  const auto ends = [](const HairMesh& mesh, EdgeRef edge) {
    const Bundle& bundle = mesh.bundles()[mesh.indexOf(edge.bundle)];
    const auto face = bundle.face(0);
    return std::pair(mesh.vertices()[face[edge.side]].id,
                     mesh.vertices()[face[(edge.side + 1) % bundle.corners]].id);
  };
  const auto mine = ends(before, ref), theirs = ends(before, partner);
  if (std::minmax(mine.first, mine.second) == std::minmax(theirs.first, theirs.second))
    return std::optional<EdgeRef>();
  // The operation may have put corners into the partner's face: find the side again by the ids of its root
  // ends.
  const std::uint32_t j = after.indexOf(partner.bundle);
  if (j != kNone && partner.layer <= after.bundles()[j].height()) {
    for (partner.side = 0; partner.side < after.bundles()[j].corners; ++partner.side) {
      if (ends(after, partner) == theirs) return std::optional(partner);
    }
  }
  return makeError(ErrorCode::NotFound, "the mirror image is gone once the operation is done on one side",
                   placeOf(ref));
}

Result<std::vector<BundleId>> withMirrored(const HairMesh& mesh, const Mirror& mirror,
                                           std::span<const BundleId> ids) {
  std::vector<BundleId> result;
  for (const BundleId id : ids) {
    COIF_ASSIGN(const FaceRef partner, mirrored(mesh, mirror, FaceRef{id, 0}));
    for (const BundleId each : {id, partner.bundle}) {
      if (std::ranges::find(result, each) == result.end()) result.push_back(each);
    }
  }
  return result;
}

Status moveSymmetrically(HairMesh& mesh, const Mirror& mirror, std::span<const Vec3> displacements) {
  COIF_TRY(checkMirror(mesh, mirror));
  if (displacements.size() != mesh.vertices().size()) {
    return refuse("there must be one displacement a vertex", "displacements");
  }
  const Vec3 n = mirror.normal;
  std::vector<Vec3> total(displacements.begin(), displacements.end());
  for (std::uint32_t v = 0; v < total.size(); ++v) {
    if (!displacements[v].allFinite()) {
      return refuse("the displacement is not finite", placeOf(mesh.vertices()[v].id));
    }
    const std::uint32_t partner = mirror.vertexPartner[v];
    if (partner == kNone) continue;
    const Vec3& d = displacements[v];
    if (partner == v) {
      total[v] = d - d.dot(n) * n;
    } else {
      total[partner] += d - 2 * d.dot(n) * n;
    }
  }
  for (std::uint32_t v = 0; v < total.size(); ++v) mesh.setPosition(v, mesh.position(v) + total[v]);
  return {};
}

Result<std::size_t> symmetrise(HairMesh& mesh, const Mirror& mirror) {
  COIF_TRY(checkMirror(mesh, mirror));
  const auto all = mesh.vertices();
  std::vector<std::uint32_t> roots(all.size());
  for (std::uint32_t v = 0; v < all.size(); ++v) {
    roots[v] = v;
    while (all[roots[v]].parent != kNone) roots[v] = all[roots[v]].parent;
  }
  const auto height = [&](std::uint32_t v) { return (mesh.position(v) - mirror.point).dot(mirror.normal); };
  std::vector<Vec3> placed;
  for (const HairVertex& vertex : all) placed.push_back(vertex.position);
  std::size_t alone = 0;
  for (std::uint32_t v = 0; v < all.size(); ++v) {
    const std::uint32_t partner = mirror.vertexPartner[v];
    if (partner == kNone) {
      ++alone;
    } else if (partner == v) {
      placed[v] = mesh.position(v) - height(v) * mirror.normal;
    } else if (const double mine = height(roots[v]), theirs = height(roots[partner]);
               mine < theirs || (mine == theirs && v > partner)) {
      placed[v] = mirror.image(mesh.position(partner));
    }
  }
  for (std::uint32_t v = 0; v < all.size(); ++v) mesh.setPosition(v, placed[v]);
  return alone;
}

}  // namespace coif
