#include "report/figure.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/check.h"
#include "core/error.h"
#include "recording/text/text.h"

namespace flextip::report {
namespace {

using Json = nlohmann::json;

/// JSON has no word for a number that is not finite; Plotly draws null as a gap.
Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json Numbers(const std::vector<double>& values) {
  auto list = Json::array();
  for (const double v : values) list.push_back(Number(v));
  return list;
}

const char* Name(FigureTrace::Kind kind) {
  switch (kind) {
    case FigureTrace::Kind::kPoints:
      return "points";
    case FigureTrace::Kind::kBars:
      return "bars";
    case FigureTrace::Kind::kLine:
      break;
  }
  return "line";
}

Json TraceJson(const FigureTrace& trace) {
  FLEXTIP_CHECK((trace.labels.empty() ? trace.x.size() == trace.y.size()
                                      : trace.labels.size() == trace.y.size()),
                "a place or a label for each y");
  FLEXTIP_CHECK(trace.y_error.empty() || trace.y_error.size() == trace.y.size(),
                "an error for each y");
  FLEXTIP_CHECK(trace.texts.empty() || trace.texts.size() == trace.y.size(), "a text for each y");
  FLEXTIP_CHECK(trace.colors.empty() || trace.colors.size() == trace.y.size(),
                "a color for each y");
  Json json{{"name", trace.name}, {"kind", Name(trace.kind)}, {"y", Numbers(trace.y)}};
  if (trace.labels.empty()) {
    json["x"] = Numbers(trace.x);
  } else {
    json["x"] = trace.labels;
  }
  if (!trace.z.empty()) {
    FLEXTIP_CHECK(trace.z.size() == trace.y.size(), "as many z as y");
    json["z"] = Numbers(trace.z);
  }
  if (!trace.y_error.empty()) json["y_error"] = Numbers(trace.y_error);
  if (!trace.texts.empty()) json["texts"] = trace.texts;
  if (!trace.colors.empty()) json["colors"] = trace.colors;
  if (!trace.color.empty()) json["color"] = trace.color;
  if (!trace.symbol.empty()) json["symbol"] = trace.symbol;
  if (trace.width > 0.0) json["width"] = trace.width;
  if (trace.dashed) json["dashed"] = true;
  if (trace.arrow) json["arrow"] = true;
  return json;
}

Json FieldJson(const FigureField& field) {
  const std::size_t columns = field.x.size();
  FLEXTIP_CHECK(field.values.size() == columns * field.y.size(), "a value for each cell");
  auto rows = Json::array();
  for (std::size_t r = 0; r < field.y.size(); ++r) {
    auto row = Json::array();
    for (std::size_t c = 0; c < columns; ++c) row.push_back(Number(field.values[r * columns + c]));
    rows.push_back(std::move(row));
  }
  Json json{
      {"name", field.name},        {"x", Numbers(field.x)},           {"y", Numbers(field.y)},
      {"values", std::move(rows)}, {"levels", Numbers(field.levels)}, {"low", Number(field.low)},
      {"high", Number(field.high)}};
  if (field.cells) json["cells"] = true;
  return json;
}

Json FigureJson(const Figure& figure) {
  Json json{
      {"name", figure.name},       {"title", figure.title},           {"caption", figure.caption},
      {"x_label", figure.x_label}, {"y_label", figure.y_label},       {"log_x", figure.log_x},
      {"log_y", figure.log_y},     {"equal_axes", figure.equal_axes}, {"y_down", figure.y_down},
      {"fields", Json::array()},   {"traces", Json::array()}};
  for (const auto& field : figure.fields) json["fields"].push_back(FieldJson(field));
  for (const auto& trace : figure.traces) json["traces"].push_back(TraceJson(trace));
  if (!figure.z_label.empty()) json["z_label"] = figure.z_label;
  if (figure.lying_bars) json["lying_bars"] = true;
  if (!figure.y_names.empty()) json["y_names"] = figure.y_names;
  for (const auto& band : figure.bands) {
    json["bands"].push_back({{"from", band.from}, {"to", band.to}, {"color", band.color}});
  }
  return json;
}

std::string Text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

FigureTrace Segments(const std::vector<double>& x, const std::vector<double>& y,
                     const std::vector<double>& u, const std::vector<double>& v) {
  FLEXTIP_CHECK(x.size() == y.size() && x.size() == u.size() && x.size() == v.size(),
                "an arrow at each place");
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
  FigureTrace trace;
  for (std::size_t i = 0; i < x.size(); ++i) {
    trace.x.insert(trace.x.end(), {x[i] - 0.5 * u[i], x[i] + 0.5 * u[i], kGap});
    trace.y.insert(trace.y.end(), {y[i] - 0.5 * v[i], y[i] + 0.5 * v[i], kGap});
  }
  return trace;
}

std::string FigureText(const Figure& figure) { return Text(FigureJson(figure)); }

void WriteFigures(const std::filesystem::path& file, const std::vector<Figure>& figures) {
  auto json = Json::array();
  for (const auto& figure : figures) json.push_back(FigureJson(figure));
  WriteTextFile(file, Text(json) + "\n");
}

}  // namespace flextip::report
