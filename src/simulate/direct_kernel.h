// Newton's method for chains of rigid links, L of them at a time. Included by kernels.inl only.
//
// Unknowns are two rotations a joint, so lengths hold exactly. The step's objective is
//   φ = Σ ½ w |x − y|² + Σ ½ κ |u − t|² − lateral and field work,
// and the quadratic model of a subtree, in the displacement dx and rotation ω at its base,
//   ½ dxᵀP dx + dxᵀQ ω + ½ ωᵀS ω + p·dx + s·ω,
// is passed from tip to root, two coordinates leaving it at each joint (docs/simulate.md, "the direct
// solver").

template <class T, int L, bool kBend, bool kCurved>
class Direct : Lane<T, L> {
  using Base = Lane<T, L>;
  using Base::all, Base::any, Base::basis, Base::load, Base::loadSym, Base::max, Base::pick, Base::sqrt,
      Base::store, Base::storeSym, Base::turn, Base::unit;
  using typename Base::M;
  using typename Base::Mat;
  using typename Base::Sym;
  using typename Base::V;
  using typename Base::V3;
  using Work = NodeWork<T, L>;

  struct Model {
    Sym p;
    Mat q;  // rows: dx, columns: ω
    Sym s;
    V3 force, torque, sum;  // sum: Σ of the subtree's gradients, for the tension
  };

 public:
  Direct(Block<T, L>& block, const StepConstants& constants) : b_(block), c_(constants) {}

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
  bool linear() const {
    return c_.scheme == Scheme::ArticulatedExplicit || c_.scheme == Scheme::ArticulatedImplicit;
  }
  bool midpoint() const { return c_.scheme == Scheme::Midpoint; }

  // Rates at which a trial position becomes a velocity: v = rate (x − back).
  T rate() const {
    const T h = T(c_.step);
    return c_.scheme == Scheme::Bdf2 ? T(1.5) / h : midpoint() ? 2 / h : 1 / h;
  }
  V3 back(const Work& n) const {
    const V3 x0 = load(n.x0);
    return c_.scheme == Scheme::Bdf2 ? (x0 * all(4) - load(n.xp)) * all(T(1) / 3) : x0;
  }
  V3 gravity() const { return {all(T(c_.gravity[0])), all(T(c_.gravity[1])), all(T(c_.gravity[2]))}; }

  // w and y: inertia, gravity and drag are one quadratic about y.
  void prepare() {
    const T h = T(c_.step);
    const T k = rate() * rate();
    const bool bdf = c_.scheme == Scheme::Bdf2;
    for (int i = 0; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      const NodeConstants<T, L>& fixed = b_.constants[i];
      const V3 x0 = load(n.x0), v0 = load(n.v0), from = back(n);
      const V3 v = bdf ? (v0 * all(4) - load(n.vp)) * all(T(1) / 3) : v0;
      V3 y = from + v * all(1 / rate()) + gravity() * all(1 / k);
      if (linear()) y = y - centripetal(i) * all(h * h);
      const V mass = load(fixed.mass), inertia = mass * k, drag = load(fixed.drag) * mass * rate();
      const V w = inertia + drag;
      store(n.w, w);
      store(n.y, (y * inertia + from * drag) * (1 / w));
      if (i > 0) {
        const V3 link = x0 - load(b_.work[b_.parents[i]].x0);
        const V3 u = unit(link);
        store(n.u0, u), store(n.u, u);
        store(n.r, load(fixed.length)), store(n.kappa, load(fixed.kappa));
      }
    }
    placeRoot();
  }

  // Acceleration of the node when every link keeps its angular velocity; kept in gainX1 until the solve.
  V3 centripetal(int i) {
    Work& n = b_.work[i];
    V3 sum = {all(0), all(0), all(0)};
    if (i > 0) {
      const Work& p = b_.work[b_.parents[i]];
      const V3 link = load(n.x0) - load(p.x0), speed = load(n.v0) - load(p.v0);
      sum = load(p.gainX1) - link * (speed.dot(speed) / link.dot(link));
    }
    store(n.gainX1, sum);
    return sum;
  }

