#include "preview/light_volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "coif/base/parallel.h"

namespace coif::preview {
namespace {

constexpr int kCells = 80;            // along the longest side of the hair's box
constexpr float kHeadOptical = 2.5f;  // of a cell that the head's surface crosses
constexpr float kSkyOpacity = 0.30f;  // part of the extinction that the diffuse light of the sky feels

std::size_t cellIndex(const LightVolume& grid, const Vec3& p) {
  const Vec3 c = (p - grid.lo) / grid.cell;
  const auto clamped = [](double v, int n) { return std::size_t(std::clamp(int(v), 0, n - 1)); };
  return (clamped(c.z(), grid.nz) * grid.ny + clamped(c.y(), grid.ny)) * grid.nx + clamped(c.x(), grid.nx);
}

LightVolume makeGrid(const Box& box) {
  LightVolume grid;
  const Vec3 size = box.hi - box.lo;
  grid.cell = std::max({size.maxCoeff() / kCells, 1e-6 * box.hi.norm(), 1e-12});
  grid.lo = box.lo - Vec3::Constant(2 * grid.cell);
  grid.nx = int(size.x() / grid.cell) + 5;
  grid.ny = int(size.y() / grid.cell) + 5;
  grid.nz = int(size.z() / grid.cell) + 5;
  return grid;
}

std::vector<float> hairOpticalSize(const LightVolume& grid, const CoarseStrands& strands) {
  std::vector<float> optical(std::size_t(grid.nx) * grid.ny * grid.nz, 0.0f);
  const double perCell = 0.25 * 3.14159265358979323846 / (grid.cell * grid.cell);
  for (std::size_t s = 0; s + 1 < strands.starts.size(); ++s) {
    for (std::uint32_t i = strands.starts[s]; i + 1 < strands.starts[s + 1]; ++i) {
      const CoarseStrands::Point &a = strands.points[i], &b = strands.points[i + 1];
      const Vec3 from = a.position.cast<double>(), d = b.position.cast<double>() - from;
      const double length = d.norm();
      const int steps = 1 + int(std::min(length / (0.7 * grid.cell), 1000.0));
      const double all = length * double(strands.longer[s]);
      const float amount = float(perCell * 0.5 * (double(a.width) + b.width) * all / steps);
      for (int k = 0; k < steps; ++k) optical[cellIndex(grid, from + d * ((k + 0.5) / steps))] += amount;
    }
  }
  return optical;
}

void addHead(const LightVolume& grid, const PolygonMesh& head, std::vector<float>& optical) {
  const Vec3 hi = grid.lo + grid.extent();
  for (std::size_t f = 0; f < head.faceCount(); ++f) {
    const auto face = head.face(f);
    for (std::size_t t = 1; t + 1 < face.size(); ++t) {
      const Vec3 a = head.positions[face[0]], u = head.positions[face[t]] - a,
                 v = head.positions[face[t + 1]] - a;
      const int steps = 1 + int(std::min(std::max(u.norm(), v.norm()) / (0.6 * grid.cell), 500.0));
      for (int i = 0; i <= steps; ++i) {
        for (int j = 0; i + j <= steps; ++j) {
          const Vec3 p = a + u * (double(i) / steps) + v * (double(j) / steps);
          if ((p.array() < grid.lo.array()).any() || (p.array() >= hi.array()).any()) continue;
          float& cell = optical[cellIndex(grid, p)];
          cell = std::max(cell, kHeadOptical);
        }
      }
    }
  }
}

// Directions of the sky about `up`: a ring low, a ring high, and the middle.
std::vector<Vec3> skyDirections(const Vec3& up) {
  const Vec3 a = up.unitOrthogonal(), b = up.cross(a);
  std::vector<Vec3> result{up};
  for (int k = 0; k < 5; ++k) {
    const double w = 2 * 3.14159265358979323846 * k / 5;
    result.push_back((0.75 * up + 0.66 * (std::cos(w) * a + std::sin(w) * b)).normalized());
    result.push_back((0.1 * up + std::cos(w + 0.6) * a + std::sin(w + 0.6) * b).normalized());
  }
  return result;
}

std::vector<std::vector<float>> sweeps(const LightVolume& grid, std::span<const float> optical,
                                       std::span<const Vec3> directions, const Context& context) {
  std::vector<std::vector<float>> depths(directions.size());
  parallelFor(context, directions.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d) depths[d] = sweepOpticalDepth(grid, optical, directions[d]);
  });
  return depths;
}

/// How open the half of the sphere about `up` is, by cell.
std::vector<float> openHalf(const LightVolume& grid, std::span<const float> optical, const Vec3& up,
                            const Context& context) {
  const auto depths = sweeps(grid, optical, skyDirections(up), context);
  std::vector<float> open(optical.size());
  parallelFor(context, optical.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    Eigen::Map<Eigen::ArrayXf> sum(open.data() + begin, Eigen::Index(end - begin));
    sum.setZero();
    for (const std::vector<float>& depth : depths) {
      sum += (-kSkyOpacity * Eigen::Map<const Eigen::ArrayXf>(depth.data() + begin, sum.size())).exp() /
             float(depths.size());
    }
  });
  return open;
}

}  // namespace

