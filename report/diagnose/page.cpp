// The page of `flextip diagnose`: a sentence for ten seconds, then what it stands on.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "report/diagnose/discovered.h"
#include "report/diagnose/head.h"
#include "report/diagnose/parts.h"
#include "report/diagnose/recordings.h"
#include "report/diagnose/residuals.h"
#include "report/diagnose/result.h"
#include "report/diagnose/words.h"
#include "report/labels.h"
#include "report/page_end.h"
#include "report/pages.h"
#include "report/report.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

void AddProbabilities(Report& report, const DiagnosedResult& result) {
  std::string credible;
  for (const auto& name : result.credible_set) {
    credible += (credible.empty() ? "" : "; ") + SpokenHypothesis(name);
  }
  Figure answers = ProbabilityBars(result);
  if (!credible.empty()) answers.caption = "90 % lie in: " + credible + ".";
  if (!result.adequate) {
    answers.caption +=
        std::string(answers.caption.empty() ? "" : " ") +
        "All of it holds among the known causes alone: something else is in the data, too.";
  }
  std::vector<Figure> figures;
  for (const Figure& bars : {answers, PresenceBars(result)}) {
    if (!bars.traces.empty()) figures.push_back(bars);
  }
  report.AddFigures(figures);
}

void AddWhatIsWrong(Report& report, const DiagnosedResult& result, const ResultTable& residuals) {
  if (result.signatures.empty()) return;
  report.AddHeading(result.signatures.front().score < kChanceScore
                        ? "The residuals depend on nothing beyond chance"
                        : "What the simulation gets wrong");
  report.AddHtml(HeatMapHtml(result.signatures));
  for (const auto& signature : result.signatures) {  // the strongest that can be drawn
    const auto pattern = SignaturePlot(residuals, signature);
    if (!pattern) continue;
    report.AddHtml("<div class=\"side\">\n");
    report.AddFigure(*pattern);
    if (const auto over_time = TimePlot(residuals, signature)) report.AddFigure(*over_time);
    report.AddHtml("</div>\n");
    return;
  }
}

/// The channels of the file first to last, then those that only the other model has.
std::vector<std::string> ScoredChannels(const DiagnosedResult& result) {
  std::vector<std::string> channels;
  for (const auto* score : {&result.base, &result.extended}) {
    for (const auto& [channel, rms] : score->heldout_rms) {
      if (std::find(channels.begin(), channels.end(), channel) == channels.end())
        channels.push_back(channel);
    }
  }
  return channels;
}

/// Held-out errors in units of noise where the noise is stated; else those of the whole recording.
void AddErrorBars(Report& report, const DiagnosedResult& result, const ResultTable& residuals) {
  std::vector<ErrorPair> heldout, whole;
  for (const auto& channel : ScoredChannels(result)) {
    const auto noise = result.noise_sd.find(channel);
    const auto b = result.base.heldout_rms.find(channel);
    const auto e = result.extended.heldout_rms.find(channel);
    if (noise == result.noise_sd.end() || !(noise->second > 0.0)) continue;
    if (b == result.base.heldout_rms.end() || e == result.extended.heldout_rms.end()) continue;
    heldout.push_back(
        {SpokenChannel(channel), b->second / noise->second, e->second / noise->second});
  }
  for (const auto& channel : ResidualChannels(residuals)) {
    const auto b = ResidualRms(residuals, "base", channel);
    const auto e = ResidualRms(residuals, "extended", channel);
    if (b && e) whole.push_back({SpokenChannel(channel), *b, *e});
  }
  if (!heldout.empty()) {
    report.AddFigure(ErrorBars("Held-out error, in units of noise", heldout,
                               "Root mean square on parts of the recording that were not fitted."));
    return;
  }
  if (whole.empty()) return;
  report.AddFigure(ErrorBars(
      "Error by channel over the whole recording, in units of noise", whole,
      "Root mean square. What the unknown force on the tip explains is taken out, so noise alone "
      "may come to a little less than 1. Errors on parts that were not fitted are in the table."));
}

