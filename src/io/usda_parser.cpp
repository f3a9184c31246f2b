// .usda text into a Layer: the grammar that real files use; compositions are skipped and noted, not resolved.
#include <Eigen/Core>
#include <set>
#include <unordered_map>

#include "usd_layer.h"
#include "usda_lexer.h"

namespace coif::io::usd {
namespace {

constexpr std::size_t kBlock = 1 << 16;  ///< numbers between two looks at the budget
constexpr int kGreatestDepth = 256;      ///< of prims in prims

bool isListOp(std::string_view word) {
  return word == "prepend" || word == "append" || word == "add" || word == "delete" || word == "reorder";
}

/// Where the attributes of the prim being read are, by name.
using Index = std::unordered_map<std::string, std::size_t>;

class TextParser {
 public:
  TextParser(std::string_view text, MemoryBudget& budget) : lexer_(text), budget_(budget) {}

  Result<Layer> layer() {
    if (!lexer_.rest().starts_with("#usda ")) return lexer_.fail("the text does not begin with '#usda'");
    lexer_.skipBlank();
    if (lexer_.peek() == '(') COIF_TRY(metadata(layer_.metadata));
    while (true) {
      lexer_.skipBlank();
      if (lexer_.atEnd()) break;
      const std::string_view word = lexer_.word();
      if (word == "reorder" || word == "relocates") {
        COIF_TRY(lexer_.skipStatement());
      } else {
        COIF_TRY(prim(word, layer_.prims, 0));
      }
    }
    for (const std::string& what : leftOut_) layer_.notes.push_back(what + " are not resolved: left out.");
    return std::move(layer_);
  }

 private:
  Status prim(std::string_view specifier, std::vector<Prim>& siblings, int depth) {
    if (depth >= kGreatestDepth) return lexer_.fail("prims are nested too deeply", ErrorCode::Unsupported);
    Prim p;
    if (specifier == "over") {
      p.specifier = Specifier::Over;
    } else if (specifier == "class") {
      p.specifier = Specifier::Class;
    } else if (specifier != "def") {
      return lexer_.fail("a prim (def, over, class) is expected here");
    }
    p.typeName = lexer_.word();
    COIF_ASSIGN(p.name, lexer_.quoted());
    lexer_.skipBlank();
    if (lexer_.peek() == '(') COIF_TRY(metadata(p.metadata));
    if (!lexer_.accept('{')) return lexer_.fail("the prim '" + p.name + "' has no body");
    Index index;
    while (!lexer_.accept('}')) {
      if (lexer_.atEnd()) return lexer_.fail("the prim '" + p.name + "' is not closed");
      COIF_TRY(primItem(p, index, depth));
    }
    siblings.push_back(std::move(p));
    return {};
  }

  Status primItem(Prim& p, Index& index, int depth) {
    std::string_view word = lexer_.word();
    if (word.empty()) return lexer_.fail("a prim or a property is expected here");
    if (word == "def" || word == "over" || word == "class") return prim(word, p.children, depth + 1);
    if (word == "variantSet") {
      leftOut_.insert("Variants");
      COIF_TRY(skipStringAndEquals());
      return lexer_.skipValue();
    }
    const std::string_view next = lexer_.peekWord();
    if (word == "reorder" && (next == "nameChildren" || next == "properties")) return lexer_.skipStatement();
    return property(word, p, index);
  }

  Status skipStringAndEquals() {
    const auto name = lexer_.quoted();
    if (!name) return name.error();
    return lexer_.accept('=') ? Status() : Status(lexer_.fail("'=' is expected here"));
  }

  /// [listop] [custom] [uniform|varying] (rel | type) name[.timeSamples|.connect|.…] [= value] [(metadata)]
  Status property(std::string_view word, Prim& p, Index& index) {
    bool remove = false, custom = false, uniform = false;
    while (isListOp(word) || word == "custom" || word == "uniform" || word == "varying" || word == "config") {
      remove |= word == "delete" || word == "reorder";
      custom |= word == "custom";
      uniform |= word == "uniform";
      word = lexer_.word();
    }
    if (word == "rel") return relationship(p, remove);
    std::string typeName(word);
    if (lexer_.accept('[')) {
      if (!lexer_.accept(']')) return lexer_.fail("']' is expected here");
      typeName += "[]";
    }
    const std::string name(lexer_.word());
    if (typeName.empty() || name.empty()) return lexer_.fail("a property is expected here");
    const auto [at, isNew] = index.emplace(name, p.attributes.size());
    if (isNew) {
      p.attributes.emplace_back();
      p.attributes.back().name = name;
      p.attributes.back().typeName = typeName;
    }
    Attribute& a = p.attributes[at->second];
    a.custom |= custom;
    a.uniform |= uniform;
    return attributeBody(a, typeOfName(typeName), remove);
  }

