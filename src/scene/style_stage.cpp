// The stage "style": operators on the strands, and on strands that move.
#include <algorithm>

#include "coif/base/random.h"
#include "scene/evaluation_impl.h"
#include "scene/style_json.h"

namespace coif {

namespace {

std::uint64_t styleKeyOf(const StyleStack& styles, std::uint64_t strands, const Scene& scene) {
  std::uint64_t hash = hashCombine(strands, std::uint64_t(scene.upAxis));
  for (const char c : coif::scene::stylesJson(styles).dump()) hash = hashCombine(hash, std::uint8_t(c));
  return hash;
}

std::size_t fewestPoints(const StrandSet& strands) {
  std::size_t fewest = strands.pointCount();
  for (std::size_t s = 0; s < strands.strandCount(); ++s)
    fewest = std::min(fewest, std::size_t(strands.offsets[s + 1] - strands.offsets[s]));
  return fewest;
}

void noteStyle(const StyleReport& style, const StrandSet& strands, StageReport& report) {
  for (const StyleOperatorReport& op : style.operators)
    report.notes.push_back(op.name + (op.ran ? ": ran" : ": left out, " + op.leftOut));
  const std::size_t points = fewestPoints(strands);
  if (style.pointsWanted > points && strands.strandCount() > 0)
    report.notes.push_back("its waves want " + std::to_string(style.pointsWanted) +
                           " points a strand to look round, and there are " + std::to_string(points));
}

}  // namespace

Status Evaluation::Impl::style(const Scene& scene, const Context& context) {
  if (scene.styles.empty()) {
    stylePlan = {}, styled = {}, styleKey.reset();
    add("style", StageState::Skipped, "there is no operator");
    return {};
  }
  const std::uint64_t key = styleKeyOf(scene.styles, *strandsKey, scene);
  if (styleKey == key && !forced("style")) {
    if (stylePlan.changesNothing()) {
      noteStyle(stylePlan.report(), grown.strands,
                add("style", StageState::Skipped, "no operator would change anything"));
    } else {
      add("style", StageState::Reused, "neither strands nor operators changed", 0,
          styled.bytes() + stylePlan.bytes());
    }
    return {};
  }
  const Stopwatch watch;
  styleKey.reset(), stylePlan = {}, styled = {};
  StyleOptions asking;
  asking.head = head.get(), asking.runIdle = forced("style");
  context.report("styling", 0);
  auto plan = StylePlan::create(placed, grown.strands, scene.styles, asking, context);
  if (!plan.ok()) {
    Error error = plan.error();
    if (error.place.starts_with("[")) error.place = "styles" + error.place;
    return inFile(error, scene.file.string());
  }
  if (!plan->changesNothing()) {
    styled = grown.strands;
    COIF_TRY(plan->apply(placed, styled, context));
  }
  stylePlan = std::move(*plan);
  styleKey = key;
  const bool idle = stylePlan.changesNothing();
  StageReport& report = add("style", idle ? StageState::Skipped : StageState::Ran,
                            idle ? "no operator would change anything" : "strands or operators are new",
                            watch.seconds(), idle ? 0 : styled.bytes() + stylePlan.bytes());
  noteStyle(stylePlan.report(), grown.strands, report);
  return {};
}

Result<const StylePlan*> Evaluation::Impl::styleForMotion(const Scene& scene, const Context& context) {
  static const StylePlan kNothing;
  if (scene.styles.empty()) return &kNothing;
  Scene asked = scene;
  asked.strands.tolerance = 0;
  const std::uint64_t strands = strandsKeyOf(asked);
  const std::uint64_t key = styleKeyOf(scene.styles, strands, scene);
  if (styleKey == key) return &stylePlan;
  if (motionStyleKey != key) {
    motionStyleKey.reset();
    COIF_ASSIGN(const GrowResult atRest, grow(placed, growOptions(asked, head.get()), context));
    StyleOptions asking;
    asking.head = head.get();
    COIF_ASSIGN(motionPlan, StylePlan::create(placed, atRest.strands, scene.styles, asking, context));
    motionStyleKey = key;
  }
  return static_cast<const StylePlan*>(&motionPlan);
}

const StylePlan* Evaluation::stylePlan() const {
  const bool none = !impl_->styleKey || impl_->stylePlan.changesNothing();
  return none ? nullptr : &impl_->stylePlan;
}

}  // namespace coif