void AddErrorTable(Report& report, const DiagnosedResult& result) {
  Table table{.title = "On parts of the recording that were not fitted",
              .header = {"channel", "base", "extended", "unit", "ratio"}};
  const auto add = [&](const std::string& name, double b, double e, const std::string& unit) {
    table.rows.push_back(
        {name, Brief(b), Brief(e), unit, b > 0.0 ? fmt::format("{:.2f}", e / b) : "–"});
  };
  for (const auto& channel : ScoredChannels(result)) {
    const auto b = result.base.heldout_rms.find(channel);
    const auto e = result.extended.heldout_rms.find(channel);
    if (b == result.base.heldout_rms.end() || e == result.extended.heldout_rms.end()) continue;
    const auto unit = ShownUnitOf(channel);
    add(SpokenChannel(channel), unit.per_si * b->second, unit.per_si * e->second, unit.unit);
  }
  if (result.base.tip_prediction_rms_m && result.extended.tip_prediction_rms_m) {
    add("tip, from all other sensors", 1e3 * *result.base.tip_prediction_rms_m,
        1e3 * *result.extended.tip_prediction_rms_m, "mm");
  }
  if (result.base.weighted_rms && result.extended.weighted_rms) {
    add("all, weighted", *result.base.weighted_rms, *result.extended.weighted_rms, "noise sd");
  }
  if (!table.rows.empty()) report.AddTable(table);
}

void AddClosedLoop(Report& report, const DiagnosedResult& result) {
  if (!result.closed_loop) return;
  const auto& loop = *result.closed_loop;
  const bool of_arm = !loop.joints.empty() || !loop.notes.empty();
  std::string notes;
  for (const std::string& note : loop.notes) notes += " " + note + ".";
  Table table{.title = "Closed loop: deviation from the desired path",
              .caption = of_arm
                             ? "A simulated arm with what was found, commanded as desired and by "
                               "the feed-forward of its joints: true joints less desired." +
                                   notes
                             : "The controller " + loop.controller +
                                   " on a simulated plant with what was found, with the base model "
                                   "and with the extended one.",
              .header = {"", of_arm ? "as desired" : "base model",
                         of_arm ? "feed-forward" : "extended model"}};
  const auto add = [&](const std::string& name, const auto& before, const auto& after,
                       const std::string& unit) {
    if (before && after) {
      table.rows.push_back(
          {name, Brief(1e3 * *before) + " " + unit, Brief(1e3 * *after) + " " + unit});
    }
  };
  const std::string of = of_arm ? "tip, " : "";
  add(of + "largest", loop.max_before_m, loop.max_after_m, "mm");
  add(of + "root mean square", loop.rms_before_m, loop.rms_after_m, "mm");
  for (const DiagnosedLoopJoint& joint : loop.joints) {
    const std::string name = joint.component.substr(0, joint.component.find('_')),
                      unit = joint.component.ends_with("_rad") ? "mrad" : "mm";
    add(name + ", largest", joint.max_before, joint.max_after, unit);
    add(name + ", root mean square", joint.rms_before, joint.rms_after, unit);
  }
  if (table.rows.empty() && of_arm) table.rows.push_back({"not measured", "–", "–"});
  if (!table.rows.empty()) report.AddTable(table);
}

std::vector<std::vector<std::string>> ParameterRows(
    const std::vector<DiagnosedParameter>& parameters, double least_off) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& p : parameters) {
    for (std::size_t i = 0; i < p.value.size(); ++i) {
      const auto unit = ShownUnitOf(p, i);
      const auto off = p.TolerancesOff(i);
      if (least_off > 0.0 && off.value_or(0.0) <= least_off) continue;
      const std::string component = ComponentName(p, i);
      const double sd = p.sd.empty() ? 0.0 : unit.per_si * p.sd[i];
      rows.push_back(
          {SpokenHypothesis(p.effect), unit.name + (component.empty() ? "" : " " + component),
           WithDeviation(unit.per_si * p.value[i], sd, unit.unit),
           p.tolerance.empty() ? "–" : WithDeviation(unit.per_si * p.tolerance[i], 0.0, unit.unit),
           off ? fmt::format("{:.1f}", *off) : "–"});
    }
  }
  return rows;
}

void AddParameters(Report& report, const DiagnosedResult& result) {
  constexpr double kMoved = 0.5;  // tolerances
  const std::vector<std::string> header{"effect", "parameter", "value ± standard deviation",
                                        "tolerance", "tolerances off"};
  const auto found = ParameterRows(result.parameters, 0.0);
  const auto within = ParameterRows(result.within_tolerance, kMoved);
  if (found.empty() && within.empty()) return;
  report.AddHeading("Parameters of the extended model");
  if (!found.empty()) {
    report.AddTable({.caption = "The tolerance is one standard deviation of what counts as within "
                                "specification; the last column counts in it from nominal.",
                     .header = header,
                     .rows = found});
  }
  if (!within.empty()) {
    report.AddHtml(FoldedTableHtml(
        fmt::format("{} moved within tolerance by more than half a tolerance",
                    within.size() == 1 ? std::string("1 parameter")
                                       : std::to_string(within.size()) + " parameters"),
        header, within));
  }
}

