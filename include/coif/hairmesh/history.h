// Unlimited, exact undo and redo of a hair mesh, by structural differences.
//
// A step keeps only the vertices, bundles, splits, group names and counters that it changed, so a moved
// vertex costs some tens of bytes. Undo to the start and redo to the end give back the same bytes
// (canonicalBytes).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "coif/hairmesh/hair_mesh.h"

namespace coif {

/// The whole mesh as bytes: little-endian, every field in a fixed order, positions bit for bit. Equal bytes
/// mean equal meshes, and the other way round but for the sign of zero. Cost: linear.
std::vector<std::byte> canonicalBytes(const HairMesh& mesh);

class History {
 public:
  /// Adds the step from `before` to `after` and forgets what was undone; a step that changes nothing is left
  /// out.
  void record(const HairMesh& before, const HairMesh& after, std::string label);

  /// Runs operation(mesh), which returns a Result, and records it when it succeeds. A failing operation that
  /// changed the mesh is taken back.
  template <class Operation>
  auto apply(HairMesh& mesh, std::string label, Operation&& operation) {
    HairMesh before = mesh;
    auto result = operation(mesh);
    if (result.ok()) {
      record(before, mesh, std::move(label));
    } else {
      mesh = std::move(before);
    }
    return result;
  }

  /// Takes the last step back, or does the last one taken back again. Errors: NotFound when there is none;
  /// InvalidArgument when what the step changed was changed since without record(). Then the mesh is
  /// unchanged.
  Status undo(HairMesh& mesh);
  Status redo(HairMesh& mesh);

  std::size_t undoCount() const { return done_; }
  std::size_t redoCount() const { return steps_.size() - done_; }
  const std::string& undoLabel() const;  ///< of the step that undo() takes back; empty when there is none
  const std::string& redoLabel() const;
  std::size_t bytes() const;  ///< memory held, about
  void clear();

 private:
  /// Elements by id: indices shift when others come or go.
  struct VertexRecord {
    HairVertex vertex;  // parent: the parent's id
    bool operator==(const VertexRecord& other) const;
  };
  struct State {  // one side of a step
    std::vector<VertexRecord> vertices;
    std::vector<Bundle> bundles;    // vertices: ids
    std::vector<EdgeSplit> splits;  // a, b: ids
    std::vector<std::string> groupNames;
    std::uint32_t nextVertexId = 0, nextBundleId = 0;
  };
  struct Step {
    std::string label;
    State before, after;
    bool groupsChanged = false;
  };
  class Differ;
  class Change;

  std::vector<Step> steps_;
  std::size_t done_ = 0;
};

}  // namespace coif
