// Hair in motion: play, wind, head moves, draping, keeping a pose, baking frames to a file; and progress.
#include <imgui.h>

#include <algorithm>

#include "coif/scene/evaluate.h"
#include "studio.h"

namespace coif::studio {

MotionInput Studio::motionInput() const {
  const Scene& scene = document_->editor.scene();
  return {scene.hairMesh, scene.dynamics, headMove_, document_->head(), scene.metersPerUnit, scene.upAxis};
}

void Studio::playMotion() {
  if (!document_) return say("open a head or a document first", true);
  if (player_.running()) return player_.pause();
  if (player_.active()) return player_.resume();
  player_.play(motionInput());
}

std::vector<Action> Studio::motionActions() {
  const auto noDocument = [this] { return document_ ? std::string() : "no document is open"; };
  return {
      {"play", "Play", "Motion", "Space", "Lets the hair move, or holds it.", [this] { playMotion(); },
       [this] { return player_.running(); }, noDocument},
      {"motion_reset",
       "Reset",
       "Motion",
       "Shift+Space",
       "Goes back to the hair as it was modelled.",
       [this] { player_.reset(); },
       {},
       noDocument},
      {"keep_shape",
       "Keep this shape",
       "Motion",
       "Ctrl+K",
       "Makes the pose that is shown the modelled hairstyle: one step of undo.",
       [this] { keepMotion(); },
       {},
       noDocument},
      {"bake",
       "Bake ...",
       "Motion",
       "Ctrl+Shift+B",
       "Writes every frame: USD with time samples, or a .coifcache.",
       [this] { askPath(PathUse::BakeMotion); },
       {},
       noDocument},
  };
}

void Studio::takeMotion() {
  if (const std::string problem = player_.takeProblem(); !problem.empty()) say(problem, true);
  if (!document_) return;
  const bool edited =
      playedMesh_ && !std::ranges::equal(playedMesh_->bundles(), document_->editor.mesh().bundles());
  if (player_.active() && (tool_ || edited)) player_.reset();  // the mesh is worked on as it was modelled
  if (!player_.active()) {
    played_.reset(), playedMesh_.reset();
    return;
  }
  auto frame = player_.take();
  if (!frame || frame->positions.size() != document_->editor.mesh().vertices().size()) return;
  HairMesh mesh = document_->editor.mesh();
  for (std::uint32_t v = 0; v < frame->positions.size(); ++v) mesh.setPosition(v, frame->positions[v]);
  playedMesh_ = std::move(mesh);
  played_ = std::move(frame);
}

void Studio::keepMotion() {
  if (!document_ || !played_) return say("play the motion first, and pause it where it is to be kept", true);
  const HairMesh& mesh = document_->editor.mesh();
  const auto external = externalVertices(mesh);
  // Symmetric moves add both sides' up.
  const double part = document_->editor.state().symmetric ? 0.5 : 1;
  std::vector<double> vertices, offsets;
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    if (!external[v] || mesh.vertices()[v].layer == 0) continue;
    vertices.push_back(std::uint32_t(mesh.vertices()[v].id));
    const Vec3 by = part * (played_->positions[v] - mesh.position(v));
    offsets.insert(offsets.end(), {by.x(), by.y(), by.z()});
  }
  player_.reset();
  run("displace", {{"vertices", vertices}, {"offsets", offsets}});
}

void Studio::bakeMotion(const std::filesystem::path& path) {
  if (!document_ || waitsForJob()) return;
  auto scene = std::make_shared<const Scene>(document_->editor.scene());
  SimulateOptions what;
  what.framesPerSecond = MotionPlayer::kFramesPerSecond;
  what.frames = std::size_t(bakeSeconds_ * what.framesPerSecond) + 1;
  const bool cache = path.extension() == ".coifcache";
  if (cache) what.cache = path;
  auto poses = headPoses(headMove_, scene->hairMesh, scene->upAxis, what.frames, what.framesPerSecond);
  if (!poses.ok()) return say(poses.error().text(), true);
  if (headMove_.move != HeadMove::Still) what.motion.poses = std::move(*poses);
  const LoadedHead head = document_->loadedHead();
  job_.start("Baking " + path.filename().string(), [=, this](const Context& context) -> Job::Finish {
    Evaluation evaluation;
    evaluation.holdHead(head);
    std::string problem, note;
    if (cache) {
      if (const auto done = evaluation.simulate(*scene, what, context); !done.ok())
        problem = done.error().text();
    } else {
      const auto done = evaluation.exportMotion(*scene, what, path, context);
      if (!done.ok()) {
        problem = done.error().text();
      } else if (!done->notes.empty()) {
        note = "; " + done->notes.back();
      }
    }
    return [this, problem, note, path] {
      problem.empty() ? say("baked " + path.string() + note) : say(problem, true);
    };
  });
}

