// What a session uploads and keeps, by numbers; and hair at its extremes.
#include "coif/preview/session.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coif/light/image_metrics.h"
#include "coif/scalp/example_head.h"
#include "preview_fixture.h"
#include "sample_hair.h"

namespace coif {
namespace {

class Sessions : public testing::PreviewTest {
 protected:
  static Camera camera(double azimuth = 20) {
    return frameBox({Vec3(-0.5, 0, -3.5), Vec3(4.5, 6, 0.5)}, UpAxis::Y, azimuth, 10);
  }
  static PreviewSession session(const HairMesh& mesh, const StrandSet& strands) {
    PreviewSession out(*preview());
    EXPECT_TRUE(out.setHair(mesh, strands).ok());
    Lights lights;
    lights.followCamera = false;
    out.setLights(lights);
    out.setCamera(camera());
    return out;
  }
  static Picture picture(PreviewSession& session, const PreviewOptions& options) {
    auto made = session.render(options);
    EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().text());
    return made.ok() ? *std::move(made) : Picture{};
  }
  static StageState stateOf(const Picture& picture, const std::string& name) {
    for (const StageReport& stage : picture.stages) {
      if (stage.name == name) return stage.state;
    }
    ADD_FAILURE() << "no stage named " << name;
    return StageState::Skipped;
  }
  const HairMesh mesh_ = samples::grid(4, 3, 5, 0.2);
  const StrandSet strands_ = samples::grownOn(mesh_, 3000);
};

TEST_F(Sessions, ANewCameraUploadsNoStrandDataAndKeepsTheMaps) {
  PreviewSession session = this->session(mesh_, strands_);
  const PreviewOptions options = small(96, 1);
  const Picture first = picture(session, options);
  // 3000 roots of 32 bytes and four weights each, and the topology of 12 bundles.
  EXPECT_GE(first.uploaded.strands, 3000u * (32 + 16));
  EXPECT_LE(first.uploaded.strands, 3000u * (32 + 16) + 12u * (16 + 6 * 4 * 4));
  EXPECT_EQ(first.uploaded.hairMesh, 16 * mesh_.vertices().size());
  session.setCamera(camera(60));
  const Picture turned = picture(session, options);
  EXPECT_EQ(turned.uploaded.strands, 0u);
  EXPECT_EQ(turned.uploaded.hairMesh, 0u);
  EXPECT_LE(turned.uploaded.plan, 12u * (32 + 64 * 4));  // by bundle: at most some samples of each
  EXPECT_EQ(stateOf(turned, "hair"), StageState::Reused);
  EXPECT_EQ(stateOf(turned, "shadow maps"), StageState::Reused);
  EXPECT_NE(turned.image.rgba, first.image.rgba);
  // The picture is the one that a fresh session makes.
  PreviewSession fresh = this->session(mesh_, strands_);
  fresh.setCamera(camera(60));
  EXPECT_EQ(picture(fresh, options).image.rgba, turned.image.rgba);
}

TEST_F(Sessions, ANewLightUploadsNoStrandDataAndKeepsTheStrands) {
  PreviewSession session = this->session(mesh_, strands_);
  const PreviewOptions options = small(96, 1);
  picture(session, options);
  Lights lights;
  lights.followCamera = false;
  lights.key.direction = Vec3(1, 0.2, 0.1);
  session.setLights(lights);
  const Picture lit = picture(session, options);
  EXPECT_EQ(lit.uploaded.strands + lit.uploaded.hairMesh, 0u);
  EXPECT_EQ(stateOf(lit, "strands for the eye"), StageState::Reused);
  EXPECT_EQ(stateOf(lit, "shadow maps"), StageState::Ran);
}

TEST_F(Sessions, EveryShadowMethodIsKeptWhileLightAndHairAre) {
  for (const VisibilityMethod method :
       {VisibilityMethod::Opacity, VisibilityMethod::DensityClustering, VisibilityMethod::LightMap,
        VisibilityMethod::DeepOpacity, VisibilityMethod::Occupancy, VisibilityMethod::Exact}) {
    PreviewSession session = this->session(mesh_, strands_);
    PreviewOptions options = small(48, 1);
    options.visibility.method = method;
    options.visibility.slices = 8;
    picture(session, options);
    EXPECT_EQ(stateOf(picture(session, options), "shadow maps"), StageState::Reused) << name(method);
    std::vector<Vec3> positions;
    for (const HairVertex& v : mesh_.vertices()) positions.push_back(v.position + Vec3(0.01, 0, 0));
    ASSERT_TRUE(session.moveHair(positions).ok());
    EXPECT_EQ(stateOf(picture(session, options), "shadow maps"), StageState::Ran) << name(method);
    EXPECT_EQ(stateOf(picture(session, options), "shadow maps"), StageState::Reused) << name(method);
  }
}

TEST_F(Sessions, WithoutAKeyLightNoMapIsDrawnAndThePictureIsTheSame) {
  PreviewSession session = this->session(mesh_, strands_);
  Lights lights;
  lights.followCamera = false;
  lights.key.color = Vec3f::Zero();
  session.setLights(lights);
  for (const PreviewShading shading : {PreviewShading::Studio, PreviewShading::DualScattering}) {
    PreviewOptions options = small(96, 1);
    options.shading = shading;
    const Picture left = picture(session, options);
    options.leaveOut = false;
    const Picture all = picture(session, options);
    const auto drawn = [](const Picture& made) {
      return std::ranges::count(made.stages, "strands for the maps", &StageReport::name);
    };
    EXPECT_EQ(drawn(left), 0);
    EXPECT_EQ(drawn(all), 1);
    EXPECT_EQ(left.image.rgba, all.image.rgba);
  }
}

TEST_F(Sessions, MovingTheMeshUploadsTheMeshAlone) {
  PreviewSession session = this->session(mesh_, strands_);
  const PreviewOptions options = small(96, 1);
  const Picture still = picture(session, options);
  std::vector<Vec3> positions;
  for (const HairVertex& v : mesh_.vertices())
    positions.push_back(v.position + (v.layer > 0 ? Vec3(0.3, 0, 0) : Vec3(0, 0, 0)));
  ASSERT_TRUE(session.moveHair(positions).ok());
  const Picture moved = picture(session, options);
  EXPECT_EQ(moved.uploaded.strands, 0u);
  EXPECT_EQ(moved.uploaded.hairMesh, 16 * mesh_.vertices().size());
  EXPECT_EQ(stateOf(moved, "strands for the eye"), StageState::Ran);
  EXPECT_EQ(stateOf(moved, "shadow maps"), StageState::Ran);
  EXPECT_NE(moved.image.rgba, still.image.rgba);
  positions.pop_back();
  EXPECT_EQ(session.moveHair(positions).error().code, ErrorCode::InvalidArgument);
}

TEST_F(Sessions, NothingChangedNothingIsUploadedUnlessAskedFor) {
  PreviewSession session = this->session(mesh_, strands_);
  PreviewOptions options = small(96, 1);
  const Picture first = picture(session, options), again = picture(session, options);
  EXPECT_EQ(again.uploaded.strands + again.uploaded.hairMesh + again.uploaded.plan + again.uploaded.head, 0u);
  EXPECT_EQ(again.image.rgba, first.image.rgba);
  options.keep = false;
  const Picture all = picture(session, options);
  EXPECT_EQ(stateOf(all, "strands for the eye"), StageState::Ran);
  EXPECT_EQ(stateOf(all, "shadow maps"), StageState::Ran);
  EXPECT_EQ(all.image.rgba, first.image.rgba);
}

TEST_F(Sessions, GrownStrandsLookLikeTheSameStrandsAsPoints) {
  PreviewSession grown = this->session(mesh_, strands_), points = this->session(mesh_, strands_);
  ASSERT_TRUE(points.setStrands(strands_).ok());
  PreviewOptions options = small(128, 4);
  options.lod = false;
  const Picture a = picture(grown, options), b = picture(points, options);
  EXPECT_EQ(a.strandsDrawn, b.strandsDrawn);
  EXPECT_EQ(a.segmentsDrawn, b.segmentsDrawn);
  // Only the light volume is made from other points of the strands, and rounding moves a sample now and then.
  double sum = 0;
  for (std::size_t i = 0; i < a.image.rgba.size(); ++i) sum += std::abs(a.image.rgba[i] - b.image.rgba[i]);
  EXPECT_LT(sum / double(a.image.rgba.size()) / 255, 2e-3);
}

TEST_F(Sessions, LevelOfDetailKeepsCoverageAndThePicture) {
  const StrandSet strands = samples::grownOn(mesh_, 20000, Knots::Uniform, nullptr, 0.003);
  PreviewSession session = this->session(mesh_, strands);
  PreviewOptions options = small(128, 4);
  options.lod = false;
  const Picture full = picture(session, options);
  const auto covered = [&](const Picture&) {
    double sum = 0;
    const StrandSet made = session.readBack().value();
    for (std::size_t s = 0; s < made.strandCount(); ++s) {
      for (std::size_t i = made.offsets[s]; i + 1 < made.offsets[s + 1]; ++i)
        sum += double((made.points[i + 1] - made.points[i]).norm()) * 0.5 *
               double(made.widths[i] + made.widths[i + 1]);
    }
    return sum;
  };
  const double area = covered(full);
  options.lod = true;
  for (const double fraction : {0.0, 0.2}) {
    options.strandFraction = fraction;
    const Picture less = picture(session, options);
    EXPECT_LT(less.segmentsDrawn, full.segmentsDrawn / 2);
    if (fraction > 0) {
      EXPECT_EQ(less.strandsDrawn, std::size_t(std::lround(20000 * fraction)));
    }
    // 4000 strands stand for 20000: blue noise of lengths that differ by some 10 %; chords are a little
    // shorter.
    EXPECT_NEAR(covered(less), area, 0.02 * area);
    EXPECT_NEAR(alphaSum(less.image), alphaSum(full.image), 0.03 * alphaSum(full.image));
    const auto error = flip(toLinear(less.image), toLinear(full.image));
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->mean, 0.1);  // the bar for a whole picture is 0.1
    RecordProperty("flip" + std::to_string(int(100 * fraction)), std::to_string(error->mean));
  }
}

