// Commands that change what is shown, symmetry, and the document's settings.
#include <algorithm>

#include "scene/editor/command_table.h"

namespace coif::editor {
namespace {

template <class T>
void addTo(std::vector<T>& list, const std::vector<T>& more) {
  list.insert(list.end(), more.begin(), more.end());
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

Result<std::vector<BundleId>> chosenBundles(const Work& work) {
  std::vector<BundleId> ids = selectedBundles(work.mesh, work.state.selection);
  if (ids.empty()) return refuse("select faces first");
  return ids;
}

Status hide(Work& work, const Arguments&) {
  COIF_ASSIGN(const auto ids, chosenBundles(work));
  addTo(work.state.hidden, ids);
  work.selection() = {};
  return {};
}

Status isolate(Work& work, const Arguments&) {
  COIF_ASSIGN(const auto ids, chosenBundles(work));
  work.state.hidden.clear();
  for (const Bundle& bundle : work.mesh.bundles()) {
    if (!std::ranges::binary_search(ids, bundle.id)) work.state.hidden.push_back(bundle.id);
  }
  return {};
}

Status freeze(Work& work, const Arguments&) {
  std::vector<VertexId> ids;
  for (std::uint32_t v : selectedVertices(work.mesh, work.selection())) {
    ids.push_back(work.mesh.vertices()[v].id);
  }
  if (ids.empty()) return refuse("select vertices first");
  addTo(work.state.frozen, ids);
  return {};
}

/// The plane as given, or the one of the three through the roots' middle that finds the most partners.
Status setSymmetry(Work& work, const Arguments& arguments) {
  EditState& state = work.state;
  state.symmetric = arguments.flag("on");
  if (!state.symmetric) return {};
  const Vec3 given = arguments.vector("normal");
  Box box{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  for (const HairVertex& v : work.mesh.vertices()) {
    if (v.layer > 0) continue;
    box.lo = box.lo.cwiseMin(v.position);
    box.hi = box.hi.cwiseMax(v.position);
  }
  const Vec3 middle = 0.5 * (box.lo + box.hi);
  std::vector<std::pair<Vec3, Vec3>> planes;  // point, normal
  if (!given.isZero(0)) {
    planes.push_back({arguments.vector("point"), given.normalized()});
  } else {
    for (int axis : {0, 2, 1}) planes.push_back({middle, Vec3::Unit(axis)});
  }
  std::size_t best = 0;
  for (const auto& [point, normal] : planes) {
    EditState trial = state;
    trial.mirrorPoint = point, trial.mirrorNormal = normal;
    COIF_ASSIGN(const std::unique_ptr<Mirror> found, mirrorOf(work.mesh, trial));
    const auto partners =
        std::size_t(std::ranges::count_if(found->vertexPartner, [](auto p) { return p != kNone; }));
    if (partners > best) best = partners, state = trial;
  }
  if (2 * best < work.mesh.vertices().size()) {
    return refuse("fewer than half of the vertices have a partner across the plane");
  }
  return {};
}

Status setStrands(Work& work, const Arguments& arguments) {
  StrandSettings& s = work.state.strands;
  s.count = std::size_t(arguments.number("count"));
  s.points = std::uint32_t(arguments.number("points"));
  s.tolerance = arguments.number("tolerance");
  s.seed = std::uint64_t(arguments.number("seed"));
  s.width = arguments.number("width");
  s.tipWidth = arguments.number("tip_width");
  return {};
}

Status setLook(Work& work, const Arguments& arguments) {
  const Vec3 color = arguments.vector("color");
  if (color.minCoeff() < 0 || color.maxCoeff() > 1) return refuse("the colour's parts lie between 0 and 1");
  work.state.look.hairColor = color.cast<float>();
  work.state.look.longitudinalRoughness = arguments.number("roughness");
  work.state.look.azimuthalRoughness = arguments.number("azimuthal_roughness");
  work.state.look.azimuthDeg = arguments.number("azimuth");
  work.state.look.elevationDeg = arguments.number("elevation");
  return {};
}

Status setLight(Work& work, const Arguments& arguments) {
  LightSettings& light = work.state.look.light;
  light.azimuthDeg = arguments.number("azimuth");
  light.elevationDeg = arguments.number("elevation");
  light.key = arguments.number("key");
  light.fill = arguments.number("fill");
  light.rim = arguments.number("rim");
  light.sky = arguments.number("sky");
  light.followCamera = arguments.flag("follow_camera");
  return {};
}

}  // namespace

std::vector<Command> settingCommands() {
  return {
      {{"hide", "Hide", "View", "H", "Hides the selected bundles."}, hide},
      {{"isolate", "Isolate", "View", "Shift+H", "Hides all but the selected bundles."}, isolate},
      {{"show_all", "Show all", "View", "Alt+H", "Shows every bundle."},
       [](Work& work, const Arguments&) -> Status {
         work.state.hidden.clear();
         return {};
       }},
      {{"freeze", "Freeze", "Edit", "Ctrl+F", "Keeps the selected vertices from being moved."}, freeze},
      {{"unfreeze_all", "Unfreeze all", "Edit", "Alt+F", "Lets every vertex be moved again."},
       [](Work& work, const Arguments&) -> Status {
         work.state.frozen.clear();
         return {};
       }},
      {{"symmetry",
        "Symmetry",
        "Edit",
        "Ctrl+M",
        "Works on both sides of a plane.",
        {flag("on", true, "On or off."), vector("point", Vec3::Zero(), "A point of the plane, scene units."),
         vector("normal", Vec3::Zero(), "Of the plane; zero: the best of the three axes.")}},
       setSymmetry},
      {{"set_strands",
        "Strands",
        "Strands",
        "",
        "What is grown on the mesh.",
        {integer("count", 20000, 0, 1e8, "Strands."), integer("points", 32, 2, 100000, "Points a strand."),
         number("tolerance", 0, 0, 1e12, "Above 0: adaptive, chord error in scene units."),
         integer("seed", 1, 0, 9e15, "Of the roots."),
         number("width", 0, 0, 1e12, "Root diameter, scene units; 0: 0.08 mm."),
         number("tip_width", 0.25, 0, 1, "Tip diameter / root diameter.")}},
       setStrands},
      {{"set_look",
        "Look",
        "View",
        "",
        "Hair colour and camera.",
        {vector("color", Vec3(0.16, 0.08, 0.04), "Linear RGB reflectance."),
         number("azimuth", 30, -1e6, 1e6, "Degrees; 0 looks at the face."),
         number("elevation", 8, -90, 90, "Degrees."),
         number("roughness", 0.3, 0, 1, "Along the hair: how wide highlights are."),
         number("azimuthal_roughness", 0.3, 0, 1, "Around the hair: how far light is spread.")}},
       setLook},
      {{"set_light",
        "Light",
        "View",
        "",
        "Where the key light stands, and how strong all lights are.",
        {number("azimuth", -42, -1e6, 1e6, "Degrees, of the key light; 0: from the eye, or the front."),
         number("elevation", 38, -90, 90, "Degrees."), number("key", 1, 0, 1000, "Factor of the key light."),
         number("fill", 1, 0, 1000, "Factor of the fill light."),
         number("rim", 1, 0, 1000, "Factor of the light from behind."),
         number("sky", 1, 0, 1000, "Factor of the light from all around."),
         flag("follow_camera", true, "The lights turn with the camera; else they stay about the head.")}},
       setLight},
  };
}

}  // namespace coif::editor
