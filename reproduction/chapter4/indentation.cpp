#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>
#include <numeric>

#include "reproduction/chapter4/parts.h"
#include "reproduction/chapter4/press.h"

namespace flextip::reproduction {
namespace {

/// A controller with its sensors, and what 4.4 gives for it (mm).
struct PressTrial {
  std::string name;
  Ch4Kind kind;
  bool strain = false, expects_tissue = true;
  std::optional<double> max_mm = {}, rms_mm = {};
  std::vector<PressRun> runs = {};
};

std::vector<PressTrial> AllTrials() {
  const auto by = [](Ch4Kind kind, bool strain) {
    return fmt::format("{}, {}", Name(kind), strain ? "strain" : "orientations");
  };
  std::vector<PressTrial> trials = {
      {Name(Ch4Kind::kStraight), Ch4Kind::kStraight, false, true, 2.6, 0.76}};
  for (const bool strain : {false, true}) {
    for (const Ch4Kind kind : {Ch4Kind::kPrinted, Ch4Kind::kPrintedWithLine, Ch4Kind::kPortForce,
                               Ch4Kind::kTipForce, Ch4Kind::kRod}) {
      trials.push_back({by(kind, strain), kind, strain});
      if (kind == Ch4Kind::kPrintedWithLine) {
        trials.back().max_mm = strain ? 0.94 : 1.1;
        trials.back().rms_mm = strain ? 0.35 : 0.32;
      }
    }
    trials.push_back(
        {by(Ch4Kind::kRod, strain) + ", block's stiffness left out", Ch4Kind::kRod, strain, false});
  }
  return trials;
}

/// What may limit the paths, changed one at a time; without sensor noise.
struct Change {
  const char* name;
  void (*apply)(PressSetup&);
};
constexpr std::array<Change, 8> kChanges = {{
    {"as it is", [](PressSetup&) {}},
    {"outer loop at 1000 Hz", [](PressSetup& s) { s.outer_hz = 1000.0; }},
    {"a fifth of the arm's inertia", [](PressSetup& s) { s.inertia_scale = 0.2; }},
    {"stiffer joints (kp 40, kd 2)",
     [](PressSetup& s) {
       s.pid.kp_Nm_rad = 40.0;
       s.pid.kd_Nms_rad = 2.0;
     }},
    {"motors that do not feel the shaft, little integral",
     [](PressSetup& s) {
       s.load_on_arm = false;
       s.pid.ki_Nm_rad_s = 0.1;
     }},
    {"block of 34 N/m", [](PressSetup& s) { s.tissue_N_m = 34.0; }},
    {"block of 110 N/m", [](PressSetup& s) { s.tissue_N_m = 110.0; }},
    {"friction 0.1 at the port", [](PressSetup& s) { s.port_friction = 0.1; }},
}};
constexpr std::array<Ch4Kind, 3> kCompared = {Ch4Kind::kStraight, Ch4Kind::kPrintedWithLine,
                                              Ch4Kind::kRod};

struct Results {
  std::vector<PressTrial> trials = AllTrials();
  std::array<std::array<PressRun, kCompared.size()>, kChanges.size()> changed;
};

Results RunAll(const ReproduceOptions& options, const ChapterProgress& progress) {
  Results results;
  const int repeats = options.quick ? 1 : 5;
  for (PressTrial& trial : results.trials) trial.runs.resize(repeats);
  const int trial_jobs = static_cast<int>(results.trials.size()) * repeats;
  const int jobs =
      trial_jobs + (options.quick ? 0 : static_cast<int>(kChanges.size() * kCompared.size()));
  std::mutex reporting;
  int done = 0;
  tbb::parallel_for(0, jobs, [&](int job) {
    PressSetup setup;
    if (job < trial_jobs) {
      PressTrial& trial = results.trials[job / repeats];
      setup.kind = trial.kind;
      setup.strain = trial.strain;
      setup.expects_tissue = trial.expects_tissue;
      setup.seed = 1000 * options.seed + job % repeats;
      trial.runs[job % repeats] = RunPress(setup);
    } else {
      const std::size_t change = (job - trial_jobs) / kCompared.size();
      const std::size_t kind = (job - trial_jobs) % kCompared.size();
      setup.kind = kCompared[kind];
      setup.position_noise_m = setup.angle_noise_rad = 0.0;
      kChanges[change].apply(setup);
      results.changed[change][kind] = RunPress(setup);
    }
    const std::lock_guard lock(reporting);
    progress(static_cast<double>(++done) / jobs);
  });
  return results;
}

double Mean(const PressTrial& trial, double PressRun::*member) {
  std::vector<double> values;
  for (const PressRun& run : trial.runs) values.push_back(run.*member);
  return MeanSdOf(values).mean;
}

double Max(const PressTrial& trial, double PressRun::*member) {
  double largest = 0.0;
  for (const PressRun& run : trial.runs) largest = std::max(largest, run.*member);
  return largest;
}

double Seconds(const PressTrial& trial) {
  return Mean(trial, &PressRun::down_s) + Mean(trial, &PressRun::up_s);
}

double StraightShare(const PressTrial& trial) {
  double straight = 0.0, all = 0.0;
  for (const PressRun& run : trial.runs) {
    straight += trial.kind == Ch4Kind::kStraight ? 0 : run.straight_instead;
    all += static_cast<double>(run.p_RE.size());
  }
  return straight / all;
}

void AddTrials(const std::vector<PressTrial>& trials, std::vector<TableRow>& rows) {
  for (const PressTrial& trial : trials) {
    const auto unfinished = std::count_if(trial.runs.begin(), trial.runs.end(),
                                          [](const PressRun& run) { return !run.finished; });
    std::string note = unfinished > 0 ? fmt::format("{} of {} trials did not finish; ", unfinished,
                                                    trial.runs.size())
                                      : "";
    note += fmt::format("{:.0f} % of the updates by the straight shaft, for want of flexion to fit",
                        100.0 * StraightShare(trial));
    rows.push_back({"4.4 dynamic, largest deviation, " + trial.name, trial.max_mm,
                    1e3 * Max(trial, &PressRun::max_m), "mm", note});
    rows.push_back({"4.4 dynamic, mean RMS deviation, " + trial.name, trial.rms_mm,
                    1e3 * Mean(trial, &PressRun::rms_m), "mm", note});
  }
}

void AddTimes(const std::vector<PressTrial>& trials, std::vector<TableRow>& rows) {
  const auto find = [&](Ch4Kind kind) {
    return *std::find_if(trials.begin(), trials.end(),
                         [&](const PressTrial& t) { return t.kind == kind; });
  };
  const PressTrial straight = find(Ch4Kind::kStraight), printed = find(Ch4Kind::kPrintedWithLine),
                   rod = find(Ch4Kind::kRod);
  rows.push_back(
      {"4.4 seconds a dynamic trial, straight", 2.0, Seconds(straight), "s",
       "the PID's gains are chosen for this and for an upstroke without overshoot, as 4.5.2 says"});
  rows.push_back({"4.4 seconds a dynamic trial, flexion as printed, phi repaired", 2.0,
                  Seconds(printed), "s"});
  rows.push_back({"4.4 seconds a dynamic trial, rod",
                  {},
                  Seconds(rod),
                  "s",
                  "it expects the block to push back, so it asks for more"});
  rows.push_back({"4.5.2 share of the trials whose largest deviation is on the way up", 1.0,
                  [&] {
                    double up = 0.0, all = 0.0;
                    for (const PressTrial& trial : trials) {
                      for (const PressRun& run : trial.runs) {
                        up += run.max_up_m > run.max_down_m;
                        all += 1.0;
                      }
                    }
                    return up / all;
                  }(),
                  "", "all controllers"});
  rows.push_back({"4.5 dynamic, reduction of the largest deviation", 55.0,
                  100.0 * (1.0 - Max(printed, &PressRun::max_m) / Max(straight, &PressRun::max_m)),
                  "%", "flexion as printed, phi repaired, orientations"});
  rows.push_back(
      {"4.3.2 force on the tip, largest",
       {},
       Max(straight, &PressRun::peak_force_N),
       "N",
       "79 N/m: a side of 2.38 x 10 mm pressed into 10.8 kPa (1.13 E / (1 - nu^2) sqrt(A))"});
  rows.push_back({"4.3.2 tip beside a straight shaft's, largest",
                  {},
                  1e3 * Max(straight, &PressRun::peak_flexion_m),
                  "mm"});
}

void AddChanges(const Results& results, std::vector<TableRow>& rows) {
  for (std::size_t c = 0; c < kChanges.size(); ++c) {
    for (std::size_t k = 0; k < kCompared.size(); ++k) {
      const PressRun& run = results.changed[c][k];
      rows.push_back({fmt::format("4.5.2 largest deviation without noise, {}, {}",
                                  Name(kCompared[k]), kChanges[c].name),
                      {},
                      1e3 * run.max_m,
                      "mm",
                      fmt::format("RMS {:.2f} mm, {:.1f} s{}", 1e3 * run.rms_m,
                                  run.down_s + run.up_s, run.finished ? "" : ", not finished")});
    }
  }
}

/// The trial whose mean squared deviation is the median.
const PressRun& MedianRun(const PressTrial& trial) {
  std::vector<std::size_t> order(trial.runs.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return trial.runs[a].rms_m < trial.runs[b].rms_m;
  });
  return trial.runs[order[order.size() / 2]];
}

report::Figure PathsFigure(const std::vector<PressTrial>& trials) {
  report::Figure figure;
  figure.name = "fig-4-4";
  figure.title = "Indentation of silicone, down and back (Fig. 4.4)";
  figure.caption =
      "Of five trials the one with the median mean squared deviation. The block's surface is "
      "at y = 0, the port at (-300, -15). The axes are scaled differently.";
  figure.x_label = "x (mm)";
  figure.y_label = "y (mm)";
  const std::vector<std::pair<std::size_t, const char*>> drawn = [&] {
    std::vector<std::pair<std::size_t, const char*>> found;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      const PressTrial& t = trials[i];
      if (t.kind == Ch4Kind::kStraight) found.emplace_back(i, "#d62728");
      if (t.kind == Ch4Kind::kPrintedWithLine)
        found.emplace_back(i, t.strain ? "#9467bd" : "#1f77b4");
      if (t.kind == Ch4Kind::kRod && !t.strain && t.expects_tissue)
        found.emplace_back(i, "#2ca02c");
    }
    return found;
  }();
  for (const auto& [i, color] : drawn) {
    const PressRun& run = MedianRun(trials[i]);
    report::FigureTrace trace = PathTrace(run.p_RE, run.p_start);
    trace.name = trials[i].name;
    trace.color = color;
    figure.traces.push_back(trace);
  }
  return figure;
}

