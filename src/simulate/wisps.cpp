#include "coif/simulate/wisps.h"

#include <algorithm>
#include <limits>

#include "coif/base/parallel.h"
#include "coif/strands/catmull_rom.h"
#include "coif/strands/frames.h"
#include "coif/strands/grow.h"

namespace coif {

namespace {

constexpr std::size_t kStrandsAWisp = 16;  // looked at when its guides are chosen

/// Where a curve is at its root, half way and at its tip: enough to tell neighbours from what only begins
/// beside them.
using Course = std::array<Vec3, 3>;

template <class Points>
Course courseOf(const Points& points) {
  const auto at = [&](std::size_t i) { return Vec3(points[i].template cast<double>()); };
  return {at(0), at(points.size() / 2), at(points.size() - 1)};
}

double apart(const Course& a, const Course& b) {
  return (a[0] - b[0]).squaredNorm() + (a[1] - b[1]).squaredNorm() + (a[2] - b[2]).squaredNorm();
}

std::uint32_t nearest(const Course& course, std::span<const Course> centres) {
  std::uint32_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t c = 0; c < centres.size(); ++c) {
    const double distance = apart(course, centres[c]);
    if (distance < least) least = distance, best = c;
  }
  return best;
}

/// The member that is furthest from the nearest of `from`.
std::uint32_t furthest(std::span<const std::uint32_t> members, std::span<const Course> courses,
                       std::span<const Course> from) {
  std::uint32_t best = members[0];
  double most = -1;
  for (const std::uint32_t m : members) {
    double least = std::numeric_limits<double>::infinity();
    for (const Course& other : from) least = std::min(least, apart(courses[m], other));
    if (least > most) most = least, best = m;
  }
  return best;
}

/// Barycentric coordinates of the triangle's point that is near p; a third each where it has no area.
std::array<double, 3> weightsIn(const std::array<Vec3, 3>& corner, const Vec3& p) {
  const Vec3 u = corner[1] - corner[0], v = corner[2] - corner[0], w = p - corner[0];
  const Vec3 normal = u.cross(v);
  const double area2 = normal.squaredNorm(), size = u.squaredNorm() + v.squaredNorm();
  if (!(area2 > 1e-12 * size * size)) return {1. / 3, 1. / 3, 1. / 3};
  const double b = std::max(0.0, w.cross(v).dot(normal) / area2);
  const double c = std::max(0.0, u.cross(w).dot(normal) / area2);
  const double a = std::max(0.0, 1 - w.cross(v).dot(normal) / area2 - u.cross(w).dot(normal) / area2);
  return {a / (a + b + c), b / (a + b + c), c / (a + b + c)};
}

void addGuide(const HairMesh& mesh, const StrandSet& strands, std::uint32_t strand, WispSet& out) {
  for (const Vec3f& p : strands.strand(strand)) out.guides.push_back(p.cast<double>());
  WispSet::Root root;
  const Bundle& bundle = mesh.bundles()[mesh.indexOf(BundleId(strands.rootFaces[strand]))];
  root.vertices.assign(bundle.face(0).begin(), bundle.face(0).end());
  double sum = 0;
  for (std::uint64_t k = strands.weightOffsets[strand]; k < strands.weightOffsets[strand + 1]; ++k) {
    root.weights.push_back(double(strands.weights[k]));
    sum += root.weights.back();
  }
  for (double& weight : root.weights) weight /= sum;  // they were rounded to floats
  out.roots.push_back(std::move(root));
}

/// Points and turns (from rest) of every guide at the fractions of P points a strand: rows of P.
struct GuideTable {
  std::vector<Vec3> rest, now;
  std::vector<Eigen::Quaterniond> turns;
};

/// Turns of a guide's points: those of its links, and between two links the mean.
void turnsOf(std::span<const Vec3> rest, std::span<const Vec3> now, const Mat3& headTurn,
             std::vector<Eigen::Quaterniond>& out) {
  const auto matrix = [](const Frame& f) {
    Mat3 m;
    m << f.normal, f.binormal, f.tangent;
    return m;
  };
  Frame before, after;
  const auto turned = [](const Frame& frame, const Vec3& link) {
    return link.squaredNorm() > 0 ? turnedTo(frame, link) : frame;
  };
  before = turned(before, rest[1] - rest[0]);
  const Mat3 root = headTurn * matrix(before);
  after = {root.col(2), root.col(0), root.col(1)};
  std::vector<Eigen::Quaterniond> links;
  for (std::size_t i = 0; i + 1 < rest.size(); ++i) {
    before = turned(before, rest[i + 1] - rest[i]);
    after = turned(after, now[i + 1] - now[i]);
    links.emplace_back(matrix(after) * matrix(before).transpose());
  }
  out.assign(1, Eigen::Quaterniond(headTurn));
  for (std::size_t i = 1; i < links.size(); ++i) out.push_back(links[i - 1].slerp(0.5, links[i]));
  out.push_back(links.back());
}

GuideTable tableOf(const WispSet& wisps, std::span<const Vec3> positions, const Mat3& headTurn,
                   std::size_t samples, const Context& context) {
  const std::size_t n = wisps.points;
  const auto parameters = evenParameters(std::uint32_t(n - 1), samples);
  const std::vector<double> intervals(n - 1, 1);
  const SplineTable spline(intervals, parameters);
  GuideTable table;
  table.rest.resize(wisps.guideCount() * samples);
  table.now = table.rest;
  table.turns.resize(table.rest.size());
  parallelFor(context, wisps.guideCount(), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<Eigen::Quaterniond> turns;
    for (std::size_t g = begin; g < end; ++g) {
      const auto rest = wisps.guide(g), now = positions.subspan(g * n, n);
      turnsOf(rest, now, headTurn, turns);
      for (std::size_t j = 0; j < samples; ++j) {
        const auto row = spline.row(j);
        Vec3 &a = table.rest[g * samples + j], &b = table.now[g * samples + j];
        a.setZero(), b.setZero();
        for (std::size_t k = 0; k < n; ++k) a += row[k] * rest[k], b += row[k] * now[k];
        const auto first = std::min(std::size_t(parameters[j]), n - 2);
        table.turns[g * samples + j] = turns[first].slerp(parameters[j] - double(first), turns[first + 1]);
      }
    }
  });
  return table;
}

}  // namespace