  // A free root starts where its momentum takes it; a prescribed one is where it has to be (at the middle of
  // the step for the midpoint scheme).
  void placeRoot() {
    Work& n = b_.work[0];
    const M isFree = load(b_.freeRoot) > 0;
    V3 goal = load(n.x);
    if (midpoint()) goal = (goal + load(n.x0)) * all(T(0.5));
    const V3 x = pick(isFree, load(n.y), goal);
    store(n.xOld, x);
    store(n.x, x);
    store(n.dx, V3{all(0), all(0), all(0)});
    store(n.omega, V3{all(0), all(0), all(0)});
    const V3 axes[3] = {load(&b_.rootAxes[0]), load(&b_.rootAxes[3]), load(&b_.rootAxes[6])};
    store(n.normal, axes[0]), store(n.binormal, axes[1]), store(n.u, axes[2]), store(n.trial, axes[2]);
  }

  void newton() {
    V value = positions(false, all(0)), scale = scale_;
    value = betterOf(value, scale);
    M active = load(b_.active) > 0;
    V steps = all(0), previous = all(0);
    const V tolerance = all(T(c_.tolerance));
    clearFaults();
    markFaults(~(value < all(limit())) & active, LaneFault::NotFinite, active);
    for (int iteration = 0; iteration < c_.maxNewton && any(active); ++iteration) {
      const V decrease = eliminateSafely(active);  // gᵀ H⁻¹ g
      const V size = backSubstitute();
      markFaults(~(decrease < all(limit())) | ~(size < all(limit())), LaneFault::NotFinite, active);
      steps = pick(active, steps + 1, steps);
      // Superlinear: what is left after this step is about size · (size / previous).
      const M last =
          (size * Base::min(size / previous, all(1)) <= tolerance) | (decrease <= all(noise()) * scale);
      value = search(active, value, decrease, scale);
      previous = size;
      active &= ~last;
    }
    store(b_.newtonSteps, steps);
    markFaults(active, LaneFault::NotConverged, active);
  }

  static constexpr T limit() { return sizeof(T) == 8 ? T(1e300) : T(1e37); }
  static constexpr T noise() { return sizeof(T) == 8 ? T(1e-28) : T(1e-12); }
  static constexpr T slack() { return sizeof(T) == 8 ? T(1e-10) : T(1e-4); }

  void clearFaults() {
    for (int l = 0; l < L; ++l) b_.fault[l] = LaneFault::None;
  }
  void markFaults(M which, LaneFault fault, M& active) {
    for (int l = 0; l < L; ++l) {
      if (which[l] != 0 && active[l] != 0) b_.fault[l] = fault;
    }
    active &= ~which;
  }

  // Starts from where each link's own angular velocity takes it, if that is lower than staying.
  V betterOf(V staying, V& scale) {
    const T h = T(c_.step) * (midpoint() ? T(0.5) : T(1));
    for (int i = 1; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      const Work& p = b_.work[b_.parents[i]];
      const V3 speed = (load(n.v0) - load(p.v0)) * (1 / load(b_.constants[i].length));
      store(n.omega, load(n.u0).cross(speed) * all(h));
    }
    const V value = positions(true, all(1));
    const M better = value < staying;
    for (int i = 1; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      store(n.u, pick(better, load(n.trial), load(n.u)));
    }
    const V chosen = positions(false, all(0));
    scale = scale_;
    keepForces();
    return chosen;
  }

  // Positions, frames and φ of the iterate, or of the trial at a fraction of the Newton step; field forces
  // too.
  V positions(bool trial, V fraction) {
    V value = all(0), size = all(0);
    Work& root = b_.work[0];
    if (trial) store(root.x, load(root.xOld) + load(root.dx) * fraction);
    if (b_.anyFree) value += rootValue(root);
    for (int i = 1; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      const Work& p = b_.work[b_.parents[i]];
      const V3 u = trial ? turn(load(n.u), load(n.omega) * fraction) : load(n.u);
      if (trial) store(n.trial, u);
      V r = load(n.r);
      if (midpoint()) r = midLength(i, u);
      const V3 x = load(p.x) + u * r;
      store(n.x, x);
      const V3 e = x - load(n.y);
      value += load(n.w) * e.dot(e) * T(0.5);
      const V pull = (u * r).dot(load(n.lateral));
      value -= pull, size += pull + Base::abs(pull);
      if (kBend) value += joint(n, p, b_.constants[i], u, trial ? load(p.trial) : load(p.u));
    }
    scale_ = value + size;
    if (b_.fields != nullptr) callFields();
    return value;
  }

  V rootValue(const Work& n) const {
    const V3 e = load(n.x) - load(n.y);
    return pick(load(b_.freeRoot) > 0, load(n.w) * e.dot(e) * T(0.5), all(0));
  }

