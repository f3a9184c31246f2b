#include "coif/scalp/example_head.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "coif/base/parallel.h"
#include "scalp/example_head_shape.h"

namespace coif {
namespace {

// The surface of a box of nx × ny × nz cells, x even so that the mirror plane carries vertices.
struct BoxLattice {
  int nx, ny, nz;
  std::vector<std::uint32_t> index;    // (nx+1)(ny+1)(nz+1), kNone inside
  std::vector<std::array<int, 3>> at;  // V
  std::vector<std::array<std::uint32_t, 4>> quads;

  BoxLattice(int x, int y, int z) : nx(x), ny(y), nz(z) {
    index.assign(std::size_t(nx + 1) * (ny + 1) * (nz + 1), kNone);
    for (int j = 0; j <= ny; ++j)
      for (int k = 0; k <= nz; ++k)
        for (int i = 0; i <= nx; ++i)
          if (i == 0 || i == nx || j == 0 || j == ny || k == 0 || k == nz) {
            slot(i, j, k) = std::uint32_t(at.size());
            at.push_back({i, j, k});
          }
    addSide(2, nz, false), addSide(2, 0, true);
    addSide(0, nx, false), addSide(0, 0, true);
    addSide(1, ny, false), addSide(1, 0, true);
  }
  std::uint32_t& slot(int i, int j, int k) { return index[(std::size_t(j) * (nz + 1) + k) * (nx + 1) + i]; }
  std::uint32_t mirror(std::uint32_t v) { return slot(nx - at[v][0], at[v][1], at[v][2]); }

 private:
  void addSide(int axis, int level, bool flip) {
    const std::array<int, 3> size{nx, ny, nz};
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (int q = 0; q < size[b]; ++q)
      for (int p = 0; p < size[a]; ++p) {
        std::array<std::uint32_t, 4> quad;
        for (int c = 0; c < 4; ++c) {
          std::array<int, 3> ijk;
          ijk[axis] = level;
          ijk[a] = p + (c == 1 || c == 2);
          ijk[b] = q + (c >= 2);
          quad[flip ? 3 - c : c] = slot(ijk[0], ijk[1], ijk[2]);
        }
        quads.push_back(quad);
      }
  }
};

constexpr double kSkullStart = 0.7;  // fraction of the rows below the skull's centre

struct Ray {
  Vec3 origin, direction;
  double reach;  // fraction of the way to the surface
};

// Rows up to the skull's centre look sideways from a bent axis; above, a cube-sphere closes the crown without
// a pole.
Ray rayOf(const BoxLattice& box, const std::array<int, 3>& ijk) {
  const double quarter = std::atan(1.0);
  const double a = 2.0 * ijk[0] / box.nx - 1, t = double(ijk[1]) / box.ny, b = 2.0 * ijk[2] / box.nz - 1;
  const Vec3 flat(std::tan(quarter * a), 0, std::tan(quarter * b));
  if (ijk[1] == 0) {
    const double reach = std::max(std::abs(a), std::abs(b));
    const Vec3 out =
        reach > 0 ? Vec3(std::tan(quarter * a / reach), 0, std::tan(quarter * b / reach)) : Vec3(0, 0, 1);
    return {kHeadBase + Vec3(0, 0.5, 0), out.normalized(), reach};
  }
  if (t <= kSkullStart) {
    const Vec3 low = kHeadBase + Vec3(0, 0.5, 0);
    return {low + (kHeadCentre - low) * (t / kSkullStart), flat.normalized(), 1};
  }
  const double up = std::tan(quarter * (t - kSkullStart) / (1 - kSkullStart));
  return {kHeadCentre, (flat + Vec3(0, up, 0)).normalized(), 1};
}

Vec3 firstExit(const Ray& ray) {
  double t = 0;
  for (int step = 0; step < 200; ++step) {
    const double d = headField(ray.origin + t * ray.direction);
    if (d > -1e-4) break;
    t += 0.7 * -d;
  }
  return ray.origin + ray.reach * t * ray.direction;
}

// One Newton step to the surface; `normal` receives the unit gradient.
Vec3 project(const Vec3& p, Vec3& normal) {
  constexpr double h = 1e-3;
  Vec3 gradient = Vec3::Zero();
  double mean = 0;
  for (const Vec3& corner : {Vec3(1, -1, -1), Vec3(-1, -1, 1), Vec3(-1, 1, -1), Vec3(1, 1, 1)}) {
    const double d = headField(p + h * corner);
    gradient += d * corner;
    mean += 0.25 * d;
  }
  gradient /= 4 * h;
  const double squared = gradient.squaredNorm();
  if (squared < 1e-12) return p;
  normal = gradient / std::sqrt(squared);
  return p - std::clamp(mean / std::sqrt(squared), -0.5, 0.5) * normal;
}

// How much finer than elsewhere the mesh wants to be: ears, then the features of the face.
double fineness(const Vec3& p) {
  const Vec3 m(std::abs(p.x()), p.y(), p.z());
  const auto bump = [&](const Vec3& c, double r) { return std::exp(-(m - c).squaredNorm() / (r * r)); };
  const double neck = std::clamp((2 - p.y()) / 4, 0.0, 1.0);
  return 1 - 0.5 * neck + 8.0 * bump({8.2, 10.4, -2.2}, 3.2) + 5.0 * bump({0, 8.5, 10.5}, 3) +
         4.0 * bump({3, 11.6, 8}, 2.3) + 4.0 * bump({0, 5.2, 9}, 2.6);
}

std::vector<std::vector<std::uint32_t>> neighbours(const BoxLattice& box) {
  std::vector<std::vector<std::uint32_t>> result(box.at.size());
  for (const auto& quad : box.quads)
    for (int c = 0; c < 4; ++c) result[quad[c]].push_back(quad[(c + 1) % 4]);  // each edge once a direction
  return result;
}

void relax(BoxLattice& box, std::vector<Vec3>& positions, int rounds) {
  const auto ring = neighbours(box);
  std::vector<Vec3> next(positions.size());
  for (int round = 0; round < rounds; ++round) {
    parallelFor({}, positions.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        if (2 * box.at[v][0] < box.nx) continue;  // the mirrored half
        Vec3 sum = Vec3::Zero(), normal = Vec3::UnitY();
        double weights = 0;
        for (const std::uint32_t n : ring[v]) {
          // Weighting by length evens the edges out; plain averaging would slide off nose and ears.
          const double w =
              fineness(0.5 * (positions[n] + positions[v])) * (positions[n] - positions[v]).norm();
          sum += w * positions[n];
          weights += w;
        }
        const Vec3 onSurface = project(positions[v], normal);
        const Vec3 move = sum / weights - positions[v];
        next[v] = onSurface + 0.35 * (move - normal * normal.dot(move));
      }
    });
    for (std::size_t v = 0; v < positions.size(); ++v) {
      if (2 * box.at[v][0] < box.nx) continue;
      if (2 * box.at[v][0] == box.nx) next[v].x() = 0;
      positions[v] = next[v];
      positions[box.mirror(std::uint32_t(v))] = Vec3(-next[v].x(), next[v].y(), next[v].z());
    }
  }
}

