// Log–log plots as SVG, drawn here: no fonts beyond the viewer's, no scripts.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "bench/bench.h"
#include "bench/bench_text.h"

namespace coif {

namespace {

constexpr double kWidth = 760, kHeight = 460;
constexpr double kLeft = 78, kRight = 560, kTop = 52, kBottom = 402;
constexpr double kLegend = kRight + 38, kLegendLine = 22;
constexpr double kLetter = 7.5;  // more than any 12 px sans-serif takes of a letter in the mean
// Okabe and Ito's colours: told apart by colour-blind readers too; shapes repeat the distinction.
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9",
                                    "#e69f00", "#444444", "#882255", "#117733"};
// An error of exactly 0 has no place on a logarithmic axis; it is drawn here, at double's own precision.
constexpr double kErrorFloor = 1e-17;

struct Axis {
  double low = 0, high = 1;  ///< decades; values themselves where linear
  double from = 0, to = 1;   ///< pixels
  bool linear = false;
  double at(double value) const {
    return from + ((linear ? value : std::log10(value)) - low) / (high - low) * (to - from);
  }
};

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", x);
  return text;
}

std::string decade(int exponent) {
  return "10<tspan dy=\"-5\" font-size=\"9\">" + std::string(exponent < 0 ? "\xe2\x88\x92" : "") +
         std::to_string(std::abs(exponent)) + "</tspan>";
}

std::string text(double x, double y, const std::string& attributes, const std::string& content) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" " + attributes + ">" + content + "</text>\n";
}

std::string line(double x1, double y1, double x2, double y2, const std::string& colour) {
  return "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) + "\" y2=\"" +
         number(y2) + "\" stroke=\"" + colour + "\"/>\n";
}

std::string marker(std::size_t shape, double x, double y, const std::string& colour, const std::string& tip) {
  static constexpr double kOutlines[][8] = {{-4, -4, 4, -4, 4, 4, -4, 4},
                                            {0, -5.5, 5.5, 0, 0, 5.5, -5.5, 0},
                                            {0, -5, 5, 4, 5, 4, -5, 4},
                                            {0, 5, 5, -4, 5, -4, -5, -4}};
  const std::string title = tip.empty() ? "" : "<title>" + tip + "</title>";
  const std::string style = " fill=\"" + colour + "\" stroke=\"#fff\"";
  if (shape % 5 == 0) {
    return "<circle cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"4.5\"" + style + ">" + title +
           "</circle>\n";
  }
  std::string points;
  const double* outline = kOutlines[shape % 5 - 1];
  for (int i = 0; i < 8; i += 2) points += number(x + outline[i]) + "," + number(y + outline[i + 1]) + " ";
  return "<polygon points=\"" + points + "\"" + style + ">" + title + "</polygon>\n";
}

std::vector<std::string> methodsOf(const BenchPlot& plot) {
  std::vector<std::string> methods;
  for (const BenchSample& s : plot.samples) {
    if (std::ranges::find(methods, s.method) == methods.end()) methods.push_back(s.method);
  }
  return methods;
}

double drawn(const BenchPlot& plot, double error) {
  return plot.curves ? error : std::max(error, kErrorFloor);
}

bool drawable(const BenchPlot& plot, const BenchSample& sample) {
  const double x = plot.abscissa(sample);
  return std::isfinite(x) && (plot.curves || x > 0) && std::isfinite(sample.error);
}

void fit(const BenchPlot& plot, Axis& x, Axis& y) {
  double left = HUGE_VAL, right = -HUGE_VAL, good = HUGE_VAL, bad = -HUGE_VAL;
  for (const BenchSample& s : plot.samples) {
    if (!drawable(plot, s)) continue;
    left = std::min(left, plot.abscissa(s));
    right = std::max(right, plot.abscissa(s));
    good = std::min(good, drawn(plot, s.error));
    bad = std::max(bad, drawn(plot, s.error));
  }
  if (!(left <= right)) left = right = 1, good = bad = 1;
  if (plot.curves) {
    x = {left, std::max(right, left + 1e-9), kLeft, kRight, true};
    y = {std::min(0.0, good), std::max(bad, good + 1e-9), kBottom, kTop, true};
    return;
  }
  x = {std::floor(std::log10(left * 0.8)), std::ceil(std::log10(right * 1.2)), kLeft, kRight};
  y = {std::floor(std::log10(good * 0.6)), std::ceil(std::log10(bad * 1.6)), kBottom, kTop};
}

