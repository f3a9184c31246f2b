#include "scalp/example_head_shape.h"

#include <algorithm>
#include <cmath>

namespace coif {
namespace {

// Blends with a polynomial fillet of width k (Quilez's smooth minimum).
double unite(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k * 0.25;
}
double carve(double a, double b, double k) {
  return -unite(-a, b, k);
}

double ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii) {
  const Vec3 q = (p - centre).cwiseQuotient(radii);
  const double k0 = q.norm();
  const double k1 = q.cwiseQuotient(radii).norm();
  return k1 > 1e-12 ? k0 * (k0 - 1) / k1 : -radii.minCoeff();
}

// A capsule whose radius goes from ra to rb.
double limb(const Vec3& p, const Vec3& a, const Vec3& b, double ra, double rb) {
  const Vec3 d = b - a;
  const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (p - a - t * d).norm() - (ra + t * (rb - ra));
}

double ball(const Vec3& p, const Vec3& centre, double radius) {
  return (p - centre).norm() - radius;
}

double skull(const Vec3& p) {
  double d = ellipsoid(p, {0, 15.0, -1.6}, {7.55, 9.0, 9.3});
  d = unite(d, ellipsoid(p, {0, 15.6, 1.7}, {6.7, 7.0, 7.3}), 2.5);          // forehead
  d = unite(d, ellipsoid(p, {0, 8.4, 2.8}, {6.0, 8.0, 6.1}), 2.5);           // middle of the face
  d = unite(d, ellipsoid(p, {0, 4.2, 2.8}, {5.2, 3.6, 5.8}), 2.5);           // floor of the mouth
  d = unite(d, limb(p, {5.3, 4.6, -0.3}, {1.3, 1.35, 6.9}, 1.1, 1.2), 3.0);  // jaw
  d = unite(d, limb(p, {5.3, 4.8, -0.4}, {6.0, 10.0, 0.4}, 1.0, 0.7), 3.0);
  d = unite(d, ellipsoid(p, {0, 1.5, 7.4}, {1.7, 1.4, 1.5}), 1.4);            // chin
  d = unite(d, ellipsoid(p, {4.2, 9.5, 5.0}, {1.7, 1.3, 2.0}), 2.4);          // cheekbone
  d = unite(d, limb(p, {1.2, 13.5, 8.1}, {4.7, 13.7, 6.3}, 0.75, 0.7), 1.6);  // brow
  return d;
}

double eyes(double d, const Vec3& p) {
  d = carve(d, ellipsoid(p, {3.1, 11.9, 9.3}, {2.0, 1.25, 1.9}), 1.3);
  d = unite(d, ball(p, {3.15, 11.75, 6.75}, 1.45), 0.5);
  d = unite(d, limb(p, {1.6, 11.9, 7.85}, {3.1, 12.55, 8.1}, 0.22, 0.28), 0.4);  // upper lid
  d = unite(d, limb(p, {3.1, 12.55, 8.1}, {4.6, 11.9, 7.3}, 0.28, 0.2), 0.4);
  return unite(d, limb(p, {2.0, 11.25, 7.85}, {4.3, 11.2, 7.35}, 0.18, 0.18), 0.5);  // lower lid
}

double nose(double d, const Vec3& p) {
  d = unite(d, limb(p, {0, 12.0, 7.6}, {0, 8.6, 9.2}, 0.9, 1.35), 0.8);    // what the bridge stands on
  d = unite(d, limb(p, {0, 12.9, 8.25}, {0, 8.9, 10.9}, 0.65, 0.8), 1.0);  // bridge
  d = unite(d, ball(p, {0, 8.4, 10.9}, 0.95), 0.8);
  d = unite(d, ellipsoid(p, {1.2, 8.0, 9.9}, {0.75, 0.75, 1.0}), 0.5);
  return carve(d, ellipsoid(p, {0.62, 7.25, 10.55}, {0.32, 0.4, 0.55}), 0.35);
}

double mouth(double d, const Vec3& p) {
  d = unite(d, ellipsoid(p, {0, 5.3, 7.6}, {2.9, 2.3, 1.75}), 1.6);
  d = unite(d, limb(p, {0.35, 5.72, 9.25}, {2.2, 5.3, 8.35}, 0.42, 0.2), 0.5);  // upper lip
  d = unite(d, limb(p, {0, 4.72, 9.1}, {1.9, 5.05, 8.35}, 0.5, 0.25), 0.5);     // lower lip
  d = carve(d, limb(p, {0, 5.25, 9.85}, {2.3, 5.18, 8.75}, 0.16, 0.1), 0.3);
  d = carve(d, ellipsoid(p, {0, 3.4, 9.95}, {2.0, 0.7, 1.1}), 1.0);  // fold above the chin
  return carve(d, limb(p, {0, 7.3, 10.2}, {0, 6.3, 9.9}, 0.3, 0.3), 0.6);
}

double neck(double d, const Vec3& p) {
  const Vec3 q(p.x() * 1.06, p.y(), p.z());
  double n = limb(q, {0, -9, -3.4}, {0, 9, -2.6}, 5.7, 5.4);
  n = unite(n, limb(p, {5.6, 7.5, -2.2}, {1.3, -6.5, 3.0}, 0.9, 0.7), 1.8);   // sternomastoid
  n = unite(n, limb(p, {2.8, 1.5, -5.4}, {9.0, -9.6, -4.0}, 2.0, 2.2), 4.0);  // trapezius
  n = unite(n, ellipsoid(p, {0, -10.8, -2.4}, {13.0, 6.6, 8.0}), 4.0);        // shoulders
  return unite(d, n, 1.4);
}

// In the ear's own frame: u to the back, v up, w away from the head.
double ear(double d, const Vec3& p) {
  static const Mat3 earFromHead = [] {
    const double flare = 0.50, lean = 0.20;  // radians: away from the skull, and backwards
    Mat3 f, l;
    f << 0, 0, -1, 0, 1, 0, 1, 0, 0;
    Mat3 r;
    r << std::cos(flare), 0, std::sin(flare), 0, 1, 0, -std::sin(flare), 0, std::cos(flare);
    l << std::cos(lean), -std::sin(lean), 0, std::sin(lean), std::cos(lean), 0, 0, 0, 1;
    return Mat3(l * r * f);
  }();
  const Vec3 e = earFromHead * (p - Vec3(7.35, 10.5, -1.9));
  // The outline narrows to the lobe.
  const double width = 1.75 + 0.16 * std::clamp(e.y(), -3.0, 2.0);
  const Vec3 s(e.x() / width, e.y() / 3.15, e.z());
  const double rho = std::sqrt(s.x() * s.x() + s.y() * s.y());
  const double across = (rho - 1) * width;
  const double shell = std::max(across, std::abs(e.z() + 0.12) - 0.42);
  const double rim = std::sqrt(std::pow(across + 0.22, 2) + std::pow(e.z() - 0.22, 2)) - 0.46;
  const double inner = std::sqrt(std::pow((rho - 0.56) * width, 2) + std::pow(e.z() - 0.18, 2)) - 0.27;
  d = unite(d, shell, 0.9);
  d = unite(d, ellipsoid(e, {-0.2, 0.0, -0.95}, {1.6, 2.5, 1.2}), 1.0);  // root
  d = unite(d, rim, 0.5);
  if (e.x() > -0.5) d = unite(d, inner, 0.5);
  d = carve(d, ellipsoid(e, {-0.1, -0.35, 0.55}, {0.8, 1.2, 0.8}), 0.6);       // concha
  d = unite(d, ellipsoid(e, {-1.0, -0.55, 0.25}, {0.42, 0.6, 0.38}), 0.4);     // tragus
  return unite(d, ellipsoid(e, {-0.45, -2.75, 0.0}, {0.75, 0.7, 0.42}), 0.5);  // lobe
}

}  // namespace

double headField(const Vec3& point) {
  const Vec3 p(std::abs(point.x()), point.y(), point.z());
  double d = nose(eyes(skull(p), p), p);
  d = neck(mouth(d, p), p);
  if (ball(p, {7.6, 10.5, -1.9}, 6.0) < 0) d = ear(d, p);
  return carve(d, p.y() - kHeadBase.y(), 1.2);
}

}  // namespace coif