TEST_F(Sessions, ComputeAndPipelineCoverTheSame) {
  // Few hairs, so that hardly two share a pixel: then both are the area, whatever the rule for overlaps.
  const StrandSet strands = samples::grownOn(mesh_, 60, Knots::Uniform, nullptr, 0.02);
  PreviewSession session = this->session(mesh_, strands);
  PreviewOptions options = small(256, 32);
  options.shadows = false;
  const double pipeline = alphaSum(picture(session, options).image);
  for (const bool nearest : {false, true}) {
    const auto compute = session.coverageByCompute(256, 256, nearest);
    ASSERT_TRUE(compute.ok()) << compute.error().text();
    double sum = 0;
    for (const float c : compute->coverage) sum += c;
    EXPECT_NEAR(sum, pipeline, 0.04 * pipeline);  // 8-bit alpha, 128 samples, and the few overlaps
    EXPECT_GT(sum, 500);
  }
}

TEST_F(Sessions, AStrandThatIsNotANumberIsLeftOut) {
  StrandSet strands = samples::grownOn(mesh_, 500);
  strands.weights[strands.weightOffsets[3]] = std::numeric_limits<float>::quiet_NaN();
  strands.points[strands.offsets[7]].x() = std::numeric_limits<float>::infinity();
  strands.rootFaces[11] = 4000;
  PreviewSession session = this->session(mesh_, strands);
  EXPECT_EQ(picture(session, small(64, 1)).strandsDropped, 3u);
  std::vector<Vec3> positions;
  for (const HairVertex& v : mesh_.vertices()) positions.push_back(v.position);
  std::vector<Vec3> broken = positions;
  broken[mesh_.bundles()[0].face(5)[0]].y() = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(session.moveHair(broken).ok());
  const Picture hidden = picture(session, small(64, 1));
  EXPECT_GT(hidden.strandsDropped, 20u);  // a bundle of twelve
  EXPECT_LT(hidden.strandsDropped, 300u);
  EXPECT_GT(alphaSum(hidden.image), 50);
  ASSERT_TRUE(session.moveHair(positions).ok());
  EXPECT_EQ(picture(session, small(64, 1)).strandsDropped, 3u);
}

