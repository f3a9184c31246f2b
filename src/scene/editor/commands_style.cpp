// The style's stack: operators added, told, ordered, named and masked.
#include <algorithm>
#include <cmath>

#include "coif/hairmesh/brush.h"
#include "coif/style/style_kinds.h"
#include "coif/style/style_plan.h"
#include "scene/editor/command_table.h"

namespace coif::editor {
namespace {

constexpr std::uint32_t kMostFitted = 256;  // points a strand that an operator is given unasked

CommandArgument operatorArgument() {
  return text("operator", "", "Name of the operator.");
}

Result<std::uint32_t> chosen(const Work& work, const Arguments& arguments) {
  const std::string& name = arguments.text("operator");
  const std::uint32_t at = indexOf(work.state.styles, name);
  if (at != kNone) return at;
  std::string known;
  for (const StyleOperator& op : work.state.styles) known += (known.empty() ? "'" : ", '") + op.name + "'";
  return refuse("there is no operator '" + name + "'; " +
                (known.empty() ? "the style has none" : "there are " + known));
}

/// Fixed points, as many as the style's waves want.
void fitPoints(Work& work, std::uint32_t least, std::uint32_t most) {
  StrandSettings& strands = work.state.strands;
  const std::uint32_t wanted = pointsWanted(work.state.styles, work.mesh, work.metersPerUnit);
  if (wanted == 0) return;
  strands.points = std::clamp(wanted, least, std::max(least, most));
  strands.tolerance = 0;
}

Status addOperator(Work& work, const Arguments& arguments) {
  StyleStack& stack = work.state.styles;
  COIF_ASSIGN(StyleOperator op, makeStyleOperator(arguments.text("kind")));
  const std::string& name = arguments.text("name");
  op.name = freeName(stack, name.empty() ? op.name : name);
  // Two of a kind are two different throws.
  op.seed += std::uint64_t(std::ranges::count(stack, op.kind, &StyleOperator::kind));
  const double at = arguments.number("at");
  const std::size_t position = at < 0 ? stack.size() : std::min(std::size_t(at), stack.size());
  stack.insert(stack.begin() + std::ptrdiff_t(position), std::move(op));
  if (arguments.flag("fit_points")) fitPoints(work, work.state.strands.points, kMostFitted);
  return {};
}

Status removeOperator(Work& work, const Arguments& arguments) {
  COIF_ASSIGN(const std::uint32_t at, chosen(work, arguments));
  work.state.styles.erase(work.state.styles.begin() + at);
  return {};
}

Status moveOperator(Work& work, const Arguments& arguments) {
  COIF_ASSIGN(const std::uint32_t at, chosen(work, arguments));
  StyleStack& stack = work.state.styles;
  const std::size_t to = std::min(std::size_t(arguments.number("to")), stack.size() - 1);
  StyleOperator op = std::move(stack[at]);
  stack.erase(stack.begin() + at);
  stack.insert(stack.begin() + std::ptrdiff_t(to), std::move(op));
  return {};
}

Status renameOperator(Work& work, const Arguments& arguments) {
  COIF_ASSIGN(const std::uint32_t at, chosen(work, arguments));
  const std::string& name = arguments.text("name");
  if (name.empty()) return refuse("an operator needs a name");
  const std::uint32_t other = indexOf(work.state.styles, name);
  if (other != kNone && other != at) return refuse("another operator is named '" + name + "'");
  work.state.styles[at].name = name;
  return {};
}

/// What every operator has beside its kind's parameters.
Result<bool> setCommon(const Work& work, StyleOperator& op, const Arguments& arguments) {
  const std::string& what = arguments.text("parameter");
  const double value = arguments.number("value");
  if (what == "amount") {
    if (!(value >= 0 && value <= 1)) return refuse("amount wants a number from 0 to 1");
    op.amount = value;
  } else if (what == "enabled") {
    const std::string& word = arguments.text("text");
    const bool known = word.empty() ? value == 0 || value == 1 : word == "on" || word == "off";
    if (!known) return refuse("enabled wants on or off");
    op.enabled = word.empty() ? value == 1 : word == "on";
  } else if (what == "seed") {
    if (!(value >= 0 && value <= 9e15) || value != std::floor(value))
      return refuse("seed wants a whole number from 0 to 9e15");
    op.seed = std::uint64_t(value);
  } else if (what == "group") {
    const std::string& group = arguments.text("text");
    if (!group.empty() && std::ranges::find(work.mesh.groupNames(), group) == work.mesh.groupNames().end())
      return refuse("there is no group '" + group + "'");
    op.group = group;
  } else {
    return false;
  }
  return true;
}

Status setOperator(Work& work, const Arguments& arguments) {
  COIF_ASSIGN(const std::uint32_t at, chosen(work, arguments));
  StyleOperator& op = work.state.styles[at];
  COIF_ASSIGN(const bool common, setCommon(work, op, arguments));
  if (common) return {};
  const std::string& word = arguments.text("text");
  return word.empty() ? setParameter(op, arguments.text("parameter"), arguments.number("value"))
                      : setParameter(op, arguments.text("parameter"), word);
}

Status setRamp(Work& work, const Arguments& arguments) {
  COIF_ASSIGN(const std::uint32_t at, chosen(work, arguments));
  const auto& numbers = arguments.numbers("points");
  if (numbers.size() % 2 != 0) return refuse("points must hold two numbers a point");
  Ramp ramp;
  ramp.points.clear();
  for (std::size_t i = 0; i < numbers.size(); i += 2) ramp.points.push_back({numbers[i], numbers[i + 1]});
  ramp.shape = arguments.text("shape") == "linear" ? RampShape::Linear : RampShape::Smooth;
  COIF_TRY(validate(ramp));
  work.state.styles[at].ramp = std::move(ramp);
  return {};
}

/// A mask with every root vertex in it.
void adoptMask(const Work& work, StyleOperator& op, const std::vector<double>& values) {
  op.mask.clear();
  for (std::uint32_t v = 0; v < values.size(); ++v) {
    if (work.mesh.vertices()[v].layer == 0) op.mask.push_back({work.mesh.vertices()[v].id, values[v]});
  }
  const auto whole = [](const auto& entry) { return entry.second == 1; };
  if (std::ranges::all_of(op.mask, whole)) op.mask.clear();
}

Status setMask(Work& work, const Arguments& arguments) {
  COIF_ASSIGN(const std::uint32_t at, chosen(work, arguments));
  StyleOperator& op = work.state.styles[at];
  const auto &ids = arguments.numbers("vertices"), &values = arguments.numbers("values");
  if (ids.empty()) return op.mask.clear(), Status();
  if (values.size() != 1 && values.size() != ids.size())
    return refuse("values must hold one number, or one a vertex");
  std::vector<double> mask = maskOf(op.mask, work.mesh);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const double value = values[values.size() == 1 ? 0 : i];
    const bool real = ids[i] >= 0 && ids[i] < kNone && ids[i] == std::floor(ids[i]);
    const std::uint32_t v = real ? work.mesh.indexOf(VertexId(std::uint32_t(ids[i]))) : kNone;
    if (v == kNone || work.mesh.vertices()[v].layer > 0)
      return refuse("a mask lies on the root layer's vertices, and one of these is none");
    if (!(value >= 0 && value <= 1)) return refuse("a mask's values lie between 0 and 1");
    mask[v] = value;
  }
  adoptMask(work, op, mask);
  return {};
}

double distanceToLine(const Vec3& point, std::span<const Vec3> path, const Vec3& through) {
  const auto flat = [&](const Vec3& v) {
    return through.isZero(0) ? v : Vec3(v - v.dot(through) / through.squaredNorm() * through);
  };
  double nearest = flat(point - path[0]).norm();
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vec3 along = flat(path[i] - path[i - 1]), from = flat(point - path[i - 1]);
    const double length = along.squaredNorm();
    const double t = length > 0 ? std::clamp(from.dot(along) / length, 0.0, 1.0) : 0;
    nearest = std::min(nearest, (from - t * along).norm());
  }
  return nearest;
}