report::Figure DepthFigure(const std::vector<PressTrial>& trials) {
  report::Figure figure;
  figure.name = "fig-4-4-time";
  figure.title = "Depth of the tip during a trial";
  figure.caption =
      "One trial each. The way down slows as the block pushes back; the integral brings the rest.";
  figure.x_label = "time (s)";
  figure.y_label = "y (mm)";
  for (const PressTrial& trial : trials) {
    if (trial.strain || !trial.expects_tissue || trial.kind == Ch4Kind::kPrinted ||
        trial.kind == Ch4Kind::kPortForce) {
      continue;
    }
    const PressRun& run = trial.runs.front();
    report::FigureTrace trace = PathTrace(run.p_RE, run.p_start);
    trace.x = run.t_s;
    trace.name = trial.name;
    figure.traces.push_back(trace);
  }
  return figure;
}

}  // namespace

ChapterResult Ch4Indentation(const ReproduceOptions& options, const ChapterProgress& progress) {
  const Results results = RunAll(options, progress);
  ChapterResult chapter;
  AddTrials(results.trials, chapter.rows);
  AddTimes(results.trials, chapter.rows);
  if (!options.quick) AddChanges(results, chapter.rows);
  chapter.figures = {PathsFigure(results.trials), DepthFigure(results.trials)};
  return chapter;
}

}  // namespace flextip::reproduction
