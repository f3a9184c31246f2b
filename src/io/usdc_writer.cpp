// USD layers as crates: values as they come, then the tables that name them, then the table of contents.
#include <algorithm>
#include <map>
#include <tuple>
#include <unordered_map>

#include "coif/base/check.h"
#include "usd_coding.h"
#include "usd_crate.h"
#include "usd_layer.h"

namespace coif::io::usd {
namespace {

using namespace crate;

template <class T>
std::span<const std::byte> bytesOf(const T& value) {
  return std::as_bytes(std::span(&value, 1));
}

CrateType crateTypeOf(const Type& type) {
  for (const TypePair& pair : kNumericTypes) {
    if (pair.base == type.base && pair.components == type.components) return pair.crate;
  }
  COIF_CHECK(false, "no crate type for this kind of number");
}

/// Names and texts, each once. Path elements give property names a minus sign, so index 0 must not name one.
class Names {
 public:
  Names() { index(";-)"); }
  std::uint32_t index(std::string_view text) {
    const auto [at, isNew] = indices_.emplace(std::string(text), std::uint32_t(all_.size()));
    if (isNew) all_.push_back(at->first);
    return at->second;
  }
  std::uint32_t stringIndex(std::string_view text) {
    const std::uint32_t name = index(text);
    const auto [at, isNew] = stringIndices_.emplace(name, std::uint32_t(strings_.size()));
    if (isNew) strings_.push_back(name);
    return at->second;
  }
  const std::vector<std::string>& all() const { return all_; }
  const std::vector<std::uint32_t>& strings() const { return strings_; }

 private:
  std::unordered_map<std::string, std::uint32_t> indices_;
  std::unordered_map<std::uint32_t, std::uint32_t> stringIndices_;
  std::vector<std::string> all_;
  std::vector<std::uint32_t> strings_;
};

struct Field {
  std::uint32_t name = 0;
  Rep rep;
  auto operator<=>(const Field&) const = default;
};

class CrateWriter {
 public:
  CrateWriter(SafeFile& file, const Context& context) : file_(file), context_(context) {}

  void layer(const Layer& layer) {
    file_.write(std::vector<std::byte>(kHeaderBytes));
    names_.index("");
    addPath("", false, 0);
    Branch root;
    for (const Prim& p : layer.prims) root.children.push_back(branchOf(p));
    for (const Prim& p : layer.prims) addTargets(p, root);
    indexPaths(root);
    rootSpec(layer);
    for (const Prim& p : layer.prims) primSpecs(p, "/" + p.name);
    writeTables();
  }

 private:
  struct PathNode {
    std::int32_t element = 0;  ///< name; negative for a property
    std::int32_t jump = 0;  ///< -2 leaf, -1 child alone, 0 sibling alone, > 0 both: distance to the sibling
  };
  struct Spec {
    std::int32_t path = 0, fieldSet = 0, type = 0;
  };

  // Paths: depth first, children before properties; a path's index is its place in that order.

  void addPath(const std::string& path, bool isProperty, std::uint32_t name) {
    pathIndices_.emplace(path, std::uint32_t(paths_.size()));
    paths_.push_back({isProperty ? -std::int32_t(name) : std::int32_t(name), 0});
  }

  /// A prim's place among the paths. Targets in other layers have one too, but no spec.
  struct Branch {
    std::string name;
    std::vector<Branch> children;
    std::vector<std::string> properties;
  };

  static Branch branchOf(const Prim& p) {
    Branch branch;
    branch.name = p.name;
    for (const Prim& child : p.children) branch.children.push_back(branchOf(child));
    for (const Attribute& a : p.attributes) branch.properties.push_back(a.name);
    for (const Relationship& r : p.relationships) branch.properties.push_back(r.name);
    return branch;
  }

  /// Relationships aim at prims; connections stay within the layer.
  static void addTargets(const Prim& p, Branch& root) {
    for (const Relationship& r : p.relationships) {
      for (const std::string& target : r.targets) addTarget(target, root);
    }
    for (const Prim& child : p.children) addTargets(child, root);
  }

  static void addTarget(std::string_view path, Branch& root) {
    Branch* at = &root;
    while (!path.empty()) {
      path.remove_prefix(1);  // the slash
      const std::string_view name = path.substr(0, path.find('/'));
      path.remove_prefix(name.size());
      const auto child = std::find_if(at->children.begin(), at->children.end(),
                                      [&](const Branch& branch) { return branch.name == name; });
      at = child != at->children.end() ? &*child
                                       : &at->children.emplace_back(Branch{std::string(name), {}, {}});
    }
  }

