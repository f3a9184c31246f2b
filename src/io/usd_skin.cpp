#include "usd_skin.h"

#include <algorithm>
#include <numeric>

namespace coif::io::usd {
namespace {

constexpr Type kInts{Base::Int, 1, true}, kFloats{Base::Float, 1, true};

void applySchema(Prim& prim, const char* schema) {
  const auto at = std::find_if(prim.metadata.begin(), prim.metadata.end(),
                               [](const Entry& entry) { return entry.name == "apiSchemas"; });
  if (at == prim.metadata.end()) {
    prim.metadata.insert(prim.metadata.begin(), {"apiSchemas", prependedTokens({schema})});
  } else {
    at->value.strings.push_back(schema);
  }
}

template <class To, class From>
Value spread(const SkinBinding& skin, std::span<const std::uint32_t> rows, Type type,
             const std::vector<From>& values) {
  if (skin.rigid()) return owned(type, std::vector<To>(values.begin(), values.end()));
  std::vector<To> out;
  out.reserve(rows.size() * skin.influences);
  for (const std::uint32_t row : rows) {
    const auto first = values.begin() + std::ptrdiff_t(skin.firstOf(row));
    out.insert(out.end(), first, first + skin.influences);
  }
  return owned(type, std::move(out));
}

}  // namespace

void bindToSkeleton(const SkinBinding& skin, std::span<const std::uint32_t> rows, Prim& prim) {
  applySchema(prim, "SkelBindingAPI");
  const auto primvar = [&](const char* name, const char* typeName, Value value) {
    Attribute attribute = makePrimvar(name, typeName, skin.rigid() ? "constant" : "vertex", std::move(value));
    attribute.metadata.insert(attribute.metadata.begin(),
                              {"elementSize", integer(std::int32_t(skin.influences))});
    prim.attributes.push_back(std::move(attribute));
  };
  primvar("primvars:skel:jointIndices", "int[]", spread<std::int32_t>(skin, rows, kInts, skin.joints));
  primvar("primvars:skel:jointWeights", "float[]", spread<float>(skin, rows, kFloats, skin.weights));
  prim.attributes.push_back(
      makeAttribute("primvars:skel:geomBindTransform", "matrix4d", matrix(skin.bindFromScene)));
  if (!skin.jointNames.empty())
    prim.attributes.push_back(makeUniform("skel:joints", "token[]", tokens(skin.jointNames)));
  prim.relationships.push_back({"skel:skeleton", {skin.skeleton}});
}

void bindVertices(const SkinBinding& skin, std::size_t vertices, Prim& prim) {
  std::vector<std::uint32_t> rows(skin.rigid() ? 0 : vertices);
  std::iota(rows.begin(), rows.end(), 0u);
  bindToSkeleton(skin, rows, prim);
}

bool isPrimPath(std::string_view path) {
  return path.size() > 1 && path.front() == '/' && path.back() != '/' &&
         path.find("//") == std::string_view::npos &&
         path.find_first_of(" .:,;<>{}[]()\"'\\\n\t") == std::string_view::npos;
}

Status checkSkin(const StrandExport& what) {
  const auto fits = [](const SkinBinding& skin, std::size_t elements) {
    const std::size_t size = skin.rigid() ? skin.influences : elements * skin.influences;
    return skin.influences > 0 && skin.joints.size() == size && skin.weights.size() == size;
  };
  if (!isPrimPath(what.skin->strands.skeleton) || !isPrimPath(what.skin->hairMesh.skeleton) ||
      !isPrimPath(what.skin->head.skeleton)) {
    return makeError(ErrorCode::InvalidArgument, "the skin's binding names no skeleton by an absolute path");
  }
  if (fits(what.skin->strands, what.strands->strandCount()) &&
      (what.hairMesh == nullptr || fits(what.skin->hairMesh, what.hairMesh->vertices().size())) &&
      (what.head == nullptr || fits(what.skin->head, what.head->vertexCount()))) {
    return {};
  }
  return makeError(ErrorCode::InvalidArgument, "the skin's binding is of another size than what it moves");
}

}  // namespace coif::io::usd
