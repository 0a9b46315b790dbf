#include "apps/calibrate/budget/output.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/calibrate/verdict_json.h"
#include "recording/streams/series_file.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "report/figure.h"
#include "report/pages.h"

namespace flextip {
namespace {

using Json = nlohmann::json;

std::string Table(const std::vector<TimedBudget>& budgets) {
  std::vector<std::string> columns = {"p_RE_x [m]", "p_RE_y [m]", "p_RE_z [m]"};
  std::vector<std::string> names;
  for (const BudgetPartSize& part : SummariseBudgets(budgets)) names.push_back(part.name);
  for (const std::string& name : names) {
    std::string column = name;
    std::replace(column.begin(), column.end(), ' ', '_');
    columns.push_back(column + "_depth [m]");
    columns.push_back(column + "_across [m]");
  }
  for (const char* column : {"xx", "xy", "xz", "yy", "yz", "zz"}) {
    columns.push_back(fmt::format("total_cov_{} [m2]", column));
  }
  CsvWriter csv(TimedColumns(columns));
  for (const TimedBudget& b : budgets) {
    csv.Add(b.t_ns);
    AddVector3(csv, b.value.p_RE);
    const std::vector<BudgetPart> parts = PartsWithTotal(b.value);
    for (const std::string& name : names) {
      const auto part = std::find_if(parts.begin(), parts.end(),
                                     [&](const BudgetPart& one) { return one.name == name; });
      if (part == parts.end()) {
        csv.AddEmpty(2);
        continue;
      }
      const DepthAndAcross sd = SplitByDepth(part->covariance_R, b.value.depth_R);
      csv.AddOrEmpty(sd.depth_m, 4).AddOrEmpty(sd.across_m, 4);
    }
    const Eigen::Matrix3d C = b.value.TotalCovariance();
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) csv.AddOrEmpty(C(i, j), 6);
    }
    csv.EndRow();
  }
  return csv.text();
}

report::Figure BarFigure(const std::vector<BudgetPartSize>& parts) {
  report::Figure figure;
  figure.name = "budget";
  figure.title = "What contributes to the tip's error";
  figure.caption =
      "Standard deviation, RMS over the frames: along the line of sight, and in the worst "
      "direction across it. Where the force was measured the tracker corrects the bending: then "
      "it is not in the total, and load and stiffness are; else the other way round.";
  figure.y_label = "standard deviation (mm)";
  report::FigureTrace depth{.name = "depth", .kind = report::FigureTrace::Kind::kBars};
  report::FigureTrace across{.name = "across", .kind = report::FigureTrace::Kind::kBars};
  for (const BudgetPartSize& part : parts) {
    depth.labels.push_back(part.name);
    across.labels.push_back(part.name);
    depth.y.push_back(part.depth_mm);
    across.y.push_back(part.across_mm);
  }
  figure.traces = {depth, across};
  return figure;
}

report::Figure TimeFigure(const std::vector<TimedBudget>& budgets,
                          const std::vector<BudgetPartSize>& parts) {
  report::Figure figure;
  figure.name = "budget-over-time";
  figure.title = "Along the line of sight, frame by frame";
  figure.x_label = "time (s)";
  figure.y_label = "standard deviation (mm)";
  for (const BudgetPartSize& shown : parts) {
    report::FigureTrace line{.name = shown.name};
    for (const TimedBudget& b : budgets) {
      for (const BudgetPart& part : PartsWithTotal(b.value)) {
        if (part.name != shown.name) continue;
        line.x.push_back(1e-9 * static_cast<double>(b.t_ns - budgets.front().t_ns));
        line.y.push_back(1e3 * SplitByDepth(part.covariance_R, b.value.depth_R).depth_m);
      }
    }
    figure.traces.push_back(line);
  }
  return figure;
}

}  // namespace

std::string BudgetText(const std::vector<TimedBudget>& budgets) {
  std::string text;
  for (const BudgetPartSize& part : SummariseBudgets(budgets)) {
    text +=
        fmt::format("{:<12} {:8.4f} mm along the line of sight, {:8.4f} mm across{}\n", part.name,
                    part.depth_mm, part.across_mm, part.in_total ? "" : " (not in the total)");
  }
  return text;
}

void WriteBudgetResults(OutputFolder& output, const std::vector<TimedBudget>& budgets,
                        const std::vector<UnknownPart>& not_known, const Json& calibrations) {
  const std::vector<BudgetPartSize> parts = SummariseBudgets(budgets);
  WriteTextFile(output.folder() / "budget.csv", Table(budgets));
  report::WriteFigures(output.folder() / "figures.json",
                       {BarFigure(parts), TimeFigure(budgets, parts)});
  Json list = Json::array(), missing = Json::array();
  for (const BudgetPartSize& part : parts) {
    list.push_back({{"part", part.name},
                    {"depth_mm", part.depth_mm},
                    {"across_mm", part.across_mm},
                    {"in_total", part.in_total}});
  }
  for (const UnknownPart& one : not_known) {
    missing.push_back({{"part", one.part}, {"reason", one.reason}});
    output.Warn(fmt::format("{} is not in the budget: {}", one.part, one.reason));
  }
  output.WriteSummary({{"frames", budgets.size()},
                       {"parts", list},
                       {"not_known", missing},
                       {"verdict", VerdictJson(JudgeBudget(parts, not_known, budgets.size()))},
                       {"advice", BudgetAdvice(parts)},
                       {"calibrations", calibrations}});
  report::WriteCalibrateReport(output.folder());
  output.Commit();
}

}  // namespace flextip
