// flextip map: how far a controller's motions miss, across a robot's workspace; what errors it
// stands, and paths that avoid them.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/next_step.h"
#include "apps/common/output.h"
#include "apps/map/output.h"
#include "core/error.h"
#include "recording/text/text.h"
#include "report/pages.h"

namespace flextip {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

struct Options {
  std::filesystem::path scenario, out;
  bool force = false;
};

/// The findings, in the order of table.csv and for summary.json.
struct Findings {
  explicit Findings(const std::vector<std::string>& map_columns) : map(map_columns) {}

  CsvWriter table{{"quantity", "value", "unit", "note"}, false};
  nlohmann::json summary;
  std::vector<report::Figure> figures;
  CsvWriter map;

  void Add(const std::string& quantity, double value, const std::string& unit,
           const std::string& note = "") {
    table.Add(quantity).AddOrEmpty(value, 5).Add(unit).Add(note).EndRow();
  }
};

template <int N>
std::string Where(const VectorN<N>& p_m) {
  const VectorN<N> mm = 1000.0 * p_m;
  if constexpr (N == 2)
    return fmt::format("z {:.1f} y {:.1f} mm", mm[0], mm[1]);
  else
    return fmt::format("x {:.1f} y {:.1f} z {:.1f} mm", mm[0], mm[1], mm[2]);
}

template <int N>
nlohmann::json InSpace(const VectorN<N>& p_m) {
  if constexpr (N == 2)
    return {0.0, p_m[1], p_m[0]};
  else
    return {p_m[0], p_m[1], p_m[2]};
}

/// Without any, its maps are empty.
template <int N>
bool HasErrors(const MapSetup<N>& setup) {
  return setup.force || !setup.error.AsVector().isZero(0.0) || setup.gain != 1.0;
}

/// Shares and largest values of a slice.
template <int N>
void Summarise(const MapSetup<N>& setup, const std::string& slice, const WorkspaceMap<N>& map,
               Findings& findings) {
  double norm = 0.0, angle = 0.0;
  std::size_t grows = 0, turns = 0, without = 0;
  for (const auto& at : map.points) {
    if (!at.state) continue;
    if (!at.step.IsUsable() || !at.angle.IsUsable()) {
      ++without;
      continue;
    }
    norm = std::max(norm, at.step.norm);
    angle = std::max(angle, at.angle.phi_max_rad);
    grows += at.step.norm > 1.0 ? 1 : 0;
    turns += at.angle.phi_max_rad > 0.5 * std::numbers::pi ? 1 : 0;
  }
  const double reached = double(map.Reached());
  const double area_cm2 = 1e4 * map.spacing_m * map.spacing_m * reached;
  findings.Add(slice + ": area the tip can reach", area_cm2, "cm2");
  findings.summary["slices"].push_back({{"slice", slice},
                                        {"points", map.Reached()},
                                        {"without_measures", without},
                                        {"area_cm2", area_cm2},
                                        {"largest_norm_G", norm},
                                        {"largest_angle_deg", kDegrees * angle}});
  if (!HasErrors(setup)) return;
  findings.Add(slice + ": part with ||G|| > 1", 100.0 * double(grows) / reached, "%",
               "a step may leave a longer error than it found");
  findings.Add(slice + ": part with the largest angle past 90 deg", 100.0 * double(turns) / reached,
               "%", "no gain converges steadily");
  findings.Add(slice + ": largest ||G||", norm, "");
  findings.Add(slice + ": largest angle", kDegrees * angle, "deg");
}

/// One row for each error that is bounded, with the size that was found.
template <int N>
void AddErrors(const std::string& slice, const BeliefError<N>& error, Findings& findings) {
  const auto v = error.AsVector();
  for (int i = 0; i < BeliefError<N>::kCount; ++i) {
    if (v[i] == 0.0) continue;
    const bool is_angle = i >= N + 2 && i < 2 * N + 2;
    findings.Add(fmt::format("{}: {} of the error that passes it first", slice, ErrorName<N>(i)),
                 (is_angle ? 1.0 : 1000.0) * v[i], is_angle ? "rad" : "mm");
  }
}

template <int N>
void AnswerTolerance(const MapScenario<N>& scenario, Findings& findings, OutputFolder& output) {
  const ToleranceTask<N>& task = *scenario.tolerance;
  for (const auto& [slice, geometry] : scenario.slices) {
    const auto map = ComputeMap(scenario.setup, geometry, task.spacing_m);
    const auto answer = FindTolerance(scenario.setup, map, task.question);
    nlohmann::json entry{
        {"slice", slice}, {"status", Name(answer.status)}, {"points", answer.points}};
    if (answer.status == ToleranceStatus::kOk) {
      entry["scale"] = answer.scale;
      entry["first_at_m"] = InSpace<N>(map.points[answer.point].p_tip);
      findings.Add(slice + ": multiple of the bounds that keeps to the limit", answer.scale, "",
                   fmt::format("first passed at {}", Where<N>(map.points[answer.point].p_tip)));
      AddErrors(slice, answer.first.error, findings);
    } else {
      output.Warn(fmt::format("tolerance, {}: {}", slice, Name(answer.status)));
    }
    findings.summary["tolerance"].push_back(entry);
  }
}

template <int N>
void AddPath(const std::string& name, const Path& path, const Followed<N>& followed,
             Findings& findings) {
  const bool arrived = followed.status == FollowStatus::kOk;
  nlohmann::json entry{{"path", name}, {"status", Name(path.status)}};
  if (path.status == PathStatus::kOk) {
    findings.Add(name + " path: length", 1000.0 * path.length_m, "mm");
    findings.Add(name + " path: largest deviation of the tip", 1000.0 * followed.max_deviation_m,
                 "mm", arrived ? "" : Name(followed.status));
    findings.Add(name + " path: mean deviation of the tip", 1000.0 * followed.mean_deviation_m,
                 "mm", arrived ? "" : Name(followed.status));
    entry.update({{"following", Name(followed.status)},
                  {"length_m", path.length_m},
                  {"max_deviation_m", followed.max_deviation_m},
                  {"mean_deviation_m", followed.mean_deviation_m}});
  }
  findings.summary["plan"].push_back(entry);
}

template <int N>
void AnswerPlan(const MapScenario<N>& scenario, Findings& findings, OutputFolder& output) {
  const PlanTask<N>& task = *scenario.plan;
  const Slice<N>& slice = scenario.slices.front().second;
  const auto map = ComputeMap(scenario.setup, slice, task.options.spacing_m);
  const auto plan = [&](double weight) {
    PlanOptions options = task.options;
    options.weight = weight;
    return PlanMotion(map, slice.InPlane(task.start), slice.InPlane(task.goal), options);
  };
  const auto follow = [&](const Path& path) {
    if (path.status != PathStatus::kOk) return Followed<N>{};
    std::vector<VectorN<N>> points;
    for (const auto& p : path.points) points.push_back(slice.Point(p.x(), p.y()));
    return FollowPath(scenario.setup, points, task.follow);
  };
  const Path direct = plan(0.0), planned = plan(task.options.weight);
  const auto by_direct = follow(direct), by_planned = follow(planned);
  AddPath("shortest", direct, by_direct, findings);
  AddPath("planned", planned, by_planned, findings);
  if (planned.status != PathStatus::kOk) {
    output.Warn(fmt::format("plan: {}", Name(planned.status)));
    return;
  }
  findings.figures.push_back(PlanFigure(map, direct, planned, by_direct, by_planned));
}

/// The maps of all slices, with the worst cases where they are asked for.
template <int N>
void ComputeSlices(const MapScenario<N>& scenario, Findings& findings, OutputFolder& output) {
  for (std::size_t i = 0; i < scenario.slices.size(); ++i) {
    const auto& [name, slice] = scenario.slices[i];
    const std::string prefix = N == 2 ? "" : fmt::format("slice{}-", i + 1);
    const auto map = ComputeMap(scenario.setup, slice, scenario.spacing_m);
    if (map.Reached() == 0) {
      output.Warn(fmt::format("slice {}: the tip reaches no point of it", name));
      continue;
    }
    WorstValues worst;
    if (scenario.tolerance) {
      const auto& bounds = scenario.tolerance->question.bounds;
      worst.norm = WorstOverMap(scenario.setup, map, bounds, Measure::kNorm);
      worst.angle_rad = WorstOverMap(scenario.setup, map, bounds, Measure::kAngle);
    }
    Summarise(scenario.setup, name, map, findings);
    AddMapRows(name, map, worst, findings.map);
    std::vector<report::Figure> figures;
    if (HasErrors(scenario.setup)) figures = MapFigures(scenario.setup, name, prefix, map);
    if (scenario.tolerance) {
      auto more = WorstFigures(scenario.setup, *scenario.tolerance, name, prefix, map, worst);
      std::move(more.begin(), more.end(), std::back_inserter(figures));
    }
    std::move(figures.begin(), figures.end(), std::back_inserter(findings.figures));
  }
}

template <int N>
void RunScenario(const MapScenario<N>& scenario, OutputFolder& output, bool quiet) {
  Findings findings(MapColumns<N>(scenario.tolerance.has_value()));
  ComputeSlices(scenario, findings, output);
  if (scenario.tolerance) AnswerTolerance(scenario, findings, output);
  if (scenario.plan) AnswerPlan(scenario, findings, output);
  WriteTextFile(output.folder() / "map.csv", findings.map.text());
  WriteTextFile(output.folder() / "table.csv", findings.table.text());
  report::WriteFigures(output.folder() / "figures.json", findings.figures);
  output.WriteSummary(findings.summary);
  report::WriteMapReport(output.folder());
  const auto page = output.name() / "report.html";
  output.Commit();
  if (quiet) return;
  fmt::print("{}", findings.table.text());
  PrintNextOf(output.folder());
  fmt::print("{}\n", page.string());
}

void RunMap(const Options& options, const AppContext& context) {
  const AnyMapScenario scenario = ReadMapScenario(options.scenario);
  OutputFolder output(options.out, "map", {.force = options.force, .inputs = {options.scenario}});
  std::visit([&](const auto& of_n) { RunScenario(of_n, output, context.quiet); }, scenario);
}

}  // namespace

void AddMap(CLI::App& app, AppContext& context) {
  auto* command =
      app.add_subcommand("map", "Motion errors across a workspace, tolerances, better paths");
  auto options = std::make_shared<Options>();
  command->add_option("scenario", options->scenario, "Arm, instrument, port and errors (YAML)")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("-o,--output", options->out, "Folder for the results")->required();
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Example:\n  flextip map testdata/maps/thesis.yaml -o maps\n"
      "The keys of a scenario are explained in docs/usage/maps.md.\n");
  OnRun(*command, context, [options, &context] { RunMap(*options, context); });
}

}  // namespace flextip
