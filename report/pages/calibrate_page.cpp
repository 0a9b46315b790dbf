// The page of flextip calibrate, align, collar and board: verdict, figures, pictures, then every
// number.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/diagnose/parts.h"
#include "report/page_parts.h"
#include "report/pages.h"
#include "report/report.h"
#include "report/result_files.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kPictures = 12;
constexpr std::size_t kResiduals = 400;  // rows of residuals.csv that a page shows

std::string TitleOf(const std::string& command) {
  static const std::map<std::string, std::string> titles = {
      {"align", "Clocks"},
      {"board", "Calibration board"},
      {"collar", "Tag collar"},
      {"calibrate budget", "Error budget of the tip"},
      {"calibrate camera", "Camera calibration"},
      {"calibrate em", "EM calibration"},
      {"calibrate hand-eye", "Hand-eye calibration"},
      {"calibrate stereo", "Stereo calibration"},
      {"calibrate stiffness", "Stiffness of the shaft"},
      {"calibrate strain", "Strain gage calibration"},
      {"calibrate tip", "Tip calibration"}};
  const auto it = titles.find(command);
  return it == titles.end() ? "Calibration" : it->second;
}

/// Tells whether the command's result is a thing, which is shown before anything else.
bool IsDrawn(const std::string& command) { return command == "collar" || command == "board"; }

std::string Text(const Json& object, const char* key) {
  return object.contains(key) && object[key].is_string() ? object[key].get<std::string>() : "";
}

std::string ValuesHtml(const Json& values) {
  if (values.empty()) return "";
  std::string html = "<dl class=\"figures found\">\n";
  for (const auto& v : values) {
    const std::string sd = Text(v, "sd");
    html += fmt::format("<div><dt>{}</dt><dd>{}{}</dd></div>\n", EscapeHtml(Text(v, "name")),
                        EscapeHtml(Text(v, "value")),
                        sd.empty() ? "" : fmt::format("<small>± {}</small>", EscapeHtml(sd)));
  }
  return html + "</dl>\n";
}

std::string NotFoundHtml(const Json& list) {
  if (list.empty()) return "";
  std::string html = "<aside class=\"warnings\"><h3>What is not known</h3>\n<ul>\n";
  for (const auto& one : list) {
    html += fmt::format("<li><b>{}</b>: {}</li>\n", EscapeHtml(Text(one, "parameter")),
                        EscapeHtml(Text(one, "reason")));
  }
  return html + "</ul></aside>\n";
}

void AddResiduals(Report& report, const fs::path& file) {
  if (!fs::exists(file)) return;
  const auto table = ReadResultTable(file);
  const std::size_t shown = std::min(kResiduals, table.Rows());
  std::vector<std::vector<std::string>> rows(shown);
  for (std::size_t r = 0; r < shown; ++r) {
    for (const auto& column : table.texts) rows[r].push_back(column[r]);
  }
  const std::string title =
      shown == table.Rows()
          ? fmt::format("residuals.csv ({} rows)", shown)
          : fmt::format("residuals.csv (the first {} of {} rows)", shown, table.Rows());
  report.AddHtml(FoldedTableHtml(title, table.names, rows));
}

}  // namespace

void WriteCalibrateReport(const fs::path& folder) {
  const std::string command = CommandOf(folder);
  Report report = TitledPage(folder, TitleOf(command));
  const Json summary = Json::parse(ReadBytes(folder / "summary.json"));
  const Json verdict = summary.value("verdict", Json::object());
  report.AddHtml(HeadHtml(HeadOf(folder)));
  if (!verdict.empty()) {
    report.AddHtml(ValuesHtml(verdict.value("values", Json::array())));
    report.AddHtml(NotFoundHtml(verdict.value("not_found", Json::array())));
  }
  AddFindings(report, folder);
  report.AddWarnings(WarningsNotSaid(folder));
  auto pictures = PicturesIn(folder, kPictures);
  const auto views = PicturesIn(folder / "overlay", kPictures);
  pictures.insert(pictures.end(), views.begin(), views.end());
  if (IsDrawn(command)) AddPictureFiles(report, "Drawing and print", pictures);
  if (fs::exists(folder / "figures.json")) {
    report.AddHeading(IsDrawn(command) ? "Accuracy to expect" : "Where, and by how much");
    report.AddFigureFile(folder / "figures.json");
  }
  if (!IsDrawn(command)) AddPictureFiles(report, "Pictures", pictures);
  report.AddHeading("All numbers");
  AddSummaryNumbers(report, folder);
  AddSummaryTables(report, folder);
  AddResiduals(report, folder / "residuals.csv");
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
