#include "motion_player.h"

#include <algorithm>
#include <chrono>

namespace coif::studio {
namespace {

constexpr std::size_t kFrames = 24 * 600;  // of the head's motion; it rests after ten minutes

using Clock = std::chrono::steady_clock;

/// From the pose where the head is at `frame`, into the new way of moving within half a second.
Result<std::vector<RigidPose>> posesFrom(const MotionInput& input, std::size_t frame, const RigidPose& from) {
  COIF_ASSIGN(const auto fresh,
              headPoses(input.head, input.mesh, input.upAxis, kFrames, MotionPlayer::kFramesPerSecond));
  std::vector<RigidPose> poses(frame + 1, from);
  constexpr double kBlendFrames = MotionPlayer::kFramesPerSecond / 2;
  for (std::size_t f = 1; f < fresh.size(); ++f) {
    poses.push_back(between(from, fresh[f], std::min(double(f) / kBlendFrames, 1.0)));
  }
  return poses;
}

bool sameHair(const MotionInput& a, const MotionInput& b) {
  return a.mesh == b.mesh && a.surface == b.surface && a.metersPerUnit == b.metersPerUnit &&
         a.upAxis == b.upAxis;
}

}  // namespace

MotionPlayer::MotionPlayer(std::function<void()> wake)
    : wake_(std::move(wake)), thread_([this] { loop(); }) {}

MotionPlayer::~MotionPlayer() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = cancel_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void MotionPlayer::play(MotionInput input) {
  {
    const std::scoped_lock lock(mutex_);
    wanted_ = std::move(input);
    fresh_ = true;
    state_ = State::Playing;
    preparing_ = true;
    cancel_ = false;
    problem_.clear();
  }
  changed_.notify_all();
}

void MotionPlayer::change(MotionInput input) {
  {
    const std::scoped_lock lock(mutex_);
    if (state_ == State::Off) return;
    wanted_ = std::move(input);
  }
  changed_.notify_all();
}

void MotionPlayer::pause() {
  const std::scoped_lock lock(mutex_);
  if (state_ == State::Playing) state_ = State::Paused;
}

void MotionPlayer::resume() {
  {
    const std::scoped_lock lock(mutex_);
    if (state_ == State::Paused) state_ = State::Playing;
  }
  changed_.notify_all();
}

void MotionPlayer::reset() {
  {
    const std::scoped_lock lock(mutex_);
    state_ = State::Off;
    cancel_ = true;
    preparing_ = false;
    wanted_.reset(), newest_.reset();
  }
  changed_.notify_all();
}

std::optional<MotionFrame> MotionPlayer::take() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(newest_, std::nullopt);
}

std::string MotionPlayer::takeProblem() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(problem_, {});
}

void MotionPlayer::fail(const Error& error) {
  const std::scoped_lock lock(mutex_);
  if (error.code != ErrorCode::Cancelled) problem_ = error.text(), state_ = State::Off;
  simulation_.reset();
}

Status MotionPlayer::prepare(const MotionInput& input, bool fresh) {
  Context context;
  context.cancel = &cancel_;
  const bool goesOn = !fresh && simulation_ && sameHair(input, playing_);
  const std::size_t frame = goesOn ? simulation_->frame() : 0;
  COIF_ASSIGN(auto poses, posesFrom(input, frame, goesOn ? simulation_->pose() : RigidPose{}));
  SimulationWorld world{input.surface.get(), input.metersPerUnit,
                        input.upAxis,        {std::move(poses), {}},
                        kFramesPerSecond,    playing_.surface == input.surface ? band_ : nullptr};
  DynamicsSettings dynamics = input.dynamics;
  dynamics.wisps = 0;  // it is the mesh that is shown
  COIF_ASSIGN(auto made, Simulation::create(input.mesh, dynamics, world, context));
  // Air that one of the two does not have cannot be carried over: then the hair starts at rest.
  if (goesOn) (void)made->restore(simulation_->state());
  simulation_ = std::move(made);
  band_ = simulation_->band();
  playing_ = input;
  return {};
}

Status MotionPlayer::step() {
  Context context;
  context.cancel = &cancel_;
  COIF_TRY(simulation_->advance(context));
  MotionFrame frame{simulation_->frame(), {}, simulation_->pose()};
  const auto now = simulation_->positions();
  for (std::uint32_t v = 0; v < now.size(); ++v) {
    // Roots rest in the head's frame to the bit, so that strands need not grow again.
    const bool root = playing_.mesh.vertices()[v].layer == 0;
    frame.positions.push_back(root ? playing_.mesh.position(v) : frame.pose.local(now[v]));
  }
  const std::scoped_lock lock(mutex_);
  if (state_ != State::Off) newest_ = std::move(frame);
  return {};
}

void MotionPlayer::loop() {
  Clock::time_point due = Clock::now();
  while (true) {
    std::optional<MotionInput> input;
    bool fresh = false;
    {
      std::unique_lock lock(mutex_);
      if (state_ == State::Off) simulation_.reset();
      changed_.wait(lock, [&] { return stop_ || wanted_ || state_ == State::Playing; });
      if (stop_) return;
      input = std::exchange(wanted_, std::nullopt);
      if (input) fresh = std::exchange(fresh_, false);
    }
    if (input) {
      const Status ready = prepare(*input, fresh);
      preparing_ = false;
      if (!ready.ok()) fail(ready.error());
      due = Clock::now();
    }
    if (simulation_ && state_ == State::Playing) {
      if (const Status done = step(); !done.ok()) fail(done.error());
    }
    wake_();
    // In real time where the machine keeps up, as fast as it can where not.
    due = std::max(due + std::chrono::duration_cast<Clock::duration>(
                             std::chrono::duration<double>(1 / kFramesPerSecond)),
                   Clock::now() - std::chrono::milliseconds(100));
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, due, [&] { return stop_ || wanted_ || state_ == State::Off; });
  }
}

}  // namespace coif::studio
