#include "report/stops/stops.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "report/pages.h"
#include "report/result_files.h"
#include "report/stops/figures.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kPictures = 3;

Json SummaryOf(const fs::path& excerpt) {
  const fs::path file = excerpt / "summary.json";
  Json json = Json::parse(ReadBytes(file), nullptr, false);
  if (!json.is_object() || !json.contains("says") || !json.contains("stop"))
    throw InputError::At(file.string(), 0, "is damaged, expected the summary of an excerpt");
  return json;
}

/// The number before a folder's name: "2_tip_jump".
long NumberOf(const fs::path& excerpt) { return std::atol(excerpt.filename().c_str()); }

void AddPicture(Report& report, const fs::path& excerpt, const std::string& name) {
  const std::vector<Figure> figures = StopPicture(excerpt, name);
  const auto half = static_cast<std::ptrdiff_t>(std::min<std::size_t>(2, figures.size()));
  report.AddFigures({figures.begin(), figures.begin() + half});
  report.AddFigures({figures.begin() + half, figures.end()});
}

std::string Paragraph(const std::string& text) {
  return fmt::format("<p>{}</p>\n", EscapeHtml(text));
}

}  // namespace

std::vector<fs::path> StopsIn(const fs::path& folder) {
  std::vector<fs::path> stops;
  if (fs::is_directory(folder / "stops")) stops = FoldersWith(folder / "stops", "stop.csv");
  std::sort(stops.begin(), stops.end(),
            [](const auto& a, const auto& b) { return NumberOf(a) < NumberOf(b); });
  return stops;
}

std::string StopSays(const fs::path& excerpt) {
  return SummaryOf(excerpt)["says"].get<std::string>();
}

std::vector<Figure> StopPicture(const fs::path& excerpt, const std::string& name) {
  const Json stop = SummaryOf(excerpt)["stop"];
  const StopMarks marks{.at_s = stop.value("at_s", 0.0),
                        .fault_s = stop.value("fault_s", 0.0),
                        .end_s = stop.value("end_s", 0.0),
                        .odd = stop.value("odd", ""),
                        .name = name};
  return StopFigures(ReadStopRows(excerpt / "stop.csv"), marks);
}

void AddStops(Report& report, const fs::path& folder, const std::string& name) {
  const std::vector<fs::path> stops = StopsIn(folder);
  const std::string of = name.empty() ? "" : name + ": ";
  for (std::size_t i = 0; i < std::min(kPictures, stops.size()); ++i) {
    report.AddHeading(stops.size() == 1
                          ? fmt::format("{}What stopped it", of)
                          : fmt::format("{}Stop {} of {}, by weight", of, i + 1, stops.size()));
    const bool in_head = i == 0 && name.empty();
    if (!in_head) report.AddHtml(Paragraph(StopSays(stops[i])));
    AddPicture(report, stops[i], fmt::format("{}stop{}", name.empty() ? "" : name + "-", i + 1));
  }
  if (stops.size() <= kPictures) return;
  report.AddHeading(
      fmt::format("{}{} more stops, without a picture here", of, stops.size() - kPictures));
  std::string list;
  for (std::size_t i = kPictures; i < stops.size(); ++i)
    list += fmt::format("<li>{}</li>\n", EscapeHtml(StopSays(stops[i])));
  report.AddHtml(fmt::format("<ul>\n{}</ul>\n", list));
}

void WriteExcerptReport(const fs::path& folder) {
  Report report = BeginPage(folder, "A stop");
  report.AddHeading("What stopped it");
  AddPicture(report, folder, "stop");
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
