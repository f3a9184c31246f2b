// What a step of chains of rigid links makes least, L chains at a time. Included by kernels.inl only.
//
// Unknowns are two rotations a joint, so lengths hold exactly. The step's objective is
//   φ = Σ ½ w|x − y|² + Σ ½ κ |u − t|² − lateral and field work.
// Nodes are kept as what they have moved by (x − x0), links as what they have turned by (u − u0): a short
// step is no difference of long numbers, in single precision either.

template <class T, int L, bool kBend, bool kCurved>
class StepObjective : protected NewtonSystem<T, L, kBend, kCurved> {
 protected:
  using System = NewtonSystem<T, L, kBend, kCurved>;
  using Base = Lane<T, L>;
  using Base::all, Base::any, Base::load, Base::max, Base::pick, Base::store, Base::unit;
  using System::b_, System::c_, System::now_, System::link, System::linear;
  using typename Base::M;
  using typename Base::V;
  using typename Base::V3;
  using Work = NodeWork<T, L>;

  StepObjective(Block<T, L>& block, const StepConstants& constants) : System(block, constants) {}

  bool midpoint() const { return c_.scheme == Scheme::Midpoint; }
  bool bdf2() const { return c_.scheme == Scheme::Bdf2; }
  V3 none() const { return {all(0), all(0), all(0)}; }

  // Rates at which a trial position becomes a velocity: v = rate (x − back).
  T rate() const {
    const T h = T(c_.step);
    return bdf2() ? T(1.5) / h : midpoint() ? 2 / h : 1 / h;
  }
  // back − x0.
  V3 back(const Work& n) const { return bdf2() ? load(n.back) * all(-T(1) / 3) : none(); }
  V3 gravity() const { return {all(T(c_.gravity[0])), all(T(c_.gravity[1])), all(T(c_.gravity[2]))}; }

  // w and y: inertia, gravity and drag are one quadratic about y (from x0 on).
  void prepare() {
    const T h = T(c_.step);
    const T k = rate() * rate();
    for (int i = 0; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      const NodeConstants<T, L>& fixed = b_.constants[i];
      const V3 v0 = load(n.v0), from = back(n);
      const V3 v = bdf2() ? (v0 * all(4) - load(n.vBack)) * all(T(1) / 3) : v0;
      V3 y = from + v * all(1 / rate()) + gravity() * all(1 / k);
      if (linear()) y = y - centripetal(i) * all(h * h);
      const V mass = load(fixed.mass), inertia = mass * k, drag = load(fixed.drag) * mass * rate();
      const V w = inertia + drag;
      store(n.w, w);
      store(n.y, (y * inertia + from * drag) * (1 / w));
      if (i > 0) {
        const V3 u = unitLink(startLink(i) * load(fixed.perLength));
        store(n.u0, u), store(link(n), u), store(n.turned[now_], none());
        store(n.r, load(fixed.length)), store(n.perR, load(fixed.perLength)),
            store(n.kappa, load(fixed.kappa));
      }
    }
    placeRoot();
  }

