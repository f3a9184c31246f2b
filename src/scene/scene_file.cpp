// The .coif file: JSON with typed arrays. Parents and layers of vertices follow from the bundles and are not
// stored.
#include <nlohmann/json.hpp>

#include "coif/io/safe_file.h"
#include "coif/scene/scene.h"
#include "scene/dynamics_json.h"
#include "scene/json_reader.h"
#include "scene/scene_folder.h"
#include "scene/style_json.h"
#include "scene/typed_array.h"

namespace coif {

namespace {

using nlohmann::ordered_json;
using scene::JsonReader;

constexpr const char* kFormat = "coif-scene";
// A mesh of a million vertices; more would only serve to fill memory with nested brackets.
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 26;
constexpr int kMaxDepth = 32;
constexpr const char* kKnotNames[] = {"uniform", "centripetal", "chordal"};

ordered_json meshJson(const HairMesh& mesh) {
  std::vector<std::uint32_t> ids, pinned, welded, bundleIds, corners, heights, groups, vertices, splits;
  std::vector<double> positions;
  for (const HairVertex& vertex : mesh.vertices()) {
    if (vertex.pinned) pinned.push_back(std::uint32_t(ids.size()));
    if (vertex.welded) welded.push_back(std::uint32_t(ids.size()));
    ids.push_back(std::uint32_t(vertex.id));
    for (int axis = 0; axis < 3; ++axis) positions.push_back(vertex.position[axis]);
  }
  for (const Bundle& bundle : mesh.bundles()) {
    bundleIds.push_back(std::uint32_t(bundle.id));
    corners.push_back(bundle.corners);
    heights.push_back(bundle.height());
    groups.push_back(bundle.group);
    vertices.insert(vertices.end(), bundle.vertices.begin(), bundle.vertices.end());
  }
  for (const EdgeSplit& split : mesh.splits()) splits.insert(splits.end(), {split.a, split.b, split.layer});
  ordered_json out;
  out["vertices"] = {{"ids", scene::encodeIntegers(ids)},
                     {"positions", scene::encodeDoubles(positions)},
                     {"pinned", scene::encodeIntegers(pinned)},
                     {"welded", scene::encodeIntegers(welded)}};
  out["bundles"] = {{"ids", scene::encodeIntegers(bundleIds)},
                    {"corners", scene::encodeIntegers(corners)},
                    {"heights", scene::encodeIntegers(heights)},
                    {"groups", scene::encodeIntegers(groups)},
                    {"vertices", scene::encodeIntegers(vertices)}};
  out["splits"] = scene::encodeIntegers(splits);
  out["groupNames"] = std::vector<std::string>(mesh.groupNames().begin(), mesh.groupNames().end());
  out["nextVertexId"] = mesh.nextVertexId();
  out["nextBundleId"] = mesh.nextBundleId();
  return out;
}

std::string numberText(std::uint64_t number) {
  return std::to_string(number);
}

Result<std::vector<HairVertex>> readVertices(JsonReader reader) {
  const auto ids = reader.integers("ids");
  const auto positions = reader.doubles("positions");
  const auto pinned = reader.integers("pinned");
  const auto welded = reader.integers("welded");
  COIF_TRY(reader.status());
  if (positions.size() != 3 * ids.size()) {
    reader.fail("positions", numberText(3 * ids.size()) + " values are wanted for " + numberText(ids.size()) +
                                 " vertices, and " + numberText(positions.size()) + " are here");
  }
  for (const auto& [name, list] : {std::pair("pinned", &pinned), std::pair("welded", &welded)}) {
    for (std::uint32_t index : *list) {
      if (index >= ids.size()) reader.fail(name, "vertex " + numberText(index) + " does not exist");
    }
  }
  COIF_TRY(reader.status());
  std::vector<HairVertex> vertices(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    vertices[i].id = VertexId(ids[i]);
    vertices[i].position = Vec3(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
  }
  for (std::uint32_t index : pinned) vertices[index].pinned = true;
  for (std::uint32_t index : welded) vertices[index].welded = true;
  return vertices;
}

Result<std::vector<Bundle>> readBundles(JsonReader reader, std::size_t vertexCount) {
  const auto ids = reader.integers("ids");
  const auto corners = reader.integers("corners");
  const auto heights = reader.integers("heights");
  const auto groups = reader.integers("groups");
  const auto vertices = reader.integers("vertices");
  COIF_TRY(reader.status());
  if (corners.size() != ids.size() || heights.size() != ids.size() || groups.size() != ids.size()) {
    reader.fail("ids", "the arrays of the bundles have different lengths");
    return reader.status().error();
  }
  std::vector<Bundle> bundles(ids.size());
  std::uint64_t cursor = 0;
  for (std::size_t j = 0; j < ids.size(); ++j) {
    const std::uint64_t length = (std::uint64_t(heights[j]) + 1) * corners[j];
    if (corners[j] < 3 || cursor + length > vertices.size()) {
      reader.fail("vertices", "bundle " + numberText(j) + " has " + numberText(corners[j]) +
                                  " corners and height " + numberText(heights[j]) +
                                  ", which the array does not hold");
      return reader.status().error();
    }
    bundles[j].id = BundleId(ids[j]);
    bundles[j].corners = corners[j];
    bundles[j].group = groups[j];
    bundles[j].vertices.assign(vertices.begin() + cursor, vertices.begin() + cursor + length);
    cursor += length;
    for (std::uint32_t index : bundles[j].vertices) {
      if (index >= vertexCount) reader.fail("vertices", "vertex " + numberText(index) + " does not exist");
    }
  }
  if (cursor != vertices.size()) reader.fail("vertices", "there are more values than the bundles use");
  COIF_TRY(reader.status());
  return bundles;
}

/// A vertex lies on one layer and has one parent: both follow from the bundles, or the file contradicts
/// itself.
Status deriveParents(std::vector<HairVertex>& vertices, const std::vector<Bundle>& bundles) {
  std::vector<std::uint8_t> seen(vertices.size(), 0);
  for (const Bundle& bundle : bundles) {
    for (std::uint32_t layer = 0; layer <= bundle.height(); ++layer) {
      for (std::uint32_t corner = 0; corner < bundle.corners; ++corner) {
        const std::uint32_t index = bundle.face(layer)[corner];
        const std::uint32_t parent = layer == 0 ? kNone : bundle.face(layer - 1)[corner];
        HairVertex& vertex = vertices[index];
        if (seen[index] && (vertex.layer != layer || vertex.parent != parent)) {
          return makeError(ErrorCode::Malformed,
                           "vertex " + numberText(index) +
                               " would have two parents or lie on two layers (bundle " +
                               numberText(std::uint32_t(bundle.id)) + ", layer " + numberText(layer) + ")",
                           "hairMesh.bundles.vertices");
        }
        seen[index] = 1;
        vertex.layer = layer;
        vertex.parent = parent;
      }
    }
  }
  return {};
}

Result<HairMesh> readMesh(JsonReader reader) {
  COIF_ASSIGN(auto vertices, readVertices(reader.object("vertices")));
  COIF_ASSIGN(auto bundles, readBundles(reader.object("bundles"), vertices.size()));
  const auto splitValues = reader.integers("splits");
  auto groupNames = reader.texts("groupNames");
  const auto nextVertexId = std::uint32_t(reader.integer("nextVertexId", 0, 0, kNone));
  const auto nextBundleId = std::uint32_t(reader.integer("nextBundleId", 0, 0, kNone));
  if (splitValues.size() % 3 != 0) reader.fail("splits", "three values an edge are wanted here");
  COIF_TRY(reader.status());
  COIF_TRY(deriveParents(vertices, bundles));
  std::vector<EdgeSplit> splits(splitValues.size() / 3);
  for (std::size_t i = 0; i < splits.size(); ++i) {
    splits[i] = {splitValues[3 * i], splitValues[3 * i + 1], splitValues[3 * i + 2]};
  }
  auto mesh = HairMesh::fromParts(std::move(vertices), std::move(bundles), std::move(splits),
                                  std::move(groupNames), nextVertexId, nextBundleId);
  if (mesh.ok()) return mesh;
  Error error = mesh.error();
  error.code = ErrorCode::Malformed;
  error.place = "hairMesh" + (error.place.empty() ? "" : ", " + error.place);
  return error;
}

StrandSettings readStrands(JsonReader reader) {
  const StrandSettings base;
  StrandSettings out;
  out.count = reader.integer("count", base.count, 0, std::uint64_t{1} << 32);
  out.points = std::uint32_t(reader.integer("points", base.points, 2, 65536));
  out.tolerance = reader.number("tolerance", base.tolerance, 0, 1e30);
  out.seed = reader.integer("seed", base.seed, 0, ~std::uint64_t{0});
  out.width = reader.number("width", base.width, 0, 1e30);
  out.tipWidth = reader.number("tipWidth", base.tipWidth, 0, 1e6);
  const std::string knots = reader.text("knots", kKnotNames[0]);
  for (int i = 0; i < 3; ++i) {
    if (knots == kKnotNames[i]) return out.knots = Knots(i), out;
  }
  reader.fail("knots", "\"uniform\", \"centripetal\" or \"chordal\" is wanted here");
  return out;
}

LookSettings readLook(JsonReader reader) {
  const LookSettings base;
  LookSettings out;
  out.azimuthDeg = reader.number("azimuth", base.azimuthDeg, -1e6, 1e6);
  out.elevationDeg = reader.number("elevation", base.elevationDeg, -90, 90);
  out.hairColor = reader.color("hairColor", base.hairColor);
  out.longitudinalRoughness = reader.number("longitudinalRoughness", base.longitudinalRoughness, 0, 1);
  out.azimuthalRoughness = reader.number("azimuthalRoughness", base.azimuthalRoughness, 0, 1);
  if (!reader.has("light")) return out;
  JsonReader light = reader.object("light");
  LightSettings& l = out.light;
  l.azimuthDeg = light.number("azimuth", l.azimuthDeg, -1e6, 1e6);
  l.elevationDeg = light.number("elevation", l.elevationDeg, -90, 90);
  l.key = light.number("key", l.key, 0, 1000);
  l.fill = light.number("fill", l.fill, 0, 1000);
  l.rim = light.number("rim", l.rim, 0, 1000);
  l.sky = light.number("sky", l.sky, 0, 1000);
  l.followCamera = light.integer("followCamera", l.followCamera, 0, 1) != 0;
  return out;
}

Result<Scene> readScene(const nlohmann::json& json) {
  if (!json.is_object() || !json.contains("format") || json["format"] != kFormat) {
    return makeError(ErrorCode::Malformed, "this is no Coif scene: \"format\": \"coif-scene\" is missing");
  }
  JsonReader reader(json);
  const auto version = reader.integer("version", 0, 1, 1000000);
  COIF_TRY(reader.status());
  if (version > Scene::kVersion) {
    return makeError(ErrorCode::Unsupported,
                     "the scene has version " + numberText(version) + ", and this Coif reads up to version " +
                         numberText(Scene::kVersion) + "; a newer Coif is needed",
                     "version");
  }
  Scene out;
  out.name = reader.text("name", "");
  out.metersPerUnit = reader.number("metersPerUnit", 0.01, 1e-12, 1e12);
  const std::string up = reader.text("upAxis", "Y");
  if (up != "Y" && up != "Z") reader.fail("upAxis", "\"Y\" or \"Z\" is wanted here");
  out.upAxis = up == "Z" ? UpAxis::Z : UpAxis::Y;
  JsonReader head = reader.object("head");
  out.head.path = head.requiredText("path");
  out.head.contentHash = head.integer("contentHash", 0, 0, ~std::uint64_t{0});
  out.placedHash = reader.integer("placedHash", 0, 0, ~std::uint64_t{0});
  if (reader.has("strands")) out.strands = readStrands(reader.object("strands"));
  if (reader.has("styles")) out.styles = scene::readStyles(reader);
  if (reader.has("look")) out.look = readLook(reader.object("look"));
  if (reader.has("dynamics")) out.dynamics = scene::readDynamics(reader.object("dynamics"));
  COIF_TRY(reader.status());
  COIF_ASSIGN(out.hairMesh, readMesh(reader.object("hairMesh")));
  COIF_TRY(reader.status());
  return out;
}

bool isUtf8(const std::string& text) {
  try {
    return !ordered_json(text).dump().empty();
  } catch (const ordered_json::type_error&) {
    return false;
  }
}

}  // namespace

std::string sceneText(const Scene& scene) {
  ordered_json out;
  out["format"] = kFormat;
  out["version"] = Scene::kVersion;
  out["name"] = scene.name;
  out["metersPerUnit"] = scene.metersPerUnit;
  out["upAxis"] = scene.upAxis == UpAxis::Z ? "Z" : "Y";
  out["head"] = {{"path", scene.head.path.generic_string()}, {"contentHash", scene.head.contentHash}};
  const StrandSettings& s = scene.strands;
  out["strands"] = {
      {"count", s.count}, {"points", s.points},     {"tolerance", s.tolerance},         {"seed", s.seed},
      {"width", s.width}, {"tipWidth", s.tipWidth}, {"knots", kKnotNames[int(s.knots)]}};
  out["styles"] = scene::stylesJson(scene.styles);
  const Vec3f& c = scene.look.hairColor;
  out["look"] = {{"azimuth", scene.look.azimuthDeg},
                 {"elevation", scene.look.elevationDeg},
                 {"hairColor", {c[0], c[1], c[2]}},
                 {"longitudinalRoughness", scene.look.longitudinalRoughness},
                 {"azimuthalRoughness", scene.look.azimuthalRoughness}};
  const LightSettings& l = scene.look.light;
  out["look"]["light"] = {{"azimuth", l.azimuthDeg},
                          {"elevation", l.elevationDeg},
                          {"key", l.key},
                          {"fill", l.fill},
                          {"rim", l.rim},
                          {"sky", l.sky},
                          {"followCamera", l.followCamera ? 1 : 0}};
  out["dynamics"] = scene::dynamicsJson(scene.dynamics);
  out["placedHash"] = scene.placedHash;
  out["hairMesh"] = meshJson(scene.hairMesh);
  return out.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

Result<Scene> parseScene(std::string_view text, const std::filesystem::path& path) {
  const std::size_t first = text.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  if (first == std::string_view::npos)
    return makeError(ErrorCode::Malformed, "the file is empty", "", path.string());
  if (text[first] != '{')
    return makeError(ErrorCode::Malformed, "this is no Coif scene: it does not begin with {", "",
                     path.string());
  nlohmann::json json;
  try {
    json =
        nlohmann::json::parse(text.begin(), text.end(), [](int depth, nlohmann::json::parse_event_t, auto&) {
          if (depth > kMaxDepth) throw std::runtime_error("the JSON is nested deeper than any Coif scene");
          return true;
        });
  } catch (const nlohmann::json::parse_error& error) {
    return makeError(ErrorCode::Malformed, "this is not valid JSON (is the file cut off?)",
                     "byte " + numberText(error.byte), path.string());
  } catch (const nlohmann::json::out_of_range&) {
    return makeError(ErrorCode::Malformed, "the JSON holds a number that is too large", "", path.string());
  } catch (const std::exception& error) {
    return makeError(ErrorCode::Malformed, error.what(), "", path.string());
  }
  auto scene = readScene(json);
  if (!scene.ok()) return inFile(scene.error(), path.string());
  scene->file = path;
  return scene;
}

Result<Scene> loadScene(const std::filesystem::path& path) {
  COIF_ASSIGN(const auto bytes, readFile(path, kMaxFileBytes));
  return parseScene({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
}

Status saveScene(Scene& scene, const std::filesystem::path& path) {
  Scene saved = scene;
  if (!scene.head.path.empty()) {
    std::error_code failed;
    const auto absolute = std::filesystem::absolute(scene.headPath(), failed);
    const auto folder = scene::folderOf(std::filesystem::absolute(path, failed));
    const auto relative = std::filesystem::proximate(absolute, folder, failed);
    saved.head.path = failed || relative.empty() ? absolute : relative;
  }
  if (!isUtf8(saved.head.path.native()))
    return makeError(ErrorCode::InvalidArgument,
                     "a scene cannot name this head: its name or folder is not UTF-8; rename it", "",
                     scene.headPath().string());
  saved.file = path;
  const std::string text = sceneText(saved);
  // What could not be opened again must not take the place of what can.
  if (const auto again = parseScene(text, path); !again.ok())
    return makeError(ErrorCode::InvalidArgument, again.error().message, again.error().place, path.string());
  COIF_ASSIGN(auto file, SafeFile::create(path));
  file.write(text);
  COIF_TRY(file.commit());
  scene = std::move(saved);
  return {};
}

}  // namespace coif
