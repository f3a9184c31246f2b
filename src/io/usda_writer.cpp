// USD layers as text.
#include <array>
#include <charconv>

#include "coif/base/check.h"
#include "coif/base/parallel.h"
#include "usd_layer.h"

namespace coif::io::usd {
namespace {

constexpr std::size_t kBatchElements = 16384;  ///< formatted by one thread at a time
constexpr std::size_t kBatchesInFlight = 64;   ///< text kept before it is written: some 32 MB

template <class T>
void appendNumber(T number, std::string& out) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr;
  out.append(buffer.data(), end);
}

/// Readers parse decimals as double and round again; the shortest float that survives that, too.
void appendFloat(float number, std::string& out) {
  const std::size_t start = out.size();
  appendNumber(number, out);
  double back = 0;
  std::from_chars(out.data() + start, out.data() + out.size(), back);
  if (float(back) == number || number != number) return;
  out.resize(start);
  appendNumber(double(number), out);
}

template <class T>
T load(const std::byte* bytes) {
  T number;
  std::memcpy(&number, bytes, sizeof number);
  return number;
}

void appendComponent(Base base, const std::byte* bytes, std::string& out) {
  switch (base) {
    case Base::Bool:
    case Base::UChar:
      return appendNumber(int(load<std::uint8_t>(bytes)), out);
    case Base::Int:
      return appendNumber(load<std::int32_t>(bytes), out);
    case Base::UInt:
      return appendNumber(load<std::uint32_t>(bytes), out);
    case Base::Int64:
      return appendNumber(load<std::int64_t>(bytes), out);
    case Base::UInt64:
      return appendNumber(load<std::uint64_t>(bytes), out);
    case Base::Float:
      return appendFloat(load<float>(bytes), out);
    case Base::Double:
      return appendNumber(load<double>(bytes), out);
    default:
      COIF_CHECK(false, "no text form for this kind of number");
  }
}

void appendElement(const Type& type, const std::byte* bytes, std::string& out) {
  const std::size_t size = baseBytes(type.base);
  const int row = type.components == 16 ? 4 : type.components;  // a matrix is a tuple of its rows
  if (type.components > row) out += "( ";
  for (int c = 0; c < type.components; ++c) {
    if (c > 0) out += ", ";
    if (type.components > 1 && c % row == 0) out += '(';
    appendComponent(type.base, bytes + std::size_t(c) * size, out);
    if (type.components > 1 && c % row == row - 1) out += ')';
  }
  if (type.components > row) out += " )";
}

std::string inQuotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '\n') {
      out += "\\n";
    } else if (c == '\t') {
      out += "\\t";
    } else {
      out += c;
    }
  }
  return out + '"';
}

class TextWriter {
 public:
  TextWriter(SafeFile& file, const Context& context) : file_(file), context_(context) {}

  void layer(const Layer& layer) {
    file_.write(std::string_view("#usda 1.0\n"));
    metadata(layer.metadata, 0);
    for (const Prim& p : layer.prims) prim(p, 0);
  }

 private:
  struct Piece {
    const std::byte* data = nullptr;
    std::size_t count = 0;
  };
  using Batch = std::vector<Piece>;

  void line(int depth, std::string_view text) {
    file_.write(std::string(std::size_t(depth) * 4, ' '));
    file_.write(text);
    file_.write(std::string_view("\n"));
  }

  static std::string metadataName(const Entry& entry) {
    if (entry.name == "documentation") return "doc";
    return entry.value.type.base == Base::PrependedTokens ? "prepend " + entry.name : entry.name;
  }

  /// " (...)" after a prim or an attribute, "(...)" on its own for a layer.
  void metadata(std::span<const Entry> entries, int depth) {
    if (entries.empty()) return;
    file_.write(std::string_view("(\n"));
    for (const Entry& entry : entries) {
      file_.write(std::string(std::size_t(depth) * 4 + 4, ' ') + metadataName(entry) + " = ");
      value(entry.value);
      file_.write(std::string_view("\n"));
    }
    line(depth, ")");
  }

  void value(const Value& value) {
    if (isNumeric(value.type.base)) return numeric(value);
    const bool list = value.type.array || value.type.base == Base::PrependedTokens;
    std::string out = list ? "[" : "";
    for (std::size_t i = 0; i < value.strings.size(); ++i) {
      if (i > 0) out += ", ";
      out += inQuotes(value.strings[i]);
    }
    file_.write(list ? out + "]" : out);
  }