  V3 startLink(int i) const {
    const Work &n = b_.work[i], &p = b_.work[b_.parents[i]];
    alignas(64) T d[3][L];
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < L; ++l) d[k][l] = T(n.start[k][l] - p.start[k][l]);
    return load(d);
  }
  // One Newton step on the sphere where that is enough.
  V3 unitLink(const V3& d) const {
    const V off = d.dot(d) - 1;
    if (!any(~(Base::abs(off) < all(sizeof(T) == 8 ? T(1e-8) : T(1e-4))))) return d * (1 - off * T(0.5));
    return unit(d);
  }

  // Acceleration of the node when every link keeps its angular velocity; kept in gainX1 until the solve.
  V3 centripetal(int i) {
    Work& n = b_.work[i];
    V3 sum = none();
    if (i > 0) {
      const Work& p = b_.work[b_.parents[i]];
      const V3 d = startLink(i), speed = load(n.v0) - load(p.v0);
      sum = load(p.gainX1) - d * (speed.dot(speed) / d.dot(d));
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
    if (midpoint()) goal = goal * all(T(0.5));
    const V3 move = pick(isFree, load(n.y), goal);
    store(n.moveOld, move), store(n.move, move);
    store(n.dx, none()), store(n.omega, none());
    const V3 axes[3] = {load(&b_.rootAxes[0]), load(&b_.rootAxes[3]), load(&b_.rootAxes[6])};
    store(n.normal, axes[0]), store(n.binormal, axes[1]), store(n.u[0], axes[2]), store(n.u[1], axes[2]);
  }

  // Displacements, frames and φ of the iterate, or of the trial at a fraction of the Newton step; field
  // forces too.
  V positions(bool trial, V fraction) {
    V value = all(0), size = all(0);
    bend_ = all(0);
    const int at = trial ? 1 - now_ : now_;
    const M moves = fraction > 0;  // the others stay to the bit
    Work& root = b_.work[0];
    if (trial)
      store(root.move, pick(moves, load(root.moveOld) + load(root.dx) * fraction, load(root.moveOld)));
    if (b_.anyFree) value += rootValue(root);
    for (int i = 1; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      const Work& p = b_.work[b_.parents[i]];
      V3 u = load(link(n)), turned = load(n.turned[now_]);
      if (trial) {
        turned = pick(moves, turnedBy(turned, load(n.u0), u, load(n.omega) * fraction), turned);
        u = load(n.u0) + turned;
        store(n.u[at], u), store(n.turned[at], turned);
      }
      const V3 change = midpoint() ? midChange(i, u, turned) : turned * load(b_.constants[i].length);
      const V3 move = load(p.move) + change;
      store(n.move, move);
      const V3 e = move - load(n.y);
      value += load(n.w) * e.dot(e) * T(0.5);
      if (b_.lateral) {
        const V pull = change.dot(load(n.lateral));
        value -= pull, size += pull + Base::abs(pull);
      }
      if (kBend) bend_ += joint(n, p, b_.constants[i], u, load(p.u[at]));
    }
    value += bend_;
    scale_ = value + size;
    if (b_.fields != nullptr) callFields();
    return value;
  }

  V rootValue(const Work& n) const {
    const V3 e = load(n.move) - load(n.y);
    return pick(load(b_.freeRoot) > 0, load(n.w) * e.dot(e) * T(0.5), all(0));
  }

  // u − u0 after u has turned by Cayley's map of w (about w, by 2 atan |w|/2): the same w turns everything
  // rigidly, however large it is. Rounding's drift off the sphere is taken out, |u0 + t|² − 1 = 2 u0·t + t·t.
  V3 turnedBy(const V3& turned, const V3& u0, const V3& u, const V3& w) const {
    const V3 c = w.cross(u);
    const V3 t = turned + (c + w.cross(c) * all(T(0.5))) * (1 / (1 + w.dot(w) * T(0.25)));
    return t - (u0 + t) * (u0.dot(t) + t.dot(t) * T(0.5));
  }

  // With the ends of length ℓ, half their sum is as long as it is along the start (Thales): ℓ u·u0 = ℓ (1 −
  // ½|t|²) with t = u − u0. What the link has changed by is ℓ times u0's part across u.
  V3 midChange(int i, const V3& u, const V3& turned) {
    Work& n = b_.work[i];
    const NodeConstants<T, L>& fixed = b_.constants[i];
    const V length = load(fixed.length), off = turned.dot(turned) * T(0.5);
    const V share = max(1 - off, all(T(1e-3)));
    store(n.r, length * share), store(n.perR, load(fixed.perLength) * (1 / share));
    if (kBend) {
      const int p = b_.parents[i];
      const V other = p > 0 ? load(b_.work[p].r) * load(b_.constants[p].perLength) : all(1);
      store(n.kappa, load(fixed.kappa) * share * other);
    }
    return (turned - u * (1 - share)) * length;
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
      store(n.v, (load(n.move) - back(n)) * all(rate()));
    }
    b_.fields(b_.context);
  }
  void keepForces() {
    if (b_.fields == nullptr) return;
    for (int i = 0; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      store(n.forceOld, load(n.force)), store(n.moveOld, load(n.move));
    }
  }
  // Work of the fields from the iterate to the trial, by the trapezoidal rule.
  V fieldWork() const {
    V work = all(0);
    if (b_.fields == nullptr) return work;
    for (int i = 0; i < b_.nodes; ++i) {
      const Work& n = b_.work[i];
      work += (load(n.force) + load(n.forceOld)).dot(load(n.move) - load(n.moveOld)) * T(0.5);
    }
    return work;
  }

  V value_ = all(0), scale_ = all(0);  // φ of the iterate, and the size of what is summed in it
  V bend_ = all(0);                    // the joints' part of it
};
