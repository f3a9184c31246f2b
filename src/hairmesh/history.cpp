#include "coif/hairmesh/history.h"

#include <algorithm>
#include <cstring>

#include "hairmesh/builder.h"

namespace coif {
namespace {

std::uint32_t idOf(const HairMesh& mesh, std::uint32_t vertex) {
  return vertex == kNone ? kNone : std::uint32_t(mesh.vertices()[vertex].id);
}

/// Walks two ranges that ascend by key; onlyA, onlyB, both are called with the elements.
template <class A, class B, class Key, class OnlyA, class OnlyB, class Both>
void mergeById(A&& a, B&& b, Key key, OnlyA onlyA, OnlyB onlyB, Both both) {
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() || j != b.end()) {
    if (j == b.end() || (i != a.end() && key(*i) < key(*j))) {
      onlyA(*i++);
    } else if (i == a.end() || key(*j) < key(*i)) {
      onlyB(*j++);
    } else {
      both(*i++, *j++);
    }
  }
}

const auto kRecordKey = [](const auto& record) { return record.vertex.id; };
const auto kBundleKey = [](const Bundle& b) { return b.id; };
const auto kSplitKey = [](const EdgeSplit& s) { return std::pair(s.a, s.b); };

Error mismatch() {
  return makeError(ErrorCode::InvalidArgument, "the mesh was changed since without being recorded",
                   "history");
}

/// Position of the element with a key in a range that ascends by key; kNone when there is none.
template <class Range, class Key, class Value>
std::uint32_t findKey(const Range& range, Key key, const Value& wanted) {
  const auto at = std::lower_bound(range.begin(), range.end(), wanted,
                                   [&](const auto& element, const Value& w) { return key(element) < w; });
  return at != range.end() && key(*at) == wanted ? std::uint32_t(at - range.begin()) : kNone;
}

/// `base` without the keys of `take`, with `put`, ascending by key.
template <class T, class Key>
std::vector<T> exchange(std::vector<T> base, const std::vector<T>& take, const std::vector<T>& put, Key key) {
  std::vector<T> rest, result;
  rest.reserve(base.size());
  result.reserve(base.size() + put.size());
  mergeById(
      base, take, key, [&](T& x) { rest.push_back(std::move(x)); }, [](const T&) {}, [](T&, const T&) {});
  mergeById(
      rest, put, key, [&](T& x) { result.push_back(std::move(x)); }, [&](const T& x) { result.push_back(x); },
      [&](T&, const T& x) { result.push_back(x); });
  return result;
}

}  // namespace

bool History::VertexRecord::operator==(const VertexRecord& other) const {
  // Bit by bit: undo must bring back the sign of a zero as well.
  return std::memcmp(vertex.position.data(), other.vertex.position.data(), 3 * sizeof(double)) == 0 &&
         vertex.id == other.vertex.id && vertex.parent == other.vertex.parent &&
         vertex.layer == other.vertex.layer && vertex.pinned == other.vertex.pinned &&
         vertex.welded == other.vertex.welded;
}

/// Elements of a mesh with ids in place of indices, and the difference of two meshes.
class History::Differ {
 public:
  static VertexRecord record(const HairMesh& mesh, const HairVertex& vertex) {
    VertexRecord result{vertex};
    result.vertex.parent = idOf(mesh, vertex.parent);
    return result;
  }
  static Bundle record(const HairMesh& mesh, Bundle bundle) {
    for (std::uint32_t& v : bundle.vertices) v = idOf(mesh, v);
    return bundle;
  }
  /// Vertices ascend by id, so the order of splits by ids is the one by indices.
  static std::vector<EdgeSplit> splits(const HairMesh& mesh) {
    std::vector<EdgeSplit> result(mesh.splits().begin(), mesh.splits().end());
    for (EdgeSplit& split : result) split.a = idOf(mesh, split.a), split.b = idOf(mesh, split.b);
    return result;
  }
  static bool sameBundle(const HairMesh& before, const Bundle& x, const HairMesh& after, const Bundle& y) {
    return x.corners == y.corners && x.group == y.group &&
           std::equal(x.vertices.begin(), x.vertices.end(), y.vertices.begin(), y.vertices.end(),
                      [&](std::uint32_t a, std::uint32_t b) { return idOf(before, a) == idOf(after, b); });
  }