  void indexPaths(const Branch& root) {
    paths_[0] = {std::int32_t(names_.index("")), root.children.empty() ? -2 : -1};
    for (const Branch& b : root.children) indexBranch(b, "/" + b.name, &b == &root.children.back());
  }

  void indexBranch(const Branch& b, const std::string& path, bool last) {
    const std::size_t self = paths_.size();
    addPath(path, false, names_.index(b.name));
    for (const Branch& child : b.children) {
      indexBranch(child, path + "/" + child.name, b.properties.empty() && &child == &b.children.back());
    }
    for (const std::string& name : b.properties) {
      addPath(path + "." + name, true, names_.index(name));
      paths_.back().jump = &name == &b.properties.back() ? -2 : 0;
    }
    const bool leaf = b.properties.empty() && b.children.empty();
    paths_[self].jump = leaf ? (last ? -2 : 0) : (last ? -1 : std::int32_t(paths_.size() - self));
  }

  std::uint32_t pathIndex(const std::string& path) const { return pathIndices_.at(path); }

  // Specs.

  void rootSpec(const Layer& layer) {
    std::vector<Field> fields = metadataFields(layer.metadata);
    std::vector<std::string> children;
    for (const Prim& p : layer.prims) children.push_back(p.name);
    fields.push_back(field("primChildren", tokenVector(children)));
    addSpec("", SpecType::PseudoRoot, fields);
  }

  void primSpecs(const Prim& p, const std::string& path) {
    std::vector<Field> fields;
    fields.push_back(
        field("specifier", Rep::of(CrateType::Specifier, Rep::kInlined, std::uint64_t(p.specifier))));
    fields.push_back(field("typeName", tokenRep(p.typeName)));
    for (const Field& f : metadataFields(p.metadata)) fields.push_back(f);
    std::vector<std::string> children, properties;
    for (const Prim& child : p.children) children.push_back(child.name);
    for (const Attribute& a : p.attributes) properties.push_back(a.name);
    for (const Relationship& r : p.relationships) properties.push_back(r.name);
    if (!children.empty()) fields.push_back(field("primChildren", tokenVector(children)));
    if (!properties.empty()) fields.push_back(field("properties", tokenVector(properties)));
    addSpec(path, SpecType::Prim, fields);
    for (const Attribute& a : p.attributes) attributeSpec(a, path + "." + a.name);
    for (const Relationship& r : p.relationships) {
      addSpec(path + "." + r.name, SpecType::Relationship,
              {variability(true), field("targetPaths", pathList(r.targets))});
    }
    for (const Prim& child : p.children) primSpecs(child, path + "/" + child.name);
  }

  void attributeSpec(const Attribute& a, const std::string& path) {
    std::vector<Field> fields;
    fields.push_back(field("custom", Rep::of(CrateType::Bool, Rep::kInlined, a.custom)));
    fields.push_back(field("typeName", tokenRep(a.typeName)));
    fields.push_back(variability(a.uniform));
    if (!a.connections.empty()) fields.push_back(field("connectionPaths", pathList(a.connections)));
    if (a.value) fields.push_back(field("default", valueRep(*a.value)));
    for (const Field& f : metadataFields(a.metadata)) fields.push_back(f);
    if (!a.samples.empty()) fields.push_back(field("timeSamples", timeSamples(a.samples)));
    addSpec(path, SpecType::Attribute, fields);
  }

  Field variability(bool uniform) {
    return field("variability", Rep::of(CrateType::Variability, Rep::kInlined, uniform));
  }

  std::vector<Field> metadataFields(std::span<const Entry> entries) {
    std::vector<Field> fields;
    for (const Entry& entry : entries) fields.push_back(field(entry.name, valueRep(entry.value)));
    return fields;
  }

  Field field(std::string_view name, Rep rep) { return {names_.index(name), rep}; }

  void addSpec(const std::string& path, SpecType type, const std::vector<Field>& fields) {
    std::vector<std::int32_t> set;
    for (const Field& f : fields) {
      const auto [at, isNew] = fieldIndices_.emplace(f, std::int32_t(fields_.size()));
      if (isNew) fields_.push_back(f);
      set.push_back(at->second);
    }
    set.push_back(std::int32_t(kEndOfFieldSet));
    const auto [at, isNew] = setIndices_.emplace(set, std::int32_t(fieldSets_.size()));
    if (isNew) fieldSets_.insert(fieldSets_.end(), set.begin(), set.end());
    specs_.push_back({std::int32_t(pathIndex(path)), at->second, std::int32_t(type)});
  }

  // Values.

