// How hair moves, and letting it hang, as commands.
#include <algorithm>

#include "coif/simulate/simulation.h"
#include "scene/editor/command_table.h"

namespace coif::editor {
namespace {

Status setDynamics(Work& work, const Arguments& arguments) {
  DynamicsSettings s = work.state.dynamics;
  s.droop = arguments.number("droop");
  s.gravity = arguments.number("gravity");
  s.drag = arguments.number("drag");
  s.lateral = arguments.number("lateral");
  s.settleSeconds = arguments.number("settle");
  const std::string& wind = arguments.text("wind");
  s.wind = wind == "constant" ? WindKind::Constant
           : wind == "gusts"  ? WindKind::Gusts
           : wind == "fluid"  ? WindKind::Fluid
                              : WindKind::None;
  s.windVelocity = arguments.vector("wind_velocity");
  s.gustSpeed = arguments.number("gust_speed");
  s.collide = arguments.flag("collide");
  s.thickness = arguments.number("thickness");
  s.friction = arguments.number("friction");
  s.repulsion = arguments.number("repulsion");
  COIF_TRY(validate(s));
  work.state.dynamics = s;
  return {};
}

/// The outside hangs as it came to rest; the inside is placed after it, as after any move. Both sides hang by
/// themselves, so symmetry adds nothing.
Status drapeMesh(Work& work, const Arguments& arguments) {
  HairMesh draped = work.mesh;
  const SimulationWorld world{work.head, work.metersPerUnit, work.upAxis, {}, 24};
  DrapeOptions options;
  options.seconds = arguments.number("seconds");
  COIF_ASSIGN(const DrapeReport report, drape(draped, work.state.dynamics, world, options, work.context));
  (void)report;
  for (std::uint32_t v = 0; v < work.mesh.vertices().size(); ++v) {
    if (!std::ranges::binary_search(work.state.frozen, work.mesh.vertices()[v].id))
      work.mesh.setPosition(v, draped.position(v));
  }
  return {};
}

}  // namespace

std::vector<Command> motionCommands() {
  const DynamicsSettings s;
  std::vector<Command> list = {
      {{"set_dynamics",
        "Dynamics",
        "Motion",
        "",
        "How the hair moves.",
        {number("droop", s.droop, 0, 100, "How far a level column sinks, of its length; 0: limp."),
         number("gravity", s.gravity, 0, 1000, "m/s², against the up axis."),
         number("drag", s.drag, 0, 1e4, "Of the air, per second."),
         number("lateral", s.lateral, 0, 1e6, "Stiffness between neighbouring columns, 1/s²."),
         number("settle", s.settleSeconds, 0, 60, "Seconds in which hair finds its hang before it is shown."),
         choice("wind", {"none", "constant", "gusts", "fluid"}, "What the air does."),
         vector("wind_velocity", s.windVelocity, "Mean wind, m/s."),
         number("gust_speed", s.gustSpeed, 0, 100, "Of gusts, m/s."),
         flag("collide", s.collide, "With the head."),
         number("thickness", s.thickness, 0, 1, "Of hair over the skin, metres."),
         number("friction", s.friction, 0, 10, "Of hair on the skin, Coulomb's coefficient."),
         number("repulsion", s.repulsion, 0, 100, "Speed at which pressed hair pushes back, m/s; 0: off.")}},
       setDynamics},
      {{"drape",
        "Drape",
        "Motion",
        "Shift+D",
        "Lets the hair hang under gravity and keeps that shape.",
        {number("seconds", 5, 0.05, 60, "Time that it may take to come to rest.")}},
       drapeMesh},
  };
  list.back().info.changesMesh = true;
  return list;
}

}  // namespace coif::editor
