// Numbers and text for the writers.
#pragma once

#include <string>

namespace coif {

/// &, <, >, " as entities.
std::string escapeXml(const std::string& text);
/// Three significant digits.
std::string shortNumber(double value);
/// Shortest text that reads back as the same double.
std::string exactNumber(double value);

}  // namespace coif
