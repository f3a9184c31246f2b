#include "usdc_tables.h"

#include <algorithm>

#include "usd_coding.h"

namespace coif::io::usd::crate {
namespace {

constexpr std::uint8_t kLeastMinor = 4, kGreatestMinor = 13;

struct Section {
  std::string_view name;
  std::uint64_t start = 0, size = 0;
};

class TableReader {
 public:
  TableReader(std::span<const std::byte> file, MemoryBudget& budget) : file_(file), budget_(budget) {}

  Result<Tables> read() {
    COIF_TRY(header());
    COIF_TRY(names());
    COIF_TRY(fields());
    COIF_TRY(paths());
    COIF_TRY(specs());
    return std::move(tables_);
  }

 private:
  static Error broken(const std::string& section, const std::string& why) {
    return makeError(ErrorCode::Malformed, why, section.empty() ? "" : "section " + section);
  }

  Status header() {
    Cursor cursor(file_, kMagic.size());
    const auto version = cursor.take<std::array<std::uint8_t, 8>>();
    const auto contents = cursor.take<std::uint64_t>();
    if (!cursor.ok) return broken("", "the file is too short for a crate");
    if (version[0] != 0 || version[1] < kLeastMinor || version[1] > kGreatestMinor) {
      return makeError(ErrorCode::Unsupported,
                       "crates of version " + std::to_string(version[0]) + "." + std::to_string(version[1]) +
                           " are not read (0.4 to 0.13 are)",
                       "byte 8");
    }
    tables_.minor = version[1];
    Cursor list(file_, contents);
    const auto count = list.take<std::uint64_t>();
    if (!list.ok || count > list.left() / kSectionBytes)
      return broken("", "the table of contents is cut off");
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto name = list.takeBytes(16);
      const auto start = list.take<std::uint64_t>(), size = list.take<std::uint64_t>();
      if (start > file_.size() || size > file_.size() - start) {
        return broken("", "a section lies outside the file");
      }
      const auto* text = reinterpret_cast<const char*>(name.data());
      sections_.push_back({std::string_view(text, std::find(text, text + 16, '\0')), start, size});
    }
    return {};
  }

  Result<Cursor> open(std::string_view name) const {
    for (const Section& s : sections_) {
      if (s.name == name) return Cursor(file_.first(s.start + s.size), s.start);
    }
    return broken(std::string(name), "the section is missing");
  }

  Status names() {
    COIF_ASSIGN(Cursor cursor, open("TOKENS"));
    const auto count = cursor.take<std::uint64_t>(), size = cursor.take<std::uint64_t>();
    const auto packed = cursor.takeSized();
    if (!cursor.ok || count > size) return broken("TOKENS", "the section is cut off");
    COIF_TRY(budget_.take(size, 1));
    COIF_TRY(budget_.take(count, sizeof(std::string_view)));
    COIF_ASSIGN(tables_.text, decompress(packed, size));
    const auto* at = reinterpret_cast<const char*>(tables_.text.data());
    const char* end = at + tables_.text.size();
    while (at != end && tables_.tokens.size() < count) {
      const char* stop = std::find(at, end, '\0');
      if (stop == end) break;
      tables_.tokens.emplace_back(at, std::size_t(stop - at));
      at = stop + 1;
    }
    if (tables_.tokens.size() != count || count == 0) return broken("TOKENS", "the names are not all there");
    return strings();
  }

  Status strings() {
    COIF_ASSIGN(Cursor cursor, open("STRINGS"));
    const auto count = cursor.take<std::uint64_t>();
    if (!cursor.ok || count > cursor.left() / 4) return broken("STRINGS", "the section is cut off");
    for (std::uint64_t i = 0; i < count; ++i) tables_.strings.push_back(cursor.take<std::uint32_t>());
    return inRange("STRINGS", tables_.strings, tables_.tokens.size());
  }

  static Status inRange(const char* section, const std::vector<std::uint32_t>& indices, std::size_t count) {
    const bool good = std::all_of(indices.begin(), indices.end(), [&](std::uint32_t i) { return i < count; });
    return good ? Status() : Status(broken(section, "an index is out of range"));
  }

  Result<std::vector<std::uint32_t>> column(const char* section, Cursor& cursor, std::uint64_t count) {
    const auto packed = cursor.takeSized();
    if (!cursor.ok) return broken(section, "the section is cut off");
    COIF_TRY(budget_.take(count, 16));  // coded, decoded and copied
    auto values = decodeIntegers<std::int32_t>(packed, count);
    if (!values) return broken(section, values.error().message);
    return std::vector<std::uint32_t>(values->begin(), values->end());
  }

