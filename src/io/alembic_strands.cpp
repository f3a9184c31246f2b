// Strands as Alembic curves, with Unreal's groom attributes (schema 1.5); built where Alembic is installed.
#include "coif/io/can_write.h"
#include "io/formats.h"

#ifdef COIF_WITH_ALEMBIC

#include <Alembic/AbcCoreAbstract/All.h>
#include <Alembic/AbcCoreOgawa/All.h>
#include <Alembic/AbcGeom/All.h>

#include <cmath>
#include <sstream>

namespace coif::io {
namespace {

namespace Abc = Alembic::Abc;
namespace AbcGeom = Alembic::AbcGeom;

constexpr double kUniformTimes = 1e-9;  // of a frame: closer times are one period apart

std::vector<double> secondsOf(const StrandExport& what) {
  std::vector<double> times;
  for (const StrandFrame& frame : what.frames) times.push_back(frame.timeCode / what.timeCodesPerSecond);
  return times;
}

/// Evenly spaced frames by their period, others each by its own time.
std::uint32_t addTimes(Abc::OArchive& archive, const std::vector<double>& times) {
  if (times.size() < 2) return 0;
  const double period = times[1] - times[0];
  bool even = true;
  for (std::size_t f = 0; f < times.size(); ++f)
    even &= std::abs(times[f] - times[0] - period * double(f)) <= kUniformTimes * period;
  if (even) return archive.addTimeSampling(Alembic::AbcCoreAbstract::TimeSampling(period, times[0]));
  const Alembic::AbcCoreAbstract::TimeSamplingType acyclic(
      Alembic::AbcCoreAbstract::TimeSamplingType::kAcyclic);
  return archive.addTimeSampling(Alembic::AbcCoreAbstract::TimeSampling(acyclic, times));
}

template <class Sample, class T>
Sample arrayOf(std::span<const T> values) {
  static_assert(sizeof(typename Sample::value_type) == sizeof(T));
  return Sample(reinterpret_cast<const typename Sample::value_type*>(values.data()), values.size());
}

/// One value a strand, under the curves' own attributes.
template <class Param, class T>
void addUniform(Abc::OCompoundProperty& parent, const char* name, const std::vector<T>& values) {
  using Sample = typename Param::Sample;
  Param param(parent, name, false, AbcGeom::kUniformScope, 1);
  param.set(
      Sample(Abc::TypedArraySample<typename Param::prop_type::traits_type>(
                 reinterpret_cast<const typename Param::prop_type::traits_type::value_type*>(values.data()),
                 values.size()),
             AbcGeom::kUniformScope));
}

void addAttributes(const StrandSet& set, AbcGeom::OCurvesSchema& curves) {
  Abc::OCompoundProperty all = curves.getArbGeomParams();
  std::vector<std::int32_t> ids(set.strandCount());
  for (std::size_t s = 0; s < ids.size(); ++s) ids[s] = std::int32_t(s);  // ours have 64 bits
  addUniform<AbcGeom::OInt32GeomParam>(all, "groom_id", ids);
  if (!set.groups.empty()) addUniform<AbcGeom::OInt32GeomParam>(all, "groom_group_id", set.groups);
  if (!set.guides.empty()) {
    addUniform<AbcGeom::OInt32GeomParam>(all, "groom_guide",
                                         std::vector<std::int32_t>(set.guides.begin(), set.guides.end()));
  }
  if (!set.rootUvs.empty()) addUniform<AbcGeom::OV2fGeomParam>(all, "groom_root_uv", set.rootUvs);
  if (!set.colors.empty()) {
    AbcGeom::OV3fGeomParam colors(all, "groom_color", false, AbcGeom::kVertexScope, 1);
    colors.set({arrayOf<Abc::V3fArraySample>(std::span(set.colors)), AbcGeom::kVertexScope});
  }
}

void addCurves(const StrandExport& what, Abc::OObject& parent, std::uint32_t times) {
  const StrandSet& set = *what.strands;
  AbcGeom::OCurves object(parent, "strands", times);
  AbcGeom::OCurvesSchema& curves = object.getSchema();
  std::vector<std::int32_t> counts;
  for (std::size_t s = 0; s < set.strandCount(); ++s)
    counts.push_back(std::int32_t(set.offsets[s + 1] - set.offsets[s]));
  const float hair = float(kUsualHairWidth / set.metersPerUnit);
  const std::span<const float> widths =
      set.widths.empty() ? std::span<const float>(&hair, 1) : std::span<const float>(set.widths);
  const auto scope = set.widths.empty() ? AbcGeom::kConstantScope : AbcGeom::kVertexScope;
  AbcGeom::OCurvesSchema::Sample sample(
      arrayOf<Abc::P3fArraySample>(what.frames.empty() ? std::span(set.points) : what.frames[0].points),
      Abc::Int32ArraySample(counts), AbcGeom::kLinear, AbcGeom::kNonPeriodic,
      AbcGeom::OFloatGeomParam::Sample(arrayOf<Abc::FloatArraySample>(widths), scope));
  curves.set(sample);
  for (std::size_t f = 1; f < what.frames.size(); ++f)
    curves.set(AbcGeom::OCurvesSchema::Sample(arrayOf<Abc::P3fArraySample>(what.frames[f].points)));
  addAttributes(set, curves);
}

Abc::M44d rows(const Eigen::Matrix4d& m) {
  Abc::M44d out;  // Imath multiplies rows from the left
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) out[column][row] = m(row, column);
  return out;
}

void addHead(const StrandExport& what, Abc::OObject& parent, std::uint32_t times) {
  const PolygonMesh& head = *what.head;
  AbcGeom::OXform place(parent, "head", times);
  for (const Eigen::Matrix4d& pose : what.headPoses) {
    AbcGeom::XformSample sample;
    sample.setMatrix(rows(pose));
    place.getSchema().set(sample);
  }
  std::vector<Vec3f> positions;
  for (const Vec3& p : head.positions) positions.push_back(p.cast<float>());
  std::vector<std::int32_t> counts, corners;
  for (std::size_t face = 0; face + 1 < head.faceOffsets.size(); ++face) {
    counts.push_back(std::int32_t(head.faceOffsets[face + 1] - head.faceOffsets[face]));
    for (std::uint64_t c = head.faceOffsets[face + 1]; c-- > head.faceOffsets[face];)
      corners.push_back(std::int32_t(head.corners[c]));  // Alembic's faces go round clockwise
  }
  AbcGeom::OPolyMesh mesh(place, "headShape");
  mesh.getSchema().set({arrayOf<Abc::P3fArraySample>(std::span<const Vec3f>(positions)),
                        Abc::Int32ArraySample(corners), Abc::Int32ArraySample(counts)});
}

}  // namespace

