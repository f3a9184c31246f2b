// A crate into a Layer.
#include <algorithm>
#include <set>
#include <unordered_map>

#include "usd_layer.h"
#include "usdc_values.h"

namespace coif::io::usd {
namespace {

using namespace crate;

constexpr int kGreatestDepth = 256;                                ///< of prims in prims
constexpr std::uint64_t kGreatestVisits = std::uint64_t{1} << 26;  ///< of fields, all specs together

class CrateReader {
 public:
  CrateReader(std::span<const std::byte> file, const Tables& tables, MemoryBudget& budget)
      : tables_(tables), values_(file, tables, budget), children_(tables.nodes.size()), budget_(budget) {}

  Result<Layer> layer() {
    for (const std::uint32_t node : tables_.order) {
      const std::uint32_t parent = tables_.nodes[node].parent;
      if (parent != kNone) children_[parent].push_back(node);
    }
    if (tables_.order.empty()) return makeError(ErrorCode::Malformed, "the crate has no root");
    Layer layer;
    const std::uint32_t root = tables_.order.front();
    std::vector<std::string> names;
    COIF_TRY(forEachField(root, [&](std::string_view name, Rep rep) -> Status {
      noteComposition(name);
      return metadata(name, rep, layer.metadata, names);
    }));
    COIF_TRY(prims(root, names, layer.prims, 0));
    for (const std::string& what : leftOut_) layer.notes.push_back(what + " are not resolved: left out.");
    return layer;
  }

 private:
  template <class F>
  Status forEachField(std::uint32_t node, F&& body) {
    const Node& n = tables_.nodes[node];
    if (n.type == SpecType{}) return {};
    for (std::size_t i = n.fieldSet; tables_.fieldSets[i] != kEndOfFieldSet; ++i) {
      if (++visits_ > kGreatestVisits) return makeError(ErrorCode::TooLarge, "the file has too many fields");
      const std::uint32_t f = tables_.fieldSets[i];
      COIF_TRY(body(tables_.tokens[tables_.fieldNames[f]], tables_.fieldReps[f]));
    }
    return {};
  }

  std::string_view nameOf(std::uint32_t node) const { return tables_.tokens[tables_.nodes[node].name]; }

  /// Copies of names and texts are paid for: one long name must not be copied a million times.
  Status pay(std::uint64_t bytes) { return budget_.take(bytes, 1); }

  Result<Value> value(Rep rep) {
    COIF_ASSIGN(Value found, values_.read(rep));
    for (const std::string& text : found.strings) COIF_TRY(pay(text.size()));
    return found;
  }

  Status metadata(std::string_view name, Rep rep, std::vector<Entry>& entries,
                  std::vector<std::string>& children) {
    if (name == "primChildren" || name == "properties") {
      COIF_ASSIGN(Value list, value(rep));
      if (name == "primChildren") children = std::move(list.strings);
      return {};
    }
    const CrateType type = rep.type();
    const bool plain = type == CrateType::Token || type == CrateType::String || type == CrateType::Double ||
                       type == CrateType::Bool || type == CrateType::Float || type == CrateType::Int;
    if (!plain || rep.array()) return {};
    COIF_TRY(pay(name.size()));
    COIF_ASSIGN(Value found, value(rep));
    entries.push_back({std::string(name), std::move(found)});
    return {};
  }

  /// The child prims of a node in the order that its primChildren field gives.
  Status prims(std::uint32_t node, const std::vector<std::string>& names, std::vector<Prim>& out, int depth) {
    if (depth > kGreatestDepth) return makeError(ErrorCode::Unsupported, "prims are nested too deeply");
    std::unordered_map<std::string_view, std::size_t> ranks;
    for (std::size_t i = 0; i < names.size(); ++i) ranks.emplace(names[i], i);
    std::vector<std::pair<std::size_t, std::uint32_t>> ordered;
    for (const std::uint32_t child : children_[node]) {
      if (nameOf(child).starts_with('{')) leftOut_.insert("Variants");
      if (tables_.nodes[child].property || tables_.nodes[child].type != SpecType::Prim) continue;
      const auto rank = ranks.find(nameOf(child));
      ordered.emplace_back(rank == ranks.end() ? names.size() : rank->second, child);
    }
    std::stable_sort(ordered.begin(), ordered.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [rank, child] : ordered) {
      out.emplace_back();
      COIF_TRY(prim(child, out.back(), depth));
    }
    return {};
  }

