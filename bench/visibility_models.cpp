#include "bench/visibility_models.h"

#include <cstdlib>
#include <filesystem>

#include "coif/base/random.h"
#include "coif/io/strand_io.h"
#include "coif/light/fragments.h"
#include "coif/light/opaque_map.h"
#include "coif/scalp/example_head.h"
#include "coif/scalp/region.h"
#include "coif/scene/hairstyle.h"
#include "coif/strands/grow.h"

namespace coif {
namespace {

Box boxOf(const StrandSet& strands) {
  Box box{Vec3::Constant(HUGE_VAL), Vec3::Constant(-HUGE_VAL)};
  for (const Vec3f& p : strands.points) {
    if (!p.allFinite()) continue;
    box.lo = box.lo.cwiseMin(p.cast<double>());
    box.hi = box.hi.cwiseMax(p.cast<double>());
  }
  return box;
}

struct Mannequin {
  Surface surface{makeExampleHead()};
  Region region = require(automaticCap(surface));
};

HairModel styled(const Mannequin& head, const std::string& style, const std::string& called,
                 std::size_t count, const BenchOptions& options) {
  CageOptions cage;
  cage.count = int(suggestedCageCount(style));
  const Cage laid = require(buildCage(head.surface.mesh(), head.surface, head.region, cage, options.context));
  const Hairstyle hairstyle = require(modelHairstyle(style, laid, head.surface, options.context));
  GrowOptions growing;
  growing.count = count;
  growing.seed = options.seed;
  growing.head = &head.surface;
  HairModel model{
      called, require(grow(hairstyle.mesh, growing, options.context)).strands, head.surface.mesh(), {}};
  model.box = boxOf(model.strands);
  return model;
}

std::filesystem::path sharedData() {
  const char* named = std::getenv("COIF_SHARED_DATA");
  return named != nullptr ? named : COIF_BENCH_DATA;
}

HairModel fileOr(const Mannequin& head, const std::string& name, const std::string& style,
                 const BenchOptions& options) {
  const auto path = sharedData() / "strands" / (name + ".hair");
  std::error_code failed;
  if (!std::filesystem::exists(path, failed))
    return styled(head, style, name + " (generated)", 20000, options);
  HairModel model{name, require(loadStrands(path)), {}, {}};
  model.box = boxOf(model.strands);
  return model;
}

struct PixelFragment {
  float depth, alpha, along;
  std::uint32_t point;
};

}  // namespace

std::vector<HairModel> hairModels(const BenchOptions& options) {
  const Mannequin head;
  std::vector<HairModel> models;
  models.push_back(styled(head, "bob", "bob", options.quick ? 8000 : 100000, options));
  if (options.quick) return models;
  models.push_back(fileOr(head, "ponytail", "long", options));
  models.push_back(fileOr(head, "mohawk", "mohawk", options));
  return models;
}

std::vector<SeenPoint> seenPoints(const HairModel& model, const Camera& camera, int pixels,
                                  const BenchOptions& options) {
  // The picture is the map of a pinhole where the eye is.
  const LightView view = pointLightView(camera.eye, model.box, pixels);
  const OpaqueMap head = require(OpaqueMap::make(model.head, view, options.context));
  FragmentOptions cut;
  cut.opaque = &head;
  const FragmentStream stream = require(FragmentStream::make(model.strands, view, cut, options.context));
  std::vector<SeenPoint> seen;
  std::vector<std::vector<PixelFragment>> band(std::size_t(FragmentStream::kBandRows * pixels));
  for (int b = 0; b < stream.bandCount(); ++b) {
    const std::size_t first = std::size_t(b) * band.size();
    for (auto& pixel : band) pixel.clear();
    stream.forBand(b, [&](const Fragment& f) {
      band[f.texel - first].push_back({f.depth, f.alpha, f.along, f.point});
    });
    for (std::size_t i = 0; i < band.size(); ++i) {
      auto& pixel = band[i];
      if (pixel.empty()) continue;
      std::stable_sort(pixel.begin(), pixel.end(),
                       [](const auto& u, const auto& v) { return u.depth < v.depth; });
      double through = 1;
      for (const PixelFragment& f : pixel) through *= 1 - double(f.alpha);
      const double coverage = 1 - through;
      double drawn = coverage * CounterRandom(options.seed, first + i).uniform(0);
      double left = 1;
      const PixelFragment* chosen = &pixel.back();
      for (const PixelFragment& f : pixel) {
        drawn -= left * double(f.alpha);
        left *= 1 - double(f.alpha);
        if (drawn < 0) {
          chosen = &f;
          break;
        }
      }
      const Vec3 a = model.strands.points[chosen->point].cast<double>();
      const Vec3 d = model.strands.points[chosen->point + 1].cast<double>() - a;
      seen.push_back({a + double(chosen->along) * d, coverage, first + i});
    }
  }
  return seen;
}

}  // namespace coif