// Unfolds the box around its top: the sides become square rings about the middle square; the base lies
// beside.
Vec2 uvOf(const BoxLattice& box, const std::array<int, 3>& ijk, bool base) {
  const Vec2 square(2.0 * ijk[0] / box.nx - 1, 1 - 2.0 * ijk[2] / box.nz);
  if (base) return Vec2(0.9375, 0.0625) + 0.05 * Vec2(square.x(), -square.y());
  const double size = 0.4 + 0.6 * (1 - double(ijk[1]) / box.ny);
  return Vec2(0.4375, 0.4375) + 0.4375 * size * square;
}

// Hair grows above a line that runs from the forehead over the ears to the nape.
bool isScalp(const Vec3& p) {
  const double line = p.z() > 3    ? 14.5 + 0.85 * (p.z() - 3)
                      : p.z() > -3 ? 12.5 + (p.z() + 3) / 3
                                   : 4 + (p.z() + 8) * 1.7;
  const bool ear = (Vec3(std::abs(p.x()), p.y(), p.z()) - Vec3(7.9, 10.5, -2.4)).norm() < 3.5;
  return p.y() > std::max(line, 4.0) && !ear;
}

}  // namespace

PolygonMesh makeExampleHead(int resolution) {
  const int r = (std::clamp(resolution, 16, 256) + 3) / 4 * 4;
  BoxLattice box(r / 2, r, r / 2);
  std::vector<Vec3> positions(box.at.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (2 * box.at[v][0] < box.nx) continue;
    positions[v] = firstExit(rayOf(box, box.at[v]));
    const Vec3& p = positions[v];
    positions[box.mirror(std::uint32_t(v))] = Vec3(-p.x(), p.y(), p.z());
  }
  relax(box, positions, 3 * r);

  PolygonMesh mesh;
  mesh.metersPerUnit = 0.01;
  mesh.groupNames = {"scalp", "face", "base"};
  for (const auto& quad : box.quads) {
    mesh.addFace(quad);
    const bool base = std::all_of(quad.begin(), quad.end(), [&](auto v) { return box.at[v][1] == 0; });
    Vec3 middle = Vec3::Zero();
    for (const std::uint32_t v : quad) {
      middle += 0.25 * positions[v];
      mesh.cornerUvs.push_back(uvOf(box, box.at[v], base));
    }
    mesh.faceGroups.push_back(base ? 2 : isScalp(middle) ? 0 : 1);
  }
  mesh.positions = std::move(positions);
  return mesh;
}

}  // namespace coif
