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

const auto kBundleKey = [](const Bundle& b) { return b.id; };
const auto kSplitKey = [](const EdgeSplit& s) { return std::pair(s.a, s.b); };

Error mismatch() {
  return makeError(ErrorCode::InvalidArgument, "the mesh was changed since without being recorded",
                   "history");
}

/// `base` without `take`, with `put`, ascending by key; false when `take` is not part of it.
template <class T, class Key>
bool exchange(std::vector<T>& base, const std::vector<T>& take, const std::vector<T>& put, Key key) {
  std::vector<T> rest, result;
  bool matches = true;
  mergeById(
      base, take, key, [&](T& x) { rest.push_back(std::move(x)); }, [&](const T&) { matches = false; },
      [&](T& x, const T& taken) { matches = matches && x == taken; });
  const auto add = [&](const T& x) { result.push_back(x); };
  mergeById(rest, put, key, add, add, [&](const T&, const T&) { matches = false; });
  base = std::move(result);
  return matches;
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

Status History::change(HairMesh& mesh, const Step& step, const State& from, const State& to) {
  if (mesh.nextVertexId() != from.nextVertexId || mesh.nextBundleId() != from.nextBundleId) return mismatch();
  std::vector<VertexRecord> vertices;
  std::vector<Bundle> bundles;
  for (const HairVertex& vertex : mesh.vertices()) vertices.push_back(Differ::record(mesh, vertex));
  for (const Bundle& bundle : mesh.bundles()) bundles.push_back(Differ::record(mesh, bundle));
  std::vector<EdgeSplit> splits = Differ::splits(mesh);
  std::vector<std::string> groups(mesh.groupNames().begin(), mesh.groupNames().end());
  if (step.groupsChanged && groups != from.groupNames) return mismatch();
  if (step.groupsChanged) groups = to.groupNames;
  const auto vertexKey = [](const VertexRecord& r) { return r.vertex.id; };
  if (!exchange(vertices, from.vertices, to.vertices, vertexKey) ||
      !exchange(bundles, from.bundles, to.bundles, kBundleKey) ||
      !exchange(splits, from.splits, to.splits, kSplitKey)) {
    return mismatch();
  }
  // Back from ids to indices. The table is as long as the greatest live id.
  std::vector<std::uint32_t> index(vertices.empty() ? 0 : std::size_t(vertices.back().vertex.id) + 1, kNone);
  for (std::uint32_t v = 0; v < vertices.size(); ++v) index[std::uint32_t(vertices[v].vertex.id)] = v;
  bool known = true;
  const auto translate = [&](std::uint32_t& id) {
    id = id < index.size() ? index[id] : kNone;
    known = known && id != kNone;
  };
  std::vector<HairVertex> plain;
  for (VertexRecord& record : vertices) {
    if (record.vertex.parent != kNone) translate(record.vertex.parent);
    plain.push_back(record.vertex);
  }
  for (Bundle& bundle : bundles) std::for_each(bundle.vertices.begin(), bundle.vertices.end(), translate);
  for (EdgeSplit& split : splits) translate(split.a), translate(split.b);
  if (!known) return mismatch();
  mesh = HairMeshBuilder::restore(std::move(plain), std::move(bundles), std::move(splits), std::move(groups),
                                  to.nextVertexId, to.nextBundleId);
  return {};
}

Status History::undo(HairMesh& mesh) {
  if (done_ == 0) return makeError(ErrorCode::NotFound, "there is no step to undo", "history");
  const Step& step = steps_[done_ - 1];
  COIF_TRY(change(mesh, step, step.after, step.before));
  --done_;
  return {};
}

Status History::redo(HairMesh& mesh) {
  if (done_ == steps_.size()) return makeError(ErrorCode::NotFound, "there is no step to redo", "history");
  const Step& step = steps_[done_];
  COIF_TRY(change(mesh, step, step.before, step.after));
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
