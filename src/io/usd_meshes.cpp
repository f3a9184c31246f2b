// The meshes and the material beside the strands, and the names of prims.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "usd_layer.h"

namespace coif::io::usd {
namespace {

constexpr Type kInts{Base::Int, 1, true}, kFloat2s{Base::Float, 2, true}, kFloat3s{Base::Float, 3, true};

struct Faces {
  std::vector<std::int32_t> counts, corners, bundles, layers;
  void add(std::span<const std::uint32_t> face, std::uint32_t bundle, std::uint32_t layer) {
    counts.push_back(std::int32_t(face.size()));
    for (const std::uint32_t v : face) corners.push_back(std::int32_t(v));
    bundles.push_back(std::int32_t(bundle));
    layers.push_back(std::int32_t(layer));
  }
};

Result<Prim> meshPrim(std::string name, const std::vector<Vec3>& positions, std::vector<std::int32_t> counts,
                      std::vector<std::int32_t> corners) {
  std::vector<Vec3f> points;
  points.reserve(positions.size());
  Vec3f lo = Vec3f::Zero(), hi = Vec3f::Zero();
  for (std::size_t v = 0; v < positions.size(); ++v) {
    points.push_back(positions[v].cast<float>());
    if (!points.back().allFinite()) {
      return makeError(ErrorCode::Degenerate, "the position does not fit a float",
                       name + " vertex " + std::to_string(v));
    }
    lo = v == 0 ? points.back() : Vec3f(lo.cwiseMin(points.back()));
    hi = v == 0 ? points.back() : Vec3f(hi.cwiseMax(points.back()));
  }
  Prim prim;
  prim.name = std::move(name);
  prim.typeName = "Mesh";
  prim.attributes.push_back(makeUniform("subdivisionScheme", "token", token("none")));
  prim.attributes.push_back(makeUniform("doubleSided", "bool", boolean(true)));
  prim.attributes.push_back(makeAttribute("extent", "float3[]", owned(kFloat3s, std::vector<Vec3f>{lo, hi})));
  prim.attributes.push_back(makeAttribute("faceVertexCounts", "int[]", owned(kInts, std::move(counts))));
  prim.attributes.push_back(makeAttribute("faceVertexIndices", "int[]", owned(kInts, std::move(corners))));
  prim.attributes.push_back(makeAttribute("points", "point3f[]", owned(kFloat3s, std::move(points))));
  return prim;
}

void addSubsets(const PolygonMesh& mesh, Prim& prim) {
  if (mesh.faceGroups.size() != mesh.faceCount()) return;
  std::vector<std::vector<std::int32_t>> faces(mesh.groupNames.size());
  for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
    if (mesh.faceGroups[f] < faces.size()) faces[mesh.faceGroups[f]].push_back(std::int32_t(f));
  }
  std::vector<std::string> taken;
  for (std::size_t g = 0; g < faces.size(); ++g) {
    if (faces[g].empty()) continue;
    Prim subset;
    subset.name = primName(mesh.groupNames[g], taken);
    subset.typeName = "GeomSubset";
    subset.metadata.push_back({"displayName", string(cleanText(mesh.groupNames[g]))});
    subset.attributes.push_back(makeUniform("elementType", "token", token("face")));
    subset.attributes.push_back(makeUniform("familyName", "token", token("group")));
    subset.attributes.push_back(makeAttribute("indices", "int[]", owned(kInts, std::move(faces[g]))));
    prim.children.push_back(std::move(subset));
  }
  if (!prim.children.empty()) {
    prim.attributes.push_back(makeUniform("subsetFamily:group:familyType", "token", token("nonOverlapping")));
  }
}

Prim shader(std::string name, std::string id) {
  Prim prim;
  prim.name = std::move(name);
  prim.typeName = "Shader";
  prim.attributes.push_back(makeUniform("info:id", "token", token(std::move(id))));
  return prim;
}

/// Bytes of the well-formed UTF-8 character at the front of `text`; 0 when it is broken.
std::size_t utf8Length(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  const std::size_t length = lead < 0x80   ? 1
                             : lead < 0xC2 ? 0
                             : lead < 0xE0 ? 2
                             : lead < 0xF0 ? 3
                             : lead < 0xF5 ? 4
                                           : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) return 0;
  }
  const auto second = static_cast<unsigned char>(length > 1 ? text[1] : 0x80);
  const bool overlong = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
  const bool beyond = (lead == 0xED && second >= 0xA0) || (lead == 0xF4 && second >= 0x90);
  return overlong || beyond ? 0 : length;
}

}  // namespace

std::string cleanText(std::string_view text) {
  std::string clean;
  while (!text.empty()) {
    const std::size_t length = utf8Length(text);
    const auto lead = static_cast<unsigned char>(text[0]);
    const bool printable =
        length > 1 || (length == 1 && ((lead >= 0x20 && lead != 0x7F) || lead == '\n' || lead == '\t'));
    if (printable) clean += text.substr(0, length);
    if (length == 0) clean += '?';
    text.remove_prefix(std::max<std::size_t>(1, length));
  }
  return clean;
}