Status paintMask(Work& work, const Arguments& arguments) {
  COIF_ASSIGN(const std::uint32_t at, chosen(work, arguments));
  COIF_ASSIGN(const std::vector<Vec3> path, pointsOf(arguments.numbers("path"), "path"));
  if (path.empty()) return refuse("a stroke needs a point");
  StyleOperator& op = work.state.styles[at];
  std::vector<double> mask = maskOf(op.mask, work.mesh);
  COIF_ASSIGN(const std::unique_ptr<Mirror> partners, work.mirror());
  const std::vector<double> before = mask;
  const auto paint = [&](std::uint32_t v, double share) {
    const double painted = before[v] + share * (arguments.number("value") - before[v]);
    if (std::abs(painted - before[v]) > std::abs(mask[v] - before[v])) mask[v] = painted;
  };
  for (std::uint32_t v = 0; v < mask.size(); ++v) {
    if (work.mesh.vertices()[v].layer > 0) continue;
    const double far = distanceToLine(work.mesh.position(v), path, arguments.vector("through"));
    const double share =
        arguments.number("strength") * falloffAt(falloffOf(arguments), far / arguments.number("radius"));
    if (!(share > 0)) continue;
    paint(v, share);
    if (partners && partners->vertexPartner[v] != kNone) paint(partners->vertexPartner[v], share);
  }
  adoptMask(work, op, mask);
  return {};
}

}  // namespace

