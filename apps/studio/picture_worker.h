// Pictures of the document in the background: the window never waits for strands or for light.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "coif/preview/session.h"
#include "coif/scene/evaluate.h"
#include "trace.h"

namespace coif::studio {

struct PictureRequest {
  std::shared_ptr<const Scene> scene;  ///< with its internal vertices placed
  std::vector<Vec3> moved;             ///< where its vertices are now; empty: where they are in the scene
  std::uint64_t revision = 0;          ///< of the scene and where it is: the same need not be looked at again
  Camera camera;
  Lights lights;
  PreviewOptions options;
  bool strands = true, head = true;
  bool draft = false;  ///< made to its end, so that something is seen while the mouse moves on
  LoadedHead loaded;   ///< the head
};

struct PictureAnswer {
  Image image;
  Camera camera;
  std::string problem;  ///< a sentence; empty when the picture was made
  std::vector<StageReport> stages;
  double seconds = 0;
  std::size_t strandsDrawn = 0;
};

class PictureWorker {
 public:
  /// `ready` is called from the worker's thread after each answer.
  PictureWorker(std::function<void()> ready, Trace& trace);
  ~PictureWorker();

  /// Replaces a request that was not begun; a fine one that runs is cancelled.
  void ask(PictureRequest request);
  /// The newest answer since the last call.
  std::optional<PictureAnswer> take();
  bool busy() const { return busy_; }
  /// All that was on the GPU is gone: the next picture begins with nothing.
  void loseContext() { lost_ = true; }

 private:
  void loop();
  PictureAnswer answer(const PictureRequest& request);
  Status openPreview();
  void forgetPreview();
  Status show(const PictureRequest& request, PictureAnswer& out);
  void adaptDrafts(double seconds);
  Status updateHair(const PictureRequest& request, const Context& context);
  Status growHair(const PictureRequest& request, std::uint64_t topology, const Context& context);

  std::function<void()> ready_;
  Trace& trace_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<PictureRequest> wanted_;
  std::optional<PictureAnswer> done_;
  std::atomic<bool> stop_{false}, cancel_{false}, busy_{false}, lost_{false};
  bool draftRuns_ = false;

  // The worker's own; only its thread touches them.
  std::optional<Preview> preview_;
  std::unique_ptr<PreviewSession> session_;
  Evaluation evaluation_, drafts_;  ///< of all strands, and of the few that a draft shows
  /// The strands on the GPU: which, how styled, and on which mesh that was planned.
  struct Shown {
    std::uint64_t topology = 0, planned = 0;
    StyleStack styles;
    bool whole = true;  ///< all of them
  };
  std::optional<Shown> shown_;
  std::shared_ptr<const Surface> shownHead_;
  std::size_t draftSegments_ = 15000;  // follows the machine
  bool anythingShown_ = false;
  bool headShown_ = false;
  std::uint64_t shownRevision_ = 0;

  std::thread thread_;
};

}  // namespace coif::studio
