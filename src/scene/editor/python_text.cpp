// Commands as lines of Python.
#include <cstdio>

#include "coif/scene/command.h"

namespace coif {
namespace {

std::string text(double value) {
  char buffer[40];
  for (int digits : {15, 16, 17}) {  // the shortest that reads back as the same number
    std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
    if (std::strtod(buffer, nullptr) == value) break;
  }
  return buffer;
}

std::string quoted(const std::string& value) {
  std::string out = "\"";
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (byte < 0x20) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\x%02x", byte);
      out += escape;
    } else {
      out += c;
    }
  }
  return out + "\"";
}

struct PythonValue {
  std::string operator()(bool value) const { return value ? "True" : "False"; }
  std::string operator()(double value) const { return text(value); }
  std::string operator()(const std::string& value) const { return quoted(value); }
  std::string operator()(const Vec3& v) const {
    return "(" + text(v.x()) + ", " + text(v.y()) + ", " + text(v.z()) + ")";
  }
  std::string operator()(const std::vector<double>& values) const {
    std::string out = "[";
    for (double value : values) out += (out.size() > 1 ? ", " : "") + text(value);
    return out + "]";
  }
};

}  // namespace

std::string pythonLine(std::string_view command, const CommandArguments& arguments) {
  std::string line = "editor." + std::string(command) + "(";
  bool first = true;
  for (const auto& [name, value] : arguments) {
    line += (first ? "" : ", ") + name + "=" + std::visit(PythonValue{}, value);
    first = false;
  }
  return line + ")";
}

}  // namespace coif
