// The page of flextip predict: both models' errors on a recording that was not fitted.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/diagnose/parts.h"
#include "report/diagnose/residuals.h"
#include "report/diagnose/words.h"
#include "report/pages.h"
#include "report/report.h"
#include "report/result_files.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

using Summary = nlohmann::ordered_json;

void AddErrorBars(Report& report, const ResultTable& residuals) {
  std::vector<ErrorPair> errors;
  for (const auto& channel : ResidualChannels(residuals)) {
    const auto b = ResidualRms(residuals, "base", channel);
    const auto e = ResidualRms(residuals, "extended", channel);
    if (b && e) errors.push_back({SpokenChannel(channel), *b, *e});
  }
  if (errors.empty()) return;
  report.AddFigure(ErrorBars("Error of prediction, in units of noise", errors,
                             "Root mean square over the recording, of which neither model has seen "
                             "anything. What an unknown force on the tip explains is taken out."));
}

void AddErrorTable(Report& report, const Summary& summary) {
  Table table{.title = "By channel",
              .caption =
                  "The tip, when all that measures it is hidden, is a prediction from the "
                  "other sensors.",
              .header = {"channel", "base", "extended", "unit", "ratio"}};
  const auto add = [&](const std::string& name, double b, double e, const std::string& unit) {
    table.rows.push_back(
        {name, Brief(b), Brief(e), unit, b > 0.0 ? fmt::format("{:.2f}", e / b) : "–"});
  };
  const Summary extended = summary.value("extended_rms", Summary::object());
  const Summary base = summary.value("base_rms", Summary::object());
  for (const auto& [channel, rms] : base.items()) {
    if (!extended.contains(channel)) continue;
    const auto unit = ShownUnitOf(channel);
    add(SpokenChannel(channel), unit.per_si * rms.get<double>(),
        unit.per_si * extended[channel].get<double>(), unit.unit);
  }
  const auto add_keys = [&](const std::string& name, const char* b, const char* e, double factor,
                            const std::string& unit) {
    if (summary.contains(b) && summary.contains(e))
      add(name, factor * summary[b].get<double>(), factor * summary[e].get<double>(), unit);
  };
  add_keys("tip, RMS", "base_tip_rms_m", "extended_tip_rms_m", 1e3, "mm");
  add_keys("tip, mean", "base_tip_mean_m", "extended_tip_mean_m", 1e3, "mm");
  add_keys("all, weighted", "base_weighted_rms", "extended_weighted_rms", 1.0, "noise sd");
  if (!table.rows.empty()) report.AddTable(table);
}

void AddMemory(Report& report, const ResultTable& residuals) {
  const auto memory = ResidualMemory(residuals, "extended");
  if (memory.plot.traces.empty()) return;
  report.AddHeading("What is left");
  report.AddFigure(memory.plot);
}

}  // namespace

void WritePredictReport(const std::filesystem::path& folder) {
  const Summary summary = Summary::parse(ReadBytes(folder / "summary.json"));
  const ResultTable residuals = ReadResultTable(folder / "residuals.csv");
  Report report = BeginPage(folder, "Prediction of a recording that was not fitted");
  AddErrorBars(report, residuals);
  AddErrorTable(report, summary);
  if (std::filesystem::exists(folder / "figures.json"))
    report.AddFigureFile(folder / "figures.json", "Joint by joint");
  AddMemory(report, residuals);
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