std::vector<Command> styleCommands() {
  std::vector<std::string> kinds;
  for (const StyleKind& kind : styleKinds()) kinds.push_back(kind.name);
  return {
      {{"add_operator",
        "Add operator",
        "Style",
        "",
        "Does something to all strands: curls, clumps, cuts them.",
        {choice("kind", kinds, "What it does."), text("name", "", "Its name; empty: that of its kind."),
         integer("at", -1, -1, 1e6, "Place in the stack, counted from 0; -1: the end."),
         flag("fit_points", true, "Strands get the points that its waves want, 256 at most.")}},
       addOperator},
      {{"set_operator",
        "Set operator",
        "Style",
        "",
        "Changes one thing about an operator.",
        {operatorArgument(),
         text("parameter", "amount", "A parameter of its kind, or amount, enabled, seed or group."),
         number("value", 1, -1e300, 1e300, "What it becomes; of a choice, the index."),
         text("text", "", "The same in words: a choice, on or off, a group.")}},
       setOperator},
      {{"set_ramp",
        "Set ramp",
        "Style",
        "",
        "How strong an operator is from root to tip.",
        {operatorArgument(), numbers("points", "Two numbers a point: 0 root to 1 tip, and 0 to 1."),
         choice("shape", {"smooth", "linear"}, "Between the points.")}},
       setRamp},
      {{"remove_operator",
        "Remove operator",
        "Style",
        "Ctrl+Shift+X",
        "Takes an operator away.",
        {operatorArgument()}},
       removeOperator},
      {{"move_operator",
        "Move operator",
        "Style",
        "",
        "Changes when an operator acts.",
        {operatorArgument(), integer("to", 0, 0, 1e6, "Place in the stack, counted from 0.")}},
       moveOperator},
      {{"rename_operator",
        "Rename operator",
        "Style",
        "",
        "Gives an operator another name.",
        {operatorArgument(), text("name", "", "The new name.")}},
       renameOperator},
      {{"set_mask",
        "Set mask",
        "Style",
        "Ctrl+Shift+M",
        "Says on which part of the head an operator acts; without vertices: on all of it.",
        {operatorArgument(), numbers("vertices", "Ids of root vertices."),
         numbers("values", "0 to 1, one for all or one each.")}},
       setMask},
      {{"paint_mask",
        "Paint mask",
        "Style",
        "",
        "Changes an operator's mask along a line over the scalp.",
        {operatorArgument(), numbers("path", "Three numbers a point, scene units."),
         number("radius", 1, 1e-9, 1e12, "Scene units."), number("value", 1, 0, 1, "What the mask goes to."),
         number("strength", 1, 0, 1, "How far it goes there."), falloffArgument(),
         vector("through", Vec3::Zero(), "Unless zero: the brush reaches all along this direction.")}},
       paintMask},
      {{"fit_points", "Fit points", "Style", "Ctrl+Shift+F",
        "Gives strands the points that the style's waves want."},
       [](Work& work, const Arguments&) -> Status {
         if (pointsWanted(work.state.styles, work.mesh, work.metersPerUnit) == 0)
           return refuse("the style has no waves, so any number of points does");
         fitPoints(work, 2, 1000);
         return {};
       }},
  };
}

}  // namespace coif::editor
