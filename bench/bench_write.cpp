#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/bench.h"
#include "bench/bench_text.h"
#include "coif/io/safe_file.h"

namespace coif {

std::string escapeXml(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string shortNumber(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string exactNumber(double value) {
  char text[40];
  return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}

namespace {

std::string quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\n") == std::string::npos) return cell;
  std::string out = "\"";
  for (const char c : cell) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

// Names of the parameters, in the order of their first use.
std::vector<std::string> parameterNames(const BenchPlot& plot) {
  std::vector<std::string> names;
  for (const BenchSample& s : plot.samples) {
    for (const auto& [key, value] : s.parameters) {
      if (std::find(names.begin(), names.end(), key) == names.end()) names.push_back(key);
    }
  }
  return names;
}

// Names of the measures, in the order of their first use.
std::vector<std::string> measureNames(const BenchPlot& plot) {
  std::vector<std::string> names;
  for (const BenchSample& s : plot.samples) {
    for (const auto& [key, value] : s.measures) {
      if (std::find(names.begin(), names.end(), key) == names.end()) names.push_back(key);
    }
  }
  return names;
}

std::string barText(const BenchFigure& f) {
  if (f.kind == Bar::None) return "";
  return (f.kind == Bar::AtMost ? "\xe2\x89\xa4 " : "\xe2\x89\xa5 ") + shortNumber(f.bar);
}

nlohmann::ordered_json machineJson() {
  const BenchMachine m = benchMachine();
  return {{"processor", m.processor}, {"threads", m.threads}, {"system", m.system},
          {"compiler", m.compiler},   {"build", m.build},     {"version", m.version}};
}

constexpr const char* kStyle =
    "body{font:15px/1.5 system-ui,Helvetica,Arial,sans-serif;max-width:860px;margin:2em auto;padding:0 "
    "1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0}th,td{padding:.25em .8em;border-bottom:1px solid "
    "#ddd;text-align:left}"
    "td.n{text-align:right;font-variant-numeric:tabular-nums}svg{width:100%;height:auto;border:1px solid "
    "#eee;"
    "border-radius:6px}.no{color:#b00020;font-weight:600}.yes{color:#00695c}figure{margin:2em 0}"
    "figcaption,.small{color:#666;font-size:13px}";

std::string figureRows(const BenchReport& report) {
  std::string out;
  for (const BenchFigure& f : report.figures) {
    out += "<tr><td>" + escapeXml(f.name) + "</td><td class=\"n\">" + shortNumber(f.value) + " " +
           escapeXml(f.unit) + "</td><td class=\"n\">" + barText(f) + "</td><td>";
    if (f.kind != Bar::None)
      out += f.holds() ? "<span class=\"yes\">holds</span>" : "<span class=\"no\">fails</span>";
    out += "</td></tr>\n";
  }
  return out;
}

Status writeText(const std::filesystem::path& path, const std::string& text) {
  COIF_ASSIGN(SafeFile file, SafeFile::create(path));
  file.write(text);
  return file.commit();
}

}  // namespace

std::string benchCsv(const BenchPlot& plot) {
  const std::vector<std::string> names = parameterNames(plot);
  const std::vector<std::string> measured = measureNames(plot);
  std::string out = "method";
  for (const std::string& name : names) out += "," + quoted(name);
  for (const std::string& name : measured) out += "," + quoted(name);
  out += ",error,seconds,ratio\n";
  for (const BenchSample& s : plot.samples) {
    out += quoted(s.method);
    for (const std::string& name : names) {
      const auto at = std::find_if(s.parameters.begin(), s.parameters.end(),
                                   [&](const auto& p) { return p.first == name; });
      out += "," + (at == s.parameters.end() ? "" : quoted(at->second));
    }
    for (const std::string& name : measured) {
      const auto at =
          std::find_if(s.measures.begin(), s.measures.end(), [&](const auto& m) { return m.first == name; });
      out += "," + (at == s.measures.end() ? "" : exactNumber(at->second));
    }
    out += "," + exactNumber(s.error) + "," + exactNumber(s.seconds) + "," + exactNumber(s.ratio) + "\n";
  }
  return out;
}

std::string benchJson(const std::vector<BenchReport>& reports) {
  // "bars" repeats the promised figures by name, for programs that only ask whether they hold.
  nlohmann::ordered_json out{{"machine", machineJson()},
                             {"bars", nlohmann::ordered_json::object()},
                             {"benches", nlohmann::ordered_json::array()}};
  for (const BenchReport& r : reports) {
    for (const BenchFigure& f : r.figures) {
      if (f.kind == Bar::None) continue;
      out["bars"][r.name + ": " + f.name] = {{"value", f.value}, {"bar", f.bar}, {"holds", f.holds()}};
    }
    nlohmann::ordered_json bench{{"name", r.name},   {"title", r.title},     {"seed", r.seed},
                                 {"quick", r.quick}, {"seconds", r.seconds}, {"holds", r.holds()}};
    for (const BenchFigure& f : r.figures) {
      nlohmann::ordered_json figure{{"name", f.name}, {"value", f.value}, {"unit", f.unit}};
      if (f.kind != Bar::None) {
        figure["bar"] = f.bar;
        figure["kind"] = f.kind == Bar::AtMost ? "at most" : "at least";
      }
      figure["holds"] = f.holds();
      bench["figures"].push_back(figure);
    }
    for (const BenchPlot& p : r.plots) {
      nlohmann::ordered_json plot{
          {"name", p.name}, {"title", p.title}, {"errorUnit", p.errorUnit}, {"truth", p.truth}};
      for (const BenchSample& s : p.samples) {
        nlohmann::ordered_json sample{{"method", s.method}};
        for (const auto& [key, value] : s.parameters) sample["parameters"][key] = value;
        for (const auto& [key, value] : s.measures) sample["measures"][key] = value;
        sample["error"] = s.error;
        sample["seconds"] = s.seconds;
        sample["ratio"] = s.ratio;
        plot["samples"].push_back(sample);
      }
      bench["plots"].push_back(plot);
    }
    out["benches"].push_back(bench);
  }
  return out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string benchHtml(const std::vector<BenchReport>& reports) {
  const BenchMachine m = benchMachine();
  std::string out =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Coif: error against run "
      "time</title><style>";
  out += kStyle;
  out += "</style></head><body>\n<h1>Error against run time</h1>\n<p class=\"small\">Coif " +
         escapeXml(m.version) + " \xc2\xb7 " + escapeXml(m.processor) + ", " + std::to_string(m.threads) +
         " threads \xc2\xb7 " + escapeXml(m.system) + " \xc2\xb7 " + escapeXml(m.compiler) + ", " +
         escapeXml(m.build) +
         "</p>\n<p class=\"small\">Compare ratios, taken within one run; seconds are this machine's.</p>\n";
  for (const BenchReport& r : reports) {
    out += "<h2>" + escapeXml(r.title) + "</h2>\n<p>" + escapeXml(r.about) +
           "</p>\n<p class=\"small\">Seed " + std::to_string(r.seed) + (r.quick ? ", quick run" : "") + ", " +
           shortNumber(r.seconds) + " s in all.</p>\n";
    if (!r.figures.empty()) {
      out += "<table><tr><th>figure</th><th>value</th><th>bar</th><th></th></tr>\n" + figureRows(r) +
             "</table>\n";
    }
    for (const BenchPlot& p : r.plots) {
      out += "<figure>" + benchSvg(p) + "<figcaption>Truth: " + escapeXml(p.truth) + ". Data: <a href=\"" +
             p.name + ".csv\">" + p.name + ".csv</a></figcaption></figure>\n";
    }
  }
  return out + "</body></html>\n";
}

Status writeBench(const std::vector<BenchReport>& reports, const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed)
    return makeError(ErrorCode::Unreadable, "the folder cannot be made: " + failed.message(), {},
                     folder.string());
  for (const BenchReport& r : reports) {
    for (const BenchPlot& p : r.plots) {
      COIF_TRY(writeText(folder / (p.name + ".csv"), benchCsv(p)));
      COIF_TRY(writeText(folder / (p.name + ".svg"), benchSvg(p)));
    }
  }
  COIF_TRY(writeText(folder / "report.html", benchHtml(reports)));
  return writeText(folder / "report.json", benchJson(reports));
}

}  // namespace coif