  // With the ends of length ℓ, half their sum is as long as it is along the start: Thales.
  V midLength(int i, const V3& u) {
    Work& n = b_.work[i];
    const NodeConstants<T, L>& fixed = b_.constants[i];
    const V share = max(u.dot(load(n.u0)), all(T(1e-3)));
    const V r = load(fixed.length) * share;
    store(n.r, r);
    if (kBend) {
      const int p = b_.parents[i];
      const V other = p > 0 ? load(b_.work[p].r) / load(b_.constants[p].length) : all(1);
      store(n.kappa, load(fixed.kappa) * share * other);
    }
    return r;
  }

  V joint(Work& n, const Work& p, const NodeConstants<T, L>& fixed, const V3& u, const V3& base) {
    V3 target = base;
    if (kCurved) {
      const V3 normal = load(p.normal), binormal = load(p.binormal), rest = load(fixed.rest);
      target = normal * rest.x + binormal * rest.y + base * rest.z;
      const V3 both = base + u;
      const V turnBy = 1 / max(1 + base.dot(u), all(T(1e-6)));
      store(n.normal, normal - both * (u.dot(normal) * turnBy));
      store(n.binormal, binormal - both * (u.dot(binormal) * turnBy));
    } else if (&p == b_.work) {
      const V3 rest = load(fixed.rest);
      target = load(p.normal) * rest.x + load(p.binormal) * rest.y + base * rest.z;
    }
    store(n.target, target);
    const V3 off = u - target;
    return load(n.kappa) * off.dot(off) * T(0.5);
  }

  void callFields() {
    for (int i = 0; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      store(n.v, (load(n.x) - back(n)) * all(rate()));
    }
    b_.fields(b_.context);
  }
  void keepForces() {
    if (b_.fields == nullptr) return;
    for (int i = 0; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      store(n.forceOld, load(n.force)), store(n.xOld, load(n.x));
    }
  }
  // Work of the fields from the iterate to the trial, by the trapezoidal rule.
  V fieldWork() const {
    V work = all(0);
    if (b_.fields == nullptr) return work;
    for (int i = 0; i < b_.nodes; ++i) {
      const Work& n = b_.work[i];
      work += (load(n.force) + load(n.forceOld)).dot(load(n.x) - load(n.xOld)) * T(0.5);
    }
    return work;
  }

