#include "coif/scene/dynamics_cache.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "coif/base/random.h"
#include "coif/io/safe_file.h"

namespace coif {

namespace {

constexpr char kMagic[8] = {'C', 'O', 'I', 'F', 'C', 'A', 'C', 'H'};
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 36;

struct Header {
  char magic[8];
  std::uint32_t version, vertices;
  std::uint64_t key;
  double framesPerSecond;
  std::uint64_t frames, stateBytes;
};
static_assert(sizeof(Header) == 48);
using PoseNumbers = std::array<double, 12>;

std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t hash = bytes.size();
  for (std::size_t i = 0; i < bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min<std::size_t>(8, bytes.size() - i));
    hash = hashCombine(hash, word);
  }
  return hash;
}

Error malformed(std::string message) {
  return makeError(ErrorCode::Malformed, std::move(message));
}

}  // namespace

std::vector<std::byte> cacheBytes(const DynamicsCache& cache) {
  std::vector<std::byte> out(sizeof(Header) + cache.frameCount() * sizeof(PoseNumbers) +
                             cache.positions.size() * sizeof(Vec3f) + cache.state.size() +
                             sizeof(std::uint64_t));
  std::size_t at = 0;
  const auto add = [&](const void* data, std::size_t size) {
    if (size > 0) std::memcpy(out.data() + at, data, size);
    at += size;
  };
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = DynamicsCache::kVersion;
  header.vertices = cache.vertexCount;
  header.key = cache.key;
  header.framesPerSecond = cache.framesPerSecond;
  header.frames = cache.frameCount();
  header.stateBytes = cache.state.size();
  add(&header, sizeof header);
  for (const RigidPose& pose : cache.poses) {
    PoseNumbers numbers;
    for (int i = 0; i < 9; ++i) numbers[std::size_t(i)] = pose.rotation(i / 3, i % 3);
    for (int i = 0; i < 3; ++i) numbers[std::size_t(9 + i)] = pose.position[i];
    add(numbers.data(), sizeof numbers);
  }
  add(cache.positions.data(), cache.positions.size() * sizeof(Vec3f));
  add(cache.state.data(), cache.state.size());
  const std::uint64_t sum = checksum(std::span(out).first(at));
  add(&sum, sizeof sum);
  return out;
}

Result<DynamicsCache> parseCache(std::span<const std::byte> bytes) {
  Header header{};
  if (bytes.size() < sizeof header || std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0)
    return malformed("this is no Coif cache");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.version > DynamicsCache::kVersion || header.version == 0)
    return makeError(ErrorCode::Unsupported, "the cache has version " + std::to_string(header.version) +
                                                 ", and this Coif reads version " +
                                                 std::to_string(DynamicsCache::kVersion));
  // Counts are held against the size before anything is allocated; in double nothing overflows.
  const double wanted =
      double(sizeof header) + 8 + double(header.stateBytes) +
      double(header.frames) * (double(sizeof(PoseNumbers)) + double(header.vertices) * double(sizeof(Vec3f)));
  if (wanted != double(bytes.size())) return malformed("the cache is cut off or longer than it says");
  std::uint64_t sum = 0;
  std::memcpy(&sum, bytes.data() + bytes.size() - 8, 8);
  if (sum != checksum(bytes.first(bytes.size() - 8))) return malformed("the cache's checksum does not hold");
  if (!(header.framesPerSecond > 0 && header.framesPerSecond <= 1e5))
    return malformed("the cache has no usable number of frames a second");
  DynamicsCache cache;
  cache.key = header.key;
  cache.framesPerSecond = header.framesPerSecond;
  cache.vertexCount = header.vertices;
  const std::byte* at = bytes.data() + sizeof header;
  for (std::uint64_t f = 0; f < header.frames; ++f, at += sizeof(PoseNumbers)) {
    PoseNumbers numbers;
    std::memcpy(numbers.data(), at, sizeof numbers);
    RigidPose pose;
    for (int i = 0; i < 9; ++i) pose.rotation(i / 3, i % 3) = numbers[std::size_t(i)];
    for (int i = 0; i < 3; ++i) pose.position[i] = numbers[std::size_t(9 + i)];
    if (!pose.rotation.allFinite() || !pose.position.allFinite())
      return malformed("a pose of the head is not finite");
    cache.poses.push_back(pose);
  }
  cache.positions.resize(std::size_t(header.frames) * header.vertices);
  if (!cache.positions.empty())
    std::memcpy(static_cast<void*>(cache.positions.data()), at, cache.positions.size() * sizeof(Vec3f));
  at += cache.positions.size() * sizeof(Vec3f);
  if (!std::all_of(cache.positions.begin(), cache.positions.end(),
                   [](const Vec3f& p) { return p.allFinite(); }))
    return malformed("a position is not finite");
  cache.state.assign(at, at + header.stateBytes);
  return cache;
}

Status saveCache(const DynamicsCache& cache, const std::filesystem::path& path) {
  COIF_ASSIGN(auto file, SafeFile::create(path));
  file.write(cacheBytes(cache));
  return file.commit();
}

Result<DynamicsCache> loadCache(const std::filesystem::path& path) {
  COIF_ASSIGN(const auto bytes, readFile(path, kMaxBytes));
  auto cache = parseCache(bytes);
  if (!cache.ok()) return inFile(cache.error(), path.string());
  return cache;
}

}  // namespace coif
