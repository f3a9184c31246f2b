// The light-oriented density map behind the interface of the other shadow maps.
#include "coif/light/light_density_map.h"
#include "light/map_passes.h"

namespace coif {
namespace {

class GridMap : public VisibilityMap {
 public:
  GridMap(const FragmentStream& stream, const VisibilityOptions& options, LightDensityMap map)
      : VisibilityMap(stream.view(), options, 1), map_(std::move(map)) {}
  double bytesPerTexel() const override {
    const double side = double(1 << options().gridLog2Size);
    return double(map_.bytes()) / (side * side);
  }

 protected:
  void sumsAt(std::size_t, double, std::span<double> out) const override { std::ranges::fill(out, 0.0); }
  bool ownTransmittance(const Vec3& world, double& transmittance) const override {
    transmittance = map_.transmittance(world);
    return true;
  }

 private:
  LightDensityMap map_;
};

}  // namespace

MapResult buildGrid(const FragmentStream& stream, const VisibilityOptions& options,
                    const ChannelSource& channels, const Context& context) {
  if (channels.count > 0) {
    return makeError(ErrorCode::InvalidArgument, "a light map sums no channels beside the optical depth");
  }
  LightDensityOptions grid;
  grid.log2Size = options.gridLog2Size;
  COIF_ASSIGN(LightDensityMap map, LightDensityMap::make(stream, grid, context));
  return MapResult(std::make_unique<GridMap>(stream, options, std::move(map)));
}

}  // namespace coif
