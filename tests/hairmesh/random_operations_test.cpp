// Thousands of random operations: invariants after each, exact undo and redo.
#include "hairmesh/random_operations.h"

#include "coif/hairmesh/history.h"
#include "hairmesh/test_meshes.h"

namespace coif {
namespace {

void walk(const HairMesh& start, std::uint64_t seed, int count) {
  HairMesh mesh = start;
  expectSound(mesh);
  History history;
  Draw draw(seed);
  std::size_t faces = start.bundles().size();
  const double size = 0.05;
  std::vector<int> done(std::size(kKinds), 0), asked(std::size(kKinds), 0);
  const std::vector<std::byte> first = canonicalBytes(mesh);
  std::size_t steps = 0;
  int performed = 0;
  for (int i = 0; performed < count; ++i) {
    ASSERT_LT(i, 4 * count);
    const std::size_t kind = chooseKind(mesh, draw, faces, faces + faces / 2);
    const HairMesh before = mesh;
    const Status status = randomOperation(mesh, kind, draw, size);
    const bool ok = status.ok();
    ++asked[kind];
    done[kind] += ok;
    performed += ok;
    if (!ok) {
      // A refusal must come from the operation's own rules, not from the check that guards them.
      ASSERT_EQ(status.error().message.find("would break"), std::string::npos)
          << kKinds[kind].name << ", operation " << i << ": " << status.error().text();
      ASSERT_EQ(mesh, before) << "a refused " << kKinds[kind].name << " changed the mesh, operation " << i;
      continue;
    }
    const auto faults = checkInvariants(mesh);
    ASSERT_TRUE(faults.empty()) << kKinds[kind].name << ", operation " << i << ": " << faults[0].name << ": "
                                << faults[0].element << ": " << faults[0].message;
    history.record(before, mesh, kKinds[kind].name);
    steps = history.undoCount();
    if (i % 97 == 0) {  // a step back and forth now and then, with other steps following
      const auto bytes = canonicalBytes(mesh);
      ASSERT_TRUE(history.undo(mesh).ok());
      ASSERT_EQ(canonicalBytes(mesh), canonicalBytes(before));
      ASSERT_TRUE(history.redo(mesh).ok());
      ASSERT_EQ(canonicalBytes(mesh), bytes);
    }
  }
  for (std::size_t kind = 0; kind < std::size(kKinds); ++kind) {
    EXPECT_GT(done[kind], 0) << kKinds[kind].name << " never succeeded in " << asked[kind] << " attempts";
    testing::Test::RecordProperty(kKinds[kind].name,
                                  std::to_string(done[kind]) + " of " + std::to_string(asked[kind]));
  }
  const std::vector<std::byte> last = canonicalBytes(mesh);
  while (history.undoCount() > 0) ASSERT_TRUE(history.undo(mesh).ok());
  EXPECT_EQ(canonicalBytes(mesh), first);
  EXPECT_EQ(mesh, start);
  while (history.redoCount() > 0) ASSERT_TRUE(history.redo(mesh).ok());
  EXPECT_EQ(canonicalBytes(mesh), last);
  EXPECT_EQ(history.undoCount(), steps);
  EXPECT_FALSE(history.redo(mesh).ok());
}

class RandomWalk : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Seeds, RandomWalk, testing::Values(1, 2, 3));

TEST_P(RandomWalk, Suzanne) {
  if (!std::filesystem::exists(headPath("suzanne.obj"))) GTEST_SKIP() << "no shared data";
  const HairMesh mesh = headMesh("suzanne.obj", [](const Vec3&) { return true; });
  walk(mesh, 10 + std::uint64_t(GetParam()), 10000);
}

TEST_P(RandomWalk, UpperHead) {
  if (!std::filesystem::exists(headPath("lee-perry-smith.obj"))) GTEST_SKIP() << "no shared data";
  const HairMesh mesh = headMesh("lee-perry-smith.obj", [](const Vec3& p) { return p.y() > 3.0; });
  walk(mesh, 20 + std::uint64_t(GetParam()), 10000);
}

TEST_P(RandomWalk, Cap) {
  walk(capMesh(8), std::uint64_t(GetParam()), 10000);
}

}  // namespace
}  // namespace coif
