// The Newton system of a chain of rigid links, L chains at a time: eliminated from tip to root, solved from
// root to tip. Included by kernels.inl only.
//
// The quadratic model of a subtree, in the displacement dx and rotation ω at its base,
//   ½ dxᵀP dx + dxᵀQ ω + ½ ωᵀS ω + p·dx + s·ω,
// is passed on, two coordinates leaving it at each joint (docs/simulate.md, "the direct solver").

template <class T, int L, bool kBend, bool kCurved>
class NewtonSystem : protected Lane<T, L> {
 protected:
  using Base = Lane<T, L>;
  using Base::all, Base::any, Base::basis, Base::load, Base::loadSym, Base::max, Base::pick, Base::sqrt,
      Base::store, Base::storeSym, Base::unit;
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

  NewtonSystem(Block<T, L>& block, const StepConstants& constants) : b_(block), c_(constants) {}

  // The iterate's direction of the link above node n.
  auto& link(Work& n) const { return n.u[now_]; }
  auto& link(const Work& n) const { return n.u[now_]; }

  bool linear() const {
    return c_.scheme == Scheme::ArticulatedExplicit || c_.scheme == Scheme::ArticulatedImplicit;
  }

  V3 lateralOf(const Work& n) const { return b_.lateral ? load(n.lateral) : V3{all(0), all(0), all(0)}; }

  Model ownModel(int i) const {
    const Work& n = b_.work[i];
    const V w = load(n.w), zero = all(0);
    const V3 none = {zero, zero, zero};
    Model m{{w, zero, zero, w, zero, w},
            {none, none, none},
            {zero, zero, zero, zero, zero, zero},
            (load(n.move) - load(n.y)) * w,
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
    const V3 u = load(link(n)), lateral = lateralOf(n);
    V3 e1, e2;
    basis(u, e1, e2);
    const V3 f1 = m.p.times(e1), f2 = m.p.times(e2);
    const V geometric = tension(u, m.sum - lateral) * load(n.perR);
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
    const V3 u = load(link(n)), lateral = lateralOf(n);
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
    const V3 base = load(link(b_.work[b_.parents[i]]));
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
      const V3 u = load(link(n)), e1 = load(n.axis1), e2 = load(n.axis2);
      V3 omega, move;
      if (kBend) {
        a1 += load(n.gainW1).dot(w), a2 += load(n.gainW2).dot(w);
        omega = w - e1 * a1 - e2 * a2;
        move = omega.cross(u) * load(n.r);
      } else {
        move = V3{all(0), all(0), all(0)} - e1 * a1 - e2 * a2;
        omega = u.cross(move) * load(n.perR);
      }
      const V3 moved = dx + move;
      store(n.omega, omega), store(n.dx, moved);
      most = max(most, moved.dot(moved));
    }
    return sqrt(most);
  }

  int now_ = 0;  // which of the two is the iterate
  Block<T, L>& b_;
  const StepConstants& c_;
  M safe_ = all(0) != all(0), positive_ = safe_;
};