struct Tick {
  double at = 0;  ///< pixels
  std::string label;
};

std::vector<Tick> ticks(const Axis& axis) {
  std::vector<Tick> out;
  if (axis.linear) {
    // 1, 2 or 5 times a power of ten: four to ten of them.
    const double range = axis.high - axis.low, ten = std::pow(10, std::floor(std::log10(range / 4)));
    const double step = ten * (range / ten >= 20 ? 5 : range / ten >= 8 ? 2 : 1);
    for (int i = int(std::ceil(axis.low / step)); i * step <= axis.high + 1e-9 * range; ++i) {
      out.push_back({axis.at(i * step), shortNumber(i * step)});
    }
    return out;
  }
  const int step = axis.high - axis.low > 10 ? 2 : 1;
  for (int e = int(axis.low); e <= int(axis.high); e += step) {
    out.push_back({axis.at(std::pow(10.0, e)), decade(e)});
  }
  return out;
}

std::string grid(const BenchPlot& plot, const Axis& x, const Axis& y) {
  std::string out = "<g font-size=\"11\" fill=\"#555\">\n";
  for (const Tick& t : ticks(x)) {
    out += line(t.at, kTop, t.at, kBottom, "#e3e3e3") +
           text(t.at, kBottom + 18, "text-anchor=\"middle\"", t.label);
  }
  for (const Tick& t : ticks(y)) {
    out += line(kLeft, t.at, kRight, t.at, "#e3e3e3") +
           text(kLeft - 8, t.at + 4, "text-anchor=\"end\"", t.label);
  }
  out += "</g>\n" + line(kLeft, kBottom, kRight, kBottom, "#888") + line(kLeft, kTop, kLeft, kBottom, "#888");
  out += text((kLeft + kRight) / 2, kBottom + 42, "text-anchor=\"middle\" font-size=\"12\" fill=\"#333\"",
              escapeXml(plot.against));
  const std::string label =
      plot.curves ? plot.errorUnit : "error" + (plot.errorUnit.empty() ? "" : " (" + plot.errorUnit + ")");
  out += "<text transform=\"translate(20 " + number((kTop + kBottom) / 2) +
         ") rotate(-90)\" text-anchor=\"middle\" font-size=\"12\" fill=\"#333\">" + escapeXml(label) +
         "</text>\n";
  return out;
}

}  // namespace

std::string benchSvg(const BenchPlot& plot) {
  Axis x, y;
  fit(plot, x, y);
  const std::vector<std::string> methods = methodsOf(plot);
  double width = kWidth;
  for (const std::string& name : methods) width = std::max(width, kLegend + kLetter * double(name.size()));
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(width) + " " +
                    number(kHeight) + "\" font-family=\"system-ui, Helvetica, Arial, sans-serif\">\n";
  out += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  out += text(kLeft, 28, "font-size=\"15\" font-weight=\"600\" fill=\"#222\"", escapeXml(plot.title));
  out += grid(plot, x, y);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const std::string colour = kColours[m % std::size(kColours)];
    std::string path, markers;
    for (const BenchSample& s : plot.samples) {
      if (s.method != methods[m] || !drawable(plot, s)) continue;
      const double px = x.at(plot.abscissa(s)), py = y.at(drawn(plot, s.error));
      std::string tip = s.method;
      for (const auto& [key, value] : s.parameters) tip += ", " + key + " " + value;
      path += (path.empty() ? "M" : "L") + number(px) + " " + number(py);
      if (plot.curves) continue;
      markers +=
          marker(m, px, py, colour,
                 escapeXml(tip + ": error " + shortNumber(s.error) + ", " + shortNumber(s.seconds) + " s"));
    }
    out +=
        "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + colour + "\" stroke-width=\"1.8\"/>\n" + markers;
    const double row = kTop + 10 + kLegendLine * double(m);
    out += marker(m, kRight + 24, row, colour, "") +
           text(kLegend, row + 4, "font-size=\"12\" fill=\"#333\"", escapeXml(methods[m]));
  }
  return out + "</svg>\n";
}

}  // namespace coif