TEST_F(Sessions, OneStrandNoWidthAndACameraInside) {
  for (const double width : {0.01, 1e-30}) {
    const StrandSet one = samples::grownOn(mesh_, 1, Knots::Uniform, nullptr, width);
    PreviewSession session = this->session(mesh_, one);
    EXPECT_EQ(picture(session, small(64, 1)).strandsDrawn, 1u);
  }
  PreviewSession session = this->session(mesh_, strands_);
  Camera inside;
  inside.eye = Vec3(2, 2, -1.5);
  inside.target = Vec3(3, 2.5, -1);
  session.setCamera(inside);
  const Picture picture = this->picture(session, small(96, 2));
  EXPECT_GT(alphaSum(picture.image), 200);
  for (std::size_t i = 0; i < picture.image.rgba.size(); i += 4) {
    const std::uint8_t* p = &picture.image.rgba[i];
    ASSERT_TRUE(p[3] <= 8 || p[0] + p[1] + p[2] > 0) << "a value that is not a number leaves black";
  }
}

TEST_F(Sessions, AMillionStrandsAreDrawn) {
  GrowOptions options;
  options.count = 1000000;
  options.points = 2;  // the GPU makes the others
  const StrandSet strands = grow(mesh_, options).value().strands;
  PreviewSession session(*preview());
  ASSERT_TRUE(session.setHair(mesh_, strands, Knots::Uniform, 32).ok());
  session.setCamera(camera());
  const Picture picture = this->picture(session, small(96, 1));
  EXPECT_LT(picture.segmentsDrawn, preview()->software() ? 500000u : 12000000u);
  EXPECT_GT(picture.strandsDrawn, 1000u);
  EXPECT_GT(alphaSum(picture.image), 1000);
}

TEST_F(Sessions, RefusesStrandsThatDoNotSayWhereTheyGrow) {
  StrandSet strands;
  testing::addStrand(strands, {Vec3f(0, 0, 0), Vec3f(0, 1, 0)}, 0.1f);
  PreviewSession session(*preview());
  EXPECT_EQ(session.setHair(mesh_, strands).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(session.moveHair({}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(session.readBack().error().code, ErrorCode::NotFound);
  EXPECT_EQ(session.coverageByCompute(8, 8).error().code, ErrorCode::NotFound);
}

}  // namespace
}  // namespace coif
