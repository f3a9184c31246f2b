// Hair that falls: it leaves the parting or the whorl, follows the head and hangs to a cut line.
#pragma once

#include "scene/styles/style.h"

namespace coif::styles {

struct FlowStyle {
  std::uint32_t layers = 8;
  bool parted = true;
  double whorl = -0.20;      ///< w of the parting's end and of the point that hair behind it fans out from
  double fan = 0.9;          ///< pull away from the parting at the root, against gravity 1
  double reach = 0.2;        ///< head heights after which the pulls at the root have faded by 1/e
  double back = 0.6;         ///< pull backwards at the front hairline
  double length = 1.2;       ///< at most, head heights
  double thickness = 0.045;  ///< of the whole cover, head heights: the highest roots lie this far out
  double ramp = 0.75;        ///< head heights after which hair lies that far out
  double close = 0.022;      ///< the lowest roots lie this far out
  std::function<double(const Vec3&)>
      cut;             ///< height v at which hair at this point ends; empty: by length alone
  double lowest = -1;  ///< height v below which no hair falls
  double tuck = 0;     ///< pull towards the neck over the last `tuckSpan` above the cut
  double tuckSpan = 0.15;
  double shoulders = 0;  ///< pull off the shoulders' ridge: forwards for bundles before `divide`, else back
  double divide = 0.10;  ///< w at the root
};

Result<Hairstyle> flow(const StyleInput& input, FlowStyle style);

}  // namespace coif::styles
