// Hair in motion as a file: where the hair mesh's vertices are, frame by frame, and what is needed to go on.
//
// .coifcache, little-endian: "COIFCACH", u32 version, u32 vertices, u64 key, f64 frames a second, u64 frames,
// u64 bytes of state; then 12 f64 a frame (pose of the head: rotation by rows, position), vertices × 3 f32 a
// frame, the state, and a u64 checksum of all before. The same simulation gives the same bytes, in one go or
// resumed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "coif/base/result.h"
#include "coif/simulate/collider.h"

namespace coif {

struct DynamicsCache {
  static constexpr std::uint32_t kVersion = 1;

  std::uint64_t key = 0;  ///< fingerprint of mesh, settings, head and motion
  double framesPerSecond = 24;
  std::uint32_t vertexCount = 0;
  std::vector<RigidPose> poses;  ///< of the head, by frame
  std::vector<Vec3f> positions;  ///< frames × vertexCount, scene units
  std::vector<std::byte> state;  ///< Simulation::state() of the last frame

  std::size_t frameCount() const { return poses.size(); }
  std::span<const Vec3f> frame(std::size_t f) const {
    return std::span(positions).subspan(f * vertexCount, vertexCount);
  }
};

/// Writes atomically: an interruption leaves the old file whole.
Status saveCache(const DynamicsCache& cache, const std::filesystem::path& path);
/// Errors: NotFound, Unreadable, TooLarge, Malformed (no cache, cut off, checksum, values not finite),
/// Unsupported (a newer version).
Result<DynamicsCache> loadCache(const std::filesystem::path& path);
Result<DynamicsCache> parseCache(std::span<const std::byte> bytes);
std::vector<std::byte> cacheBytes(const DynamicsCache& cache);

}  // namespace coif