  Status attributeBody(Attribute& a, const Type& type, bool remove) {
    std::string_view part;
    if (lexer_.peek() == '.') {
      lexer_.advance();
      part = lexer_.word();
    }
    if (lexer_.accept('=')) {
      if (part == "connect") {
        std::vector<std::string> paths;
        COIF_TRY(targets(paths));
        if (!remove) a.connections = std::move(paths);
      } else if (part == "timeSamples") {
        COIF_TRY(timeSamples(a, type));
      } else if (part.empty()) {
        COIF_ASSIGN(a.value, value(type));
      } else {
        COIF_TRY(lexer_.skipValue());
      }
    }
    lexer_.skipBlank();
    return lexer_.peek() == '(' ? metadata(a.metadata) : Status();
  }

  Status relationship(Prim& p, bool remove) {
    Relationship r;
    r.name = lexer_.word();
    if (r.name.empty()) return lexer_.fail("a relationship is expected here");
    if (lexer_.accept('=')) COIF_TRY(targets(r.targets));
    lexer_.skipBlank();
    std::vector<Entry> ignored;
    if (lexer_.peek() == '(') COIF_TRY(metadata(ignored));
    if (!remove) p.relationships.push_back(std::move(r));
    return {};
  }

  Status targets(std::vector<std::string>& paths) {
    const bool list = lexer_.accept('[');
    if (!list && lexer_.peekWord() == "None") {
      lexer_.word();
      return {};
    }
    while (!(list && lexer_.accept(']'))) {
      COIF_ASSIGN(std::string path, lexer_.path());
      paths.push_back(std::move(path));
      if (!list) break;
      lexer_.accept(',');
    }
    return {};
  }

  /// The first sample is kept, the others are skipped.
  Status timeSamples(Attribute& a, const Type& type) {
    if (!lexer_.accept('{')) return lexer_.fail("time samples begin with '{'");
    while (!lexer_.accept('}')) {
      Sample sample;
      if (!lexer_.number(sample.time)) return lexer_.fail("a time is expected here");
      if (!lexer_.accept(':')) return lexer_.fail("':' is expected here");
      if (a.samples.empty()) {
        COIF_ASSIGN(sample.value, value(type));
        a.samples.push_back(std::move(sample));
      } else {
        COIF_TRY(lexer_.skipValue());
      }
      lexer_.accept(',');
    }
    return {};
  }

  // Values.

  Result<Value> value(const Type& type) {
    const std::string_view word = lexer_.peekWord();
    if (word == "None" || word == "AnimationBlock") {
      lexer_.word();
      return Value();
    }
    if (isText(type.base)) return texts(type);
    switch (type.base) {
      case Base::Bool:
        return numeric<std::uint8_t>(type);
      case Base::UChar:
        return numeric<std::uint8_t>(type);
      case Base::Int:
        return numeric<std::int32_t>(type);
      case Base::UInt:
        return numeric<std::uint32_t>(type);
      case Base::Int64:
        return numeric<std::int64_t>(type);
      case Base::UInt64:
        return numeric<std::uint64_t>(type);
      case Base::Half:
        return numeric<Eigen::half>(type);
      case Base::Float:
        return numeric<float>(type);
      case Base::Double:
        return numeric<double>(type);
      default:
        break;
    }
    COIF_TRY(lexer_.skipValue());
    return Value();
  }

  template <class T>
  Result<Value> numeric(const Type& type) {
    std::vector<T> numbers;
    std::size_t paid = 0;
    if (type.array) {
      if (!lexer_.accept('[')) return lexer_.fail("an array begins with '['");
      while (!lexer_.accept(']')) {
        COIF_TRY(element(type, numbers));
        lexer_.accept(',');
        if (numbers.size() - paid >= kBlock) {
          COIF_TRY(budget_.take(numbers.size() - paid, sizeof(T)));
          paid = numbers.size();
        }
      }
    } else {
      COIF_TRY(element(type, numbers));
    }
    COIF_TRY(budget_.take(numbers.size() - paid, sizeof(T)));
    const std::uint64_t count = numbers.size() / type.components;
    Value out = owned(type, std::move(numbers));
    out.array.count = count;
    return out;
  }

