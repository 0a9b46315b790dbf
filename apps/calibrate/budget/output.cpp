#include "apps/calibrate/budget/output.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "apps/calibrate/verdict.h"
#include "recording/text/text.h"
#include "report/figure.h"
#include "report/pages.h"

namespace flextip {
namespace {

using nlohmann::json;

constexpr const char* kTotal = "total";

// Root mean square over the frames.
struct PartFigures {
  std::string name;
  double depth_mm = 0.0, across_mm = 0.0;
  bool in_total = true;
  double Length() const { return std::hypot(depth_mm, across_mm); }
};

std::vector<BudgetPart> WithTotal(const TipBudget& budget) {
  std::vector<BudgetPart> parts = budget.parts;
  parts.push_back({kTotal, budget.TotalCovariance(), true});
  return parts;
}

// The largest first, the total last.
std::vector<PartFigures> Figures(const std::vector<TimedBudget>& budgets) {
  std::map<std::string, PartFigures> by_name;
  std::map<std::string, int> frames;
  for (const TimedBudget& b : budgets) {
    for (const BudgetPart& part : WithTotal(b.value)) {
      const DepthAndAcross sd = SplitByDepth(part.covariance_R, b.value.depth_R);
      PartFigures& figures = by_name[part.name];
      figures.name = part.name;
      figures.in_total = part.in_total;
      figures.depth_mm += 1e6 * sd.depth_m * sd.depth_m;
      figures.across_mm += 1e6 * sd.across_m * sd.across_m;
      ++frames[part.name];
    }
  }
  std::vector<PartFigures> sorted;
  for (auto& [name, figures] : by_name) {
    figures.depth_mm = std::sqrt(figures.depth_mm / frames[name]);
    figures.across_mm = std::sqrt(figures.across_mm / frames[name]);
    sorted.push_back(figures);
  }
  std::sort(sorted.begin(), sorted.end(), [](const PartFigures& a, const PartFigures& b) {
    if ((a.name == kTotal) != (b.name == kTotal)) return b.name == kTotal;
    return a.Length() > b.Length();
  });
  return sorted;
}

std::string Table(const std::vector<TimedBudget>& budgets) {
  std::vector<std::string> columns = {"p_RE_x [m]", "p_RE_y [m]", "p_RE_z [m]"};
  std::vector<std::string> names;
  for (const PartFigures& part : Figures(budgets)) names.push_back(part.name);
  for (const std::string& name : names) {
    std::string column = name;
    std::replace(column.begin(), column.end(), ' ', '_');
    columns.push_back(column + "_depth [m]");
    columns.push_back(column + "_across [m]");
  }
  for (const char* column : {"xx", "xy", "xz", "yy", "yz", "zz"}) {
    columns.push_back(fmt::format("total_cov_{} [m2]", column));
  }
  std::string text = fmt::format("#timestamp [ns],{}\n", fmt::join(columns, ","));
  for (const TimedBudget& b : budgets) {
    const Eigen::Vector3d& p = b.value.p_RE;
    text +=
        fmt::format("{},{},{},{}", b.t_ns, NumberText(p.x()), NumberText(p.y()), NumberText(p.z()));
    const std::vector<BudgetPart> parts = WithTotal(b.value);
    for (const std::string& name : names) {
      const auto part = std::find_if(parts.begin(), parts.end(),
                                     [&](const BudgetPart& one) { return one.name == name; });
      if (part == parts.end()) {
        text += ",,";
        continue;
      }
      const DepthAndAcross sd = SplitByDepth(part->covariance_R, b.value.depth_R);
      text += fmt::format(",{:.4g},{:.4g}", sd.depth_m, sd.across_m);
    }
    const Eigen::Matrix3d C = b.value.TotalCovariance();
    text += fmt::format(",{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", C(0, 0), C(0, 1), C(0, 2),
                        C(1, 1), C(1, 2), C(2, 2));
  }
  return text;
}

report::Figure BarFigure(const std::vector<PartFigures>& parts) {
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
  for (const PartFigures& part : parts) {
    depth.labels.push_back(part.name);
    across.labels.push_back(part.name);
    depth.y.push_back(part.depth_mm);
    across.y.push_back(part.across_mm);
  }
  figure.traces = {depth, across};
  return figure;
}

report::Figure TimeFigure(const std::vector<TimedBudget>& budgets,
                          const std::vector<PartFigures>& parts) {
  report::Figure figure;
  figure.name = "budget-over-time";
  figure.title = "Along the line of sight, frame by frame";
  figure.x_label = "time (s)";
  figure.y_label = "standard deviation (mm)";
  for (const PartFigures& shown : parts) {
    report::FigureTrace line{.name = shown.name};
    for (const TimedBudget& b : budgets) {
      for (const BudgetPart& part : WithTotal(b.value)) {
        if (part.name != shown.name) continue;
        line.x.push_back(1e-9 * static_cast<double>(b.t_ns - budgets.front().t_ns));
        line.y.push_back(1e3 * SplitByDepth(part.covariance_R, b.value.depth_R).depth_m);
      }
    }
    figure.traces.push_back(line);
  }
  return figure;
}

// What to improve first: the largest part that is a calibration's.
std::string Advice(const std::vector<PartFigures>& parts) {
  static const std::map<std::string, std::string> kWhatToDo = {
      {"pixels", "the pictures themselves: larger or more tags, nearer, sharper"},
      {"lens", "the lens: calibrate the camera again with the views it asks for"},
      {"hand-eye", "hand-eye: calibrate it again with the motion it asks for"},
      {"tip offset", "the tip's place on the collar: calibrate the tip again, with wider turns"},
      {"bending",
       "the bending beyond the collar: nearer to the tip the collar sees it, or the "
       "force has to be taken into account"},
      {"load", "the force on the tip: measure it better"},
      {"stiffness", "the shaft's stiffness: calibrate it again with the load it asks for"}};
  for (const PartFigures& part : parts) {
    if (!part.in_total || part.name == kTotal) continue;
    return "most is from " + kWhatToDo.at(part.name);
  }
  return {};
}

CalibrationVerdict Verdict(const std::vector<PartFigures>& parts,
                           const std::vector<NotKnown>& not_known, std::size_t frames) {
  CalibrationVerdict verdict;
  verdict.next = Advice(parts);
  for (const PartFigures& part : parts) {
    verdict.Add(part.in_total ? part.name : part.name + " (if bending were corrected)",
                fmt::format("{:.2g} mm in depth, {:.2g} mm across", part.depth_mm, part.across_mm));
  }
  verdict.Add("frames", std::to_string(frames));
  for (const NotKnown& one : not_known) verdict.not_found.push_back({one.part, one.reason});
  const PartFigures& total = parts.back();
  verdict.says =
      fmt::format("The tip is known to {:.2g} mm along the line of sight and {:.2g} mm across it.",
                  total.depth_mm, total.across_mm);
  if (!not_known.empty()) {
    verdict.Beware(Counted(not_known.size(), "part") +
                   " of the chain had no calibration: the truth is worse than this total");
  }
  return verdict;
}

}  // namespace

std::string BudgetText(const std::vector<TimedBudget>& budgets) {
  std::string text;
  for (const PartFigures& part : Figures(budgets)) {
    text +=
        fmt::format("{:<12} {:8.4f} mm along the line of sight, {:8.4f} mm across{}\n", part.name,
                    part.depth_mm, part.across_mm, part.in_total ? "" : " (not in the total)");
  }
  return text;
}

void WriteBudgetResults(OutputFolder& output, const std::vector<TimedBudget>& budgets,
                        const std::vector<NotKnown>& not_known, const json& calibrations) {
  const std::vector<PartFigures> parts = Figures(budgets);
  WriteTextFile(output.folder() / "budget.csv", Table(budgets));
  report::WriteFigures(output.folder() / "figures.json",
                       {BarFigure(parts), TimeFigure(budgets, parts)});
  json list = json::array(), missing = json::array();
  for (const PartFigures& part : parts) {
    list.push_back({{"part", part.name},
                    {"depth_mm", part.depth_mm},
                    {"across_mm", part.across_mm},
                    {"in_total", part.in_total}});
  }
  for (const NotKnown& one : not_known) {
    missing.push_back({{"part", one.part}, {"reason", one.reason}});
    output.Warn(fmt::format("{} is not in the budget: {}", one.part, one.reason));
  }
  output.WriteSummary({{"frames", budgets.size()},
                       {"parts", list},
                       {"not_known", missing},
                       {"verdict", VerdictJson(Verdict(parts, not_known, budgets.size()))},
                       {"advice", Advice(parts)},
                       {"calibrations", calibrations}});
  report::WriteCalibrateReport(output.folder());
  output.Commit();
}

}  // namespace flextip
