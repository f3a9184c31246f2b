// The simulate room and the scene's motion: settings, frames, a stepwise simulation, chains by themselves.
#include "bind_simulate.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include "bind.h"
#include "bind_hairmesh.h"
#include "coif/simulate/simulation.h"

namespace coif::python {

using namespace nb::literals;

HeadMotion toMotion(const nb::object& poses, const nb::object& roots) {
  HeadMotion motion;
  if (!poses.is_none()) {
    const auto array = toArray<double>(ArrayLike{poses}, "head_poses", {-1, 4, 4});
    for (std::size_t f = 0; f < array.shape(0); ++f) {
      const double* m = array.data() + 16 * f;
      RigidPose pose;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) pose.rotation(row, column) = m[4 * row + column];
        pose.position[row] = m[4 * row + 3];
      }
      motion.poses.push_back(pose);
    }
  }
  if (!roots.is_none()) {
    const auto array = toArray<double>(ArrayLike{roots}, "root_positions", {-1, -1, 3});
    for (std::size_t f = 0; f < array.shape(0); ++f) {
      std::vector<Vec3> frame;
      for (std::size_t r = 0; r < array.shape(1); ++r) {
        const double* p = array.data() + 3 * (f * array.shape(1) + r);
        frame.emplace_back(p[0], p[1], p[2]);
      }
      motion.roots.push_back(std::move(frame));
    }
  }
  return motion;
}

