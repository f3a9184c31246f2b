// From mouse and keys in the view to commands: tools in the hand, tools that a command has, refusals at the
// cursor.
#include <algorithm>

#include "brush_tool.h"
#include "gizmo.h"
#include "mesh_painter.h"
#include "operation_tool.h"
#include "scene_painter.h"
#include "studio.h"
#include "transform_tool.h"

namespace coif::studio {
namespace {

constexpr double kTurnDegPerSecond = 36, kLongestTurnStep = 0.25;

std::optional<HandTool> transformOf(const std::string& command) {
  if (command == "translate") return HandTool::Move;
  if (command == "rotate") return HandTool::Rotate;
  if (command == "scale") return HandTool::Scale;
  return std::nullopt;
}

/// Commands that are seen before they are done.
bool isOperation(const CommandInfo& info) {
  return info.menu == "Mesh" && info.changesMesh && info.name != "set_group";
}

/// Commands that want something selected, where trying costs little.
bool wantsSelection(const CommandInfo& info) {
  return info.menu == "Mesh" || info.menu == "Move" || info.name == "hide" || info.name == "isolate" ||
         info.name == "freeze";
}

/// Commands that go on from what is selected, and find nothing wrong with nothing.
bool growsSelection(const std::string& name) {
  for (const char* grows : {"select_more", "select_less", "select_linked", "select_columns"}) {
    if (name == grows) return true;
  }
  return false;
}

/// A circle goes with the mouse, and nothing is picked.
bool strokes(HandTool hand) {
  return hand == HandTool::Brush || hand == HandTool::Paint || hand == HandTool::Mask;
}

bool transforms(HandTool hand) {
  return hand == HandTool::Move || hand == HandTool::Rotate || hand == HandTool::Scale;
}

}  // namespace

CommandArguments Studio::argumentsFor(const CommandInfo& info) const {
  CommandArguments out;
  const HairMesh& mesh = document_->editor.mesh();
  for (const CommandArgument& argument : info.arguments) {
    if (argument.name == "kind" && info.menu == "Select")
      out["kind"] = argument.choices[std::size_t(view_.settings.kind)];
    if (argument.name == "operator") out["operator"] = chosenOperator();
    if (argument.name == "layer") {
      std::uint32_t layer = 0;
      for (std::uint32_t v : selectedVertices(mesh, document_->editor.state().selection))
        layer = std::max(layer, mesh.vertices()[v].layer);
      if (layer > 0) out["layer"] = double(layer);
    }
  }
  if (info.menu == "Move" && info.name != "translate") {
    const bool soft =
        std::ranges::find(info.arguments, "radius", &CommandArgument::name) != info.arguments.end();
    if (soft && info.name != "brush") tools_.soft.addTo(out);
  }
  return out;
}

void Studio::begin(const std::string& command) {
  if (!document_) return say("open a head or a document first", true);
  const CommandInfo& info = *findCommand(command);
  const CommandArguments arguments = argumentsFor(info);
  const bool nothing = document_->editor.state().selection.empty();
  const bool fails =
      nothing && (growsSelection(command) ||
                  (wantsSelection(info) && !document_->editor.attempt(command, arguments).ok()));
  if (fails && view_.screen() != nullptr && view_.hovered()) {
    // Nothing is selected: what is under the mouse is meant.
    const Selection found = under(view_, document_->editor.mesh());
    if (!found.empty()) run("select", selectArguments(found, "set"));
  }
  const Editor& editor = document_->editor;
  if (const auto hand = transformOf(command); hand && view_.screen()) {
    if (editor.state().selection.empty()) return say("select something first", true);
    tool_ = std::make_unique<TransformTool>(*hand, editor, view_, tools_, document_->head().get());
  } else if (isOperation(info) && view_.screen()) {
    if (const auto attempt = editor.attempt(command, arguments); !attempt.ok())
      return say(attempt.error().text(), true);
    tool_ = std::make_unique<OperationTool>(command, editor, view_);
  } else {
    command == "use_mesh" ? askPath(PathUse::TakeMesh) : run(command, argumentsFor(info));
  }
}

const HairMesh& Studio::shownMesh() const {
  return attempt_ ? *attempt_ : playedMesh_ ? *playedMesh_ : document_->editor.mesh();
}

void Studio::show(const std::string& command, const CommandArguments& arguments) {
  std::string line = pythonLine(command, arguments);
  if (line == attemptLine_) return;
  attemptLine_ = std::move(line);
  auto attempt = document_->editor.attempt(command, arguments);
  ++attemptNumber_;
  if (attempt.ok()) {
    attempt_ = std::move(*attempt);
    refusal_.clear();
  } else {
    refusal_ = attempt.error().text();
  }
}

void Studio::forgetAttempt() {
  attempt_.reset();
  attemptLine_.clear(), refusal_.clear();
}

void Studio::followTool() {
  const Trace::Span span(trace_, "drag");
  tool_->update(view_, window_.keys());
  if (tool_->dropped()) {
    tool_.reset(), forgetAttempt();
  } else if (tool_->confirmed()) {
    const std::string command = tool_->command();
    const CommandArguments arguments = tool_->arguments();
    if (const auto* transform = dynamic_cast<const TransformTool*>(tool_.get()))
      tools_.soft.radius = transform->softRadius();
    tool_.reset(), forgetAttempt();
    run(command, arguments);
  } else {
    show(tool_->command(), tool_->arguments());
  }
}

void Studio::followBrush() {
  const Trace::Span span(trace_, "drag");
  const auto work = brush_.update(view_, window_.keys(), tools_.brush);
  if (work && work->ended) {
    forgetAttempt();
    run("brush", work->arguments);
  } else if (work) {
    show("brush", work->arguments);
  } else {
    forgetAttempt();
  }
}

std::optional<Vec3> Studio::selectionMiddle() const {
  const HairMesh& mesh = document_->editor.mesh();
  const auto chosen = selectedVertices(mesh, document_->editor.state().selection);
  if (chosen.empty()) return std::nullopt;
  Vec3 sum = Vec3::Zero();
  for (std::uint32_t v : chosen) sum += mesh.position(v);
  return sum / double(chosen.size());
}

Gizmo Studio::gizmoAt(const Vec3& middle) const {
  const HairMesh& mesh = document_->editor.mesh();
  const auto chosen = selectedVertices(mesh, document_->editor.state().selection);
  return {tools_.hand, middle, selectionAxes(mesh, chosen, tools_.axes), view_};
}

bool Studio::takeTools() {
  if (!document_ || !view_.screen()) return false;
  if (tool_) {
    followTool();
    return true;
  }
  if (tools_.hand == HandTool::Brush || tools_.hand == HandTool::Mask) {
    tools_.hand == HandTool::Brush ? followBrush() : followMask();
    return brush_.tookKeys();
  }
  if (const char* look = view_.settings.axes ? axisAt(view_, window_.scale()) : nullptr;
      look != nullptr && ImGui::IsMouseClicked(0)) {
    for (const MenuEntry& entry : entries()) {
      if (entry.name == look) carryOut(entry);
    }
    return false;
  }
  if (const auto middle = selectionMiddle(); middle && transforms(tools_.hand) && view_.hovered()) {
    const auto handle = gizmoAt(*middle).at(view_.mouse());
    if (handle && ImGui::IsMouseClicked(0)) {
      tool_ = std::make_unique<TransformTool>(tools_.hand, document_->editor, view_, tools_,
                                              document_->head().get(), *handle);
      return true;
    }
  }
  const HairMesh& mesh = document_->editor.mesh();
  const auto wishes =
      tools_.hand == HandTool::Paint ? select_.paint(view_, mesh, tools_) : select_.update(view_, mesh);
  for (const Wish& wish : wishes) run(wish.command, wish.arguments);
  return false;
}

/// A mask is painted on the bare scalp.
bool Studio::strandsInPicture() const {
  return view_.settings.showStrands && tools_.hand != HandTool::Mask;
}

bool Studio::headInPicture() const {
  return view_.settings.headStyle == HeadStyle::Shaded || !document_->head() || !canPaintHead(*document_->head());
}

bool Studio::turnTable() {
  const double before = std::exchange(turnedAt_, secondsNow());
  if (!view_.settings.turntable) return false;
  const double passed = std::min(turnedAt_ - before, kLongestTurnStep);
  view_.camera = orbit(view_.camera, view_.upAxis, kTurnDegPerSecond * passed, 0);
  window_.wakeWithin(1.0 / 60);
  return true;
}

void Studio::drawUnderView() {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ImVec2 from = view_.origin(), size = view_.size();
  paintBackdrop(view_, settings_.lightTheme);
  list.PushClipRect(from, {from.x + size.x, from.y + size.y});
  const Surface* head = document_->head().get();
  if (view_.settings.grid) {
    std::vector<Vec3> points;
    if (head != nullptr) points = {document_->headBox().lo, document_->headBox().hi};
    for (const HairVertex& vertex : document_->editor.mesh().vertices()) points.push_back(vertex.position);
    if (!points.empty()) paintGrid(view_, bounds(points), 10 * tools_.snap.step);
  }
  if (view_.settings.showHead && !headInPicture()) paintHead(view_, *head, view_.settings.headStyle);
  list.PopClipRect();
}

void Studio::drawOverView() {
  const HairMesh& now = shownMesh();
  EditState state = document_->editor.state();
  if (attempt_) state.selection = keepValid(now, state.selection);
  if (const Selection* painted = select_.painted()) {
    for (VertexId id : painted->vertices) state.selection.vertices.push_back(id);
    for (const EdgeRef& edge : painted->edges) state.selection.edges.push_back(edge);
    for (const FaceRef& face : painted->faces) state.selection.faces.push_back(face);
    state.selection = keepValid(now, state.selection);
  }
  const Trace::Span draw(trace_, "draw mesh");
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ImVec2 from = view_.origin(), size = view_.size();
  list.PushClipRect(from, {from.x + size.x, from.y + size.y});
  MeshPainter painter(view_, now, state);
  tools_.hand == HandTool::Mask ? painter.paintMask(shownMask()) : painter.paint();
  if (tool_ && attempt_) painter.paintChanges(document_->editor.mesh());
  const bool free = !tool_ && view_.hovered() && !ImGui::IsAnyMouseDown();
  std::optional<Constraint> hot;
  if (const auto middle = tool_ ? std::nullopt : selectionMiddle(); middle && transforms(tools_.hand)) {
    const Gizmo gizmo = gizmoAt(*middle);
    if (free) hot = gizmo.at(view_.mouse());
    gizmo.draw(hot);
  }
  if (free && !hot && !strokes(tools_.hand) && view_.settings.mesh != MeshStyle::Hidden)
    painter.paintHover(under(view_, now));
  if (tool_) tool_->draw(view_);
  if (view_.settings.axes) paintAxes(view_, window_.scale());
  list.PopClipRect();
  select_.draw(view_, tools_);
  if ((tools_.hand == HandTool::Brush || tools_.hand == HandTool::Mask) && !tool_)
    brush_.draw(view_, tools_.brush);
  drawNote();
}

/// What a tool's numbers are, and why something was refused, beside the mouse.
void Studio::drawNote() {
  const bool refused = !refusal_.empty() || secondsNow() < noteUntil_;
  const std::string& problem = refusal_.empty() ? note_ : refusal_;
  const std::string text = refused ? problem : tool_ ? tool_->label() : std::string();
  if (text.empty()) return;
  if (refused && refusal_.empty()) window_.wakeWithin(noteUntil_ - secondsNow());
  const float scale = window_.scale();
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  ImVec2 at{mouse.x + 18 * scale, mouse.y + 16 * scale};
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, 320 * scale);
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  at.x = std::clamp(at.x, 0.0f, std::max(all.x - size.x - 16 * scale, 0.0f));
  at.y = std::clamp(at.y, 0.0f, std::max(all.y - size.y - 16 * scale, 0.0f));
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  const ImVec2 pad{7 * scale, 5 * scale};
  list.AddRectFilled({at.x - pad.x, at.y - pad.y}, {at.x + size.x + pad.x, at.y + size.y + pad.y},
                     refused ? IM_COL32(110, 30, 28, 235) : IM_COL32(25, 26, 30, 225), 4 * scale);
  list.AddText(nullptr, 0, at, IM_COL32(255, 255, 255, 255), text.c_str(), nullptr, 320 * scale);
}

}  // namespace coif::studio
