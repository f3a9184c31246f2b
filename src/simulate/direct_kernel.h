// A step of chains of rigid links by Newton's method, L chains at a time. Included by kernels.inl only.

template <class T, int L, bool kBend, bool kCurved>
class Direct : StepObjective<T, L, kBend, kCurved> {
  using Objective = StepObjective<T, L, kBend, kCurved>;
  using Base = Lane<T, L>;
  using Base::all, Base::any, Base::load, Base::max, Base::pick, Base::sqrt, Base::store;
  using Objective::b_, Objective::c_, Objective::now_, Objective::safe_, Objective::link, Objective::linear,
      Objective::eliminate, Objective::eliminateSafely, Objective::backSubstitute;
  using Objective::midpoint, Objective::bdf2, Objective::rate, Objective::back, Objective::gravity,
      Objective::prepare, Objective::positions, Objective::keepForces, Objective::fieldWork;
  using Objective::value_, Objective::scale_, Objective::bend_;
  using typename Base::M;
  using typename Base::V;
  using typename Base::V3;
  using Work = NodeWork<T, L>;

 public:
  Direct(Block<T, L>& block, const StepConstants& constants) : Objective(block, constants) {}

  void run() {
    prepare();
    if (linear()) {
      linearStep();
    } else {
      newton();
    }
    finish();
  }

 private:
  void newton() {
    start();
    M active = load(b_.active) > 0;
    V steps = all(0), previous = all(0), lastMove = all(0);
    const V tolerance = all(T(c_.tolerance));
    clearFaults();
    markFaults(~(value_ < all(limit())) & active, LaneFault::NotFinite, active);
    for (int iteration = 0; iteration < c_.maxNewton && any(active); ++iteration) {
      const V decrease = eliminateSafely(active);  // gᵀ H⁻¹ g
      const V size = backSubstitute();
      markFaults(~(decrease < all(limit())) | ~(size < all(limit())), LaneFault::NotFinite, active);
      steps = pick(active, steps + 1, steps);
      // Superlinear: what is left after this step is about size · (size / previous).
      lastMove = pick(active, size, lastMove);
      const M last =
          (size * Base::min(size / previous, all(1)) <= tolerance) | (decrease <= all(noise()) * scale_);
      search(active, decrease);
      previous = size;
      active &= ~last;
    }
    store(b_.newtonSteps, steps), store(b_.lastMove, lastMove);
    markFaults(active, LaneFault::NotConverged, active);
  }

  static constexpr T limit() { return sizeof(T) == 8 ? T(1e300) : T(1e37); }
  static constexpr T noise() { return sizeof(T) == 8 ? T(1e-28) : T(1e-12); }
  // Rounding of φ: a sum over the nodes of what cancels.
  static constexpr T slack() { return sizeof(T) == 8 ? T(1e-10) : T(4e-6); }

  void clearFaults() {
    for (int l = 0; l < L; ++l) b_.fault[l] = LaneFault::None;
  }
  void markFaults(M which, LaneFault fault, M& active) {
    for (int l = 0; l < L; ++l) {
      if (which[l] != 0 && active[l] != 0) b_.fault[l] = fault;
    }
    active &= ~which;
  }

  // From where each link's own angular velocity takes it, if that is lower than staying.
  void start() {
    const V staying = positions(false, all(0));
    bendBefore_ = bend_;
    const T h = T(c_.step) * (midpoint() ? T(0.5) : T(1));
    for (int i = 1; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      const Work& p = b_.work[b_.parents[i]];
      const V3 speed = (load(n.v0) - load(p.v0)) * load(b_.constants[i].perLength);
      store(n.omega, load(n.u0).cross(speed) * all(h));
    }
    value_ = positions(true, all(1));
    const M better = value_ < staying;
    const bool everywhere = !any(~better);
    for (int i = 1; i < b_.nodes && !everywhere; ++i) {
      Work& n = b_.work[i];
      store(n.u[1 - now_], pick(better, load(n.u[1 - now_]), load(n.u[now_])));
      store(n.turned[1 - now_], pick(better, load(n.turned[1 - now_]), load(n.turned[now_])));
    }
    now_ = 1 - now_;
    if (!everywhere) value_ = positions(false, all(0));
    keepForces();
  }

  // Back-tracks each lane on its own; done lanes take a step of nothing.
  void search(M& active, V decrease) {
    constexpr int kHalvings = 30;
    V fraction = pick(active, all(1), all(0));
    V trialValue = value_;
    const V scale = scale_;
    M wait = active;
    for (int k = 0; k < kHalvings; ++k) {
      trialValue = positions(true, fraction);
      const V drop = fieldWork() + value_ - trialValue;
      const V wanted = fraction * decrease * T(1e-4) - scale * slack();
      wait &= ~(drop >= wanted);
      if (midpoint()) wait &= ~wait;  // r changes with the iterate: φ is no measure there
      if (!any(wait)) break;
      fraction = pick(wait, fraction * T(0.5), fraction);
    }
    if (any(wait)) {  // no lower point along the step: stay, it is a minimum to rounding or hopeless
      fraction = pick(wait, all(0), fraction);
      trialValue = positions(true, fraction);
      markFaults(wait & (decrease > scale * slack()), LaneFault::NotConverged, active);
      active &= ~wait;
    }
    const M further = safe_ & active & (fraction >= 1);
    if (any(further) && !midpoint()) trialValue = goFurther(further, fraction);
    accept();
    value_ = trialValue;
  }

