// The document's hair in motion, played in its own time by a thread of its own.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "coif/scene/head_motion.h"
#include "coif/simulate/simulation.h"

namespace coif::studio {

/// What is played: a change of mesh, head or units starts anew; other changes go on from where the hair is.
struct MotionInput {
  HairMesh mesh;  ///< as modelled
  DynamicsSettings dynamics;
  HeadMoveSettings head;
  std::shared_ptr<const Surface> surface;  ///< null: no head
  double metersPerUnit = 0.01;
  UpAxis upAxis = UpAxis::Y;
};

struct MotionFrame {
  std::size_t frame = 0;
  std::vector<Vec3> positions;  ///< of the mesh's vertices, in the head's own frame
  RigidPose pose;               ///< of the head
};

class MotionPlayer {
 public:
  static constexpr double kFramesPerSecond = 24;

  /// `wake` is called from the player's thread when there is a new frame or a problem.
  explicit MotionPlayer(std::function<void()> wake);
  ~MotionPlayer();

  void play(MotionInput input);
  void change(MotionInput input);  ///< while there is something to change; else as nothing
  void pause();
  void resume();
  void reset();  ///< stops and forgets

  bool running() const { return state_ == State::Playing; }
  bool active() const { return state_ != State::Off; }  ///< playing or paused
  bool preparing() const { return preparing_; }
  /// The newest frame since the last call.
  std::optional<MotionFrame> take();
  std::string takeProblem();  ///< a sentence; empty: none

 private:
  enum class State { Off, Playing, Paused };
  void loop();
  Status prepare(const MotionInput& input, bool fresh);
  Status step();
  void fail(const Error& error);

  std::function<void()> wake_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<MotionInput> wanted_;
  bool fresh_ = true;  // what is wanted starts at rest
  std::optional<MotionFrame> newest_;
  std::string problem_;
  std::atomic<State> state_{State::Off};
  std::atomic<bool> stop_{false}, cancel_{false}, preparing_{false};

  // The thread's own.
  std::unique_ptr<Simulation> simulation_;
  MotionInput playing_;
  std::shared_ptr<const DistanceBand> band_;  // of its head

  std::thread thread_;
};

}  // namespace coif::studio
