#include <cstdio>
#include <span>
#include <vector>

#include "coif/hairmesh/operations.h"
#include "coif/place/place.h"
#include "coif/strands/grow.h"

int main() {
  const std::vector<coif::Vec3> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<std::uint32_t> offsets = {0, 4}, corners = {0, 1, 2, 3};
  auto mesh = coif::HairMesh::fromRoot(square, offsets, corners);
  if (!mesh) return 1;
  const coif::BundleId bundle = mesh->bundles()[0].id;
  coif::ExtrudeOptions up;
  up.distance = 1;
  if (!coif::extrudeFaces(*mesh, std::span(&bundle, 1), up)) return 2;
  if (!coif::place(*mesh)) return 3;
  coif::GrowOptions options;
  options.count = 100;
  const auto grown = coif::grow(*mesh, options);
  if (!grown || grown->strands.strandCount() != 100) return 4;
  std::printf("%zu strands\n", grown->strands.strandCount());
}
