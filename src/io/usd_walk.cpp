#include "usd_walk.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace coif::io::usd {
namespace {

using Matrix4 = Eigen::Matrix4d;

constexpr std::size_t kPathInMessages = 200;

/// R of "rotateXYZ" and its like: the first letter turns first.
std::optional<Eigen::Matrix3d> rotation(std::string_view axes, const std::vector<double>& degrees) {
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
  if (axes.empty() || axes.size() > 3) return std::nullopt;
  for (const char axis : axes) {
    if (axis < 'X' || axis > 'Z') return std::nullopt;
    const std::size_t component = axes.size() == 1 ? 0 : std::size_t(axis - 'X');
    if (component >= degrees.size()) return std::nullopt;
    const double angleRad = degrees[component] * std::numbers::pi / 180;
    turned = Eigen::AngleAxisd(angleRad, Eigen::Vector3d::Unit(axis - 'X')) * turned;
  }
  return turned;
}

/// One letter at the end of "translateX" or "scaleY"; all three without it.
std::optional<Eigen::Vector3d> axisVector(std::string_view axis, const std::vector<double>& v, double rest) {
  if (axis.empty() && v.size() == 3) return Eigen::Vector3d(v[0], v[1], v[2]);
  if (axis.size() != 1 || axis[0] < 'X' || axis[0] > 'Z' || v.size() != 1) return std::nullopt;
  Eigen::Vector3d out = Eigen::Vector3d::Constant(rest);
  out[axis[0] - 'X'] = v[0];
  return out;
}

std::optional<Matrix4> operation(std::string_view kind, const std::vector<double>& v) {
  Matrix4 m = Matrix4::Identity();
  if (kind == "transform" && v.size() == 16) {
    for (int r = 0; r < 4; ++r) {
      for (int c = 0; c < 4; ++c) m(c, r) = v[std::size_t(4 * r + c)];  // USD's points are rows
    }
  } else if (kind.starts_with("translate")) {
    const auto t = axisVector(kind.substr(9), v, 0);
    if (!t) return std::nullopt;
    m.topRightCorner<3, 1>() = *t;
  } else if (kind.starts_with("scale")) {
    const auto s = axisVector(kind.substr(5), v, 1);
    if (!s) return std::nullopt;
    m.topLeftCorner<3, 3>() = s->asDiagonal();
  } else if (kind.starts_with("rotate")) {
    const auto turned = rotation(kind.substr(6), v);
    if (!turned) return std::nullopt;
    m.topLeftCorner<3, 3>() = *turned;
  } else if (kind == "orient" && v.size() == 4) {
    m.topLeftCorner<3, 3>() = Eigen::Quaterniond(v[0], v[1], v[2], v[3]).normalized().toRotationMatrix();
  } else {
    return std::nullopt;
  }
  return m;
}

bool isInactive(const Prim& prim) {
  const Value* active = find(prim.metadata, "active");
  return active != nullptr && firstNumber(active, 1) == 0;
}

class Walk {
 public:
  Walk(std::string_view typeName, MemoryBudget& budget) : typeName_(typeName), budget_(budget) {}

  Status visit(const Prim& prim, const Placed& parent) {
    if (prim.specifier != Specifier::Def || isInactive(prim)) {
      ++leftOut;
      return {};
    }
    Placed here;
    here.prim = &prim;
    here.path = parent.path + "/" + prim.name;
    if (here.path.size() > kPathInMessages)
      here.path = "..." + here.path.substr(here.path.size() - kPathInMessages);
    here.helper = parent.helper;
    if (const Value* purpose = prim.value("purpose")) {
      here.helper = purpose->text() == "guide" || purpose->text() == "proxy";
    }
    bool resets = false;
    auto local = localTransform(prim, resets);
    if (!local) {
      Error error = local.error();
      error.place = here.path;
      return error;
    }
    here.worldFromPrim = resets ? *local : Matrix4(parent.worldFromPrim * *local);
    if (prim.typeName == typeName_) {
      COIF_TRY(budget_.take(1, sizeof(Placed) + kPathInMessages));
      found.push_back(here);
    }
    if (prim.typeName == "PointInstancer") {
      ++leftOut;
      return {};
    }
    for (const Prim& child : prim.children) COIF_TRY(visit(child, here));
    return {};
  }

  std::vector<Placed> found;
  std::size_t leftOut = 0;

 private:
  std::string_view typeName_;
  MemoryBudget& budget_;
};

}  // namespace

Result<Matrix4> localTransform(const Prim& prim, bool& resets) {
  Matrix4 local = Matrix4::Identity();
  resets = false;
  const Value* order = prim.value("xformOpOrder");
  if (order == nullptr) return local;
  for (std::string_view name : order->strings) {
    if (name == "!resetXformStack!") {
      resets = true;
      local.setIdentity();
      continue;
    }
    const bool invert = name.starts_with("!invert!");
    if (invert) name.remove_prefix(8);
    const Value* value = prim.value(name);
    if (!name.starts_with("xformOp:") || value == nullptr) {
      return makeError(ErrorCode::Malformed, "xformOpOrder names an operation without a value");
    }
    std::string_view kind = name.substr(8);
    kind = kind.substr(0, kind.find(':'));
    const auto m = operation(kind, numbers<double>(*value));
    if (!m) return makeError(ErrorCode::Unsupported, "a transform operation is of an unknown kind");
    local = local * (invert ? Matrix4(m->inverse()) : *m);
  }
  if (!local.allFinite()) return makeError(ErrorCode::Degenerate, "the transform is not finite");
  return local;
}

Result<std::vector<Placed>> placedPrims(const Layer& layer, std::string_view typeName, MemoryBudget& budget,
                                        std::vector<std::string>& notes) {
  Walk walk(typeName, budget);
  for (const Prim& prim : layer.prims) COIF_TRY(walk.visit(prim, Placed()));
  if (walk.leftOut > 0) {
    notes.push_back(std::to_string(walk.leftOut) +
                    " prims that are overrides, classes, inactive or instanced are left out.");
  }
  return std::move(walk.found);
}

double metersPerUnit(const Layer& layer, double otherwise) {
  const double unit = firstNumber(find(layer.metadata, "metersPerUnit"), otherwise);
  return std::isfinite(unit) && unit > 0 ? unit : otherwise;
}

UpAxis upAxis(const Layer& layer) {
  const Value* axis = find(layer.metadata, "upAxis");
  return axis != nullptr && axis->text() == "Z" ? UpAxis::Z : UpAxis::Y;
}

std::vector<float> primvarNumbers(const Prim& prim, const std::string& name, int components) {
  const Value* value = prim.value(name);
  if (value == nullptr || value->type.components != components) return {};
  std::vector<float> values = numbers<float>(*value);
  const Value* indexValue = prim.value(name + ":indices");
  if (indexValue == nullptr) return values;
  const std::vector<std::int64_t> indices = numbers<std::int64_t>(*indexValue);
  const auto count = std::int64_t(values.size()) / components;
  std::vector<float> expanded;
  expanded.reserve(indices.size() * std::size_t(components));
  for (const std::int64_t i : indices) {
    if (i < 0 || i >= count) return {};
    const auto first = values.begin() + i * components;
    expanded.insert(expanded.end(), first, first + components);
  }
  return expanded;
}

std::string_view interpolationOf(const Prim& prim, std::string_view name) {
  const Attribute* a = prim.attribute(name);
  const Value* stated = a == nullptr ? nullptr : find(a->metadata, "interpolation");
  return stated == nullptr ? std::string_view() : stated->text();
}

}  // namespace coif::io::usd
