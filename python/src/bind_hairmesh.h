// What Python sees as coif.HairMesh.
#pragma once

#include <memory>
#include <string>

#include "bind.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/hairmesh/history.h"
#include "coif/scalp/surface.h"

namespace coif::python {

/// A hair mesh with its history, and the scalp that it was laid on (where there is one). Python names
/// vertices and bundles by id; the C++ library by index or id: the conversions are here.
class HairMeshModel {
 public:
  HairMeshModel() = default;
  explicit HairMeshModel(HairMesh mesh) : mesh_(std::move(mesh)) {}

  const HairMesh& mesh() const { return mesh_; }
  const History& history() const { return history_; }
  /// Makes `next` the mesh: one step of the history.
  void change(const char* what, HairMesh next) {
    history_.record(mesh_, next, what);
    mesh_ = std::move(next);
  }
  /// Runs an operation, which returns a Result: one step of the history, or an exception and no change.
  template <class Operation>
  auto apply(const char* what, Operation&& operation) {
    return take(history_.apply(mesh_, what, std::forward<Operation>(operation)));
  }
  /// The same for an operation that returns no value.
  template <class Operation>
  void applyStatus(const char* what, Operation&& operation) {
    take(history_.apply(mesh_, what, std::forward<Operation>(operation)));
  }
  void undo() { take(history_.undo(mesh_)); }
  void redo() { take(history_.redo(mesh_)); }

  /// Indices of vertex ids; Error naming the first id that does not exist.
  std::vector<std::uint32_t> vertexIndices(const ArrayLike& ids, const char* argument) const;
  std::uint32_t bundleIndex(std::uint32_t id) const;

  /// Remembers the scalp: its surface for roots, its axis and unit for strands.
  void layOn(std::shared_ptr<const Surface> scalp) {
    upAxis = scalp->mesh().upAxis;
    if (const double unit = scalp->mesh().metersPerUnit; unit > 0) metersPerUnit = unit;
    head = std::move(scalp);
  }

  std::shared_ptr<const Surface> head;  ///< the surface that grow() lays roots on unless told otherwise
  double metersPerUnit = 0.01;
  UpAxis upAxis = UpAxis::Y;

 private:
  HairMesh mesh_;
  History history_;
};

void bindCreated(nb::module_& m);
void bindOperations(nb::class_<HairMeshModel>& c);
void bindEdit(nb::module_& m, nb::class_<HairMeshModel>& c);

}  // namespace coif::python
