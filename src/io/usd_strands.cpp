// Strands as BasisCurves: one prim a group, for Blender, Houdini, Unreal's groom and ourselves at once.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "usd_layer.h"
#include "usd_skin.h"

namespace coif::io::usd {
namespace {

constexpr Type kInts{Base::Int, 1, true}, kInt64s{Base::Int64, 1, true}, kFloats{Base::Float, 1, true};
constexpr Type kFloat2s{Base::Float, 2, true}, kFloat3s{Base::Float, 3, true};
constexpr double kDefaultDiameterMeters = 80e-6;  // a human hair

using Runs = std::shared_ptr<const std::vector<Run>>;

/// The strands of one group: null runs when the group is the whole set.
struct Group {
  std::string name;
  std::uint32_t index = 0;
  Runs strands, points;
  std::uint64_t strandCount = 0, pointCount = 0;
};

Group wholeSet(const StrandSet& set) {
  Group group;
  group.index = set.groups.empty() ? 0 : set.groups[0];
  group.strandCount = set.strandCount();
  group.pointCount = set.pointCount();
  return group;
}

Group groupOf(const StrandSet& set, std::uint32_t index) {
  auto strands = std::make_shared<std::vector<Run>>();
  auto points = std::make_shared<std::vector<Run>>();
  Group group;
  group.index = index;
  for (std::size_t s = 0; s < set.strandCount(); ++s) {
    if (set.groups[s] != index) continue;
    const std::uint64_t size = set.offsets[s + 1] - set.offsets[s];
    if (!strands->empty() && strands->back().first + strands->back().count == s) {
      ++strands->back().count;
      points->back().count += size;
    } else {
      strands->push_back({s, 1});
      points->push_back({set.offsets[s], size});
    }
    ++group.strandCount;
    group.pointCount += size;
  }
  group.strands = std::move(strands);
  group.points = std::move(points);
  return group;
}

std::vector<Group> groupsOf(const StrandSet& set) {
  std::vector<Group> groups;
  const bool one = set.groups.empty() || std::all_of(set.groups.begin(), set.groups.end(),
                                                     [&](std::uint32_t g) { return g == set.groups[0]; });
  if (one) {
    groups.push_back(wholeSet(set));
  } else {
    std::vector<std::uint32_t> used = set.groups;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const std::uint32_t index : used) groups.push_back(groupOf(set, index));
  }
  for (Group& group : groups) {
    group.name = group.index < set.groupNames.size() ? set.groupNames[group.index] : "hair";
  }
  return groups;
}

template <class F>
void forEachStrand(const Group& group, F&& body) {
  if (!group.strands) {
    for (std::uint64_t s = 0; s < group.strandCount; ++s) body(s);
    return;
  }
  for (const Run& run : *group.strands) {
    for (std::uint64_t s = run.first; s < run.first + run.count; ++s) body(s);
  }
}

/// One value a strand, converted by `pick(s)`.
template <class T, class F>
Value perStrand(const Group& group, Type type, F&& pick) {
  std::vector<T> values;
  values.reserve(group.strandCount);
  forEachStrand(group, [&](std::uint64_t s) { values.push_back(T(pick(s))); });
  return owned(type, std::move(values));
}

template <class T>
Value strandView(const Group& group, Type type, const std::vector<T>& values) {
  return view(type, std::span<const T>(values), group.strands, group.strandCount);
}

template <class T>
Value pointView(const Group& group, Type type, std::span<const T> values) {
  return view(type, values, group.points, group.pointCount);
}

Value extentOf(const Value& points, float radius) {
  constexpr float kBig = std::numeric_limits<float>::max();
  Vec3f lo = Vec3f::Constant(kBig), hi = Vec3f::Constant(-kBig);
  points.array.forEachPiece(sizeof(Vec3f), [&](std::span<const std::byte> bytes) {
    const auto* p = reinterpret_cast<const Vec3f*>(bytes.data());
    for (std::size_t i = 0; i < bytes.size() / sizeof(Vec3f); ++i) {
      lo = lo.cwiseMin(p[i]);
      hi = hi.cwiseMax(p[i]);
    }
  });
  return owned(kFloat3s, std::vector<Vec3f>{lo - Vec3f::Constant(radius), hi + Vec3f::Constant(radius)});
}

float greatestRadius(const StrandSet& set, const Group& group, float constantWidth) {
  if (set.widths.empty()) return constantWidth / 2;
  float width = 0;
  pointView(group, kFloats, std::span<const float>(set.widths))
      .array.forEachPiece(sizeof(float), [&](auto bytes) {
        const auto* w = reinterpret_cast<const float*>(bytes.data());
        for (std::size_t i = 0; i < bytes.size() / sizeof(float); ++i) width = std::max(width, w[i]);
      });
  return width / 2;
}

void addGeometry(const StrandExport& what, const Group& group, float constantWidth, Prim& prim) {
  const StrandSet& set = *what.strands;
  const float radius = greatestRadius(set, group, constantWidth);
  prim.attributes.push_back(makeUniform("type", "token", token("cubic")));
  prim.attributes.push_back(makeUniform("basis", "token", token("catmullRom")));
  prim.attributes.push_back(makeUniform("wrap", "token", token("pinned")));
  prim.attributes.push_back(makeAttribute(
      "curveVertexCounts", "int[]",
      perStrand<std::int32_t>(group, kInts, [&](auto s) { return set.offsets[s + 1] - set.offsets[s]; })));
  const Value points = pointView(group, kFloat3s, std::span<const Vec3f>(set.points));
  Attribute position = makeAttribute("points", "point3f[]", points);
  Attribute extent = makeAttribute("extent", "float3[]", extentOf(points, radius));
  for (const StrandFrame& frame : what.frames) {
    Value moved = pointView(group, kFloat3s, frame.points);
    extent.samples.push_back({frame.timeCode, extentOf(moved, radius)});
    position.samples.push_back({frame.timeCode, std::move(moved)});
  }
  prim.attributes.push_back(std::move(position));
  if (points.array.count > 0) prim.attributes.push_back(std::move(extent));
  const bool perPoint = !set.widths.empty();
  prim.attributes.push_back(makePrimvar("widths", "float[]", perPoint ? "vertex" : "constant",
                                        perPoint
                                            ? pointView(group, kFloats, std::span<const float>(set.widths))
                                            : owned(kFloats, std::vector<float>{constantWidth})));
}

void addColors(const StrandExport& what, const Group& group, Prim& prim) {
  const StrandSet& set = *what.strands;
  const bool perPoint = !set.colors.empty();
  const Value colors = perPoint ? pointView(group, kFloat3s, std::span<const Vec3f>(set.colors))
                                : owned(kFloat3s, std::vector<Vec3f>{what.color});
  const char* interpolation = perPoint ? "vertex" : "constant";
  prim.attributes.push_back(makePrimvar("primvars:displayColor", "color3f[]", interpolation, colors));
  prim.attributes.push_back(makePrimvar("primvars:groom_color", "float3[]", interpolation, colors));
  if (set.transparencies.empty()) return;
  std::vector<float> opacities;
  opacities.reserve(group.pointCount);
  forEachStrand(group, [&](std::uint64_t s) {
    for (std::uint64_t i = set.offsets[s]; i < set.offsets[s + 1]; ++i) {
      opacities.push_back(1 - set.transparencies[i]);
    }
  });
  prim.attributes.push_back(
      makePrimvar("primvars:displayOpacity", "float[]", "vertex", owned(kFloats, std::move(opacities))));
  // Opacity loses the last bits of small transparencies; this one is what we read back.
  prim.attributes.push_back(
      makePrimvar("primvars:coif:transparency", "float[]", "vertex",
                  pointView(group, kFloats, std::span<const float>(set.transparencies))));
}

/// Names of the strands: groom_* for Unreal (32 bits), coif:* for ourselves (all of it).
void addIdentity(const StrandSet& set, const Group& group, Prim& prim) {
  auto uniform = [&](std::string name, std::string typeName, Value value) {
    prim.attributes.push_back(makePrimvar(std::move(name), std::move(typeName), "uniform", std::move(value)));
  };
  constexpr std::uint64_t kGreatest = std::numeric_limits<std::int32_t>::max();
  const bool narrow = !set.ids.empty() && std::all_of(set.ids.begin(), set.ids.end(),
                                                      [](std::uint64_t id) { return id <= kGreatest; });
  uniform("primvars:groom_id", "int[]",
          perStrand<std::int32_t>(group, kInts, [&](auto s) { return narrow ? set.ids[s] : s; }));
  if (!set.ids.empty()) uniform("primvars:coif:id", "int64[]", strandView(group, kInt64s, set.ids));
  if (!set.groups.empty()) {
    uniform("primvars:groom_group_id", "int[]", strandView(group, kInts, set.groups));
  }
  if (!set.guides.empty()) {
    uniform("primvars:groom_guide", "int[]",
            perStrand<std::int32_t>(group, kInts, [&](auto s) { return set.guides[s] != 0; }));
  }
  if (!set.rootUvs.empty()) {
    const Value uvs = strandView(group, kFloat2s, set.rootUvs);
    uniform("primvars:st", "texCoord2f[]", uvs);
    uniform("primvars:surface_uv_coordinate", "texCoord2f[]", uvs);  // Blender's attachment attribute
    uniform("primvars:groom_root_uv", "float2[]", uvs);
  }
  if (!set.rootFaces.empty()) {
    uniform("primvars:coif:rootFace", "int[]", strandView(group, kInts, set.rootFaces));
  }
}

/// Mean value coordinates: a list of its own length a strand, which no primvar can hold, so two plain
/// attributes.
void addWeights(const StrandSet& set, const Group& group, Prim& prim) {
  if (set.weightOffsets.empty()) return;
  Attribute counts =
      makeAttribute("coif:rootWeightCounts", "int[]", perStrand<std::int32_t>(group, kInts, [&](auto s) {
                      return set.weightOffsets[s + 1] - set.weightOffsets[s];
                    }));
  std::vector<float> weights;
  forEachStrand(group, [&](std::uint64_t s) {
    weights.insert(weights.end(), set.weights.begin() + std::ptrdiff_t(set.weightOffsets[s]),
                   set.weights.begin() + std::ptrdiff_t(set.weightOffsets[s + 1]));
  });
  Attribute values = makeAttribute("coif:rootWeights", "float[]", owned(kFloats, std::move(weights)));
  counts.custom = values.custom = true;
  prim.attributes.push_back(std::move(counts));
  prim.attributes.push_back(std::move(values));
}

/// Skinning moves points: every point of a strand goes with its root.
void addSkin(const StrandExport& what, const Group& group, Prim& prim) {
  const SkinBinding& skin = what.skin->strands;
  std::vector<std::uint32_t> rows;
  if (!skin.rigid()) {
    rows.reserve(group.pointCount);
    forEachStrand(group, [&](std::uint64_t s) {
      rows.insert(rows.end(), what.strands->offsets[s + 1] - what.strands->offsets[s], std::uint32_t(s));
    });
  }
  bindToSkeleton(skin, rows, prim);
}

Prim describeGroup(const StrandExport& what, const Group& group, float constantWidth) {
  Prim prim;
  prim.typeName = "BasisCurves";
  prim.metadata.push_back({"apiSchemas", prependedTokens({"GroomAPI", "MaterialBindingAPI"})});
  prim.metadata.push_back({"displayName", string(cleanText(group.name))});
  addGeometry(what, group, constantWidth, prim);
  addColors(what, group, prim);
  addIdentity(*what.strands, group, prim);
  addWeights(*what.strands, group, prim);
  prim.relationships.push_back({"material:binding", {"/Hair/Looks/Strands"}});
  if (what.skin != nullptr) addSkin(what, group, prim);
  return prim;
}

Status checkFrames(const StrandExport& what) {
  double before = -std::numeric_limits<double>::infinity();
  for (const StrandFrame& frame : what.frames) {
    const std::string place = "frame " + std::to_string(&frame - what.frames.data());
    if (frame.points.size() != what.strands->pointCount()) {
      return makeError(ErrorCode::InvalidArgument,
                       "the frame has " + std::to_string(frame.points.size()) + " points, the strands have " +
                           std::to_string(what.strands->pointCount()) + "",
                       place);
    }
    if (!std::isfinite(frame.timeCode) || frame.timeCode <= before) {
      return makeError(ErrorCode::InvalidArgument, "time codes must be finite and ascend", place);
    }
    before = frame.timeCode;
  }
  if (!what.headPoses.empty() && what.headPoses.size() != what.frames.size())
    return makeError(ErrorCode::InvalidArgument, "there is not one pose of the head a frame");
  for (const Eigen::Matrix4d& pose : what.headPoses) {
    if (!pose.allFinite())
      return makeError(ErrorCode::InvalidArgument, "a pose of the head is not finite",
                       "frame " + std::to_string(&pose - what.headPoses.data()));
  }
  if (!what.frames.empty() && !(what.timeCodesPerSecond > 0 && std::isfinite(what.timeCodesPerSecond))) {
    return makeError(ErrorCode::InvalidArgument, "timeCodesPerSecond must be positive");
  }
  return {};
}

/// The head as a whole, by frame: xformOp:transform; the default is the first, as that of the points is.
void moveHead(const StrandExport& what, Prim& head) {
  if (what.headPoses.empty()) return;
  Attribute transform = makeAttribute("xformOp:transform", "matrix4d", matrix(what.headPoses.front()));
  for (std::size_t f = 0; f < what.frames.size(); ++f)
    transform.samples.push_back({what.frames[f].timeCode, matrix(what.headPoses[f])});
  head.attributes.push_back(std::move(transform));
  head.attributes.push_back(makeUniform("xformOpOrder", "token[]", tokens({"xformOp:transform"})));
}

Status checkLengths(const StrandSet& set) {
  for (std::size_t s = 0; s < set.strandCount(); ++s) {
    const std::uint64_t size = set.offsets[s + 1] - set.offsets[s];
    const std::string place = "strand " + std::to_string(s);
    if (size < 2) {
      return makeError(ErrorCode::InvalidArgument, "a USD curve needs two points or more", place);
    }
    if (size > std::uint64_t(std::numeric_limits<std::int32_t>::max())) {
      return makeError(ErrorCode::TooLarge, "a USD curve has at most 2^31 - 1 points", place);
    }
  }
  return {};
}

double unitOf(const StrandSet& set, std::vector<std::string>& notes) {
  if (set.metersPerUnit > 0 && std::isfinite(set.metersPerUnit)) return set.metersPerUnit;
  notes.push_back("The strands do not say their unit; centimetres are written.");
  return 0.01;
}

std::vector<Entry> layerMetadata(const StrandExport& what, double unit) {
  std::vector<Entry> metadata;
  metadata.push_back({"defaultPrim", token("Hair")});
  metadata.push_back({"documentation", string(cleanText(what.creator))});
  if (!what.frames.empty()) metadata.push_back({"endTimeCode", number(what.frames.back().timeCode)});
  metadata.push_back({"metersPerUnit", number(unit)});
  if (!what.frames.empty()) {
    metadata.push_back({"startTimeCode", number(what.frames.front().timeCode)});
    metadata.push_back({"timeCodesPerSecond", number(what.timeCodesPerSecond)});
  }
  metadata.push_back({"upAxis", token(what.strands->upAxis == UpAxis::Z ? "Z" : "Y")});
  return metadata;
}

Prim describeRoot(const StrandSet& set, bool skinned) {
  Prim root;
  root.name = "Hair";
  root.typeName = skinned ? "SkelRoot" : "Xform";  // UsdSkel moves what lies below a SkelRoot alone
  if (!set.groupNames.empty()) {
    Value names = string("");
    names.type.array = true;
    names.strings.clear();
    for (const std::string& name : set.groupNames) names.strings.push_back(cleanText(name));
    root.attributes.push_back(makeUniform("coif:groupNames", "string[]", std::move(names)));
    root.attributes.back().custom = true;
  }
  if (!set.information.empty()) {
    root.attributes.push_back(makeUniform("coif:information", "string", string(cleanText(set.information))));
    root.attributes.back().custom = true;
  }
  return root;
}

}  // namespace

