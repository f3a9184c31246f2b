// The memory a lane kernel works on: plain arrays of L chains side by side, one record a node.
//
// No vectors and no inline functions of other libraries here: the kernels are compiled once for each
// instruction set, and what they share with the rest must not be.
#pragma once

#include <cstddef>
#include <cstdint>

namespace coif::lanes {

enum class Scheme : std::int32_t { Euler, Bdf2, Midpoint, ArticulatedExplicit, ArticulatedImplicit };

/// What a step is made of, the same for every chain.
struct StepConstants {
  Scheme scheme = Scheme::Euler;
  double step = 0;
  double gravity[3] = {0, 0, 0};
  int maxNewton = 20;
  double tolerance = 0;  ///< a length
  int iterations = 20;   ///< of the projecting solvers
};

/// Does not change from step to step.
template <class T, int L>
struct alignas(64) NodeConstants {
  T length[L], perLength[L], mass[L], kappa[L], drag[L];  ///< perLength: its inverse
  T rest[3][L];                                           ///< the link's rest direction in the parent's frame
};

/// One step's data and working space. Places are relative to where the root was at the step's start.
template <class T, int L>
struct alignas(64) NodeWork {
  // In: the state before; back: from here to the step before; `lateral` is Σ k (d_neighbour − rest). A
  // prescribed root's goal is in x.
  double start[3][L];
  T v0[3][L], back[3][L], vBack[3][L], lateral[3][L];
  // Out; of the direct solver also how far it moved.
  double end[3][L];
  T v[3][L], move[3][L];
  // Of the projecting solvers.
  T x0[3][L], x[3][L];
  // The link: u0 at the start; its iterate and the trial in turns, u = u0 + turned. y counts from the start.
  T u0[3][L], u[2][3][L], turned[2][3][L];
  T y[3][L], w[L], r[L], perR[L], kappa[L];
  T moveOld[3][L], force[3][L], forceOld[3][L], stiffness[6][L];  // stiffness: xx xy xz yy yz zz
  T target[3][L], normal[3][L], binormal[3][L];                   // of the joint; of the link's frame
  T axis1[3][L], axis2[3][L];  // what the joint's two coordinates turn about
  T gainX1[3][L], gainX2[3][L], gainW1[3][L], gainW2[3][L], gain[2][L];
  T anchorTurned[3][L],
      anchorStep[3][L];     // where a lane that dared an uphill step can go back to, and its step
  T omega[3][L], dx[3][L];  // the Newton step: rotation of the link, displacement of the node
};

/// A subtree's quadratic model in the displacement and rotation at its base, kept where branches meet.
template <class T, int L>
struct alignas(64) Stash {
  T p[6][L], q[9][L], s[6][L], force[3][L], torque[3][L], sum[3][L];
};

enum class LaneFault : std::uint8_t { None, NotFinite, NotConverged };

template <class T, int L>
struct Block {
  std::int32_t nodes = 0;
  const std::int32_t* parents = nullptr;  ///< −1 for the root
  const std::int32_t* slots = nullptr;    ///< stash of a node with several children, or −1
  const NodeConstants<T, L>* constants = nullptr;
  NodeWork<T, L>* work = nullptr;
  Stash<T, L>* stashes = nullptr;
  bool bend = false, curved = false, anyFree = false, lateral = false;
  alignas(64) T rootAxes[9][L];   ///< columns of the root frame for this step: normal, binormal, z
  T active[L], freeRoot[L];       ///< 1 or 0
  T driven[L];                    ///< 1: the root is moved or turned in this step and does work
  T newtonSteps[L], lastMove[L];  ///< out; lastMove: of any node in the last Newton step
  LaneFault fault[L];             ///< out
  /// Writes force and stiffness for every node at start + move with work.v; null without fields.
  void (*fields)(void* context) = nullptr;
  void* context = nullptr;
};

template <class T, int L>
using Kernel = void (*)(Block<T, L>&, const StepConstants&);

constexpr int kDoubleLanes = 8, kFloatLanes = 16;

/// The kernels of one instruction set.
struct Kernels {
  Kernel<double, kDoubleLanes> direct, overveld, xpbd;
  Kernel<float, kFloatLanes> directFloat, overveldFloat, xpbdFloat;
  const char* name;
};
/// The widest that this processor runs; the same bytes whichever it is.
const Kernels& bestKernels();

}  // namespace coif::lanes
