// Vectors of L chains' numbers: compiler vector types, element by element, so every width gives the same
// bits. Included by kernels.inl only, inside its unnamed namespace.

template <class T, int L>
struct VectorOf {
  typedef T type __attribute__((vector_size(sizeof(T) * L)));
};
template <class T, int L>
using Vec = typename VectorOf<T, L>::type;

template <class T, int L>
struct Lane {
  using V = Vec<T, L>;
  using M = decltype(V{} < V{});

  struct V3 {
    V x, y, z;
    V3 operator+(const V3& b) const { return {x + b.x, y + b.y, z + b.z}; }
    V3 operator-(const V3& b) const { return {x - b.x, y - b.y, z - b.z}; }
    V3 operator*(V s) const { return {x * s, y * s, z * s}; }
    V dot(const V3& b) const { return x * b.x + y * b.y + z * b.z; }
    V3 cross(const V3& b) const { return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x}; }
  };
  struct Sym {  // symmetric 3 × 3
    V xx, xy, xz, yy, yz, zz;
    V3 times(const V3& a) const {
      return {xx * a.x + xy * a.y + xz * a.z, xy * a.x + yy * a.y + yz * a.z, xz * a.x + yz * a.y + zz * a.z};
    }
    Sym operator+(const Sym& b) const {
      return {xx + b.xx, xy + b.xy, xz + b.xz, yy + b.yy, yz + b.yz, zz + b.zz};
    }
    void addDiagonal(V d) { xx += d, yy += d, zz += d; }
    // −= a bᵀ where the sum over calls is symmetric: the upper triangle only.
    void subtract(const V3& a, const V3& b) {
      xx -= a.x * b.x, xy -= a.x * b.y, xz -= a.x * b.z;
      yy -= a.y * b.y, yz -= a.y * b.z, zz -= a.z * b.z;
    }
  };
  struct Mat {  // rows
    V3 a, b, c;
    Mat operator+(const Mat& o) const { return {a + o.a, b + o.b, c + o.c}; }
    V3 times(const V3& v) const { return {a.dot(v), b.dot(v), c.dot(v)}; }
    void subtract(const V3& l, const V3& r) { a = a - r * l.x, b = b - r * l.y, c = c - r * l.z; }
  };

  static V all(T s) {
    V v;
    for (int l = 0; l < L; ++l) v[l] = s;
    return v;
  }
  static V load(const T* p) { return *reinterpret_cast<const V*>(p); }
  static void store(T* p, V v) { *reinterpret_cast<V*>(p) = v; }
  static V3 load(const T (*p)[L]) { return {load(p[0]), load(p[1]), load(p[2])}; }
  static void store(T (*p)[L], const V3& v) { store(p[0], v.x), store(p[1], v.y), store(p[2], v.z); }
  // Between double and T, one after the other: the compiler makes vectors of it.
  static V loadDouble(const double* p) {
    alignas(64) T t[L];
    for (int l = 0; l < L; ++l) t[l] = T(p[l]);
    return load(t);
  }
  static V3 loadDouble(const double (*p)[L]) {
    return {loadDouble(p[0]), loadDouble(p[1]), loadDouble(p[2])};
  }
  static void storeDouble(double (*p)[L], const V3& v) {
    alignas(64) T t[3][L];
    store(t, v);
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < L; ++l) p[k][l] = double(t[k][l]);
  }
  static Sym loadSym(const T (*p)[L]) {
    return {load(p[0]), load(p[1]), load(p[2]), load(p[3]), load(p[4]), load(p[5])};
  }
  static void storeSym(T (*p)[L], const Sym& s) {
    store(p[0], s.xx), store(p[1], s.xy), store(p[2], s.xz), store(p[3], s.yy), store(p[4], s.yz),
        store(p[5], s.zz);
  }
  static V pick(M m, V a, V b) { return m ? a : b; }
  static V3 pick(M m, const V3& a, const V3& b) {
    return {pick(m, a.x, b.x), pick(m, a.y, b.y), pick(m, a.z, b.z)};
  }
  static V max(V a, V b) { return a > b ? a : b; }
  static V min(V a, V b) { return a < b ? a : b; }
  static V abs(V a) { return a < 0 ? -a : a; }
  static V sqrt(V a) {
    alignas(64) T t[L];
    store(t, a);
    for (int l = 0; l < L; ++l) t[l] = std::sqrt(t[l]);
    return load(t);
  }
  static bool any(M m) {
    bool some = false;
    for (int l = 0; l < L; ++l) some |= m[l] != 0;
    return some;
  }
  static V3 unit(const V3& a) { return a * (1 / sqrt(a.dot(a))); }

  // Two unit vectors across u (Duff et al. 2017), without a branch.
  static void basis(const V3& u, V3& e1, V3& e2) {
    const V one = all(1), sign = u.z < 0 ? -one : one;
    const V a = -1 / (sign + u.z), b = u.x * u.y * a;
    e1 = {1 + sign * u.x * u.x * a, sign * b, -sign * u.x};
    e2 = {b, sign + u.y * u.y * a, -u.y};
  }
};
