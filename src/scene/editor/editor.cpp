#include "coif/scene/editor.h"

#include <algorithm>
#include <cmath>

#include "scene/dynamics_json.h"
#include "scene/editor/command_table.h"
#include "scene/style_json.h"

namespace coif {

bool EditState::operator==(const EditState& o) const {
  return selection == o.selection && hidden == o.hidden && frozen == o.frozen && symmetric == o.symmetric &&
         mirrorPoint == o.mirrorPoint && mirrorNormal == o.mirrorNormal && strands == o.strands &&
         styles == o.styles && look == o.look && dynamics == o.dynamics;
}

namespace {

/// What the mesh no longer has is neither selected nor hidden nor frozen.
void dropMissing(const HairMesh& mesh, EditState& state) {
  state.selection = keepValid(mesh, std::move(state.selection));
  std::erase_if(state.hidden, [&](BundleId id) { return mesh.indexOf(id) == kNone; });
  std::erase_if(state.frozen, [&](VertexId id) { return mesh.indexOf(id) == kNone; });
}

bool sameTopology(const HairMesh& a, const HairMesh& b) {
  return std::ranges::equal(a.bundles(), b.bundles()) &&
         std::ranges::equal(a.vertices(), b.vertices(), {}, &HairVertex::id, &HairVertex::id);
}

}  // namespace

Editor::Editor(Scene scene) : scene_(std::move(scene)), cache_(std::make_unique<editor::AttemptCache>()) {
  state_.strands = scene_.strands;
  state_.styles = scene_.styles;
  state_.look = scene_.look;
  state_.dynamics = scene_.dynamics;
}
void Editor::setHead(const Surface* head) {
  head_ = head;
  cache_->forgetHead();
}

Editor::~Editor() = default;
Editor::Editor(Editor&&) noexcept = default;
Editor& Editor::operator=(Editor&&) noexcept = default;

Result<PreparedCommand> Editor::outcomeOf(std::string_view name, const CommandArguments& given,
                                          const Context& context) const {
  const editor::Command* command = editor::find(name);
  if (command == nullptr || !command->run) {
    return makeError(ErrorCode::NotFound, "there is no command '" + std::string(name) + "'");
  }
  COIF_ASSIGN(const editor::Arguments arguments, editor::complete(*command, given));
  editor::Work work{scene_.hairMesh,      state_,       head_, context, *cache_, revision_,
                    scene_.metersPerUnit, scene_.upAxis};
  COIF_TRY(command->run(work, arguments));
  PreparedCommand outcome{command->info.label,   {},   revision_, std::move(work.mesh),
                          std::move(work.state), false};
  outcome.meshChanged = !(outcome.mesh == scene_.hairMesh);
  if (outcome.meshChanged) COIF_TRY(cache_->place(outcome.mesh, context));
  const bool sameElements = outcome.state.selection == state_.selection &&
                            (!outcome.meshChanged || sameTopology(outcome.mesh, scene_.hairMesh));
  if (!sameElements) dropMissing(outcome.mesh, outcome.state);
  return outcome;
}

Result<PreparedCommand> Editor::prepare(std::string_view name, const CommandArguments& given,
                                        const Context& context) const {
  COIF_ASSIGN(PreparedCommand outcome, outcomeOf(name, given, context));
  outcome.python = pythonLine(name, given);
  return outcome;
}

Result<HairMesh> Editor::attempt(std::string_view command, const CommandArguments& arguments,
                                 const Context& context) const {
  COIF_ASSIGN(PreparedCommand outcome, outcomeOf(command, arguments, context));
  return std::move(outcome.mesh);
}

Status Editor::run(std::string_view name, const CommandArguments& given, const Context& context) {
  if (name == "undo" || name == "redo") {
    COIF_ASSIGN(const editor::Arguments none, editor::complete(*editor::find(name), given));
    (void)none;
    return name == "undo" ? undo() : redo();
  }
  COIF_ASSIGN(PreparedCommand outcome, prepare(name, given, context));
  return commit(std::move(outcome));
}

Status Editor::commit(PreparedCommand outcome) {
  if (outcome.revision != revision_) {
    return makeError(ErrorCode::InvalidArgument, "the document changed while the command ran");
  }
  if (!outcome.meshChanged && outcome.state == state_) return {};
  record(outcome);
  scene_.hairMesh = std::move(outcome.mesh);
  if (outcome.meshChanged) scene_.placedHash = meshHash(scene_.hairMesh);
  adopt(outcome.state);
  return {};
}

void Editor::record(const PreparedCommand& outcome) {
  const std::size_t stepsOfMesh = history_.undoCount();
  if (outcome.meshChanged) history_.record(scene_.hairMesh, outcome.mesh, outcome.label);
  steps_.resize(done_);
  const bool sharesState = !steps_.empty() && *steps_.back().after == state_;
  Step step{outcome.label, outcome.python, history_.undoCount() > stepsOfMesh,
            sharesState ? steps_.back().after : std::make_shared<const EditState>(state_), nullptr};
  step.after = outcome.state == state_ ? step.before : std::make_shared<const EditState>(outcome.state);
  steps_.push_back(std::move(step));
  if (savedAt_ > done_) savedAt_ = std::size_t(-1);  // the saved state was undone and is now out of reach
  ++done_;
}

void Editor::adopt(const EditState& state) {
  state_ = state;
  scene_.strands = state_.strands;
  scene_.styles = state_.styles;
  scene_.look = state_.look;
  scene_.dynamics = state_.dynamics;
  ++revision_;
}

Status Editor::undo() {
  if (done_ == 0) return makeError(ErrorCode::NotFound, "there is nothing to undo");
  const Step& step = steps_[done_ - 1];
  if (step.meshChanged) COIF_TRY(history_.undo(scene_.hairMesh));
  --done_;
  adopt(*step.before);
  return {};
}

Status Editor::redo() {
  if (done_ == steps_.size()) return makeError(ErrorCode::NotFound, "there is nothing to redo");
  const Step& step = steps_[done_];
  if (step.meshChanged) COIF_TRY(history_.redo(scene_.hairMesh));
  ++done_;
  adopt(*step.after);
  return {};
}

std::string Editor::refusal(std::string_view name) const {
  if (editor::find(name) == nullptr) return "there is no command '" + std::string(name) + "'";
  if (name == "undo") return done_ == 0 ? "there is nothing to undo" : "";
  if (name == "redo") return done_ == steps_.size() ? "there is nothing to redo" : "";
  return {};
}

std::vector<std::string> Editor::stepLabels() const {
  std::vector<std::string> labels;
  for (const Step& step : steps_) labels.push_back(step.label);
  return labels;
}

std::string Editor::pythonLog() const {
  std::string log;
  for (std::size_t i = 0; i < done_; ++i) log += steps_[i].python + "\n";
  return log;
}

std::size_t Editor::historyBytes() const {
  std::size_t bytes = history_.bytes();
  for (const Step& step : steps_) {
    bytes += sizeof step + step.label.size() + step.python.size() + sizeof(EditState) +
             step.after->selection.size() * sizeof(EdgeRef);
    for (const StyleOperator& op : step.after->styles)
      bytes += sizeof op + op.mask.size() * sizeof op.mask[0];
  }
  return bytes;
}

Status Editor::save(const std::filesystem::path& path) {
  COIF_TRY(saveScene(scene_, path));
  savedAt_ = done_;
  return {};
}

std::vector<std::byte> Editor::canonicalState() const {
  std::vector<std::byte> bytes = canonicalBytes(scene_.hairMesh);
  const auto put = [&](const auto& value) {
    const auto* first = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof value);
  };
  const auto putAll = [&](const auto& list) {
    put(std::uint64_t(list.size()));
    for (const auto& item : list) put(item);
  };
  putAll(state_.selection.vertices);
  putAll(state_.selection.edges);
  putAll(state_.selection.faces);
  putAll(state_.hidden);
  putAll(state_.frozen);
  put(state_.symmetric);
  for (const Vec3& v : {state_.mirrorPoint, state_.mirrorNormal}) {
    for (int i = 0; i < 3; ++i) put(v[i]);
  }
  const StrandSettings& s = state_.strands;
  put(std::uint64_t(s.count)), put(s.points), put(s.tolerance), put(s.seed), put(s.knots), put(s.width);
  const LookSettings& look = state_.look;
  put(s.tipWidth), put(look.azimuthDeg), put(look.elevationDeg);
  put(look.longitudinalRoughness), put(look.azimuthalRoughness);
  const LightSettings& light = look.light;
  for (double value : {light.azimuthDeg, light.elevationDeg, light.key, light.fill, light.rim, light.sky})
    put(value);
  put(light.followCamera);
  for (int i = 0; i < 3; ++i) put(state_.look.hairColor[i]);
  putAll(scene::stylesJson(state_.styles).dump());
  putAll(scene::dynamicsJson(state_.dynamics).dump());
  return bytes;
}

