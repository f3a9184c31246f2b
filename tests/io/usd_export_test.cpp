// Writes what tests/python/test_usd.py judges with OpenUSD, beside the raw arrays that it must find again.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "io/formats.h"
#include "usd_fixture.h"

namespace coif {
namespace {

/// COIF_TEST_OUT, or a folder that goes away.
std::filesystem::path outFolder(const TemporaryFolder& otherwise) {
  const char* wanted = std::getenv("COIF_TEST_OUT");
  return wanted != nullptr ? std::filesystem::path(wanted) : otherwise / "";
}

template <class T>
void dump(const std::filesystem::path& path, const std::vector<T>& values) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(values.data()), std::streamsize(values.size() * sizeof(T)));
}

void dumpSource(const StrandSet& set, const std::filesystem::path& base) {
  auto file = [&](const char* name) { return base.string() + "." + name + ".bin"; };
  dump(file("offsets"), set.offsets);
  dump(file("points"), set.points);
  dump(file("widths"), set.widths);
  dump(file("ids"), set.ids);
  dump(file("rootFaces"), set.rootFaces);
  dump(file("rootUvs"), set.rootUvs);
  dump(file("groups"), set.groups);
  dump(file("guides"), set.guides);
  dump(file("colors"), set.colors);
  dump(file("transparencies"), set.transparencies);
  dump(file("weights"), set.weights);
  dump(file("weightOffsets"), set.weightOffsets);
}

void write(const StrandExport& what, const std::filesystem::path& base) {
  for (const char* extension : {".usda", ".usdc"}) {
    const std::filesystem::path path = base.string() + extension;
    const auto report = io::writeUsd(what, path, {});
    ASSERT_TRUE(report.ok()) << report.error().text();
    EXPECT_EQ(report->bytes, std::filesystem::file_size(path));
  }
  dumpSource(*what.strands, base);
}

TEST(Usd, WritesEveryArray) {
  const TemporaryFolder temporary("usd_export");
  const StrandSet strands = richStrands(2000);
  const PolygonMesh head = groupedCube();
  const Vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::uint32_t offsets[] = {0, 4}, face[] = {0, 1, 2, 3};
  const auto hairMesh = HairMesh::fromRoot(corners, offsets, face);
  ASSERT_TRUE(hairMesh.ok()) << hairMesh.error().text();
  StrandExport what;
  what.strands = &strands;
  what.head = &head;
  what.hairMesh = &*hairMesh;
  write(what, outFolder(temporary) / "rich");
}

TEST(Usd, WritesTimeSamples) {
  const TemporaryFolder temporary("usd_frames");
  const StrandSet strands = richStrands(50);
  std::vector<std::vector<Vec3f>> moved(3, strands.points);
  StrandExport what;
  what.strands = &strands;
  what.timeCodesPerSecond = 30;
  for (std::size_t f = 0; f < moved.size(); ++f) {
    for (Vec3f& p : moved[f]) p.y() += float(f) * 0.1f;
    what.frames.push_back({double(f) * 0.5 + 1, moved[f]});
    dump(outFolder(temporary) / ("frames.frame" + std::to_string(f) + ".bin"), moved[f]);
  }
  write(what, outFolder(temporary) / "frames");
}

TEST(Usd, WritesPlainStrands) {
  const TemporaryFolder temporary("usd_plain");
  StrandSet strands;  // points alone: no optional array at all
  strands.points = {Vec3f(0, 0, 0), Vec3f(0, 0, 1), Vec3f(1, 0, 0), Vec3f(1, 0, 1), Vec3f(1, 0, 2)};
  strands.offsets = {0, 2, 5};
  StrandExport what;
  what.strands = &strands;
  write(what, outFolder(temporary) / "plain");
  StrandSet none;
  what.strands = &none;
  write(what, outFolder(temporary) / "none");
}

TEST(Usd, RefusesWhatCurvesCannotBe) {
  const TemporaryFolder temporary("usd_refuse");
  StrandSet strands;
  strands.points = {Vec3f(0, 0, 0), Vec3f(0, 0, 1), Vec3f(1, 0, 0)};
  strands.offsets = {0, 2, 3};
  StrandExport what;
  what.strands = &strands;
  const auto single = io::writeUsd(what, temporary / "a.usda", {});
  ASSERT_FALSE(single.ok());
  EXPECT_EQ(single.error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(single.error().place, "strand 1");
  strands.offsets = {0, 3};
  const std::vector<Vec3f> two(2, Vec3f::Zero());
  what.frames = {{1, two}};
  EXPECT_FALSE(io::writeUsd(what, temporary / "a.usda", {}).ok());
  what.frames = {{1, strands.points}, {1, strands.points}};
  EXPECT_FALSE(io::writeUsd(what, temporary / "a.usda", {}).ok());
  EXPECT_FALSE(std::filesystem::exists(temporary / "a.usda"));
}

TEST(Usd, StopsWhenCancelled) {
  const TemporaryFolder temporary("usd_cancel");
  const StrandSet strands = richStrands(100);
  const std::atomic<bool> cancel = true;
  Context context;
  context.cancel = &cancel;
  StrandExport what;
  what.strands = &strands;
  for (const char* name : {"a.usda", "a.usdc"}) {
    const auto report = io::writeUsd(what, temporary / name, context);
    ASSERT_FALSE(report.ok());
    EXPECT_EQ(report.error().code, ErrorCode::Cancelled);
    EXPECT_FALSE(std::filesystem::exists(temporary / name));
  }
}

TEST(Usd, SameBytesForAnyThreads) {
  const TemporaryFolder temporary("usd_threads");
  const StrandSet strands = richStrands(20000);
  StrandExport what;
  what.strands = &strands;
  auto bytesWith = [&](int threads) {
    Context context;
    context.threads = threads;
    EXPECT_TRUE(io::writeUsd(what, temporary / "a.usda", context).ok());
    return readFile(temporary / "a.usda").value();
  };
  EXPECT_EQ(bytesWith(1), bytesWith(3));
}

}  // namespace
}  // namespace coif