Result<Layer> describeExport(const StrandExport& all, std::vector<std::string>& notes) {
  StrandExport what = all;
  const StrandSet& set = *what.strands;
  if (what.skin != nullptr && !what.frames.empty()) {
    notes.push_back("Simulated frames move with the head already; the skin's binding is not written.");
    what.skin = nullptr;
  }
  if (what.skin != nullptr) COIF_TRY(checkSkin(what));
  COIF_TRY(checkFrames(what));
  COIF_TRY(checkLengths(set));
  const double unit = unitOf(set, notes);
  const float constantWidth = float(kDefaultDiameterMeters / unit);
  if (set.widths.empty()) notes.push_back("The strands have no widths; 0.08 mm is written for all.");

  Layer layer;
  layer.metadata = layerMetadata(what, unit);
  Prim root = describeRoot(set, what.skin != nullptr);
  std::vector<std::string> taken = {"HairMesh", "Head", "Looks"};
  for (const Group& group : groupsOf(set)) {
    Prim prim = describeGroup(what, group, constantWidth);
    prim.name = primName(group.name, taken);
    root.children.push_back(std::move(prim));
  }
  if (what.hairMesh != nullptr) {
    COIF_ASSIGN(Prim mesh, describeHairMesh(*what.hairMesh));
    if (what.skin != nullptr) bindVertices(what.skin->hairMesh, what.hairMesh->vertices().size(), mesh);
    root.children.push_back(std::move(mesh));
  }
  if (what.head != nullptr) {
    COIF_ASSIGN(Prim head, describeHead(*what.head));
    if (what.skin != nullptr) bindVertices(what.skin->head, what.head->vertexCount(), head);
    moveHead(what, head);
    root.children.push_back(std::move(head));
  }
  root.children.push_back(describeLooks("/Hair/Looks"));
  layer.prims.push_back(std::move(root));
  return layer;
}

}  // namespace coif::io::usd