  static Step difference(const HairMesh& before, const HairMesh& after) {
    Step step;
    mergeById(
        before.vertices(), after.vertices(), [](const HairVertex& v) { return v.id; },
        [&](const HairVertex& v) { step.before.vertices.push_back(record(before, v)); },
        [&](const HairVertex& v) { step.after.vertices.push_back(record(after, v)); },
        [&](const HairVertex& v, const HairVertex& w) {
          VertexRecord x = record(before, v), y = record(after, w);
          if (x == y) return;
          step.before.vertices.push_back(x);
          step.after.vertices.push_back(y);
        });
    mergeById(
        before.bundles(), after.bundles(), kBundleKey,
        [&](const Bundle& b) { step.before.bundles.push_back(record(before, b)); },
        [&](const Bundle& b) { step.after.bundles.push_back(record(after, b)); },
        [&](const Bundle& b, const Bundle& c) {
          if (sameBundle(before, b, after, c)) return;
          step.before.bundles.push_back(record(before, b));
          step.after.bundles.push_back(record(after, c));
        });
    mergeById(
        splits(before), splits(after), kSplitKey,
        [&](const EdgeSplit& s) { step.before.splits.push_back(s); },
        [&](const EdgeSplit& s) { step.after.splits.push_back(s); },
        [&](const EdgeSplit& s, const EdgeSplit& t) {
          if (s == t) return;
          step.before.splits.push_back(s);
          step.after.splits.push_back(t);
        });
    step.groupsChanged = !std::ranges::equal(before.groupNames(), after.groupNames());
    if (step.groupsChanged) {
      step.before.groupNames.assign(before.groupNames().begin(), before.groupNames().end());
      step.after.groupNames.assign(after.groupNames().begin(), after.groupNames().end());
    }
    step.before.nextVertexId = before.nextVertexId(), step.before.nextBundleId = before.nextBundleId();
    step.after.nextVertexId = after.nextVertexId(), step.after.nextBundleId = after.nextBundleId();
    return step;
  }

  static bool isEmpty(const Step& s) {
    return s.before.vertices.empty() && s.after.vertices.empty() && s.before.bundles.empty() &&
           s.after.bundles.empty() && s.before.splits.empty() && s.after.splits.empty() && !s.groupsChanged &&
           s.before.nextVertexId == s.after.nextVertexId && s.before.nextBundleId == s.after.nextBundleId;
  }
};

void History::record(const HairMesh& before, const HairMesh& after, std::string label) {
  Step step = Differ::difference(before, after);
  if (Differ::isEmpty(step)) return;
  step.label = std::move(label);
  steps_.resize(done_);
  steps_.push_back(std::move(step));
  ++done_;
}

/// Turns a mesh from one side of a step into the other.
class History::Change {
 public:
  Change(HairMesh& mesh, const State& from, const State& to, bool groupsChanged)
      : mesh_(mesh), from_(from), to_(to), groupsChanged_(groupsChanged) {}

  Status run() {
    if (!matches()) return mismatch();
    exchangeVertices();
    if (!translateParents()) return mismatch();
    std::vector<Bundle> bundles = to_.bundles;
    for (Bundle& bundle : bundles) {
      for (std::uint32_t& v : bundle.vertices) v = indexOf(v);
      if (std::ranges::find(bundle.vertices, kNone) != bundle.vertices.end()) return mismatch();
    }
    std::vector<EdgeSplit> splits = exchange(Differ::splits(mesh_), from_.splits, to_.splits, kSplitKey);
    for (EdgeSplit& split : splits) {
      split.a = indexOf(split.a), split.b = indexOf(split.b);
      if (split.a == kNone || split.b == kNone) return mismatch();
    }
    // Nothing fails from here on.
    std::vector<std::string> groups(mesh_.groupNames().begin(), mesh_.groupNames().end());
    if (groupsChanged_) groups = to_.groupNames;
    std::vector<Bundle> own = HairMeshBuilder::takeBundles(mesh_);
    for (Bundle& bundle : own) {
      for (std::uint32_t& v : bundle.vertices) v = newIndex_[v];
    }
    mesh_ = HairMeshBuilder::restore(
        std::move(vertices_), exchange(std::move(own), from_.bundles, bundles, kBundleKey), std::move(splits),
        std::move(groups), to_.nextVertexId, to_.nextBundleId);
    return {};
  }

