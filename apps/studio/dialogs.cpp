// Questions: a path, what to do with what a crash left, whether to save.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "coif/io/safe_file.h"
#include "coif/scene/hairstyle.h"
#include "studio.h"

namespace coif::studio {
namespace {

namespace fs = std::filesystem;

void centred(float width) {
  const ImVec2 middle = ImGui::GetMainViewport()->GetCenter();
  ImGui::SetNextWindowPos(middle, ImGuiCond_Appearing, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({width, 0}, ImGuiCond_Appearing);
}

/// The folder that a path being typed is in, and its entries: folders first.
std::vector<fs::path> entriesBeside(const std::string& text) {
  fs::path folder(text);
  std::error_code error;
  if (!fs::is_directory(folder, error)) folder = folder.parent_path();
  if (folder.empty()) folder = fs::current_path(error);
  std::vector<fs::path> entries{folder / ".."};
  for (const auto& entry :
       fs::directory_iterator(folder, fs::directory_options::skip_permission_denied, error)) {
    if (entry.path().filename().string().front() != '.') entries.push_back(entry.path());
  }
  std::ranges::sort(entries.begin() + 1, entries.end(), {}, [&](const fs::path& p) {
    return std::pair(!fs::is_directory(p, error), p.filename().string());
  });
  return entries;
}

}  // namespace

void Studio::askPath(PathUse use) {
  pathUse_ = use, ++pathsAsked_;
  std::error_code error;
  const fs::path folder = document_ && !document_->path.empty() ? fs::absolute(document_->path).parent_path()
                                                                : fs::current_path(error);
  const std::string stem = document_ && !document_->path.empty() ? document_->path.stem().string() : "hair";
  pathText_ = (use == PathUse::SaveAs       ? folder / (stem + ".coif")
               : use == PathUse::Export     ? folder / (stem + ".usdc")
               : use == PathUse::Screenshot ? folder / (stem + ".png")
               : use == PathUse::Turntable  ? folder / (stem + "-turn.png")
               : use == PathUse::BakeMotion ? folder / (stem + "-motion.usdc")
                                            : folder / "")
                  .string();
  ImGui::OpenPopup("path");
}

void Studio::usePath(const fs::path& path) {
  const PathUse use = std::exchange(pathUse_, PathUse::None);
  if (use == PathUse::Open) return leaveDocument([this, path] { openPath(path, options_.style); });
  if (use == PathUse::SaveAs) return saveTo(path);
  if (use == PathUse::Export) return exportTo(path);
  if (use == PathUse::Turntable) return beginTurntable(path);
  if (use == PathUse::BakeMotion) return bakeMotion(path);
  if (use == PathUse::RunScript) return runScript(path);
  if (use == PathUse::TakeMesh) return run("use_mesh", {{"file", path.string()}});
  const auto png = encodePng(window_.screenshot());
  if (!png.ok()) return say(png.error().text(), true);
  auto file = SafeFile::create(path);
  if (!file.ok()) return say(file.error().text(), true);
  file->write(*png);
  const Status written = file->commit();
  written.ok() ? say("wrote " + path.string()) : say(written.error().text(), true);
}

void Studio::drawPathDialog() {
  if (pathUse_ == PathUse::None) return;
  const char* titles[] = {"",
                          "Open a head or a .coif document",
                          "Save the document as",
                          "Export strands (.usdc, .usda, .glb, .hair)",
                          "Write a picture of the window",
                          "Write a turntable as numbered pictures",
                          "Bake hair in motion (.usdc, .usda, .coifcache)",
                          "Run a Python script",
                          "Take the hair mesh of a .coif document"};
  const std::string title = std::string(titles[int(pathUse_)]) + "###path";
  if (!ImGui::IsPopupOpen(title.c_str())) ImGui::OpenPopup(title.c_str());
  centred(560 * window_.scale());
  if (!ImGui::BeginPopupModal(title.c_str(), nullptr, ImGuiWindowFlags_NoCollapse)) return;
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1);
  // A field of its own each time, all of it selected: one that is known keeps its cursor from the last time.
  ImGui::PushID(pathsAsked_);
  ImGui::InputText("##path", &pathText_, ImGuiInputTextFlags_AutoSelectAll);
  ImGui::PopID();
  const bool enter = window_.keys().pressed("Enter");
  ImGui::BeginChild("entries", {0, 240 * window_.scale()}, true);
  std::error_code error;
  for (const fs::path& entry : entriesBeside(pathText_)) {
    const bool folder = fs::is_directory(entry, error);
    if (ImGui::Selectable((entry.filename().string() + (folder ? "/" : "")).c_str())) {
      pathText_ = folder ? (fs::weakly_canonical(entry, error) / "").string() : entry.string();
    }
  }
  ImGui::EndChild();
  if (pathUse_ == PathUse::Open) {
    const std::string now = options_.style.empty() ? "bare roots" : options_.style;
    ImGui::SetNextItemWidth(160 * window_.scale());
    if (ImGui::BeginCombo("on a head", now.c_str())) {
      if (ImGui::Selectable("bare roots", options_.style.empty())) options_.style.clear();
      for (const std::string_view style : hairstyleNames()) {
        if (ImGui::Selectable(std::string(style).c_str(), options_.style == style)) options_.style = style;
      }
      ImGui::EndCombo();
    }
  }
  if (ImGui::Button("OK", {110 * window_.scale(), 0}) || enter) {
    ImGui::CloseCurrentPopup();
    usePath(pathText_);
  }
  ImGui::SameLine();
  if (ImGui::Button("Cancel", {110 * window_.scale(), 0}) || window_.keys().pressed("Escape")) {
    pathUse_ = PathUse::None;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Studio::drawRecoveryDialog() {
  if (leftBehind_.empty()) return;
  constexpr const char* kTitle = "A document was not saved";
  if (!ImGui::IsPopupOpen(kTitle)) ImGui::OpenPopup(kTitle);
  centred(460 * window_.scale());
  if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_NoResize)) return;
  ImGui::TextWrapped("The last run ended without saving. Its newest copy can be opened again.");
  bool decided = false;
  if (ImGui::Button("Recover") || window_.keys().pressed("Enter")) {
    job_.abandon();  // whatever else was being opened
    recover(leftBehind_.front());
    decided = true;
  }
  ImGui::SameLine();
  if (ImGui::Button("Throw it away")) {
    std::error_code ignored;
    for (const fs::path& path : leftBehind_)
      fs::remove(path, ignored), fs::remove(path.string() + ".json", ignored);
    decided = true;
  }
  ImGui::SameLine();
  decided |= ImGui::Button("Later");
  if (decided) {
    leftBehind_.clear();
    ImGui::CloseCurrentPopup();
    if (!document_ && !job_.busy()) openExample();
  }
  ImGui::EndPopup();
}

void Studio::drawCloseDialog() {
  if (!leaving_) return;
  constexpr const char* kTitle = "Save first?";
  if (!ImGui::IsPopupOpen(kTitle)) ImGui::OpenPopup(kTitle);
  centred(380 * window_.scale());
  if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_NoResize)) return;
  ImGui::TextUnformatted("The document has changes that are not saved.");
  const bool saves = ImGui::Button("Save") || window_.keys().pressed("Enter");
  ImGui::SameLine();
  const bool discards = ImGui::Button("Discard");
  ImGui::SameLine();
  const bool stays = ImGui::Button("Cancel") || window_.keys().pressed("Escape");
  if (saves || discards || stays) {
    ImGui::CloseCurrentPopup();
    const auto then = std::exchange(leaving_, nullptr);
    if (saves && document_->path.empty()) {
      askPath(PathUse::SaveAs);
    } else if (saves) {
      saveTo(document_->path);
      if (!document_->editor.modified()) then();
    } else if (discards) {
      document_->forgetAutosave();
      then();
    }
  }
  ImGui::EndPopup();
}

}  // namespace coif::studio