namespace editor {

Result<std::unique_ptr<Mirror>> mirrorOf(const HairMesh& mesh, const EditState& state) {
  if (!state.symmetric) return std::unique_ptr<Mirror>();
  double size = 0;
  for (const HairVertex& v : mesh.vertices()) size = std::max(size, (v.position - state.mirrorPoint).norm());
  // Partners are found within a thousandth of the mesh: closer than an artist places two vertices.
  COIF_ASSIGN(Mirror found,
              findMirror(mesh, state.mirrorPoint, state.mirrorNormal, std::max(1e-3 * size, 1e-12)));
  return std::make_unique<Mirror>(std::move(found));
}

Status Work::adoptMoves(const HairMesh& moved, std::span<const std::uint32_t> asked) {
  std::vector<Vec3> displacements(moved.vertices().size());
  for (std::uint32_t v = 0; v < displacements.size(); ++v) {
    displacements[v] = moved.position(v) - mesh.position(v);
  }
  return displace(std::move(displacements), asked);
}

Status Work::displace(std::vector<Vec3> displacements, std::span<const std::uint32_t> asked) {
  for (VertexId id : state.frozen) displacements[mesh.indexOf(id)].setZero();
  for (const Vec3& d : displacements) {
    if (!d.allFinite()) return refuse("the move is not finite");
  }
  const std::vector<std::uint8_t> external = externalVertices(mesh);
  COIF_ASSIGN(const std::unique_ptr<Mirror> partners, mirror());
  const auto pin = [&](std::uint32_t v) {
    if (v != kNone && !external[v]) mesh.setPinned(v, true);
  };
  for (std::uint32_t v : asked) {
    if (displacements[v].isZero(0)) continue;
    pin(v);
    if (partners) pin(partners->vertexPartner[v]);
  }
  if (partners) return moveSymmetrically(mesh, *partners, displacements);
  for (std::uint32_t v = 0; v < displacements.size(); ++v) {
    mesh.setPosition(v, mesh.position(v) + displacements[v]);
  }
  return {};
}

}  // namespace editor
}  // namespace coif
