// Solvers that step freely and then push lengths back: XPBD and van Overveld's iteration. Included by
// kernels.inl only. They are what the direct solver is measured against.

template <class T, int L, bool kXpbd>
class Projecting : Lane<T, L> {
  using Base = Lane<T, L>;
  using Base::all, Base::load, Base::max, Base::pick, Base::sqrt, Base::store, Base::unit;
  using typename Base::M;
  using typename Base::V;
  using typename Base::V3;
  using Work = NodeWork<T, L>;

 public:
  Projecting(Block<T, L>& block, const StepConstants& constants) : b_(block), c_(constants) {}

  void run() {
    const T h = T(c_.step);
    startForces();
    for (int i = 0; i < b_.nodes; ++i) predict(i);
    for (int k = 0; k < c_.iterations; ++k) {
      if (kXpbd && b_.bend) bendSweep();
      for (int i = 1; i < b_.nodes; ++i) keepLength(i);
    }
    M bad = all(0) < all(0);
    for (int i = 0; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      const V3 x = load(n.x);
      store(n.v, (x - load(n.x0)) * all(1 / h));
      Base::storeDouble(n.end, x);
      bad |= ~(x.dot(x) < all(sizeof(T) == 8 ? T(1e300) : T(1e37)));
    }
    for (int l = 0; l < L; ++l) {
      b_.fault[l] = bad[l] != 0 ? LaneFault::NotFinite : LaneFault::None;
      b_.newtonSteps[l] = 1, b_.lastMove[l] = 0;
    }
  }

 private:
  bool moves(int i) const { return i > 0 || b_.anyFree; }
  V inverseMass(int i) const {
    const V w = 1 / load(b_.constants[i].mass);
    return i > 0 ? w : w * load(b_.freeRoot);
  }

  // Field, lateral and (van Overveld) joint forces at the step's start.
  void startForces() {
    for (int i = 0; i < b_.nodes; ++i) {
      Work& n = b_.work[i];
      store(n.y, load(n.x));  // where a prescribed root goes
      const V3 x0 = Base::loadDouble(n.start);
      store(n.x0, x0), store(n.x, x0), store(n.v, load(n.v0));
      store(n.move, V3{all(0), all(0), all(0)});
      store(n.force, V3{all(0), all(0), all(0)});
    }
    if (b_.fields != nullptr) b_.fields(b_.context);
    const V3 axes[3] = {load(&b_.rootAxes[0]), load(&b_.rootAxes[3]), load(&b_.rootAxes[6])};
    Work& root = b_.work[0];
    store(root.normal, axes[0]), store(root.binormal, axes[1]), store(root.u[0], axes[2]);
    for (int i = 1; i < b_.nodes; ++i) {
      if (b_.lateral) push(i, load(b_.work[i].lateral));
      frame(i);
      if (!kXpbd && b_.bend) jointForce(i);
    }
  }

  void push(int i, const V3& f) {
    Work& n = b_.work[i];
    Work& p = b_.work[b_.parents[i]];
    store(n.force, load(n.force) + f);
    store(p.force, load(p.force) - f);
  }

  void frame(int i) {
    Work& n = b_.work[i];
    const Work& p = b_.work[b_.parents[i]];
    const V3 u = unit(load(n.x) - load(p.x)), base = load(p.u[0]);
    const V3 normal = load(p.normal), binormal = load(p.binormal), rest = load(b_.constants[i].rest);
    const V3 both = base + u;
    const V by = 1 / max(1 + base.dot(u), all(T(1e-6)));
    store(n.normal, normal - both * (u.dot(normal) * by));
    store(n.binormal, binormal - both * (u.dot(binormal) * by));
    store(n.u[0], u);
    store(n.target, normal * rest.x + binormal * rest.y + base * rest.z);
  }

  void jointForce(int i) {
    const Work& n = b_.work[i];
    const int p = b_.parents[i];
    const V kappa = load(b_.constants[i].kappa);
    const V3 u = load(n.u[0]), t = load(n.target);
    push(i, (t - u * u.dot(t)) * (kappa / load(b_.constants[i].length)));
    if (p == 0) return;
    const V3 base = load(b_.work[p].u[0]);
    const V3 turned = base + u - t;  // the reaction that balances the torque, exact for a straight rest shape
    push(p, (turned - base * base.dot(turned)) * (kappa / load(b_.constants[p].length)));
  }

  void predict(int i) {
    Work& n = b_.work[i];
    const T h = T(c_.step);
    const V3 g = {all(T(c_.gravity[0])), all(T(c_.gravity[1])), all(T(c_.gravity[2]))};
    const V slow = 1 / (1 + load(b_.constants[i].drag) * h);
    const V3 v = (load(n.v0) + (g + load(n.force) * (1 / load(b_.constants[i].mass))) * all(h)) * slow;
    V3 x = load(n.x0) + v * all(h);
    if (i == 0) x = pick(load(b_.freeRoot) > 0, x, load(n.y));
    store(n.x, x);
    store(n.gainX1, V3{all(0), all(0), all(0)});
  }

  // Both ends move along the link, by their inverse masses.
  void keepLength(int i) {
    Work& n = b_.work[i];
    const int parent = b_.parents[i];
    Work& p = b_.work[parent];
    const V3 d = load(n.x) - load(p.x);
    const V w = inverseMass(i), wp = inverseMass(parent);
    const V length = sqrt(d.dot(d));
    const V3 by = d * ((length - load(b_.constants[i].length)) / (length * (w + wp)));
    store(n.x, load(n.x) - by * w);
    if (moves(parent)) store(p.x, load(p.x) + by * wp);
  }

  // C = d/ℓ − t with compliance 1/κ; λ accumulates in gainX1. The parent link feels t turn with it, which is
  // exact for straight rest shapes.
  void bendSweep() {
    for (int i = 1; i < b_.nodes; ++i) {
      frame(i);
      Work& n = b_.work[i];
      const int parent = b_.parents[i];
      Work& p = b_.work[parent];
      const V a = 1 / load(b_.constants[i].length);
      const V b = parent > 0 ? 1 / load(b_.constants[parent].length) : all(0);
      const V h = all(T(c_.step));
      const V soft = 1 / max(load(b_.constants[i].kappa) * h * h, all(T(1e-30)));
      const V w = inverseMass(i), wp = inverseMass(parent);
      const V wg = parent > 0 ? inverseMass(b_.parents[parent]) : all(0);
      const V3 c = (load(n.x) - load(p.x)) * a - load(n.target), lambda = load(n.gainX1);
      const V over = -1 / (w * a * a + wp * (a + b) * (a + b) + wg * b * b + soft);
      const V3 change = (c + lambda * soft) * over;
      store(n.gainX1, lambda + change);
      store(n.x, load(n.x) + change * (w * a));
      if (moves(parent)) store(p.x, load(p.x) - change * (wp * (a + b)));
      if (parent > 0 && moves(b_.parents[parent])) {
        Work& g = b_.work[b_.parents[parent]];
        store(g.x, load(g.x) + change * (wg * b));
      }
    }
  }

  Block<T, L>& b_;
  const StepConstants& c_;
};

template <class T, int L>
void runOverveld(Block<T, L>& block, const StepConstants& constants) {
  Projecting<T, L, false>(block, constants).run();
}
template <class T, int L>
void runXpbd(Block<T, L>& block, const StepConstants& constants) {
  Projecting<T, L, true>(block, constants).run();
}
