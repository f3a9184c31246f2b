// A turntable as numbered pictures: the picture's own thread makes them one by one while the window goes on.
#include <cmath>
#include <cstdio>

#include "coif/io/safe_file.h"
#include "studio.h"

namespace coif::studio {
namespace {

constexpr int kFrames = 48;

/// "hair.png" → "hair-0007.png".
std::filesystem::path numbered(const std::filesystem::path& path, int number) {
  char text[16];
  std::snprintf(text, sizeof text, "-%04d", number);
  return path.parent_path() / (path.stem().string() + text + path.extension().string());
}

}  // namespace

void Studio::beginTurntable(const std::filesystem::path& path) {
  if (!document_) return;
  turntable_ = TurntableRecord{path, 0, view_.camera};
  askTurntableFrame();
}

void Studio::askTurntableFrame() {
  const TurntableRecord& record = *turntable_;
  PictureRequest request = pictureRequest(true);
  request.camera = orbit(record.start, view_.upAxis, 360.0 * record.frame / kFrames, 0);
  request.options.transparentBackground = false;
  pictures_->ask(std::move(request));
}

void Studio::takeTurntableFrame(const PictureAnswer& answer) {
  TurntableRecord& record = *turntable_;
  const Camera wanted = orbit(record.start, view_.upAxis, 360.0 * record.frame / kFrames, 0);
  if (!answer.camera.eye.isApprox(wanted.eye, 1e-12)) return;  // one that was asked for before
  const auto fail = [&](const std::string& why) {
    turntable_.reset();
    say("turntable: " + why, true);
  };
  if (!answer.problem.empty()) return fail(answer.problem);
  const auto png = encodePng(answer.image);
  if (!png.ok()) return fail(png.error().text());
  auto file = SafeFile::create(numbered(record.path, record.frame + 1));
  if (!file.ok()) return fail(file.error().text());
  file->write(*png);
  if (const Status written = file->commit(); !written.ok()) return fail(written.error().text());
  if (++record.frame == kFrames) {
    say("wrote " + std::to_string(kFrames) + " pictures beside " + record.path.string());
    turntable_.reset();
    askedKey_ = 0;  // the view's own picture again
    return;
  }
  say("turntable: " + std::to_string(record.frame) + " of " + std::to_string(kFrames) + " (Esc stops it)");
  askTurntableFrame();
}

}  // namespace coif::studio