  Status prim(std::uint32_t node, Prim& p, int depth) {
    COIF_TRY(pay(nameOf(node).size()));
    p.name = nameOf(node);
    std::vector<std::string> names;
    COIF_TRY(forEachField(node, [&](std::string_view name, Rep rep) -> Status {
      noteComposition(name);
      if (name == "specifier") {
        p.specifier = Specifier(std::min<std::uint64_t>(rep.payload(), 2));
        return {};
      }
      if (name == "typeName") {
        COIF_ASSIGN(const Value type, value(rep));
        p.typeName = type.text();
        return {};
      }
      return metadata(name, rep, p.metadata, names);
    }));
    for (const std::uint32_t child : children_[node]) {
      if (tables_.nodes[child].property) COIF_TRY(property(child, p));
    }
    return prims(node, names, p.children, depth + 1);
  }

  Status property(std::uint32_t node, Prim& p) {
    COIF_TRY(pay(nameOf(node).size()));
    if (tables_.nodes[node].type == SpecType::Relationship) return relationship(node, p);
    if (tables_.nodes[node].type != SpecType::Attribute) return {};
    Attribute a;
    a.name = nameOf(node);
    std::vector<std::string> ignored;
    COIF_TRY(forEachField(node, [&](std::string_view name, Rep rep) -> Status {
      if (name == "default" || name == "timeSamples") {
        COIF_ASSIGN(Value found, value(rep));
        if (name == "default") {
          a.value = std::move(found);
        } else if (found.type.base != Base::None) {
          a.samples.push_back({0, std::move(found)});
        }
        return {};
      }
      if (name == "typeName") {
        COIF_ASSIGN(const Value type, value(rep));
        a.typeName = type.text();
        return {};
      }
      return metadata(name, rep, a.metadata, ignored);
    }));
    p.attributes.push_back(std::move(a));
    return {};
  }

  Status relationship(std::uint32_t node, Prim& p) {
    Relationship r;
    r.name = nameOf(node);
    COIF_TRY(forEachField(node, [&](std::string_view name, Rep rep) -> Status {
      if (name != "targetPaths") return {};
      COIF_ASSIGN(const std::vector<std::uint32_t> found, values_.paths(rep));
      for (const std::uint32_t target : found) {
        COIF_ASSIGN(std::string path, pathOf(target));
        r.targets.push_back(std::move(path));
      }
      return {};
    }));
    p.relationships.push_back(std::move(r));
    return {};
  }

  Result<std::string> pathOf(std::uint32_t node) {
    std::vector<std::uint32_t> chain;
    for (; node != kNone && tables_.nodes[node].parent != kNone; node = tables_.nodes[node].parent) {
      chain.push_back(node);
      COIF_TRY(pay(nameOf(node).size() + 1));
    }
    std::string path;
    for (auto at = chain.rbegin(); at != chain.rend(); ++at) {
      path += tables_.nodes[*at].property ? '.' : '/';
      path += nameOf(*at);
    }
    return path;
  }

  void noteComposition(std::string_view field) {
    if (field == "references") leftOut_.insert("References");
    if (field == "payload") leftOut_.insert("Payloads");
    if (field == "subLayers") leftOut_.insert("Sublayers");
    if (field == "inheritPaths" || field == "specializes") leftOut_.insert("Inherited prims");
    if (field == "variantSetNames") leftOut_.insert("Variants");
  }

  const Tables& tables_;
  ValueReader values_;
  std::vector<std::vector<std::uint32_t>> children_;
  std::set<std::string> leftOut_;
  MemoryBudget& budget_;
  std::uint64_t visits_ = 0;
};

}  // namespace

Result<Layer> readCrate(std::span<const std::byte> bytes, MemoryBudget& budget) {
  COIF_ASSIGN(const Tables tables, readTables(bytes, budget));
  return CrateReader(bytes, tables, budget).layer();
}

Result<Layer> readLayer(std::span<const std::byte> bytes, MemoryBudget& budget) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with(kMagic)) return readCrate(bytes, budget);
  if (text.starts_with("PK\x03\x04")) {
    return makeError(ErrorCode::Unsupported, "USD packages (.usdz) are not read; unpack it first");
  }
  return parseText(text, budget);
}

}  // namespace coif::io::usd