  // What was kept above zero makes steps too short (leaving a saddle, they grow by a factor of two): as far
  // as φ falls.
  V goFurther(M further, V fraction) {
    constexpr int kDoublings = 10;
    V lowest = positions(true, fraction) - fieldWork();
    for (int k = 0; k < kDoublings && any(further); ++k) {
      const V longer = pick(further, fraction * 2, fraction);
      const V value = positions(true, longer) - fieldWork();
      further &= value < lowest;
      fraction = pick(further, longer, fraction);
      lowest = pick(further, value, lowest);
    }
    return positions(true, fraction);
  }

  void accept() {
    now_ = 1 - now_;
    store(b_.work[0].moveOld, load(b_.work[0].move));
    keepForces();
  }

  void linearStep() {
    clearFaults();
    M active = load(b_.active) > 0;
    positions(false, all(0));
    keepForces();
    const V decrease = eliminate();
    const V size = backSubstitute();
    markFaults(~(decrease < all(limit())) | ~(size < all(limit())), LaneFault::NotFinite, active);
    positions(true, all(1));
    accept();
    store(b_.newtonSteps, all(1)), store(b_.lastMove, all(0));
  }

  // End-of-step positions by re-accumulating unit links, and velocities.
  void finish() {
    const T h = T(c_.step);
    Work& root = b_.work[0];
    const M isFree = load(b_.freeRoot) > 0;
    V3 move = load(root.move);
    if (midpoint()) move = move * all(2);
    store(root.move, move), Base::storeDouble(root.end, move);
    V3 v = move * all(1 / h);
    if (midpoint()) v = pick(isFree, v * all(2) - load(root.v0), v);
    if (bdf2()) v = pick(isFree, (move - back(root)) * all(rate()), v);
    store(root.v, v);
    for (int i = 1; i < b_.nodes; ++i) finishNode(i);
    if (c_.scheme == Scheme::Euler) keepEnergy();
  }

  void finishNode(int i) {
    const T h = T(c_.step);
    Work& n = b_.work[i];
    const Work& p = b_.work[b_.parents[i]];
    V3 turned = load(n.turned[now_]), move = load(n.move);
    if (midpoint()) {
      turned = (turned - load(link(n)) * (turned.dot(turned) * T(0.5))) * all(2);
      move = move * all(2);
    }
    endLink(n, p, turned, i);
    V3 v = (move - back(n)) * all(rate());
    if (midpoint()) v = v - load(n.v0);
    if (linear())
      v = load(p.v) + load(n.omega).cross(load(n.u0) + turned) * (load(b_.constants[i].length) * (1 / h));
    store(n.v, v);
  }

  // Re-accumulated from unit links; in double whatever T is, so that rounding is of the turn, not of the
  // link.
  void endLink(Work& n, const Work& p, const V3& turned, int i) {
    const T* length = b_.constants[i].length;
    alignas(64) double u[3][L];
    if constexpr (sizeof(T) == 8) {
      store(u, load(n.u0) + turned);
    } else {
      alignas(64) T t[3][L];
      store(t, turned);
      for (int l = 0; l < L; ++l) {
        double d[3], dd = 0;
        for (int k = 0; k < 3; ++k) d[k] = n.start[k][l] - p.start[k][l], dd += d[k] * d[k];
        const double perLength = 1 / std::sqrt(dd);
        for (int k = 0; k < 3; ++k) u[k][l] = d[k] * perLength + double(t[k][l]);
      }
    }
    for (int l = 0; l < L; ++l) {
      double uu = 0;
      for (int k = 0; k < 3; ++k) uu += u[k][l] * u[k][l];
      const double by = double(length[l]) * (sizeof(T) == 8 ? 1.5 - 0.5 * uu : 1 / std::sqrt(uu));
      for (int k = 0; k < 3; ++k) n.end[k][l] = p.end[k][l] + u[k][l] * by;
    }
  }

  // A link in compression, an inverted pendulum's, feeds energy into implicit Euler: the step ends on the far
  // side of the sphere's curvature. φ(end) ≤ φ(start) bounds the potential's rise by the kinetic energy there
  // was (ΔV ≤ Σ m a·v − ½ m a², a the end's velocity, ≤ Σ ½ m v²), so that slowing the chain down as far as
  // its energy rose without work is always possible: energy never rises, whether Newton came to its end or
  // not.
  void keepEnergy() {
    V after = all(0), rise = bend_ - bendBefore_;
    const V3 g = gravity();
    for (int i = b_.anyFree ? 0 : 1; i < b_.nodes; ++i) {
      const Work& n = b_.work[i];
      const V mass = load(b_.constants[i].mass);
      const V3 v = load(n.v), v0 = load(n.v0), move = load(n.move);
      const V kinetic = mass * v.dot(v) * T(0.5);
      after += kinetic;
      rise += mass * ((v - v0).dot(v + v0) * T(0.5) - g.dot(move));
      if (i > 0 && b_.lateral) rise -= load(n.lateral).dot(move - load(b_.work[b_.parents[i]].move));
      if (b_.fields != nullptr) rise -= load(n.force).dot(move);
    }
    const M slow = (rise > 0) & (load(b_.driven) < T(0.5));
    if (!any(slow)) return;
    const V share = pick(slow, sqrt(max(1 - rise / after, all(0))), all(1));
    for (int i = b_.anyFree ? 0 : 1; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      store(n.v, load(n.v) * share);
    }
  }

  V bendBefore_ = all(0);  // of the start of the step
};

template <class T, int L>
void runDirect(Block<T, L>& block, const StepConstants& constants) {
  if (!block.bend) {
    Direct<T, L, false, false>(block, constants).run();
  } else if (!block.curved) {
    Direct<T, L, true, false>(block, constants).run();
  } else {
    Direct<T, L, true, true>(block, constants).run();
  }
}
