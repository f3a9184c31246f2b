#include <bit>
#include <cstdint>

#include "coif/hairmesh/history.h"

namespace coif {
namespace {

class Writer {
 public:
  void u32(std::uint32_t value) {
    for (int i = 0; i < 4; ++i) bytes.push_back(std::byte(value >> (8 * i) & 0xff));
  }
  void f64(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    u32(std::uint32_t(bits));
    u32(std::uint32_t(bits >> 32));
  }
  std::vector<std::byte> bytes;
};

}  // namespace

std::vector<std::byte> canonicalBytes(const HairMesh& mesh) {
  Writer w;
  w.bytes.reserve(64 * mesh.vertices().size());
  w.u32(mesh.nextVertexId());
  w.u32(mesh.nextBundleId());
  w.u32(std::uint32_t(mesh.vertices().size()));
  for (const HairVertex& v : mesh.vertices()) {
    w.u32(std::uint32_t(v.id));
    for (int i = 0; i < 3; ++i) w.f64(v.position[i]);
    w.u32(v.parent);
    w.u32(v.layer);
    w.u32(std::uint32_t(v.pinned) | std::uint32_t(v.welded) << 1);
  }
  w.u32(std::uint32_t(mesh.bundles().size()));
  for (const Bundle& b : mesh.bundles()) {
    w.u32(std::uint32_t(b.id));
    w.u32(b.corners);
    w.u32(b.group);
    w.u32(std::uint32_t(b.vertices.size()));
    for (const std::uint32_t v : b.vertices) w.u32(v);
  }
  w.u32(std::uint32_t(mesh.splits().size()));
  for (const EdgeSplit& s : mesh.splits()) {
    w.u32(s.a);
    w.u32(s.b);
    w.u32(s.layer);
  }
  w.u32(std::uint32_t(mesh.groupNames().size()));
  for (const std::string& name : mesh.groupNames()) {
    w.u32(std::uint32_t(name.size()));
    for (const char c : name) w.bytes.push_back(std::byte(c));
  }
  return std::move(w.bytes);
}

}  // namespace coif