void AddMemory(Report& report, const DiagnosedResult& result, const ResultTable& residuals) {
  auto memory = ResidualMemory(residuals, result.Is("none") ? "base" : "extended");
  if (memory.plot.traces.empty()) return;
  report.AddHeading("What is left");
  std::string list;
  for (const auto& channel : memory.not_white) list += (list.empty() ? "" : ", ") + channel;
  memory.plot.caption =
      list.empty() ? "Autocorrelation of what the model leaves: within the band in every channel, "
                     "as white noise is."
                   : "Autocorrelation of what the model leaves. Clearly outside the band, at its "
                     "largest: " +
                         list +
                         ". There the sensor's own noise remembers, or the model still misses "
                         "something.";
  report.AddFigure(memory.plot);
}

void AddWhatWasGiven(Report& report, const DiagnosedResult& result, const RunSummary& summary,
                     const ResultTable& residuals) {
  report.AddHeading("What it was given");
  Table run{.header = {"", "value"}};
  for (const auto& [name, value] : result.counts) {
    run.rows.push_back({SpokenHypothesis(name), fmt::format("{:.0f}", value)});
  }
  const auto* t = residuals.Column("t_s");
  if (t != nullptr && !t->empty()) {
    run.rows.push_back({"duration", fmt::format("{:.1f} s", t->back() - t->front())});
    if (result.counts.empty()) run.rows.push_back({"samples", std::to_string(t->size())});
  }
  for (const auto& [name, value] : summary.figures) {
    if (name == Label("probability") || name == Label("heldout_error_ratio")) continue;  // results
    const bool said = std::any_of(run.rows.begin(), run.rows.end(),
                                  [&what = name](const auto& row) { return row.front() == what; });
    if (!said) run.rows.push_back({name, value});
  }
  Table noise{.title = "Noise: measured over data sheet", .header = {"channel", "factor"}};
  for (const auto& [channel, factor] : result.noise_scale) {
    noise.rows.push_back({SpokenChannel(channel), fmt::format("{:.2f}", factor)});
  }
  report.AddHtml("<div class=\"side\">\n");
  if (!run.rows.empty()) report.AddTable(run);
  if (!noise.rows.empty()) report.AddTable(noise);
  report.AddHtml("</div>\n");
  if (result.catalogue.empty()) return;
  std::vector<std::vector<std::string>> effects;
  for (const auto& name : result.catalogue) {
    const auto it = result.summaries.find(name);
    effects.push_back({name, it == result.summaries.end() ? "" : it->second});
  }
  report.AddHtml(FoldedTableHtml(
      fmt::format("The catalogue: {} effects that this recording could show", effects.size()),
      {"effect", "what it is"}, effects));
}

}  // namespace

void WriteDiagnoseReport(const fs::path& folder) {
  const auto summary = ReadRunSummary(folder / "summary.json");
  const auto result = ReadDiagnosedResult(folder / "diagnosis.json");
  const auto table = folder / "residuals.csv";
  const auto residuals = fs::exists(table) ? ReadResultTable(table) : ResultTable{};
  const auto headline = MakeHeadline(result);

  Head head = HeadOfDiagnosis(folder, result, headline);
  const bool answered = head.grade != kNoAnswer;
  if (const std::string began = WhatBegan(folder); answered && !began.empty()) {
    head.says = began + head.says;
    head.more.clear();  // of all recordings together, with what began
  }

  Report report("Diagnosis: " + (answered ? headline.title : "no answer"),
                "flextip " + summary.command);
  report.SetEnd(PageEnd(folder));
  report.AddHtml(HeadHtml(head));
  if (answered) AddGainFigures(report, result);
  AddFindings(report, folder);
  AddWarningsNotSaid(report, result, summary, head.reasons);
  if (answered) {
    report.AddHeading("Causes");
    AddProbabilities(report, result);
  }
  AddDiscovered(report, folder, result);
  if (fs::exists(folder / "figures.json"))
    report.AddFigureFile(folder / "figures.json", "Joint by joint");
  AddRounds(report, folder);
  AddRecordings(report, folder);
  AddWhatIsWrong(report, result, residuals);
  report.AddHeading(result.Is("none") || result.Is("unknown") ? "How well the models predict"
                                                              : "What the extended model gains");
  AddErrorBars(report, result, residuals);
  AddErrorTable(report, result);
  AddClosedLoop(report, result);
  AddParameters(report, result);
  AddMemory(report, result, residuals);
  AddWhatWasGiven(report, result, summary, residuals);
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