 private:
  /// Is all that the step takes away there as it left it, and nothing that it adds?
  bool matches() const {
    if (mesh_.nextVertexId() != from_.nextVertexId || mesh_.nextBundleId() != from_.nextBundleId)
      return false;
    if (groupsChanged_ && !std::ranges::equal(mesh_.groupNames(), from_.groupNames)) return false;
    for (const VertexRecord& record : from_.vertices) {
      const std::uint32_t v = mesh_.indexOf(record.vertex.id);
      if (v == kNone || !(Differ::record(mesh_, mesh_.vertices()[v]) == record)) return false;
    }
    for (const VertexRecord& record : to_.vertices) {
      if (findKey(from_.vertices, kRecordKey, record.vertex.id) == kNone &&
          mesh_.indexOf(record.vertex.id) != kNone) {
        return false;
      }
    }
    for (const Bundle& bundle : from_.bundles) {
      const std::uint32_t j = mesh_.indexOf(bundle.id);
      if (j == kNone || !(Differ::record(mesh_, mesh_.bundles()[j]) == bundle)) return false;
    }
    for (const Bundle& bundle : to_.bundles) {
      if (findKey(from_.bundles, kBundleKey, bundle.id) == kNone && mesh_.indexOf(bundle.id) != kNone)
        return false;
    }
    const auto splits = Differ::splits(mesh_);
    return std::ranges::all_of(from_.splits, [&](const EdgeSplit& split) {
      const std::uint32_t at = findKey(splits, kSplitKey, kSplitKey(split));
      return at != kNone && splits[at] == split;
    });
  }

  void exchangeVertices() {
    newIndex_.assign(mesh_.vertices().size(), kNone);
    std::size_t gone = 0, come = 0;
    const auto put = [&](const HairVertex& vertex, bool byId) {
      vertices_.push_back(vertex);
      byId_.push_back(byId);
    };
    for (std::uint32_t v = 0; v < newIndex_.size(); ++v) {
      const VertexId id = mesh_.vertices()[v].id;
      while (come < to_.vertices.size() && to_.vertices[come].vertex.id < id)
        put(to_.vertices[come++].vertex, true);
      if (gone < from_.vertices.size() && from_.vertices[gone].vertex.id == id) {
        ++gone;
        if (come == to_.vertices.size() || to_.vertices[come].vertex.id != id) continue;
        newIndex_[v] = std::uint32_t(vertices_.size());
        put(to_.vertices[come++].vertex, true);
        continue;
      }
      newIndex_[v] = std::uint32_t(vertices_.size());
      put(mesh_.vertices()[v], false);
    }
    while (come < to_.vertices.size()) put(to_.vertices[come++].vertex, true);
  }

  bool translateParents() {
    bool known = true;
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      std::uint32_t& parent = vertices_[v].parent;
      if (parent == kNone) continue;
      parent = byId_[v] ? indexOf(parent) : newIndex_[parent];
      known = known && parent != kNone;
    }
    return known;
  }

  std::uint32_t indexOf(std::uint32_t id) const {
    return findKey(
        vertices_, [](const HairVertex& v) { return v.id; }, VertexId{id});
  }

  HairMesh& mesh_;
  const State &from_, &to_;
  bool groupsChanged_;
  std::vector<HairVertex> vertices_;
  std::vector<std::uint8_t> byId_;  // is the parent of a new vertex an id still?
  std::vector<std::uint32_t> newIndex_;
};

Status History::undo(HairMesh& mesh) {
  if (done_ == 0) return makeError(ErrorCode::NotFound, "there is no step to undo", "history");
  const Step& step = steps_[done_ - 1];
  COIF_TRY(Change(mesh, step.after, step.before, step.groupsChanged).run());
  --done_;
  return {};
}

Status History::redo(HairMesh& mesh) {
  if (done_ == steps_.size()) return makeError(ErrorCode::NotFound, "there is no step to redo", "history");
  const Step& step = steps_[done_];
  COIF_TRY(Change(mesh, step.before, step.after, step.groupsChanged).run());
  ++done_;
  return {};
}

const std::string& History::undoLabel() const {
  static const std::string none;
  return done_ == 0 ? none : steps_[done_ - 1].label;
}

const std::string& History::redoLabel() const {
  static const std::string none;
  return done_ == steps_.size() ? none : steps_[done_].label;
}

std::size_t History::bytes() const {
  std::size_t total = steps_.capacity() * sizeof(Step);
  for (const Step& step : steps_) {
    total += step.label.capacity();
    for (const State* state : {&step.before, &step.after}) {
      total +=
          state->vertices.capacity() * sizeof(VertexRecord) + state->splits.capacity() * sizeof(EdgeSplit);
      for (const Bundle& bundle : state->bundles) total += sizeof(Bundle) + 4 * bundle.vertices.capacity();
      for (const std::string& name : state->groupNames) total += sizeof(name) + name.capacity();
    }
  }
  return total;
}

void History::clear() {
  steps_.clear();
  done_ = 0;
}

}  // namespace coif
