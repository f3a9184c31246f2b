#include "coif/scene/hairstyle.h"

#include <algorithm>
#include <array>

#include "scene/styles/style.h"

namespace coif {

namespace {

using Maker = Result<Hairstyle> (*)(const styles::StyleInput&);
struct Entry {
  std::string_view name;
  std::uint32_t cageCount;
  Maker make;
};
constexpr std::array<Entry, 5> kStyles = {{
    {"bob", 120, styles::bob},
    {"long", 110, styles::longHair},
    {"bun", 80, styles::bun},
    {"mohawk", 200, styles::mohawk},
    {"pixie", 180, styles::pixie},
}};
constexpr auto kNames = [] {
  std::array<std::string_view, kStyles.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kStyles[i].name;
  return names;
}();

const Entry* find(std::string_view style) {
  const auto it =
      std::find_if(kStyles.begin(), kStyles.end(), [&](const Entry& entry) { return entry.name == style; });
  return it == kStyles.end() ? nullptr : &*it;
}

/// The middle of the head: half way from chin to crown, where the crown is the highest point of the cage.
styles::HeadSpace spaceOf(const Cage& cage) {
  const HeadFrame& frame = cage.frame;
  double crown = -1e300;
  for (const Vec3& p : cage.positions) crown = std::max(crown, (p - frame.centre).dot(frame.up));
  styles::HeadSpace space;
  space.height = frame.height;
  space.origin = frame.centre + (crown - 0.5 * frame.height) * frame.up;
  space.axes.col(0) = -frame.right;  // as seen by somebody who looks at the face
  space.axes.col(1) = frame.up;
  space.axes.col(2) = frame.forward;
  return space;
}

}  // namespace

std::span<const std::string_view> hairstyleNames() {
  return kNames;
}

std::uint32_t suggestedCageCount(std::string_view style) {
  const Entry* entry = find(style);
  return entry ? entry->cageCount : 200;
}

Result<Hairstyle> modelHairstyle(std::string_view style, const Cage& cage, const Surface& head,
                                 const Context& context) {
  const Entry* entry = find(style);
  if (!entry) {
    return makeError(ErrorCode::InvalidArgument, "there is no hairstyle '" + std::string(style) +
                                                     "'; there are bob, long, bun, mohawk and pixie");
  }
  if (cage.positions.empty() || !(cage.frame.height > 0)) {
    return makeError(ErrorCode::Degenerate, "the cage is empty or its head has no height");
  }
  return entry->make({cage, head, spaceOf(cage), context});
}

}  // namespace coif