  // Back-tracks each lane on its own; done lanes take a step of nothing.
  V search(M& active, V value, V decrease, V& scale) {
    constexpr int kHalvings = 30;
    V fraction = pick(active, all(1), all(0));
    V trialValue = value;
    M wait = active;
    for (int k = 0; k < kHalvings; ++k) {
      trialValue = positions(true, fraction);
      const V drop = fieldWork() + value - trialValue;
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
    accept();
    scale = scale_;
    return trialValue;
  }

  void accept() {
    for (int i = 1; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      store(n.u, load(n.trial));
    }
    store(b_.work[0].xOld, load(b_.work[0].x));
    keepForces();
  }

  Model ownModel(int i) const {
    const Work& n = b_.work[i];
    const V w = load(n.w), zero = all(0);
    const V3 none = {zero, zero, zero};
    Model m{{w, zero, zero, w, zero, w},
            {none, none, none},
            {zero, zero, zero, zero, zero, zero},
            (load(n.x) - load(n.y)) * w,
            none,
            none};
    if (b_.fields != nullptr) {
      m.p = m.p + loadSym(n.stiffness);
      m.force = m.force - load(n.force);
    }
    m.sum = m.force;
    return m;
  }

  // With the exact Hessian where it is positive definite, else with its positive part: λ and cos θ held above
  // zero, what has no sign left out. A lane that needed this gets it the next time too, then tries again.
  V eliminateSafely(M active) {
    const M before = safe_;
    V decrease = eliminate();
    const M failed = ~positive_ & active & ~safe_;
    if (any(failed)) {
      safe_ |= failed;
      decrease = eliminate();
    }
    safe_ &= ~before;
    return decrease;
  }

  // From tip to root. Returns gᵀH⁻¹g, twice the decrease that the quadratic model promises.
  V eliminate() {
    V decrease = all(0);
    positive_ = all(0) == all(0);
    Model carried{};
    bool carrying = false;
    for (int i = b_.nodes - 1; i >= 0; --i) {
      Model m = ownModel(i);
      if (carrying) add(m, carried);
      if (b_.slots[i] >= 0) addStash(m, b_.stashes[b_.slots[i]]);
      if (i == 0) {
        decrease += solveRoot(m);
        break;
      }
      decrease += kBend ? leaveBending(i, m) : leaveFree(i, m);
      const int p = b_.parents[i];
      carrying = p == i - 1;
      if (carrying) {
        carried = m;
      } else {
        addToStash(b_.stashes[b_.slots[p]], m, isLastChild(i, p));
      }
    }
    return decrease;
  }

  // Nodes come from the back: the first to write is the last child.
  bool isLastChild(int i, int p) const {
    for (int k = i + 1; k < b_.nodes && b_.parents[k] >= p; ++k) {
      if (b_.parents[k] == p) return false;
    }
    return true;
  }

  static void add(Model& a, const Model& b) {
    a.p = a.p + b.p, a.force = a.force + b.force, a.sum = a.sum + b.sum;
    if (kBend) a.q = a.q + b.q, a.s = a.s + b.s, a.torque = a.torque + b.torque;
  }
  static Model unpack(const Stash<T, L>& s) {
    return {loadSym(s.p),   {load(&s.q[0]), load(&s.q[3]), load(&s.q[6])},
            loadSym(s.s),   load(s.force),
            load(s.torque), load(s.sum)};
  }
  static void addStash(Model& m, const Stash<T, L>& s) { add(m, unpack(s)); }
  static void addToStash(Stash<T, L>& s, Model m, bool first) {
    if (!first) add(m, unpack(s));
    storeSym(s.p, m.p), store(&s.q[0], m.q.a), store(&s.q[3], m.q.b), store(&s.q[6], m.q.c);
    storeSym(s.s, m.s), store(s.force, m.force), store(s.torque, m.torque), store(s.sum, m.sum);
  }

  // u·(the pull of everything beyond), positive in tension: what stiffens turns across the link.
  V tension(const V3& u, const V3& gradient) const {
    if (linear()) return all(0);
    const V lambda = -u.dot(gradient);
    return pick(safe_, max(lambda, all(0)), lambda);
  }

  struct Inverse {
    V a, b, c;
  };
  // Notes lanes whose matrix is not positive there.
  Inverse inverse(V a, V b, V c) {
    const V det = a * c - b * b;
    positive_ &= (a > 0) & (det > a * c * tiny());
    const V d = 1 / det;
    return {c * d, -b * d, a * d};
  }
  static constexpr T tiny() { return sizeof(T) == 8 ? T(1e-15) : T(1e-7); }

  // Without joint springs only the displacement is passed on.
  V leaveFree(int i, Model& m) {
    Work& n = b_.work[i];
    const V3 u = load(n.u), lateral = load(n.lateral);
    V3 e1, e2;
    basis(u, e1, e2);
    const V3 f1 = m.p.times(e1), f2 = m.p.times(e2);
    const V geometric = tension(u, m.sum - lateral) / load(n.r);
    const Inverse k = inverse(e1.dot(f1) + geometric, e1.dot(f2), e2.dot(f2) + geometric);
    const V3 gradient = m.force - lateral;
    const V g1 = e1.dot(gradient), g2 = e2.dot(gradient);
    const V a1 = k.a * g1 + k.b * g2, a2 = k.b * g1 + k.c * g2;
    const V3 x1 = f1 * k.a + f2 * k.b, x2 = f1 * k.b + f2 * k.c;
    m.p.subtract(x1, f1), m.p.subtract(x2, f2);
    m.force = m.force - f1 * a1 - f2 * a2;
    store(n.axis1, e1), store(n.axis2, e2), store(n.gainX1, x1), store(n.gainX2, x2);
    store(n.gain[0], a1), store(n.gain[1], a2);
    return g1 * a1 + g2 * a2;
  }

  V leaveBending(int i, Model& m) {
    Work& n = b_.work[i];
    const V3 u = load(n.u), lateral = load(n.lateral);
    const V r = load(n.r), kappa = load(n.kappa);
    const V3 d = u * r;
    shift(m, d);
    const V3 pull = m.force - lateral;
    m.torque = m.torque + d.cross(pull);
    const V3 gradient = m.sum - lateral;
    stiffen(m.s, u, tension(u, gradient) * r, gradient - u * u.dot(gradient), r);
    V3 e1, e2;
    basis(u, e1, e2);
    const V3 target = load(n.target);
    const V3 moment = u.cross(target) * kappa;
    const V g1 = -e1.dot(moment), g2 = -e2.dot(moment);
    // Turning the base about this link before or after the joint bends differs by a commutator.
    const V swap = linear() ? all(0) : pick(safe_, all(0), kappa * T(0.5));
    const V s1 = e1.dot(target) * swap, s2 = e2.dot(target) * swap;
    if (kCurved) addSpin(i, u, e1, e2);
    return leave(n, m, u, e1, e2, g1, g2, s1, s2, jointStiffness(n, u, kappa));
  }

  // Second derivative of the link's end under a rotation, times what pulls there:
  // λ r |ω across u|² + r (ω·u)(ω·across), `across` the gradient's part across u.
  void stiffen(Sym& s, const V3& u, V lift, V3 across, V r) const {
    s.addDiagonal(lift);
    s.subtract(u * lift, u);
    if (linear()) return;
    const V3 half = across * pick(safe_, all(0), r * T(0.5));
    s.xx += 2 * u.x * half.x, s.yy += 2 * u.y * half.y, s.zz += 2 * u.z * half.z;
    s.xy += u.x * half.y + u.y * half.x, s.xz += u.x * half.z + u.z * half.x;
    s.yz += u.y * half.z + u.z * half.y;
  }

  // The curvature of κ(1 − cos θ); what is safe is κ where that is not convex enough.
  V jointStiffness(const Work& n, const V3& u, V kappa) const {
    if (c_.scheme == Scheme::ArticulatedExplicit) return all(0);
    if (c_.scheme == Scheme::ArticulatedImplicit) return kappa;
    const V c = u.dot(load(n.target));
    return kappa * pick(safe_ & ~(c > T(0.5)), all(1), c);
  }

  // To the base of the link: dx at its end is dx + ω × d.
  static void shift(Model& m, const V3& d) {
    const Sym& p = m.p;
    // P D with D ω = ω × d: row r of P D is d × (row r of P).
    const Mat pd = {d.cross({p.xx, p.xy, p.xz}), d.cross({p.xy, p.yy, p.yz}), d.cross({p.xz, p.yz, p.zz})};
    // S + DᵀQ + QᵀD + DᵀPD, column by column of Dᵀ(Q + PD) and Dᵀ Q.
    const Mat q = m.q + pd;
    const V3 q1 = {q.a.x, q.b.x, q.c.x}, q2 = {q.a.y, q.b.y, q.c.y}, q3 = {q.a.z, q.b.z, q.c.z};
    const V3 t1 = d.cross(q1), t2 = d.cross(q2), t3 = d.cross(q3);  // columns of Dᵀ(Q + PD)
    const V3 o1 = d.cross({m.q.a.x, m.q.b.x, m.q.c.x}), o2 = d.cross({m.q.a.y, m.q.b.y, m.q.c.y}),
             o3 = d.cross({m.q.a.z, m.q.b.z, m.q.c.z});  // columns of DᵀQ; QᵀD is its transpose
    m.s.xx += t1.x + o1.x, m.s.xy += t2.x + o1.y, m.s.xz += t3.x + o1.z;
    m.s.yy += t2.y + o2.y, m.s.yz += t3.y + o2.z, m.s.zz += t3.z + o3.z;
    m.q = q;
  }

  // Parallel transport from the parent's link spins the frame by −(u_p × u)·v / (1 + u_p·u) as u moves by v.
  void addSpin(int i, const V3& u, V3& e1, V3& e2) const {
    const V3 base = load(b_.work[b_.parents[i]].u);
    const V by = 1 / max(1 + base.dot(u), all(T(1e-6)));
    e1 = e1 - u * (base.dot(e1) * by);
    e2 = e2 - u * (base.dot(e2) * by);
  }

  V leave(Work& n, Model& m, const V3& u, const V3& e1, const V3& e2, V g1, V g2, V s1, V s2, V kappa) {
    const V3 x1 = m.q.times(e1), x2 = m.q.times(e2), t1 = m.s.times(e1), t2 = m.s.times(e2);
    const V3 w1 = t1 + u * s1, w2 = t2 + u * s2;
    const Inverse k = inverse(e1.dot(t1) + kappa, e1.dot(t2), e2.dot(t2) + kappa);
    g1 += e1.dot(m.torque), g2 += e2.dot(m.torque);
    const V a1 = k.a * g1 + k.b * g2, a2 = k.b * g1 + k.c * g2;
    const V3 kx1 = x1 * k.a + x2 * k.b, kx2 = x1 * k.b + x2 * k.c;
    const V3 kw1 = w1 * k.a + w2 * k.b, kw2 = w1 * k.b + w2 * k.c;
    m.p.subtract(kx1, x1), m.p.subtract(kx2, x2);
    m.q.subtract(kx1, w1), m.q.subtract(kx2, w2);
    m.s.subtract(kw1, w1), m.s.subtract(kw2, w2);
    m.force = m.force - x1 * a1 - x2 * a2;
    m.torque = m.torque - w1 * a1 - w2 * a2;
    store(n.axis1, e1), store(n.axis2, e2);
    store(n.gainX1, kx1), store(n.gainX2, kx2), store(n.gainW1, kw1), store(n.gainW2, kw2);
    store(n.gain[0], a1), store(n.gain[1], a2);
    return g1 * a1 + g2 * a2;
  }

  V solveRoot(const Model& m) {
    Work& n = b_.work[0];
    if (!b_.anyFree) return all(0);
    const Sym& p = m.p;
    const V3 c1 = {p.yy * p.zz - p.yz * p.yz, p.xz * p.yz - p.xy * p.zz, p.xy * p.yz - p.xz * p.yy};
    const V over = 1 / (p.xx * c1.x + p.xy * c1.y + p.xz * c1.z);
    const V3 c2 = {c1.y, p.xx * p.zz - p.xz * p.xz, p.xy * p.xz - p.xx * p.yz};
    const V3 c3 = {c1.z, c2.z, p.xx * p.yy - p.xy * p.xy};
    const V3 step = V3{c1.dot(m.force), c2.dot(m.force), c3.dot(m.force)} * over;
    const M isFree = load(b_.freeRoot) > 0;
    const V3 none = {all(0), all(0), all(0)};
    store(n.dx, pick(isFree, none - step, none));
    return pick(isFree, step.dot(m.force), all(0));
  }

  // From root to tip. Returns the largest displacement of a node.
  V backSubstitute() {
    V most = load(b_.work[0].dx).dot(load(b_.work[0].dx));
    for (int i = 1; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      const Work& p = b_.work[b_.parents[i]];
      const V3 dx = load(p.dx), w = load(p.omega);
      V a1 = load(n.gain[0]) + load(n.gainX1).dot(dx), a2 = load(n.gain[1]) + load(n.gainX2).dot(dx);
      const V3 u = load(n.u), e1 = load(n.axis1), e2 = load(n.axis2);
      V3 omega, move;
      if (kBend) {
        a1 += load(n.gainW1).dot(w), a2 += load(n.gainW2).dot(w);
        omega = w - e1 * a1 - e2 * a2;
        move = omega.cross(u) * load(n.r);
      } else {
        move = V3{all(0), all(0), all(0)} - e1 * a1 - e2 * a2;
        omega = u.cross(move) * (1 / load(n.r));
      }
      const V3 moved = dx + move;
      store(n.omega, omega), store(n.dx, moved);
      most = max(most, moved.dot(moved));
    }
    return sqrt(most);
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
    store(b_.newtonSteps, all(1));
  }

  // End-of-step positions by re-accumulating unit links, and velocities.
  void finish() {
    const T h = T(c_.step);
    Work& root = b_.work[0];
    const M isFree = load(b_.freeRoot) > 0;
    const V3 x0 = load(root.x0);
    V3 x = load(root.x);
    if (midpoint()) x = x * all(2) - x0;
    store(root.x, x);
    V3 v = (x - x0) * all(1 / h);
    if (midpoint()) v = pick(isFree, v * all(2) - load(root.v0), v);
    if (c_.scheme == Scheme::Bdf2) v = pick(isFree, (x - back(root)) * all(rate()), v);
    store(root.v, v);
    for (int i = 1; i < b_.nodes; ++i) finishNode(i);
  }

  void finishNode(int i) {
    const T h = T(c_.step);
    Work& n = b_.work[i];
    const Work& p = b_.work[b_.parents[i]];
    V3 u = load(n.u);
    const V3 u0 = load(n.u0), x0 = load(n.x0);
    if (midpoint()) u = unit(u * (u.dot(u0) * 2) - u0);
    const V3 x = load(p.x) + u * load(b_.constants[i].length);
    store(n.x, x);
    V3 v = (x - x0) * all(1 / h);
    if (midpoint()) v = v * all(2) - load(n.v0);
    if (c_.scheme == Scheme::Bdf2) v = (x - back(n)) * all(rate());
    if (linear()) v = load(p.v) + load(n.omega).cross(u) * (load(b_.constants[i].length) * (1 / h));
    store(n.v, v);
  }

  Block<T, L>& b_;
  const StepConstants& c_;
  V scale_ = all(0);
  M safe_ = all(0) != all(0), positive_ = safe_;
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