void Studio::drawMotionPanel() {
  if (!header("Motion")) return;
  const float wide = 0.5f * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  if (ImGui::Button(player_.running() ? "Pause###play" : "Play###play", {wide, 0})) playMotion();
  ImGui::SameLine();
  if (ImGui::Button("Reset", {wide, 0})) player_.reset();
  if (player_.preparing()) {
    ImGui::TextDisabled("measuring the head ...");
  } else if (played_) {
    ImGui::TextDisabled("%.2f s", double(played_->frame) / MotionPlayer::kFramesPerSecond);
  } else {
    ImGui::TextDisabled("as modelled");
  }

  HeadMoveSettings head = headMove_;
  int move = int(head.move);
  if (ImGui::Combo("head", &move, kHeadMoveNames, IM_ARRAYSIZE(kHeadMoveNames))) head.move = HeadMove(move);
  if (head.move != HeadMove::Still) {
    const double slow = 0.1, fast = 4, least = 1, most = 90;
    ImGui::SliderScalar("a second", ImGuiDataType_Double, &head.timesPerSecond, &slow, &fast, "%.1f times");
    if (head.move != HeadMove::Turn)
      ImGui::SliderScalar("angle", ImGuiDataType_Double, &head.angleDeg, &least, &most, "%.0f°");
  }
  const bool headChanged = !(head == headMove_);
  headMove_ = head;

  const DynamicsSettings& s = document_->editor.state().dynamics;
  constexpr const char* kWinds[] = {"none", "constant", "gusts", "fluid"};
  CommandArguments values{{"droop", s.droop},
                          {"gravity", s.gravity},
                          {"drag", s.drag},
                          {"lateral", s.lateral},
                          {"settle", s.settleSeconds},
                          {"wind", std::string(kWinds[int(s.wind)])},
                          {"wind_velocity", s.windVelocity},
                          {"gust_speed", s.gustSpeed},
                          {"collide", s.collide},
                          {"thickness", s.thickness},
                          {"friction", s.friction},
                          {"repulsion", s.repulsion}};
  bool changed = false;
  for (const CommandArgument& argument : findCommand("set_dynamics")->arguments)
    changed |= drawArgument(argument, values);
  if (changed) run("set_dynamics", values);
  if ((changed || headChanged) && player_.active()) player_.change(motionInput());

  ImGui::Separator();
  if (ImGui::Button("Keep this shape", {-1, 0})) keepMotion();
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("Makes the paused pose the modelled hairstyle: one step of undo.");
  if (ImGui::Button("Drape", {-1, 0})) run("drape");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", findCommand("drape")->help.c_str());
  const double least = 0.1, most = 600;
  ImGui::SetNextItemWidth(wide);
  ImGui::DragScalar("##bake", ImGuiDataType_Double, &bakeSeconds_, 0.1f, &least, &most, "%.1f s");
  ImGui::SameLine();
  if (ImGui::Button("Bake ...", {wide, 0})) askPath(PathUse::BakeMotion);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("Writes every frame: USD with time samples, or a .coifcache.");
}

void Studio::drawProgress() {
  const float scale = window_.scale();
  ImGui::TextUnformatted(job_.what().c_str());
  if (job_.seconds() < 0.3) return window_.wakeWithin(0.3);
  window_.wakeWithin(0.25);
  ImGui::SameLine();
  const double fraction = job_.fraction();
  const std::string step = job_.cancelled() ? "stopping ..." : job_.step();
  ImGui::ProgressBar(fraction < 0 ? 0 : float(fraction), {220 * scale, ImGui::GetTextLineHeight()},
                     step.c_str());
  ImGui::SameLine();
  if (ImGui::SmallButton("Cancel")) job_.cancel();
}

}  // namespace coif::studio