  Status fields() {
    COIF_ASSIGN(Cursor cursor, open("FIELDS"));
    const auto count = cursor.take<std::uint64_t>();
    COIF_ASSIGN(tables_.fieldNames, column("FIELDS", cursor, count));
    COIF_TRY(inRange("FIELDS", tables_.fieldNames, tables_.tokens.size()));
    const auto packed = cursor.takeSized();
    if (!cursor.ok) return broken("FIELDS", "the section is cut off");
    COIF_ASSIGN(const std::vector<std::byte> reps, decompress(packed, count * sizeof(Rep)));
    if (reps.size() != count * sizeof(Rep)) return broken("FIELDS", "the values are not all there");
    tables_.fieldReps.resize(count);
    if (count > 0) std::memcpy(tables_.fieldReps.data(), reps.data(), reps.size());

    COIF_ASSIGN(Cursor sets, open("FIELDSETS"));
    const auto setCount = sets.take<std::uint64_t>();
    COIF_ASSIGN(tables_.fieldSets, column("FIELDSETS", sets, setCount));
    for (const std::uint32_t f : tables_.fieldSets) {
      if (f != kEndOfFieldSet && f >= count) return broken("FIELDSETS", "an index is out of range");
    }
    const bool closed = tables_.fieldSets.empty() || tables_.fieldSets.back() == kEndOfFieldSet;
    return closed ? Status() : Status(broken("FIELDSETS", "the last set is not closed"));
  }

  Status paths() {
    COIF_ASSIGN(Cursor cursor, open("PATHS"));
    const auto count = cursor.take<std::uint64_t>(), coded = cursor.take<std::uint64_t>();
    COIF_ASSIGN(const auto indices, column("PATHS", cursor, coded));
    COIF_ASSIGN(const auto elements, column("PATHS", cursor, coded));
    COIF_ASSIGN(const auto jumps, column("PATHS", cursor, coded));
    // Every path is coded once, so a count beyond that is a lie.
    if (count > coded) return broken("PATHS", "there are fewer paths than the section says");
    COIF_TRY(budget_.take(count, sizeof(Node) + 64));
    COIF_TRY(inRange("PATHS", indices, count));
    tables_.nodes.resize(count);
    return walk(indices, elements, jumps);
  }

  /// Depth first; a jump of -2 ends a branch, -1 goes on to a child, 0 to a sibling, more to both.
  Status walk(const std::vector<std::uint32_t>& indices, const std::vector<std::uint32_t>& elements,
              const std::vector<std::uint32_t>& jumps) {
    struct Todo {
      std::uint64_t at;
      std::uint32_t parent;
    };
    std::vector<Todo> todo;
    std::vector<bool> seen(tables_.nodes.size(), false);
    if (!indices.empty()) todo.push_back({0, kNone});
    while (!todo.empty()) {
      auto [at, parent] = todo.back();
      todo.pop_back();
      for (bool more = true; more;) {
        if (at >= indices.size() || seen[indices[at]]) return broken("PATHS", "the tree of paths is broken");
        const std::uint32_t self = indices[at];
        seen[self] = true;
        COIF_TRY(place(self, parent, std::int32_t(elements[at])));
        const auto jump = std::int32_t(jumps[at]);
        const bool child = jump > 0 || jump == -1, sibling = jump >= 0;
        if (child && sibling) todo.push_back({at + std::uint64_t(jump), parent});
        if (child) parent = self;
        more = child || sibling;
        ++at;
      }
    }
    return {};
  }

  Status place(std::uint32_t self, std::uint32_t parent, std::int32_t element) {
    const std::uint64_t name = std::uint64_t(std::abs(std::int64_t(element)));
    if (name >= tables_.tokens.size()) return broken("PATHS", "an index is out of range");
    if (parent != kNone && tables_.nodes[parent].property) return broken("PATHS", "a property has children");
    tables_.nodes[self].parent = parent;
    tables_.nodes[self].name = std::uint32_t(name);
    tables_.nodes[self].property = element < 0;
    tables_.order.push_back(self);
    return {};
  }

  Status specs() {
    COIF_ASSIGN(Cursor cursor, open("SPECS"));
    const auto count = cursor.take<std::uint64_t>();
    COIF_ASSIGN(const auto paths, column("SPECS", cursor, count));
    COIF_ASSIGN(const auto sets, column("SPECS", cursor, count));
    COIF_ASSIGN(const auto types, column("SPECS", cursor, count));
    COIF_TRY(inRange("SPECS", paths, tables_.nodes.size()));
    COIF_TRY(inRange("SPECS", sets, tables_.fieldSets.size()));
    for (std::size_t i = 0; i < count; ++i) {
      tables_.nodes[paths[i]].type = SpecType(std::int32_t(types[i]));
      tables_.nodes[paths[i]].fieldSet = sets[i];
    }
    return {};
  }

  std::span<const std::byte> file_;
  std::vector<Section> sections_;
  Tables tables_;
  MemoryBudget& budget_;
};

}  // namespace

Result<Tables> readTables(std::span<const std::byte> file, MemoryBudget& budget) {
  return TableReader(file, budget).read();
}

}  // namespace coif::io::usd::crate