namespace {

/// A Simulation and the head that it must not outlive.
struct SimulationModel {
  std::shared_ptr<const Surface> head;
  std::unique_ptr<Simulation> simulation;
};

Array3<double> positionsOf(const SimulationModel& s) {
  return own3({s.simulation->positions().begin(), s.simulation->positions().end()});
}

/// Chains without a mesh: what compares solvers.
struct ChainModel {
  ChainSet chains;
  std::unique_ptr<Solver> solver;
  ChainState state;
  StepReport last;
};

void bindSettings(nb::module_& m) {
  nb::enum_<DynamicsMethod>(m, "DynamicsMethod", "How chains are stepped through time.")
      .value("VAN_OVERVELD", DynamicsMethod::VanOverveld, "explicit step, lengths by iterated projection")
      .value("ARTICULATED_EXPLICIT", DynamicsMethod::ArticulatedExplicit,
             "articulated bodies, explicit joints")
      .value("ARTICULATED_IMPLICIT", DynamicsMethod::ArticulatedImplicit,
             "articulated bodies, implicit joints")
      .value("XPBD", DynamicsMethod::Xpbd, "extended position-based dynamics")
      .value("DIRECT", DynamicsMethod::Direct, "implicit Euler, direct solve: the default, stable, damps")
      .value("DIRECT_BDF2", DynamicsMethod::DirectBdf2, "second order, damps far less")
      .value("ENERGY_KEEPING", DynamicsMethod::EnergyKeeping, "second order, keeps the energy");
  nb::enum_<WindKind>(m, "WindKind", "What the air does.")
      .value("NONE", WindKind::None, "it is still")
      .value("CONSTANT", WindKind::Constant, "the same everywhere, always")
      .value("GUSTS", WindKind::Gusts, "a mean and noise without divergence")
      .value("FLUID", WindKind::Fluid, "a coarse fluid around head and hair");
  using S = DynamicsSettings;
  nb::class_<S>(m, "DynamicsSettings",
                "How a hairstyle moves: metres and seconds, whatever the scene's unit.")
      .def(nb::init<>(), "The defaults.")
      .def_rw("method", &S::method, "The solver.")
      .def_rw("longest_step", &S::longestStep, "Frames are cut into steps at most this long, s.")
      .def_rw("tolerance", &S::tolerance,
              "Newton stops where what is left moves no node by more than this fraction of the mean link.")
      .def_rw("single_precision", &S::singlePrecision,
              "Chains of up to 100 links in 32-bit floats, sixteen at once.")
      .def_rw("skip_bending", &S::skipBending, "Leave bending out of chains without stiffness.")
      .def_rw("sleep_speed", &S::sleepSpeed,
              "Chains slower than this, m/s, for sleep_seconds are left as they are; 0: never.")
      .def_rw("sleep_seconds", &S::sleepSeconds, "See sleep_speed, s.")
      .def_rw("wisps", &S::wisps,
              "Simulate so many wisps of three guides each, and strands with them; 0: the hair mesh.")
      .def_rw("guide_points", &S::guidePoints, "Of each guide of a wisp, 2 to 256.")
      .def_rw("settle_seconds", &S::settleSeconds,
              "Time before the first frame in which hair finds its hang.")
      .def_rw("gravity", &S::gravity, "Against the up axis, m/s².")
      .def_rw("droop", &S::droop, "Fraction of its length that a level column droops by; 0: limp.")
      .def_rw("lateral", &S::lateral, "Stiffness between neighbouring columns, 1/s²; 0: none.")
      .def_rw("drag", &S::drag, "Drag of the air, 1/s.")
      .def_rw("wind", &S::wind, "What the air does.")
      .def_prop_rw(
          "wind_velocity", [](const S& s) { return own(s.windVelocity); },
          [](S& s, const ArrayLike& v) { s.windVelocity = toVec3(v, "wind_velocity"); },
          nb::rv_policy::reference, "Mean wind, m/s, 3 floats.")
      .def_rw("gust_speed", &S::gustSpeed, "Root mean square of gusts, m/s.")
      .def_rw("gust_size", &S::gustSize, "Size of an eddy, m.")
      .def_rw("gust_seconds", &S::gustSeconds, "Time in which one pattern becomes another.")
      .def_rw("seed", &S::seed, "Seed of the gusts.")
      .def_rw("air_cells", &S::airCells, "Cells of the fluid along its longest side, 4 to 128.")
      .def_rw("shelter", &S::shelter, "Rate at which the densest hair takes the air along, 1/s.")
      .def_rw("collide", &S::collide, "Whether hair collides with head and capsules.")
      .def_rw("thickness", &S::thickness, "Of hair over the skin, m.")
      .def_rw("contact_stiffness", &S::contactStiffness, "Of the skin, 1/s².")
      .def_rw("friction", &S::friction, "Coulomb's coefficient.")
      .def_rw("repulsion", &S::repulsion, "Speed at which pressed hair pushes back, m/s; 0: off.")
      .def_rw("density", &S::density, "Pushed beyond this multiple of the style's greatest density.")
      .def_rw("cell", &S::cell, "Of the density grid, m.")
      .def_rw("hair_friction", &S::hairFriction, "Rate at which neighbours drag each other along, 1/s.")
      .def(
          "add_capsule",
          [](S& s, const ArrayLike& a, const ArrayLike& b, double radius, bool withHead) {
            s.capsules.push_back({toVec3(a, "a"), toVec3(b, "b"), radius, withHead});
          },
          "a"_a, "b"_a, "radius"_a, "with_head"_a = true,
          "A solid: all points within `radius` of the segment a–b (scene units; a sphere where a = b).")
      .def("__repr__",
           [](const S& s) { return std::string("<coif.DynamicsSettings: ") + name(s.method) + ">"; });
}

void bindReports(nb::module_& m) {
  using R = SimulationReport;
  nb::class_<R>(m, "SimulationReport", "What a simulation did.")
      .def_ro("vertices", &R::vertices, "Of the hair mesh, or points of the wisps' guides.")
      .def_ro("chains", &R::chains, "Trees of links.")
      .def_ro("links", &R::links, "Links in all.")
      .def_ro("frames", &R::frames, "Frames computed.")
      .def_ro("steps", &R::steps, "Steps computed.")
      .def_ro("seconds", &R::seconds, "Wall-clock seconds.")
      .def_ro("chain_steps", &R::chainSteps, "Chains solved, summed over steps.")
      .def_ro("asleep", &R::asleep, "Chains left as they were, summed over steps.")
      .def_ro("limp", &R::limp, "Chains without bending terms.")
      .def_ro("in_single", &R::inSingle, "Chains in single precision.")
      .def_ro("max_newton", &R::maxNewton, "Most Newton steps of a chain in a step.")
      .def_ro("mean_newton", &R::meanNewton, "Mean Newton steps.")
      .def_ro("resets", &R::resets, "Chains that were not finite and were reset.")
      .def_ro("unconverged", &R::unconverged, "Chain steps that kept their best iterate.")
      .def_ro("max_stretch", &R::maxStretch, "Greatest relative length error of a link.")
      .def("__repr__", [](const R& r) {
        return "<coif.SimulationReport: " + std::to_string(r.frames) + " frames of " +
               std::to_string(r.links) + " links>";
      });
  nb::class_<DrapeReport>(m, "DrapeReport", "What drape() did.")
      .def_ro("frames", &DrapeReport::frames, "Frames of 1/24 s until rest.")
      .def_ro("settled", &DrapeReport::settled, "Whether it came to rest.")
      .def_ro("greatest_move", &DrapeReport::greatestMove, "Of any vertex, scene units.")
      .def_ro("last_move", &DrapeReport::lastMove, "Of any vertex in the last 1/24 s.")
      .def("__repr__", [](const DrapeReport& r) {
        return "<coif.DrapeReport: " + std::string(r.settled ? "settled" : "moving") + " after " +
               std::to_string(r.frames) + " frames>";
      });
}

void bindSimulation(nb::module_& m) {
  nb::class_<SimulationModel>(m, "Simulation", "A hair mesh in motion, frame by frame.")
      .def(
          "__init__",
          [](SimulationModel* self, const HairMeshModel& mesh, const DynamicsSettings& settings, double fps,
             const nb::object& poses, const nb::object& roots, bool useHead, int threads) {
            SimulationModel made{useHead ? mesh.head : nullptr, nullptr};
            const HairMesh copy = mesh.mesh();
            const SimulationWorld world{made.head.get(), mesh.metersPerUnit, mesh.upAxis,
                                        toMotion(poses, roots), fps};
            made.simulation = Run(threads, nb::none())(
                [&](const Context& c) { return Simulation::create(copy, settings, world, c); });
            new (self) SimulationModel(std::move(made));
          },
          "mesh"_a, "settings"_a = DynamicsSettings{}, nb::kw_only(), "fps"_a = 24.0,
          "head_poses"_a.none() = nb::none(), "root_positions"_a.none() = nb::none(), "use_head"_a = true,
          "threads"_a = 0,
          "head_poses: (F, 4, 4) rigid transforms of the head by frame. root_positions: (F, R, 3) of the R "
          "layer-0\n"
          "vertices instead, for a scalp that deforms. use_head: collide with the scalp that the mesh lies "
          "on.\n"
          "Raises Error for settings or motion out of range.")
      .def(
          "advance",
          [](SimulationModel& s, int threads) {
            Run(threads, nb::none())([&](const Context& c) -> Result<int> {
              COIF_TRY(s.simulation->advance(c));
              return 0;
            });
            return positionsOf(s);
          },
          nb::kw_only(), "threads"_a = 0,
          "One frame on; returns its positions, (V, 3) floats. The result does not depend on threads.")
      .def_prop_ro("positions", &positionsOf, nb::rv_policy::reference,
                   "Of every vertex at the frame, or of every point of the wisps' guides, (V, 3) floats (a "
                   "copy).")
      .def_prop_ro(
          "left_out", [](const SimulationModel& s) { return s.simulation->leftOut(); },
          "What the frames so far did not need: a list of LeftOut.")
      .def_prop_ro(
          "frame", [](const SimulationModel& s) { return s.simulation->frame(); }, "Where it is.")
      .def_prop_ro(
          "report", [](const SimulationModel& s) { return s.simulation->report(); }, "What was done.")
      .def(
          "state",
          [](const SimulationModel& s) {
            const auto bytes = s.simulation->state();
            return nb::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
          },
          "All that advance() changes, as bytes.")
      .def(
          "restore",
          [](SimulationModel& s, nb::bytes state) {
            take(s.simulation->restore(std::as_bytes(std::span(state.c_str(), state.size()))));
          },
          "state"_a, "Goes on from a state() of the same inputs, with the same bytes.");
  m.def(
      "drape",
      [](HairMeshModel& model, const DynamicsSettings& settings, double seconds, double tolerance,
         int threads) {
        HairMesh mesh = model.mesh();
        const SimulationWorld world{model.head.get(), model.metersPerUnit, model.upAxis, {}, 24};
        const DrapeReport report = Run(threads, nb::none())([&](const Context& c) {
          return drape(mesh, settings, world, {seconds, tolerance}, c);
        });
        model.change("drape", std::move(mesh));
        return report;
      },
      "mesh"_a, "settings"_a = DynamicsSettings{}, nb::kw_only(), "seconds"_a = 10.0, "tolerance"_a = 1e-4,
      "threads"_a = 0,
      "Lets a HairMesh hang under gravity until it rests and keeps the shape. Can be undone.\n\n"
      "Roots stay and columns keep their lengths. tolerance: greatest move in 1/24 s, of the mesh's size.");
}

void bindChains(nb::module_& m) {
  nb::class_<ChainModel>(m, "Chains",
                         "Rigid link chains by themselves, without a mesh: for comparing solvers.")
      .def(
          "__init__",
          [](ChainModel* self, const ArrayLike& points, std::size_t chains, DynamicsMethod method,
             double rigidity, const ArrayLike& gravity, double tolerance, bool floatLanes) {
            const auto all = toPoints(points, "points");
            if (chains == 0 || all.size() % chains != 0)
              throw ErrorException(
                  makeError(ErrorCode::InvalidArgument, "points must be `chains` times equally many"));
            std::vector<std::uint64_t> offsets;
            for (std::size_t c = 0; c <= chains; ++c) offsets.push_back(c * (all.size() / chains));
            ChainOptions options;
            options.bendingRigidity = rigidity;
            ChainModel made;
            made.chains = take(chainsFromCurves(all, offsets, options)).chains;
            SolverOptions solver;
            solver.method = method;
            solver.gravity = toVec3(gravity, "gravity");
            solver.tolerance = tolerance;
            solver.floatLanes = floatLanes;
            made.solver = take(makeSolver(made.chains, solver));
            made.state = restState(made.chains);
            new (self) ChainModel(std::move(made));
          },
          "points"_a, "chains"_a, "method"_a = DynamicsMethod::Direct, nb::kw_only(), "rigidity"_a = 0.0,
          "gravity"_a = nb::make_tuple(0.0, -9.81, 0.0), "tolerance"_a = SolverOptions{}.tolerance,
          "float_lanes"_a = false,
          "points: (chains × N, 3), chain after chain, each from its fixed root; straight as given at rest. "
          "rigidity: E·I.")
      .def(
          "step",
          [](ChainModel& c, double timeStep, std::size_t steps, int threads) {
            return Run(threads, nb::none())([&](const Context& context) -> Result<double> {
              const Stopwatch watch;
              for (std::size_t i = 0; i < steps; ++i) {
                auto done = c.solver->step(c.state, {}, timeStep, {}, context);
                if (!done.ok()) return done.error();
                c.last = *done;
              }
              return watch.seconds();
            });
          },
          "time_step"_a, "steps"_a = 1, nb::kw_only(), "threads"_a = 1,
          "Takes steps; returns the seconds they took inside the library.")
      .def_prop_ro(
          "positions", [](const ChainModel& c) { return own3(c.state.positions); }, nb::rv_policy::reference,
          "(chains × N, 3), a copy.")
      .def_prop_ro(
          "links", [](const ChainModel& c) { return c.chains.linkCount(); }, "Links in all.")
      .def_prop_ro(
          "max_newton", [](const ChainModel& c) { return c.last.maxNewton; }, "Of the last step.")
      .def_prop_ro(
          "energy",
          [](const ChainModel& c) { return chainEnergy(c.chains, c.state, Vec3(0, -9.81, 0)).total(); },
          "Kinetic, gravitational and joint energy under standard gravity along −y.");
}

}  // namespace

void bindSimulate(nb::module_& m) {
  bindSettings(m);
  bindReports(m);
  bindSimulation(m);
  bindChains(m);
}

}  // namespace coif::python
