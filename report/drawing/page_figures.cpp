#include "report/drawing/page_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

using Json = nlohmann::json;

double NumberOf(const Json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::vector<double> NumbersOf(const Json& object, const char* key) {
  std::vector<double> numbers;
  for (const Json& value : object.value(key, Json::array())) numbers.push_back(NumberOf(value));
  return numbers;
}

std::vector<std::string> TextsOf(const Json& object, const char* key) {
  return object.value(key, std::vector<std::string>());
}

FigureTrace TraceOf(const Json& json) {
  static const std::map<std::string, FigureTrace::Kind> kinds{
      {"line", FigureTrace::Kind::kLine},
      {"points", FigureTrace::Kind::kPoints},
      {"bars", FigureTrace::Kind::kBars}};
  FigureTrace trace{.name = json.value("name", ""),
                    .kind = kinds.at(json.value("kind", "line")),
                    .y = NumbersOf(json, "y"),
                    .z = NumbersOf(json, "z"),
                    .y_error = NumbersOf(json, "y_error"),
                    .texts = TextsOf(json, "texts"),
                    .color = json.value("color", ""),
                    .colors = TextsOf(json, "colors"),
                    .symbol = json.value("symbol", ""),
                    .width = json.value("width", 0.0),
                    .dashed = json.value("dashed", false),
                    .arrow = json.value("arrow", false)};
  const Json x = json.value("x", Json::array());
  const bool words =
      !x.empty() && std::all_of(x.begin(), x.end(), [](const Json& v) { return v.is_string(); });
  if (words) {
    trace.labels = x.get<std::vector<std::string>>();
  } else {
    trace.x = NumbersOf(json, "x");
  }
  const std::size_t places = words ? trace.labels.size() : trace.x.size();
  if (places != trace.y.size()) throw std::out_of_range("x and y");
  return trace;
}

FigureField FieldOf(const Json& json) {
  FigureField field{.name = json.value("name", ""),
                    .x = NumbersOf(json, "x"),
                    .y = NumbersOf(json, "y"),
                    .levels = NumbersOf(json, "levels"),
                    .low = NumberOf(json.value("low", Json())),
                    .high = NumberOf(json.value("high", Json())),
                    .cells = json.value("cells", false)};
  for (const Json& row : json.value("values", Json::array())) {
    for (const Json& value : row) field.values.push_back(NumberOf(value));
  }
  if (field.values.size() != field.x.size() * field.y.size()) throw std::out_of_range("values");
  return field;
}

Figure FigureOf(const Json& json) {
  Figure figure{.name = json.value("name", ""),
                .title = json.value("title", ""),
                .caption = json.value("caption", ""),
                .x_label = json.value("x_label", ""),
                .y_label = json.value("y_label", ""),
                .z_label = json.value("z_label", ""),
                .log_x = json.value("log_x", false),
                .log_y = json.value("log_y", false),
                .y_down = json.value("y_down", false),
                .equal_axes = json.value("equal_axes", false),
                .lying_bars = json.value("lying_bars", false)};
  figure.y_names = TextsOf(json, "y_names");
  for (const Json& field : json.value("fields", Json::array())) {
    figure.fields.push_back(FieldOf(field));
  }
  for (const Json& trace : json.value("traces", Json::array())) {
    figure.traces.push_back(TraceOf(trace));
  }
  for (const Json& band : json.value("bands", Json::array())) {
    figure.bands.push_back(
        {NumberOf(band.at("from")), NumberOf(band.at("to")), band.value("color", "#e3e8ed")});
  }
  return figure;
}

/// "Tip error to expect" -> "tip-error-to-expect".
std::string NameFrom(const std::string& title) {
  std::string name;
  for (const char c : title) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) != 0) {
      name += static_cast<char>(std::tolower(letter));
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  return name.empty() ? "figure" : name.substr(0, 60);
}

}  // namespace

Figure ReadFigure(const std::string& text, const std::string& where) {
  try {
    return FigureOf(Json::parse(text));
  } catch (const std::exception&) {  // of the JSON library, and of what is missing in it
    throw InputError::At(where, 0, "holds a figure that cannot be read");
  }
}

std::vector<Figure> FiguresOfPage(const std::filesystem::path& folder) {
  constexpr std::string_view kBegin = "<script type=\"application/json\">", kEnd = "</script>";
  const auto page = folder / "report.html";
  if (!std::filesystem::exists(page)) {
    throw InputError::At(
        folder.string(), 0,
        "no report.html, expected a result folder (flextip report makes the page)");
  }
  const std::string html = ReadBytes(page);
  std::vector<Figure> figures;
  std::set<std::string> names;
  for (std::size_t at = html.find(kBegin); at != std::string::npos; at = html.find(kBegin, at)) {
    at += kBegin.size();
    const std::size_t end = html.find(kEnd, at);
    if (end == std::string::npos) break;
    Figure figure = ReadFigure(html.substr(at, end - at), page.string());
    const std::string name = figure.name.empty() ? NameFrom(figure.title) : figure.name;
    figure.name = name;
    for (int i = 2; !names.insert(figure.name).second; ++i) {
      figure.name = fmt::format("{}-{}", name, i);
    }
    figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace flextip::report
