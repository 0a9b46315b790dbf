#include "report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/check.h"
#include "core/error.h"
#include "recording/text/text.h"
#include "report/embedded/embedded.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

constexpr std::size_t kWords = 40;  // a longer cell of a table is a sentence: its lines break

/// A "<" in JSON could end the script element that holds it.
std::string WithoutTags(std::string text) {
  for (auto at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

/// Fields and bars, which the bundle for paths in space cannot draw.
bool IsFlat(const nlohmann::json& figure) {
  if (!figure.value("fields", nlohmann::json::array()).empty()) return true;
  const auto traces = figure.value("traces", nlohmann::json::array());
  return std::any_of(traces.begin(), traces.end(),
                     [](const auto& trace) { return trace.value("kind", "") == "bars"; });
}

/// A few lying bars are flat: beside a figure of full height they would leave it empty below.
bool IsLying(const nlohmann::json& figure) {
  return figure.is_object() && figure.value("lying_bars", false);
}

bool IsInSpace(const nlohmann::json& figure) {
  const auto traces = figure.value("traces", nlohmann::json::array());
  return std::any_of(traces.begin(), traces.end(),
                     [](const auto& trace) { return trace.contains("z"); });
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

/// What begins like a number, or says that there is none.
bool IsNumber(const std::string& cell) {
  return cell.empty() || std::string_view("0123456789+-.<>(").find(cell[0]) != std::string::npos ||
         cell.starts_with("–") || cell.starts_with("×");
}

/// The class of each column: sentences break their lines, words begin at the left as numbers end at
/// the right.
std::vector<std::string> ColumnClasses(const Table& table) {
  std::vector<std::string> classes(table.header.size());
  for (std::size_t c = 1; c < classes.size(); ++c) {  // the first begins at the left, always
    std::size_t words = 0, longest = 0;
    for (const auto& row : table.rows) {
      words += IsNumber(row[c]) ? 0 : 1;
      longest = std::max(longest, row[c].size());
    }
    if (longest > kWords) {
      classes[c] = "words";
    } else if (2 * words > table.rows.size()) {
      classes[c] = "text";
    }
  }
  return classes;
}

std::string Row(const std::vector<std::string>& cells, const std::vector<std::string>& classes,
                std::string_view element) {
  std::string html = "<tr>";
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const bool is_long = classes[c] == "words" && element == "td" && cells[c].size() > kWords;
    const std::string style = is_long ? "words" : classes[c].empty() ? "" : "text";
    html += fmt::format("<{0}{1}>{2}</{0}>", element,
                        style.empty() ? "" : " class=\"" + style + "\"", EscapeHtml(cells[c]));
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

void Report::AddNumbers(const std::vector<std::pair<std::string, std::string>>& numbers) {
  if (numbers.empty()) return;
  body_ += "<dl class=\"figures\">\n";
  for (const auto& [what, value] : numbers) {
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

void Report::AddBeware(const std::vector<std::pair<std::string, std::string>>& doubts_and_mends) {
  if (doubts_and_mends.empty()) return;
  body_ += "<aside class=\"warnings\"><h3>Beware: the input is doubtful</h3>\n<ul>\n";
  for (const auto& [doubt, mend] : doubts_and_mends) {
    body_ += fmt::format("<li>{}", EscapeHtml(doubt));
    if (!mend.empty()) body_ += fmt::format("<br>Mend: {}", EscapeHtml(mend));
    body_ += "</li>\n";
  }
  body_ += "</ul></aside>\n";
}

void Report::AddHeading(const std::string& text) {
  body_ += fmt::format("<h2>{}</h2>\n", EscapeHtml(text));
}

void Report::AddTable(const Table& table) {
  for (const auto& row : table.rows)
    FLEXTIP_CHECK(row.size() == table.header.size(), "a cell for each column");
  const auto classes = ColumnClasses(table);
  body_ += "<figure class=\"table\">\n" + Title(table.title) + "<table>\n<thead>" +
           Row(table.header, classes, "th") + "</thead>\n<tbody>\n";
  for (const auto& row : table.rows) body_ += Row(row, classes, "td");
  body_ += "</tbody></table>\n" + Caption(table.caption) + "</figure>\n";
}

void Report::AddDrawing(const std::string& title, const std::string& caption,
                        const std::string& json, bool in_space, bool lone) {
  has_figures_ = true;
  has_space_ = has_space_ || in_space;
  FLEXTIP_CHECK(!has_space_ || !has_flat_, "a page has one of the two plotting bundles");
  body_ += fmt::format(
      "<figure class=\"plot{}\">\n{}<div class=\"drawing{}\"><script type=\"application/json\">{}"
      "</script></div>\n{}</figure>\n",
      lone ? " lone" : "", Title(title), in_space ? " space" : "", WithoutTags(json),
      Caption(caption));
}

void Report::AddFigures(const std::vector<Figure>& figures) {
  if (figures.size() > 1) body_ += "<div class=\"drawings\">\n";
  for (const Figure& figure : figures) {
    for (const auto& trace : figure.traces) {
      has_flat_ = has_flat_ || trace.kind == FigureTrace::Kind::kBars;
    }
    has_flat_ = has_flat_ || !figure.fields.empty();
    AddDrawing(figure.title, figure.caption, FigureText(figure), figure.InSpace());
  }
  if (figures.size() > 1) body_ += "</div>\n";
}

void Report::AddFigureFile(const std::filesystem::path& file, const std::string& heading) {
  const auto figures = nlohmann::json::parse(ReadBytes(file), nullptr, false);
  if (!figures.is_array()) throw InputError::At(file.string(), 0, "is not a list of figures");
  if (figures.empty()) return;
  if (!heading.empty()) AddHeading(heading);
  const auto lying = std::count_if(figures.begin(), figures.end(), IsLying);
  body_ += "<div class=\"drawings\">\n";
  for (const auto& figure : figures) {
    if (!figure.is_object()) throw InputError::At(file.string(), 0, "holds what is no figure");
    has_flat_ = has_flat_ || IsFlat(figure);
    AddDrawing(figure.value("title", ""), figure.value("caption", ""), figure.dump(),
               IsInSpace(figure), lying == 1 && IsLying(figure));
  }
  body_ += "</div>\n";
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
  if (!end_.empty()) html += "<footer>\n" + end_ + "</footer>\n";
  html += fmt::format("<script>\n{}</script>\n", TablesJs());
  if (has_figures_) {
    html += fmt::format("<script>{}</script>\n<script>\n{}</script>\n",
                        has_space_ ? PlotlyJs() : PlotlyFlatJs(), FiguresJs());
  }
  return html + "</body>\n</html>\n";
}

void Report::Write(const std::filesystem::path& path) const { WriteTextFile(path, Html()); }

}  // namespace flextip::report
