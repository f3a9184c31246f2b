#include "values.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
namespace coif::cli {
namespace {

std::string brief(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// Not a number where the text is none, or goes on after it.
double valueOf(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' ? value : std::nan("");
}

CLI::Validator range(double least, double most, bool open, const std::string& words) {
  const auto check = [=](std::string& text) {
    const double value = valueOf(text);
    const bool good = std::isfinite(value) && value <= most && (open ? value > least : value >= least);
    return good ? std::string() : words + " is wanted, not '" + text + "'";
  };
  return CLI::Validator(check, (open ? "(" : "[") + brief(least) + " - " + brief(most) + "]");
}

}  // namespace

CLI::Validator number(double least, double most) {
  return range(least, most, false, "a number from " + brief(least) + " to " + brief(most));
}

CLI::Validator numberAbove0(double most) {
  return range(0, most, true, "a number above 0, " + brief(most) + " at most,");
}

CLI::Validator wholeNumber() {
  const auto check = [](std::string& text) {
    const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
    return digits ? std::string() : "a whole number from 0 is wanted, not '" + text + "'";
  };
  return CLI::Validator(check, "N");
}

CLI::Validator sceneOut() {
  const auto check = [](std::string& text) {
    const bool scene = extensionOf(text) == ".coif";
    return scene ? std::string() : "scenes are .coif files, not '" + text + "'";
  };
  return CLI::Validator(check, "FILE");
}

std::string extensionOf(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return extension;
}

}  // namespace coif::cli
