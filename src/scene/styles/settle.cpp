#include "scene/styles/settle.h"

#include <algorithm>

#include "coif/base/parallel.h"
#include "coif/place/place.h"
#include "scene/styles/push_out.h"

namespace coif::styles {

namespace {

struct Fault {
  double size = 0;  // 1 at the limit
  std::uint32_t vertex = 0;
};

constexpr int kRounds = 12;

std::vector<Fault> faultsOf(const HairMesh& mesh, const std::vector<std::uint8_t>& external,
                            const std::vector<Vec3>& targets, const Surface& head, const HeadSpace& space,
                            const SettleOptions& options, const Context& context) {
  std::vector<double> size(mesh.vertices().size(), 0);
  parallelFor(context, size.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (external[v]) continue;
      const Vec3 position = mesh.position(std::uint32_t(v));
      size[v] = (position - targets[v]).norm() / space.height / options.tolerance;
      Vec3 away;
      const double distance = clearanceOf(head, space, space.fromScene(position), away);
      if (distance < options.clearance)
        size[v] = std::max(size[v], 2 + (options.clearance - distance) / options.tolerance);
    }
  });
  std::vector<Fault> faults;
  for (std::uint32_t v = 0; v < size.size(); ++v) {
    if (size[v] > 1) faults.push_back({size[v], v});
  }
  std::stable_sort(faults.begin(), faults.end(),
                   [](const Fault& a, const Fault& b) { return a.size > b.size; });
  return faults;
}

}  // namespace

Result<HairstyleReport> settle(HairMesh& mesh, std::vector<Vec3> targets, const Surface& head,
                               const HeadSpace& space, const SettleOptions& options, const Context& context) {
  HairstyleReport report;
  pushOut(mesh, targets, head, space, options.clearance, context);
  for (std::uint32_t v = 0; v < targets.size(); ++v) {
    if (mesh.vertices()[v].layer > 0) mesh.setPosition(v, targets[v]);
  }
  for (int round = 0;; ++round) {
    COIF_TRY(place(mesh, {}, context));
    const auto external = externalVertices(mesh);
    const auto faults = faultsOf(mesh, external, targets, head, space, options, context);
    if (faults.empty()) break;
    // The worst eighth first: pinning them mends many of the others.
    // With those as bad as the last of them go its mirror images.
    std::size_t count = round < kRounds ? (faults.size() + 7) / 8 : faults.size();
    while (count < faults.size() && faults[count].size > 0.98 * faults[count - 1].size) ++count;
    for (std::size_t i = 0; i < count; ++i) {
      mesh.setPosition(faults[i].vertex, targets[faults[i].vertex]);
      mesh.setPinned(faults[i].vertex, true);
      ++report.pinned;
    }
    context.report("settling the hairstyle", std::min(0.95, round / double(kRounds)));
  }
  const auto external = externalVertices(mesh);
  for (std::uint32_t v = 0; v < targets.size(); ++v) {
    if (!external[v]) {
      report.worstDeviation =
          std::max(report.worstDeviation, (mesh.position(v) - targets[v]).norm() / space.height);
    }
  }
  return report;
}

std::vector<std::uint32_t> rootAncestors(const HairMesh& mesh) {
  std::vector<std::uint32_t> roots(mesh.vertices().size());
  for (std::uint32_t v = 0; v < roots.size(); ++v) {
    std::uint32_t up = v;
    while (mesh.vertices()[up].parent != kNone) up = mesh.vertices()[up].parent;
    roots[v] = up;
  }
  return roots;
}

std::vector<int> sidesOf(const HairMesh& mesh, const BundleSide& negative) {
  constexpr int kUnseen = 2;
  std::vector<int> sides(mesh.vertices().size(), kUnseen);
  for (const Bundle& bundle : mesh.bundles()) {
    const int side = negative(bundle) ? -1 : 1;
    for (std::uint32_t v : bundle.vertices) {
      sides[v] = sides[v] == kUnseen || sides[v] == side ? side : 0;
    }
  }
  return sides;
}

}  // namespace coif::styles