  void numeric(const Value& value) {
    if (!value.type.array) {
      std::string out;
      appendElement(value.type, value.array.data, out);
      return file_.write(out);
    }
    file_.write(std::string_view("["));
    const std::vector<Batch> batches = split(value);
    const std::size_t size = value.elementBytes();
    std::vector<std::string> texts(std::min(kBatchesInFlight, batches.size()));
    for (std::size_t first = 0; first < batches.size() && !context_.cancelled(); first += texts.size()) {
      const std::size_t count = std::min(texts.size(), batches.size() - first);
      parallelFor(context_, count, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          texts[i].clear();
          format(value.type, size, batches[first + i], first + i == 0, texts[i]);
        }
      });
      for (std::size_t i = 0; i < count; ++i) file_.write(texts[i]);
    }
    file_.write(std::string_view("]"));
  }

  static std::vector<Batch> split(const Value& value) {
    std::vector<Batch> batches;
    std::size_t room = 0;
    value.array.forEachPiece(value.elementBytes(), [&](std::span<const std::byte> bytes) {
      std::size_t left = bytes.size() / value.elementBytes();
      const std::byte* data = bytes.data();
      while (left > 0) {
        if (room == 0) {
          batches.emplace_back();
          room = kBatchElements;
        }
        const std::size_t count = std::min(left, room);
        batches.back().push_back({data, count});
        data += count * value.elementBytes();
        left -= count;
        room -= count;
      }
    });
    return batches;
  }

  static void format(const Type& type, std::size_t size, const Batch& batch, bool first, std::string& out) {
    for (const Piece& piece : batch) {
      for (std::size_t i = 0; i < piece.count; ++i) {
        if (!first) out += ", ";
        first = false;
        appendElement(type, piece.data + i * size, out);
      }
    }
  }

  void attribute(const Attribute& a, int depth) {
    const std::string indent(std::size_t(depth) * 4, ' ');
    const std::string start =
        indent + (a.custom ? "custom " : "") + (a.uniform ? "uniform " : "") + a.typeName + " " + a.name;
    if (a.value || (a.samples.empty() && a.connections.empty())) {
      file_.write(start);
      if (a.value) {
        file_.write(std::string_view(" = "));
        value(*a.value);
      }
      if (a.metadata.empty()) {
        file_.write(std::string_view("\n"));
      } else {
        file_.write(std::string_view(" "));
        metadata(a.metadata, depth);
      }
    }
    if (!a.samples.empty()) {
      file_.write(start + ".timeSamples = {\n");
      for (const Sample& sample : a.samples) {
        std::string time = indent + "    ";
        appendNumber(sample.time, time);
        file_.write(time + ": ");
        value(sample.value);
        file_.write(std::string_view(",\n"));
      }
      line(depth, "}");
    }
    if (!a.connections.empty()) file_.write(start + ".connect = " + targets(a.connections) + "\n");
  }

  static std::string targets(const std::vector<std::string>& paths) {
    if (paths.size() == 1) return "<" + paths[0] + ">";
    std::string out = "[";
    for (const std::string& path : paths) out += (out.size() > 1 ? ", <" : "<") + path + ">";
    return out + "]";
  }

  void prim(const Prim& p, int depth) {
    const std::string indent(std::size_t(depth) * 4, ' ');
    file_.write("\n" + indent + "def " + p.typeName + " \"" + p.name + "\"");
    file_.write(std::string_view(p.metadata.empty() ? "\n" : " "));
    metadata(p.metadata, depth);
    line(depth, "{");
    for (const Attribute& a : p.attributes) attribute(a, depth + 1);
    for (const Relationship& r : p.relationships) {
      line(depth + 1, "rel " + r.name + " = " + targets(r.targets));
    }
    for (const Prim& child : p.children) prim(child, depth + 1);
    line(depth, "}");
  }

  SafeFile& file_;
  const Context& context_;
};

}  // namespace

Status writeText(const Layer& layer, SafeFile& file, const Context& context) {
  TextWriter(file, context).layer(layer);
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "writing was cancelled");
  return {};
}

}  // namespace coif::io::usd
