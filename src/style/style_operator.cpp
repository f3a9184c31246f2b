#include "coif/style/style_operator.h"

#include <algorithm>
#include <cmath>

#include "coif/style/style_kinds.h"

namespace coif {
namespace {

Error fault(std::size_t at, const std::string& part, std::string why) {
  return makeError(ErrorCode::InvalidArgument, std::move(why),
                   "[" + std::to_string(at) + "]" + (part.empty() ? "" : "." + part));
}

Status checkMask(const StyleMask& mask) {
  const auto refuse = [](std::string why) { return makeError(ErrorCode::InvalidArgument, std::move(why)); };
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (i > 0 && !(mask[i - 1].first < mask[i].first)) return refuse("a mask's vertices ascend by their ids");
    if (!(mask[i].second >= 0 && mask[i].second <= 1)) return refuse("a mask's values lie between 0 and 1");
  }
  return {};
}

Status check(const StyleOperator& op, std::size_t at) {
  const StyleKind* kind = findStyleKind(op.kind);
  if (kind == nullptr) return fault(at, "kind", makeStyleOperator(op.kind).error().message);
  if (op.name.empty()) return fault(at, "name", "an operator needs a name");
  if (!(op.amount >= 0 && op.amount <= 1)) return fault(at, "amount", "an amount lies between 0 and 1");
  for (const auto& [name, value] : op.parameters) {
    StyleOperator trial;
    trial.kind = op.kind;
    if (const Status set = setParameter(trial, name, value); !set.ok())
      return fault(at, "parameters." + name, set.error().message);
  }
  if (const Status ramp = validate(op.ramp); !ramp.ok()) return fault(at, "ramp", ramp.error().message);
  if (const Status mask = checkMask(op.mask); !mask.ok()) return fault(at, "mask", mask.error().message);
  return {};
}

}  // namespace

Status validate(std::span<const StyleOperator> stack) {
  for (std::size_t i = 0; i < stack.size(); ++i) {
    COIF_TRY(check(stack[i], i));
    if (indexOf(stack, stack[i].name) < i)
      return fault(i, "name", "two operators are named '" + stack[i].name + "'");
  }
  return {};
}

std::uint32_t indexOf(std::span<const StyleOperator> stack, std::string_view name) {
  const auto found = std::ranges::find(stack, name, &StyleOperator::name);
  return found == stack.end() ? kNone : std::uint32_t(found - stack.begin());
}

std::string freeName(std::span<const StyleOperator> stack, const std::string& wanted) {
  std::string name = wanted;
  for (int k = 2; indexOf(stack, name) != kNone; ++k) name = wanted + " " + std::to_string(k);
  return name;
}

std::vector<double> maskOf(const StyleMask& mask, const HairMesh& mesh) {
  const std::size_t count = mesh.vertices().size();
  std::vector<double> values(count, 0.0);
  std::vector<std::uint8_t> known(count, 0);
  for (std::uint32_t v = 0; v < count; ++v) {
    if (mesh.vertices()[v].layer > 0) continue;
    if (mask.empty()) values[v] = 1, known[v] = 1;
    const VertexId id = mesh.vertices()[v].id;
    const auto listed = std::ranges::lower_bound(mask, id, {}, &StyleMask::value_type::first);
    if (listed != mask.end() && listed->first == id) values[v] = listed->second, known[v] = 1;
  }
  // Vertices that a later operation made: rings of them, from those that are known inwards.
  for (bool more = !mask.empty(); more;) {
    more = false;
    std::vector<double> sums(count, 0.0);
    std::vector<int> neighbours(count, 0);
    for (const Bundle& bundle : mesh.bundles()) {
      const auto face = bundle.face(0);
      for (std::uint32_t i = 0; i < bundle.corners; ++i) {
        const std::uint32_t a = face[i], b = face[(i + 1) % bundle.corners];
        if (known[a] && !known[b]) sums[b] += values[a], ++neighbours[b];
        if (known[b] && !known[a]) sums[a] += values[b], ++neighbours[a];
      }
    }
    for (std::uint32_t v = 0; v < count; ++v) {
      if (neighbours[v] > 0) values[v] = sums[v] / neighbours[v], known[v] = 1, more = true;
    }
  }
  return values;
}

}  // namespace coif