  /// A number, or as many as the type has, in any nesting of parentheses (matrices have rows).
  template <class T>
  Status element(const Type& type, std::vector<T>& numbers) {
    if (type.components == 1) return one(numbers);
    const std::size_t before = numbers.size();
    int depth = 0;
    do {
      lexer_.skipBlank();
      const char c = lexer_.peek();
      if (c == '(') {
        if (++depth > 2) return lexer_.fail("a tuple is nested too deeply");
        lexer_.advance();
      } else if (c == ')') {
        if (--depth < 0) return lexer_.fail("a tuple is expected here");
        lexer_.advance();
        if (depth > 0) lexer_.accept(',');
      } else {
        if (depth == 0) return lexer_.fail("a tuple is expected here");
        COIF_TRY(one(numbers));
        lexer_.accept(',');
      }
    } while (depth > 0);
    if (numbers.size() - before != type.components) {
      return lexer_.fail("a tuple of " + std::to_string(type.components) + " numbers is expected here");
    }
    return {};
  }

  template <class T>
  Status one(std::vector<T>& numbers) {
    if constexpr (std::is_integral_v<T>) {
      T number{};
      if (lexer_.number(number)) {
        numbers.push_back(number);
        return {};
      }
    } else {
      double number = 0;
      if (lexer_.number(number)) {
        if constexpr (std::is_same_v<T, double>) {
          numbers.push_back(number);
        } else {
          numbers.push_back(T(float(number)));
        }
        return {};
      }
    }
    const std::string_view word = lexer_.peekWord();
    if (word == "true" || word == "false") {
      numbers.push_back(T(word == "true"));
      lexer_.word();
      return {};
    }
    return lexer_.fail("a number is expected here");
  }

  Result<Value> texts(const Type& type) {
    Value out;
    out.type = type;
    if (!type.array) {
      COIF_TRY(text(out.strings));
      return out;
    }
    if (!lexer_.accept('[')) return lexer_.fail("an array begins with '['");
    while (!lexer_.accept(']')) {
      COIF_TRY(text(out.strings));
      lexer_.accept(',');
    }
    return out;
  }

  Status text(std::vector<std::string>& out) {
    lexer_.skipBlank();
    COIF_ASSIGN(std::string found, lexer_.peek() == '@' ? lexer_.asset() : lexer_.quoted());
    out.push_back(std::move(found));
    return {};
  }

  // Metadata: "(" [string] { [listop] key = value } ")". Kept: strings, numbers, words, lists of strings.

  Status metadata(std::vector<Entry>& entries) {
    lexer_.accept('(');
    while (!lexer_.accept(')')) {
      if (lexer_.atEnd()) return lexer_.fail("the text ends inside '(…)'");
      if (lexer_.peek() == '"' || lexer_.peek() == '\'') {  // a comment
        const auto comment = lexer_.quoted();
        if (!comment) return comment.error();
        continue;
      }
      if (lexer_.accept(',')) continue;
      std::string_view key = lexer_.word();
      if (isListOp(key)) key = lexer_.word();
      if (key.empty()) return lexer_.fail("a name is expected here");
      if (!lexer_.accept('=')) return lexer_.fail("'=' is expected here");
      noteComposition(key);
      COIF_TRY(metadataValue(key, entries));
    }
    return {};
  }

  Status metadataValue(std::string_view key, std::vector<Entry>& entries) {
    lexer_.skipBlank();
    const char c = lexer_.peek();
    double plain = 0;
    if (c == '"' || c == '\'') {
      COIF_ASSIGN(std::string found, lexer_.quoted());
      entries.push_back({std::string(key), string(std::move(found))});
      return {};
    }
    const std::string_view word = lexer_.peekWord();
    if (word == "true" || word == "false") {
      lexer_.word();
      entries.push_back({std::string(key), boolean(word == "true")});
      return {};
    }
    const bool numeral = (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.';
    if (numeral && lexer_.number(plain)) {
      entries.push_back({std::string(key), number(plain)});
      return {};
    }
    return lexer_.skipStatement();
  }

  void noteComposition(std::string_view key) {
    if (key == "references") leftOut_.insert("References");
    if (key == "payload") leftOut_.insert("Payloads");
    if (key == "subLayers") leftOut_.insert("Sublayers");
    if (key == "inherits" || key == "specializes") leftOut_.insert("Inherited prims");
  }

  TextLexer lexer_;
  Layer layer_;
  std::set<std::string> leftOut_;
  MemoryBudget& budget_;
};

}  // namespace

Result<Layer> parseText(std::string_view text, MemoryBudget& budget) {
  return TextParser(text, budget).layer();
}

}  // namespace coif::io::usd