  void align() { file_.write(std::vector<std::byte>((8 - file_.position() % 8) % 8)); }
  template <class T>
  void put(const T& value) {
    file_.write(bytesOf(value));
  }
  Rep here(CrateType type, std::uint64_t flags = 0) const { return Rep::of(type, flags, file_.position()); }
  Rep tokenRep(std::string_view text) { return Rep::of(CrateType::Token, Rep::kInlined, names_.index(text)); }

  Rep valueRep(const Value& value) {
    switch (value.type.base) {
      case Base::Token:
      case Base::String:
        return textRep(value);
      case Base::PrependedTokens:
        return prependedTokensRep(value.strings);
      default:
        return value.type.array ? arrayRep(value) : scalarRep(value);
    }
  }

  Rep textRep(const Value& value) {
    const bool isToken = value.type.base == Base::Token;
    const CrateType type = isToken ? CrateType::Token : CrateType::String;
    auto index = [&](const std::string& text) {
      return isToken ? names_.index(text) : names_.stringIndex(text);
    };
    if (!value.type.array) return Rep::of(type, Rep::kInlined, index(value.strings.at(0)));
    if (value.strings.empty()) return Rep::of(type, Rep::kArray, 0);
    std::vector<std::uint32_t> indices;
    for (const std::string& text : value.strings) indices.push_back(index(text));
    align();
    const Rep rep = here(type, Rep::kArray);
    put(std::uint64_t(indices.size()));
    file_.writeArray<std::uint32_t>(indices);
    return rep;
  }

  Rep scalarRep(const Value& value) {
    const CrateType type = crateTypeOf(value.type);
    const std::size_t size = value.elementBytes();
    std::uint64_t payload = 0;
    if (size <= 4) {
      std::memcpy(&payload, value.array.data, size);
      return Rep::of(type, Rep::kInlined, payload);
    }
    if (type == CrateType::Double) {
      double number;
      std::memcpy(&number, value.array.data, sizeof number);
      const auto narrow = float(number);
      if (double(narrow) == number) {
        std::memcpy(&payload, &narrow, sizeof narrow);
        return Rep::of(type, Rep::kInlined, payload);
      }
    }
    align();
    const Rep rep = here(type);
    file_.write(std::span(value.array.data, size));
    return rep;
  }

  /// Equal views of one array are written once.
  Rep arrayRep(const Value& value) {
    const CrateType type = crateTypeOf(value.type);
    if (value.array.count == 0) return Rep::of(type, Rep::kArray, 0);
    const auto key = std::tuple(value.array.data, value.array.runs.get(), value.array.count, type);
    const auto known = arrays_.find(key);
    if (known != arrays_.end()) return known->second;
    return arrays_[key] = newArray(value, type);
  }

  Rep newArray(const Value& value, CrateType type) {
    if (context_.cancelled()) return {};
    align();
    const bool integers =
        value.type.components == 1 && (value.type.base == Base::Int || value.type.base == Base::Int64);
    if (integers && value.array.count >= kLeastCompressed) {
      const Rep rep = here(type, Rep::kArray | Rep::kCompressed);
      put(value.array.count);
      sized(value.type.base == Base::Int ? encodeIntegers<std::int32_t>(gather<std::int32_t>(value))
                                         : encodeIntegers<std::int64_t>(gather<std::int64_t>(value)));
      return rep;
    }
    const Rep rep = here(type, Rep::kArray);
    put(value.array.count);
    value.array.forEachPiece(value.elementBytes(),
                             [&](std::span<const std::byte> bytes) { file_.write(bytes); });
    return rep;
  }

  template <class T>
  static std::vector<T> gather(const Value& value) {
    std::vector<T> all;
    all.reserve(value.array.count);
    value.array.forEachPiece(sizeof(T), [&](std::span<const std::byte> bytes) {
      const std::size_t at = all.size();
      all.resize(at + bytes.size() / sizeof(T));
      std::memcpy(all.data() + at, bytes.data(), bytes.size());
    });
    return all;
  }

  void sized(const std::vector<std::byte>& bytes) {
    put(std::uint64_t(bytes.size()));
    file_.write(bytes);
  }

  Rep tokenVector(const std::vector<std::string>& texts) {
    const Rep rep = here(CrateType::TokenVector);
    put(std::uint64_t(texts.size()));
    for (const std::string& text : texts) put(names_.index(text));
    return rep;
  }

  Rep prependedTokensRep(const std::vector<std::string>& texts) {
    const Rep rep = here(CrateType::TokenListOp);
    put(std::uint8_t(kHasPrepended));
    put(std::uint64_t(texts.size()));
    for (const std::string& text : texts) put(names_.index(text));
    return rep;
  }

