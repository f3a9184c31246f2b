// The place room: internal vertices of a hair mesh go where the energy is least.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "bind.h"
#include "bind_hairmesh.h"
#include "coif/place/place.h"

namespace coif::python {

using namespace nb::literals;

namespace {

std::string summary(const PlaceReport& r) {
  return "<coif.PlaceReport: " + std::to_string(r.unknowns) + " unknowns, " + std::to_string(r.iterations) +
         " iterations, " + (r.converged ? "converged" : "not converged") + ">";
}

void bindReport(nb::module_& m) {
  nb::enum_<PlaceSolver>(m, "PlaceSolver", "How place() solves.")
      .value("AUTO", PlaceSolver::Auto, "tensor where it pays, else direct")
      .value("CONJUGATE_GRADIENT", PlaceSolver::ConjugateGradient, "plain conjugate gradients")
      .value("JACOBI", PlaceSolver::Jacobi, "conjugate gradients, diagonal preconditioner")
      .value("INCOMPLETE_CHOLESKY", PlaceSolver::IncompleteCholesky, "conjugate gradients, incomplete factor")
      .value("TENSOR", PlaceSolver::Tensor, "conjugate gradients, tensor-product preconditioner")
      .value("DIRECT", PlaceSolver::Direct, "sparse factorisation with refinement: the reference");
  nb::class_<PlaceReport>(m, "PlaceReport", "What place() did and how far from the minimiser it may be.")
      .def_ro("solver", &PlaceReport::solver, "The solver that ran.")
      .def_ro("unknowns", &PlaceReport::unknowns, "Number of internal vertices.")
      .def_ro("free_components", &PlaceReport::freeComponents, "Layer components without a fixed vertex.")
      .def_ro("iterations", &PlaceReport::iterations, "Iterations of the solver.")
      .def_ro("converged", &PlaceReport::converged, "False when max_iterations ran out first.")
      .def_ro("energy_before", &PlaceReport::energyBefore, "Energy of the positions given.")
      .def_ro("energy_after", &PlaceReport::energyAfter, "Energy of the positions found.")
      .def_ro("error", &PlaceReport::error, "Estimated greatest distance to the minimiser.")
      .def_ro("seconds", &PlaceReport::seconds, "Wall-clock seconds.")
      .def("__repr__", &summary);
}

}  // namespace

void bindPlace(nb::module_& m) {
  bindReport(m);
  m.def(
      "place",
      [](HairMeshModel& model, PlaceSolver solver, double tolerance, int maxIterations, int threads,
         nb::object progress) {
        HairMesh mesh = model.mesh();  // solved apart, so that other threads may read the mesh meanwhile
        const PlaceOptions options{solver, tolerance, maxIterations};
        const PlaceReport report =
            Run(threads, std::move(progress))([&](const Context& c) { return place(mesh, options, c); });
        model.change("place", std::move(mesh));
        return report;
      },
      "mesh"_a, nb::kw_only(), "solver"_a = PlaceSolver::Auto, "tolerance"_a = PlaceOptions{}.tolerance,
      "max_iterations"_a = PlaceOptions{}.maxIterations, "threads"_a = 0, "progress"_a = nb::none(),
      "Moves the internal vertices of a HairMesh to where the side quads are least sheared; external and "
      "pinned\n"
      "vertices stay bit for bit (Yuksel et al. 2009, section 3.3). Can be undone.\n\n"
      "tolerance: on the estimated error, in units of the bounding-box diagonal. threads: 0 for all cores; "
      "the result\n"
      "does not depend on it. progress: a callable (what: str, fraction: float), which may raise to stop.\n"
      "Returns a PlaceReport; running out of iterations is reported there, not raised. The interpreter lock "
      "is\n"
      "released. Raises Error for positions that are not finite.");
  m.def(
      "placement_energy", [](const HairMeshModel& model) { return placementEnergy(model.mesh()); }, "mesh"_a,
      "Sum over side quads of the squared shear |(c − a) − (d − b)|², scene units squared.");
  m.def(
      "drag_response",
      [](const HairMeshModel& model, const ArrayLike& vertices) {
        const HairMesh mesh = model.mesh();
        const auto selection = model.vertexIndices(vertices, "vertices");
        return own1(
            Run(0, nb::none())([&](const Context& c) { return dragResponse(mesh, selection, {}, c); }));
      },
      "mesh"_a, "vertices"_a,
      "How far every vertex follows when the external `vertices` (ids) move together: one coefficient a "
      "vertex,\n"
      "1 on the selection, 0 on other external ones. positions += coefficients[:, None] * delta is the exact "
      "answer.");
}

}  // namespace coif::python