Result<WispSet> makeWisps(const HairMesh& mesh, const WispOptions& options, const Surface* head,
                          const Context& context) {
  if (options.wisps < 1 || options.wisps > 10000 || options.points < 2 || options.points > 256)
    return makeError(ErrorCode::InvalidArgument,
                     "1 to 10 000 wisps can be made, with 2 to 256 points a guide");
  GrowOptions growing;
  growing.count = kStrandsAWisp * options.wisps;
  growing.points = options.points;
  growing.seed = options.seed;
  growing.head = head;
  COIF_ASSIGN(const GrowResult grown, grow(mesh, growing, context));
  const StrandSet& strands = grown.strands;
  std::vector<Course> courses;
  for (std::size_t s = 0; s < strands.strandCount(); ++s) courses.push_back(courseOf(strands.strand(s)));
  // Every prefix of the roots is blue noise: the first are the middles.
  const std::size_t count = std::min(options.wisps, courses.size());
  std::vector<std::uint32_t> wispOf(courses.size());
  parallelFor(context, courses.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      wispOf[s] = nearest(courses[s], std::span(courses).first(count));
  });
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "stopped while wisps were made");
  std::vector<std::vector<std::uint32_t>> members(count);
  for (std::uint32_t s = 0; s < courses.size(); ++s) members[wispOf[s]].push_back(s);
  WispSet out;
  out.points = options.points;
  for (std::size_t w = 0; w < count; ++w) {
    std::array<std::uint32_t, 3> chosen{};
    std::vector<Course> from{courses[w]};
    for (int k = 0; k < 3; ++k) {
      chosen[k] = furthest(members[w], courses, from);
      if (k == 0) from.clear();  // the first stands far from the middle, the others far from those before
      from.push_back(courses[chosen[k]]);
    }
    std::array<std::uint32_t, 3> guides{};
    for (int k = 0; k < 3; ++k) {
      const auto same = std::find(chosen.begin(), chosen.begin() + k, chosen[k]) - chosen.begin();
      guides[k] = same < k ? guides[same] : std::uint32_t(out.guideCount());
      if (same == k) addGuide(mesh, strands, chosen[k], out);
    }
    out.wisps.push_back(guides);
  }
  return out;
}

std::vector<WispStrand> bindStrands(const WispSet& wisps, const StrandSet& strands, const Context& context) {
  std::vector<Course> middles;
  for (const auto& guides : wisps.wisps) {
    Course middle{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    for (const std::uint32_t g : guides) {
      const Course course = courseOf(wisps.guide(g));
      for (int k = 0; k < 3; ++k) middle[k] += course[k] / 3;
    }
    middles.push_back(middle);
  }
  std::vector<WispStrand> bound(strands.strandCount());
  parallelFor(context, bound.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Course course = courseOf(strands.strand(s));
      bound[s].wisp = nearest(course, middles);
      std::array<Vec3, 3> roots;
      for (int k = 0; k < 3; ++k) roots[k] = wisps.guide(wisps.wisps[bound[s].wisp][k])[0];
      bound[s].weights = weightsIn(roots, course[0]);
    }
  });
  return bound;
}

Status carryStrands(const WispSet& wisps, std::span<const Vec3> positions, const Mat3& headTurn,
                    std::span<const WispStrand> bound, StrandSet& strands, const Context& context) {
  if (positions.size() != wisps.guides.size() || bound.size() != strands.strandCount())
    return makeError(ErrorCode::InvalidArgument, "positions or strands are not those of these wisps");
  if (bound.empty()) return {};
  const std::size_t samples = strands.strand(0).size();
  for (std::size_t s = 0; s < bound.size(); ++s) {
    if (strands.strand(s).size() == samples && samples >= 2 && bound[s].wisp < wisps.wisps.size()) continue;
    return makeError(ErrorCode::InvalidArgument,
                     "strands in wisps have two points or more, the same number each",
                     "strand " + std::to_string(s));
  }
  const GuideTable table = tableOf(wisps, positions, headTurn, samples, context);
  parallelFor(context, bound.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      Vec3f* points = &strands.points[strands.offsets[s]];
      for (std::size_t j = 0; j < samples; ++j) {
        Vec3 from = Vec3::Zero(), to = Vec3::Zero();
        Eigen::Vector4d turn = Eigen::Vector4d::Zero(), first = turn;
        for (int k = 0; k < 3; ++k) {
          const std::size_t at = wisps.wisps[bound[s].wisp][k] * samples + j;
          const double weight = bound[s].weights[k];
          from += weight * table.rest[at], to += weight * table.now[at];
          const Eigen::Vector4d& q = table.turns[at].coeffs();
          if (k == 0) first = q;
          turn += (q.dot(first) < 0 ? -weight : weight) * q;
        }
        // Turns more than a half apart have no mean: then the first guide's.
        const Eigen::Quaterniond mean(turn.norm() > 1e-6 ? turn.normalized() : first);
        points[j] = (to + mean * (points[j].cast<double>() - from)).cast<float>();
      }
    }
  });
  return {};
}

}  // namespace coif