Result<WriteReport> writeAlembic(const StrandExport& what, const std::filesystem::path& path,
                                 const Context& context) {
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "stopped before the file was written");
  WriteReport report;
  std::ostringstream stream;
  try {
    Alembic::AbcCoreOgawa::WriteArchive write;
    Abc::MetaData about;
    about.set(Abc::kApplicationNameKey, what.creator);
    Abc::OArchive archive(write(&stream, about), Abc::kWrapExisting, Abc::ErrorHandler::kThrowPolicy);
    const std::uint32_t times = addTimes(archive, secondsOf(what));
    AbcGeom::OXform top(archive.getTop(), "Hair");
    AbcGeom::XformSample upright;
    if (what.strands->upAxis == UpAxis::Z) upright.setXRotation(-90);
    top.getSchema().set(upright);
    Abc::OCompoundProperty groom = top.getSchema().getArbGeomParams();
    Abc::OInt16Property(groom, "groom_version_major").set(1);
    Abc::OInt16Property(groom, "groom_version_minor").set(5);
    Abc::OStringProperty(groom, "groom_tool").set(what.creator);
    addCurves(what, top, times);
    if (what.head != nullptr) addHead(what, top, times);
  } catch (const std::exception& problem) {
    return makeError(ErrorCode::Unreadable, std::string("Alembic could not write it: ") + problem.what(), {},
                     path.string());
  }
  report.notes.push_back("Alembic holds no unit: lengths are those of the scene.");
  if (what.hairMesh != nullptr) report.notes.push_back("The hair mesh is not written to Alembic.");
  if (what.skin != nullptr) report.notes.push_back("The skin's binding is not written to Alembic.");
  COIF_ASSIGN(auto file, SafeFile::create(path));
  file.write(std::string_view(stream.view()));
  report.bytes = stream.view().size();
  COIF_TRY(file.commit());
  return report;
}

}  // namespace coif::io

#else

namespace coif::io {

Result<WriteReport> writeAlembic(const StrandExport&, const std::filesystem::path& path, const Context&) {
  return canSaveStrands(path).error();
}

}  // namespace coif::io

#endif

namespace coif {

bool writesAlembic() {
#ifdef COIF_WITH_ALEMBIC
  return true;
#else
  return false;
#endif
}

}  // namespace coif
