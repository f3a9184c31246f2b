// The View menu: from where, through which lens, and what is shown.
#include "studio.h"

namespace coif::studio {
namespace {

constexpr double kTurnStepDeg = 15;

}  // namespace

std::vector<Action> Studio::viewActions() {
  ViewSettings& s = view_.settings;
  std::vector<Action> list;
  const auto show = [&](const char* name, const char* label, const char* key, const char* help, bool& value) {
    list.push_back(
        {name, label, "View/Show", key, help, [&value] { value = !value; }, [&value] { return value; }});
  };
  show("show_strands", "Strands", "Alt+1", "Shows or hides the strands.", s.showStrands);
  show("show_head", "Head", "Alt+2", "Shows or hides the head.", s.showHead);
  show("show_inner", "Inner vertices", "Alt+3", "Shows the vertices that are placed by themselves.",
       s.showInternal);
  const auto mesh = [&](const char* name, const char* label, const char* help, MeshStyle style) {
    list.push_back({name, label, "View/Hair mesh", "", help, [this, style] { view_.settings.mesh = style; },
                    [this, style] { return view_.settings.mesh == style; }});
  };
  mesh("mesh_hidden", "Hidden", "Hides the hair mesh.", MeshStyle::Hidden);
  mesh("mesh_wire", "Wire", "Draws the hair mesh as lines.", MeshStyle::Wire);
  mesh("mesh_shaded", "Shaded", "Draws the hair's outside as faces.", MeshStyle::Shaded);
  mesh("mesh_xray", "X-ray", "Draws and picks the hair mesh through the head.", MeshStyle::XRay);
  list.push_back({"mesh_next", "Next style", "View/Hair mesh", "Z", "Goes through the styles of the mesh.",
                  [&s] { s.mesh = MeshStyle((int(s.mesh) + 1) % 4); }});

  const auto headStyle = [&](const char* name, const char* label, const char* help, HeadStyle style) {
    list.push_back({name, label, "View/Head", "", help, [this, style] { view_.settings.headStyle = style; },
                    [this, style] { return view_.settings.headStyle == style; }});
  };
  headStyle("head_shaded", "Shaded", "The head as it is lit.", HeadStyle::Shaded);
  headStyle("head_wire", "Wire", "The head as lines.", HeadStyle::Wire);
  headStyle("head_xray", "X-ray", "The head as glass: what is behind it can be seen and picked.",
            HeadStyle::XRay);
  list.push_back({"head_next", "Next style", "View/Head", "Alt+Z", "Goes through the styles of the head.",
                  [&s] { s.headStyle = HeadStyle((int(s.headStyle) + 1) % 3); }});
  const auto color = [&](const char* name, const char* label, MeshColor by) {
    list.push_back({name, label, "View/Hair mesh colours", "", std::string("One colour a ") + label + ".",
                    [this, by] { view_.settings.color = by; },
                    [this, by] { return view_.settings.color == by; }});
  };
  color("color_layer", "layer", MeshColor::Layer);
  color("color_bundle", "bundle", MeshColor::Bundle);
  color("color_group", "group", MeshColor::Group);
  list.push_back({"color_next", "Next colours", "View/Hair mesh colours", "Shift+Z",
                  "Colours by layer, by bundle, by group.",
                  [&s] { s.color = MeshColor((int(s.color) + 1) % 3); }});
  const auto shade = [&](const char* name, const char* label, const char* key, const char* help,
                         PreviewShading shading) {
    list.push_back({name, label, "View/Shading", key, help,
                    [this, shading] { view_.settings.shading = shading; },
                    [this, shading] { return view_.settings.shading == shading; }});
  };
  shade("shade_studio", "Studio", "F5", "Soft highlights by eye: quick.", PreviewShading::Studio);
  shade("shade_kajiya", "Kajiya-Kay", "F6", "Kajiya and Kay's highlights.", PreviewShading::KajiyaKay);
  shade("shade_marschner", "Marschner", "F7", "Light through single hairs.", PreviewShading::Marschner);
  shade("shade_dual", "Dual scattering", "F8", "Light from hair to hair: the truest.",
        PreviewShading::DualScattering);
  show("shadows", "Shadows", "Alt+4", "Hair shades hair and head.", s.shadows);
  show("show_grid", "Grid", "Alt+5", "Shows the ground's grid.", s.grid);
  show("show_axes", "Axes", "Alt+6", "Shows the axes in the corner.", s.axes);
  list.push_back({"beside", "Strands beside the mesh", "View", "Ctrl+B",
                  "Two views: with the mesh and without.", [&s] { s.beside = !s.beside; },
                  [&s] { return s.beside; }});
  list.push_back({"turntable", "Turntable", "View", "T", "Turns the model until it is pressed again.",
                  [&s] { s.turntable = !s.turntable; }, [&s] { return s.turntable; }});

  const auto look = [&](const char* name, const char* label, const char* key, double azimuth,
                        double elevation) {
    list.push_back({name, label, "View/Look from", key, std::string("Looks from there: ") + label + ".",
                    [this, azimuth, elevation] { view_.lookFrom(azimuth, elevation); }});
  };
  look("view_front", "Front", "Numpad1", 0, 0);
  look("view_back", "Back", "Ctrl+Numpad1", 180, 0);
  look("view_right", "Right", "Numpad3", 90, 0);
  look("view_left", "Left", "Ctrl+Numpad3", -90, 0);
  look("view_top", "Top", "Numpad7", 0, 89);
  look("view_bottom", "Bottom", "Ctrl+Numpad7", 0, -89);
  const auto turn = [&](const char* name, const char* label, const char* key, double azimuth,
                        double elevation) {
    list.push_back(
        {name, label, "View/Turn", key, std::string(label) + " by 15 degrees.", [this, azimuth, elevation] {
           view_.camera = orbit(view_.camera, view_.upAxis, azimuth, elevation);
         }});
  };
  turn("turn_left", "Turn left", "Numpad4", -kTurnStepDeg, 0);
  turn("turn_right", "Turn right", "Numpad6", kTurnStepDeg, 0);
  turn("turn_up", "Turn up", "Numpad8", 0, kTurnStepDeg);
  turn("turn_down", "Turn down", "Numpad2", 0, -kTurnStepDeg);
  list.push_back({"view_parallel", "Parallel", "View", "Numpad5", "Draws without perspective.",
                  [this] { view_.setParallel(!view_.parallel()); }, [this] { return view_.parallel(); }});
  list.push_back({"frame_selected", "Frame selected", "View", "F NumpadDecimal",
                  "Brings the selection, or all, to the middle.", [this] {
                    if (document_) view_.frame(document_->editor.mesh(), document_->editor.state().selection);
                  }});
  list.push_back(
      {"frame_all", "Frame all", "View", "Home", "Brings the whole hair mesh to the middle.", [this] {
         if (document_) view_.frame(document_->editor.mesh(), {});
       }});
  list.push_back({"maya_habits", "Mouse and keys as in Maya", "View", "", "Else as in Blender.",
                  [this] {
                    settings_.mayaMouse = !settings_.mayaMouse;
                    view_.settings.habit = settings_.mayaMouse ? MouseHabit::Maya : MouseHabit::Blender;
                    (void)settings_.save();
                  },
                  [this] { return settings_.mayaMouse; }});
  list.push_back({"light_theme", "Light theme", "View", "", "Else a dark one.",
                  [this] {
                    settings_.lightTheme = !settings_.lightTheme;
                    window_.setTheme(settings_.lightTheme);
                    (void)settings_.save();
                  },
                  [this] { return settings_.lightTheme; }});
  return list;
}

}  // namespace coif::studio
