#include "report/report.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/check.h"
#include "core/error.h"
#include "report/embedded.h"

namespace flextip::report {
namespace {

constexpr std::size_t kWords = 40;  // a longer cell of a table is a sentence: its lines break

/// JSON has no word for a number that is not finite; Plotly draws null as a gap.
nlohmann::json Numbers(const std::vector<double>& values) {
  auto list = nlohmann::json::array();
  for (const double v : values) {
    if (std::isfinite(v)) {
      list.push_back(v);
    } else {
      list.push_back(nullptr);
    }
  }
  return list;
}

nlohmann::json TraceJson(const PlotTrace& trace) {
  nlohmann::json json{{"name", trace.name},
                      {"x", Numbers(trace.x)},
                      {"y", Numbers(trace.y)},
                      {"dashed", trace.dashed},
                      {"markers", trace.markers}};
  if (!trace.z.empty()) json["z"] = Numbers(trace.z);
  if (!trace.color.empty()) json["color"] = trace.color;
  return json;
}

/// A "<" in JSON could end the script element that holds it.
std::string WithoutTags(std::string text) {
  for (auto at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

/// What page.js draws.
std::string PlotJson(const Plot& plot) {
  nlohmann::json json{{"x_label", plot.x_label},
                      {"y_label", plot.y_label},
                      {"z_label", plot.z_label},
                      {"log_y", plot.log_y},
                      {"traces", nlohmann::json::array()}};
  for (const auto& trace : plot.traces) {
    FLEXTIP_CHECK(trace.x.size() == trace.y.size(), "as many x as y");
    FLEXTIP_CHECK(trace.z.empty() || trace.z.size() == trace.x.size(), "as many z as x");
    json["traces"].push_back(TraceJson(trace));
  }
  for (const PlotBand& band : plot.bands) {
    json["bands"].push_back({{"from", band.from}, {"to", band.to}, {"color", band.color}});
  }
  return WithoutTags(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::string MimeType(const std::string& bytes) {
  return bytes.starts_with("\xFF\xD8") ? "image/jpeg" : "image/png";
}

std::string Caption(const std::string& text) {
  return text.empty() ? "" : fmt::format("<figcaption>{}</figcaption>\n", EscapeHtml(text));
}

std::string Title(const std::string& text) {
  return text.empty() ? "" : fmt::format("<h3>{}</h3>\n", EscapeHtml(text));
}

std::string Row(const std::vector<std::string>& cells, std::string_view element) {
  std::string html = "<tr>";
  for (const auto& cell : cells) {
    const bool words = element == "td" && cell.size() > kWords;
    html += fmt::format("<{0}{1}>{2}</{0}>", element, words ? " class=\"words\"" : "",
                        EscapeHtml(cell));
  }
  return html + "</tr>\n";
}

}  // namespace

std::string EscapeHtml(const std::string& text) {
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
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string Base64(const std::string& bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) -> unsigned {
      return i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U;
    };
    const unsigned word = byte(0) << 16 | byte(1) << 8 | byte(2);
    out += kDigits[word >> 18];
    out += kDigits[word >> 12 & 63];
    out += i + 1 < bytes.size() ? kDigits[word >> 6 & 63] : '=';
    out += i + 2 < bytes.size() ? kDigits[word & 63] : '=';
  }
  return out;
}

Report::Report(std::string title, std::string subtitle)
    : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

void Report::AddFigures(const std::vector<std::pair<std::string, std::string>>& figures) {
  if (figures.empty()) return;
  body_ += "<dl class=\"figures\">\n";
  for (const auto& [what, value] : figures) {
    body_ +=
        fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", EscapeHtml(what), EscapeHtml(value));
  }
  body_ += "</dl>\n";
}

void Report::AddWarnings(const std::vector<std::string>& warnings) {
  if (warnings.empty()) return;
  body_ += fmt::format("<aside class=\"warnings\"><h3>{} {}</h3>\n<ul>\n", warnings.size(),
                       warnings.size() == 1 ? "warning" : "warnings");
  for (const auto& w : warnings) body_ += fmt::format("<li>{}</li>\n", EscapeHtml(w));
  body_ += "</ul></aside>\n";
}

void Report::AddHeading(const std::string& text) {
  body_ += fmt::format("<h2>{}</h2>\n", EscapeHtml(text));
}

void Report::AddText(const std::string& text) {
  body_ += fmt::format("<p>{}</p>\n", EscapeHtml(text));
}

void Report::AddTable(const Table& table) {
  body_ += "<figure class=\"table\">\n" + Title(table.title) + "<table>\n<thead>" +
           Row(table.header, "th") + "</thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    FLEXTIP_CHECK(row.size() == table.header.size(), "a cell for each column");
    body_ += Row(row, "td");
  }
  body_ += "</tbody></table>\n" + Caption(table.caption) + "</figure>\n";
}

void Report::AddPlot(const Plot& plot) {
  FLEXTIP_CHECK(!has_figures_, "figures are added once");
  has_plots_ = true;
  const bool in_space = !plot.traces.empty() && !plot.traces.front().z.empty();
  body_ += fmt::format(
      "<figure class=\"plot\">\n{}<div class=\"canvas{}\"><script type=\"application/json\">{}"
      "</script></div>\n{}</figure>\n",
      Title(plot.title), in_space ? " space" : "", PlotJson(plot), Caption(plot.caption));
}

void Report::AddFigure(const std::string& title, const std::string& caption,
                       const std::string& json) {
  FLEXTIP_CHECK(!has_plots_, "plots are added once");
  has_figures_ = true;
  body_ += fmt::format(
      "<figure class=\"plot\">\n{}<div class=\"drawing\"><script type=\"application/json\">{}"
      "</script></div>\n{}</figure>\n",
      Title(title), WithoutTags(json), Caption(caption));
}

void Report::AddPictures(
    const std::vector<std::pair<std::string, std::string>>& bytes_and_captions) {
  if (bytes_and_captions.empty()) return;
  body_ += "<div class=\"pictures\">\n";
  for (const auto& [bytes, caption] : bytes_and_captions) {
    body_ += fmt::format("<figure><img alt=\"{}\" src=\"data:{};base64,{}\">\n{}</figure>\n",
                         EscapeHtml(caption), MimeType(bytes), Base64(bytes), Caption(caption));
  }
  body_ += "</div>\n";
}

std::string Report::Html() const {
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += fmt::format("<title>{}</title>\n<style>\n{}</style>\n", EscapeHtml(title_), PageCss());
  html += fmt::format("</head>\n<body>\n<header>\n<h1>{}</h1>\n", EscapeHtml(title_));
  if (!subtitle_.empty()) {
    html += fmt::format("<p class=\"subtitle\">{}</p>\n", EscapeHtml(subtitle_));
  }
  html += "</header>\n<main>\n" + body_ + "</main>\n";
  if (has_plots_)
    html += fmt::format("<script>{}</script>\n<script>\n{}</script>\n", PlotlyJs(), PageJs());
  if (has_figures_)
    html +=
        fmt::format("<script>{}</script>\n<script>\n{}</script>\n", PlotlyFlatJs(), FiguresJs());
  return html + "</body>\n</html>\n";
}

void Report::Write(const std::filesystem::path& path) const {
  const auto part = std::filesystem::path(path.string() + ".part");
  std::ofstream file(part, std::ios::binary);
  file << Html();
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(part, path, error);
  if (!file || error) {
    std::filesystem::remove(part, error);
    throw WorkError(fmt::format("{}: the report cannot be written", path.string()));
  }
}

}  // namespace flextip::report