double meanExtinction(const Fog& fog) {
  double sum = 0, squares = 0;
  for (const float cell : fog.hairOnly) sum += cell, squares += double(cell) * cell;
  return sum > 0 ? squares / sum / fog.grid.cell : 0;
}

std::vector<float> sweepOpticalDepth(const LightVolume& grid, std::span<const float> opticalSize,
                                     const Vec3& direction) {
  const std::array<int, 3> size{grid.nx, grid.ny, grid.nz};
  const std::array<std::size_t, 3> stride{1, std::size_t(grid.nx), std::size_t(grid.nx) * grid.ny};
  int axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  const double per = 1 / std::max(std::abs(direction[axis]), 1e-9);
  const double du = direction[u] * per, dv = direction[v] * per;  // within ±1
  const bool fromHigh = direction[axis] > 0;
  // The cell upstream is the same step away everywhere: four constant weights, and a border of nothing.
  const int x0 = int(std::floor(du)), y0 = int(std::floor(dv));
  const float fx = float(du - x0), fy = float(dv - y0);
  const float w00 = (1 - fy) * (1 - fx), w10 = (1 - fy) * fx, w01 = fy * (1 - fx), w11 = fy * fx;
  constexpr int kBorder = 2;
  const std::size_t width = std::size_t(size[u] + 2 * kBorder);
  std::vector<float> before(width * std::size_t(size[v] + 2 * kBorder), 0.0f), after(before.size(), 0.0f);
  const auto row = [&](std::vector<float>& slice, int j) {
    return &slice[std::size_t(j + kBorder) * width + kBorder];
  };
  std::vector<float> result(opticalSize.size(), 0.0f), own(std::size_t(size[u]));
  for (int k = 0; k < size[axis]; ++k) {
    const std::size_t slice = std::size_t(fromHigh ? size[axis] - 1 - k : k) * stride[axis];
    for (int j = 0; j < size[v]; ++j) {
      const std::size_t start = slice + std::size_t(j) * stride[v], step = stride[u];
      const float *near = row(before, j + y0) + x0, *far = row(before, j + y0 + 1) + x0;
      float* out = row(after, j);
      for (int i = 0; i < size[u]; ++i)
        own[std::size_t(i)] = opticalSize[start + std::size_t(i) * step] * float(per);
      for (int i = 0; i < size[u]; ++i)
        out[i] = w00 * near[i] + w10 * near[i + 1] + w01 * far[i] + w11 * far[i + 1] + own[std::size_t(i)];
      for (int i = 0; i < size[u]; ++i)
        result[start + std::size_t(i) * step] = out[i] - 0.5f * own[std::size_t(i)];
    }
    std::swap(before, after);
  }
  return result;
}

Fog makeFog(const CoarseStrands& strands, const PolygonMesh* head) {
  Fog fog;
  if (strands.points.empty()) return fog;
  fog.grid = makeGrid(strands.box);
  fog.hairOnly = hairOpticalSize(fog.grid, strands);
  if (head == nullptr) return fog;
  fog.withHead = fog.hairOnly;
  addHead(fog.grid, *head, fog.withHead);
  return fog;
}

Openness openSides(const Fog& fog, const Vec3& up, const Context& context) {
  Openness open;
  open.up = up;
  if (fog.hairOnly.empty()) return open;
  const auto& solid = fog.withHead.empty() ? fog.hairOnly : fog.withHead;
  open.sky = openHalf(fog.grid, solid, up, context);
  open.ground = openHalf(fog.grid, solid, -up, context);
  open.skyPastHair = fog.withHead.empty() ? open.sky : openHalf(fog.grid, fog.hairOnly, up, context);
  return open;
}

LightVolumes makeLightVolumes(const Fog& fog, const Openness& open, const Vec3 (&lights)[3],
                              const Context& context) {
  LightVolumes result;
  if (fog.hairOnly.empty()) return result;
  const auto hair = sweeps(fog.grid, fog.hairOnly, lights, context);
  const bool head = !fog.withHead.empty();
  const auto solid = head ? sweeps(fog.grid, fog.withHead, std::span(lights).subspan(1), context)
                          : std::vector<std::vector<float>>{hair[1], hair[2]};
  result.hairOnly = result.withHead = fog.grid;
  result.hairOnly.values.resize(fog.hairOnly.size());
  result.withHead.values.resize(fog.hairOnly.size());
  parallelFor(context, fog.hairOnly.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      result.hairOnly.values[i] = Vec4f(hair[0][i], hair[1][i], hair[2][i], open.skyPastHair[i]);
      result.withHead.values[i] = Vec4f(open.ground[i], solid[0][i], solid[1][i], open.sky[i]);
    }
  });
  return result;
}

}  // namespace coif::preview