std::string primName(std::string_view wanted, std::vector<std::string>& taken) {
  std::string base;
  for (const char c : wanted) base += std::isalnum(static_cast<unsigned char>(c)) && c > 0 ? c : '_';
  if (base.empty() || (base[0] >= '0' && base[0] <= '9')) base.insert(0, "_");
  std::string name = base;
  for (int n = 1; std::find(taken.begin(), taken.end(), name) != taken.end(); ++n) {
    name = base + "_" + std::to_string(n);
  }
  taken.push_back(name);
  return name;
}

Attribute makeAttribute(std::string name, std::string typeName, std::optional<Value> value) {
  Attribute attribute;
  attribute.name = std::move(name);
  attribute.typeName = std::move(typeName);
  attribute.value = std::move(value);
  return attribute;
}

Attribute makeUniform(std::string name, std::string typeName, Value value) {
  Attribute attribute = makeAttribute(std::move(name), std::move(typeName), std::move(value));
  attribute.uniform = true;
  return attribute;
}

Attribute makePrimvar(std::string name, std::string typeName, std::string interpolation, Value value) {
  Attribute attribute = makeAttribute(std::move(name), std::move(typeName), std::move(value));
  attribute.metadata.push_back({"interpolation", token(std::move(interpolation))});
  return attribute;
}

Result<Prim> describeHairMesh(const HairMesh& mesh) {
  std::vector<Vec3> positions;
  positions.reserve(mesh.vertices().size());
  for (const HairVertex& vertex : mesh.vertices()) positions.push_back(vertex.position);
  Faces faces;
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t layer = 0; layer <= bundle.height(); ++layer) {
      faces.add(bundle.face(layer), std::uint32_t(bundle.id), layer);
    }
  }
  for (const SideQuad& quad : sideQuads(mesh)) {
    if (!quad.exposed) continue;
    // A side is no bundle's own: -1 in coif:bundle.
    const std::uint32_t ring[] = {quad.a, quad.b, quad.d, quad.c};
    faces.add(ring, kNone, mesh.vertices()[quad.a].layer);
  }
  COIF_ASSIGN(Prim prim, meshPrim("HairMesh", positions, std::move(faces.counts), std::move(faces.corners)));
  prim.attributes.push_back(makeUniform("purpose", "token", token("guide")));
  prim.attributes.push_back(
      makePrimvar("primvars:coif:bundle", "int[]", "uniform", owned(kInts, std::move(faces.bundles))));
  prim.attributes.push_back(
      makePrimvar("primvars:coif:layer", "int[]", "uniform", owned(kInts, std::move(faces.layers))));
  return prim;
}

Result<Prim> describeHead(const PolygonMesh& mesh) {
  COIF_TRY(validate(mesh));
  std::vector<std::int32_t> counts;
  for (std::size_t f = 0; f < mesh.faceCount(); ++f) counts.push_back(std::int32_t(mesh.face(f).size()));
  std::vector<std::int32_t> corners(mesh.corners.begin(), mesh.corners.end());
  COIF_ASSIGN(Prim prim, meshPrim("Head", mesh.positions, std::move(counts), std::move(corners)));
  if (!mesh.cornerUvs.empty()) {
    std::vector<Vec2f> uvs;
    for (const Vec2& uv : mesh.cornerUvs) uvs.push_back(uv.cast<float>());
    prim.attributes.push_back(
        makePrimvar("primvars:st", "texCoord2f[]", "faceVarying", owned(kFloat2s, std::move(uvs))));
  }
  addSubsets(mesh, prim);
  return prim;
}

Prim describeLooks(const std::string& path) {
  Prim surface = shader("Surface", "UsdPreviewSurface");
  Attribute diffuse = makeAttribute("inputs:diffuseColor", "color3f", std::nullopt);
  diffuse.connections = {path + "/Strands/Color.outputs:result"};
  surface.attributes.push_back(std::move(diffuse));
  surface.attributes.push_back(makeAttribute("inputs:roughness", "float", floatValue(0.4f)));
  surface.attributes.push_back(makeAttribute("outputs:surface", "token", std::nullopt));

  Prim color = shader("Color", "UsdPrimvarReader_float3");
  color.attributes.push_back(makeAttribute("inputs:varname", "string", string("displayColor")));
  color.attributes.push_back(makeAttribute("outputs:result", "float3", std::nullopt));

  Prim material;
  material.name = "Strands";
  material.typeName = "Material";
  Attribute out = makeAttribute("outputs:surface", "token", std::nullopt);
  out.connections = {path + "/Strands/Surface.outputs:surface"};
  material.attributes.push_back(std::move(out));
  material.children.push_back(std::move(surface));
  material.children.push_back(std::move(color));

  Prim looks;
  looks.name = "Looks";
  looks.typeName = "Scope";
  looks.children.push_back(std::move(material));
  return looks;
}

}  // namespace coif::io::usd