  Rep pathList(const std::vector<std::string>& paths) {
    const Rep rep = here(CrateType::PathListOp);
    put(std::uint8_t(kExplicitFlag | kHasExplicit));
    put(std::uint64_t(paths.size()));
    for (const std::string& path : paths) put(pathIndex(path));
    return rep;
  }

  Rep timeSamples(const std::vector<Sample>& samples) {
    std::vector<Rep> reps;
    for (const Sample& sample : samples) reps.push_back(valueRep(sample.value));
    const Rep times = here(CrateType::DoubleVector);
    put(std::uint64_t(samples.size()));
    for (const Sample& sample : samples) put(sample.time);
    // Each part begins with the distance to where it goes on, so that readers can skip what lies between.
    const Rep rep = here(CrateType::TimeSamples);
    put(std::int64_t(8));
    put(times.bits);
    put(std::int64_t(8));
    put(std::uint64_t(reps.size()));
    for (const Rep& r : reps) put(r.bits);
    return rep;
  }

  // Tables.

  template <class F>
  void section(std::string_view name, F&& body) {
    const std::uint64_t start = file_.position();
    body();
    sections_.push_back({std::string(name), start, file_.position() - start});
  }

  template <class F>
  void column(std::size_t count, F&& pick) {
    std::vector<std::int32_t> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = pick(i);
    sized(encodeIntegers<std::int32_t>(values));
  }

  void writeTables() {
    section("TOKENS", [&] { writeTokens(); });
    section("STRINGS", [&] {
      put(std::uint64_t(names_.strings().size()));
      file_.writeArray<std::uint32_t>(names_.strings());
    });
    section("FIELDS", [&] {
      put(std::uint64_t(fields_.size()));
      column(fields_.size(), [&](std::size_t i) { return std::int32_t(fields_[i].name); });
      std::vector<std::uint64_t> reps;
      for (const Field& f : fields_) reps.push_back(f.rep.bits);
      sized(compress(std::as_bytes(std::span(reps))));
    });
    section("FIELDSETS", [&] {
      put(std::uint64_t(fieldSets_.size()));
      column(fieldSets_.size(), [&](std::size_t i) { return fieldSets_[i]; });
    });
    section("PATHS", [&] {
      put(std::uint64_t(paths_.size()));
      put(std::uint64_t(paths_.size()));
      column(paths_.size(), [](std::size_t i) { return std::int32_t(i); });
      column(paths_.size(), [&](std::size_t i) { return paths_[i].element; });
      column(paths_.size(), [&](std::size_t i) { return paths_[i].jump; });
    });
    section("SPECS", [&] {
      put(std::uint64_t(specs_.size()));
      column(specs_.size(), [&](std::size_t i) { return specs_[i].path; });
      column(specs_.size(), [&](std::size_t i) { return specs_[i].fieldSet; });
      column(specs_.size(), [&](std::size_t i) { return specs_[i].type; });
    });
    writeContents();
  }

  void writeTokens() {
    std::string text;
    for (const std::string& name : names_.all()) text.append(name).push_back('\0');
    put(std::uint64_t(names_.all().size()));
    put(std::uint64_t(text.size()));
    sized(compress(std::as_bytes(std::span(text))));
  }

  void writeContents() {
    const std::uint64_t contents = file_.position();
    put(std::uint64_t(sections_.size()));
    for (const auto& [name, start, size] : sections_) {
      std::array<char, 16> padded{};
      name.copy(padded.data(), padded.size() - 1);
      put(padded);
      put(start);
      put(size);
    }
    const std::uint64_t end = file_.position();
    file_.seek(0);
    file_.write(kMagic);
    put(kVersion);
    put(contents);
    file_.seek(end);
  }

  struct Section {
    std::string name;
    std::uint64_t start = 0, size = 0;
  };
  using ArrayKey = std::tuple<const std::byte*, const std::vector<Run>*, std::uint64_t, CrateType>;

  SafeFile& file_;
  const Context& context_;
  Names names_;
  std::vector<PathNode> paths_;
  std::unordered_map<std::string, std::uint32_t> pathIndices_;
  std::vector<Field> fields_;
  std::map<Field, std::int32_t> fieldIndices_;
  std::vector<std::int32_t> fieldSets_;
  std::map<std::vector<std::int32_t>, std::int32_t> setIndices_;
  std::vector<Spec> specs_;
  std::map<ArrayKey, Rep> arrays_;
  std::vector<Section> sections_;
};

}  // namespace

Status writeCrate(const Layer& layer, SafeFile& file, const Context& context) {
  CrateWriter(file, context).layer(layer);
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "writing was cancelled");
  return {};
}

}  // namespace coif::io::usd
