#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "reproduction/chapter4/parts.h"

namespace flextip::reproduction {
namespace {

const Eigen::Vector3d kPort(0.28, 0.0, 0.0);
constexpr double kForce_N = 2.0;

enum NoiseCase { kNoiseFree, kInModel, kAsStated, kAveraged, kNoiseCases };
constexpr std::array<const char*, kNoiseCases> kNoiseNames = {
    "noise-free", "noise in the model only", "noise as stated", "noise averaged over 0.5 s"};
enum PlantCase { kBeamPlant, kExactPlant, kPlantCases };
constexpr std::array<const char*, kPlantCases> kPlantNames = {"beam plant", "exact plant"};

Ch4Noise NoiseOf(NoiseCase noise) {
  if (noise == kNoiseFree) return {};
  constexpr int kAveragedSamples = 60;  // of the 120 Hz stream
  return {true, 0.0018, 0.0087, noise != kInModel, noise == kAveraged ? kAveragedSamples : 1};
}

Ch4Plant MakePlant(PlantCase plant) {
  if (plant == kBeamPlant) return Ch4Plant::Beam(Ch4Rod(), kPort, -kForce_N);
  simulation::PlantSetup setup;
  setup.instrument = Ch4Rod();
  setup.p_RP = kPort;
  setup.load.constant_N = {0.0, -kForce_N, 0.0};
  return Ch4Plant::Exact(setup);
}

/// One seed's four moves.
struct Four {
  double max_mm = 0.0, max_y_mm = 0.0, measured_mm = 0.0, updates = 0.0;
  int lost = 0;  // moves whose shaft lost its equilibrium
};

struct Case {
  PlantCase plant;
  NoiseCase noise;
  Ch4Kind kind;
  std::vector<Four> seeds;
};

Ch4Move MoveOf(const Case& c, int direction, std::uint64_t seed) {
  Ch4Move move;
  move.kind = c.kind;
  move.setup.instrument = Ch4Rod();
  move.setup.p_RP = kPort;
  move.move_m = kCh4Moves[direction];
  move.noise = NoiseOf(c.noise);
  // 4.3.1 does not say how near is "reached".
  move.reached_m = c.noise == kNoiseFree ? 5e-5 : 5e-4;
  move.seed = 4 * seed + direction;
  return move;
}

Four RunFour(const Case& c, const Ch4Plant& plant, std::uint64_t seed) {
  Four four;
  for (int direction = 0; direction < 4; ++direction) {
    const Ch4Run run = RunCh4Move(MoveOf(c, direction, seed), plant);
    four.max_mm = std::max(four.max_mm, 1e3 * run.max_m);
    four.measured_mm = std::max(four.measured_mm, 1e3 * run.max_measured_m);
    if (direction >= 2) four.max_y_mm = std::max(four.max_y_mm, 1e3 * run.max_m);
    four.updates += 0.25 * run.updates;
    four.lost += run.lost;
  }
  return four;
}

/// The rod is not tried on the beam: it is not that beam's model, and F_t constant is.
std::vector<Case> AllCases() {
  std::vector<Case> cases;
  for (int plant = 0; plant < kPlantCases; ++plant) {
    for (int noise = 0; noise < kNoiseCases; ++noise) {
      for (const Ch4Kind kind : kCh4Kinds) {
        if (plant == kBeamPlant && kind == Ch4Kind::kRod) continue;
        cases.push_back({static_cast<PlantCase>(plant), static_cast<NoiseCase>(noise), kind, {}});
      }
    }
  }
  return cases;
}

std::vector<Case> RunCases(const ReproduceOptions& options, const ChapterProgress& progress) {
  std::vector<Case> cases = AllCases();
  std::array<Ch4Plant, kPlantCases> plants = {MakePlant(kBeamPlant), MakePlant(kExactPlant)};
  for (Ch4Plant& plant : plants) plant.At(Eigen::Vector3d::Zero());  // warm: copies start there
  std::mutex reporting;
  std::size_t done = 0;
  tbb::parallel_for(std::size_t{0}, cases.size(), [&](std::size_t i) {
    Case& c = cases[i];
    c.seeds.resize(c.noise == kNoiseFree ? 1 : options.quick ? 4 : 200);
    tbb::parallel_for(std::size_t{0}, c.seeds.size(), [&](std::size_t s) {
      c.seeds[s] = RunFour(c, plants[c.plant], 1000 * options.seed + s);
    });
    const std::lock_guard lock(reporting);
    progress(static_cast<double>(++done) / static_cast<double>(cases.size()));
  });
  return cases;
}

std::vector<double> Values(const Case& c, double Four::*member) {
  std::vector<double> values;
  for (const Four& four : c.seeds) values.push_back(four.*member);
  return values;
}

const Case& Find(const std::vector<Case>& cases, PlantCase plant, NoiseCase noise, Ch4Kind kind) {
  return *std::find_if(cases.begin(), cases.end(), [&](const Case& c) {
    return c.plant == plant && c.noise == noise && c.kind == kind;
  });
}

/// What 4.4 and 4.5.1 give for a kind: over all moves, and along y.
std::optional<double> Published(Ch4Kind kind, bool along_y) {
  if (kind == Ch4Kind::kStraight) return along_y ? 0.9 : 1.8;
  if (kind == Ch4Kind::kPrinted || kind == Ch4Kind::kPrintedWithLine) return along_y ? 0.1 : 0.8;
  return {};
}

std::string NoteOf(const Case& c, const MeanSd& stat, std::optional<double> published,
                   double Four::*member) {
  if (c.noise == kNoiseFree) return "";
  std::string note = fmt::format("mean of {} seeds, sd {:.2f}", c.seeds.size(), stat.sd);
  if (published) {
    const std::vector<double> values = Values(c, member);
    const auto below = std::count_if(values.begin(), values.end(),
                                     [&](double v) { return v <= *published + 0.05; });
    note += fmt::format("; {} of them at most the thesis's figure", below);
  }
  int lost = 0;
  for (const Four& four : c.seeds) lost += four.lost;
  if (lost > 0) note += fmt::format("; {} moves ended early, without an equilibrium", lost);
  return note;
}

void AddDeviations(const std::vector<Case>& cases, std::vector<TableRow>& rows) {
  for (const bool along_y : {false, true}) {
    double Four::*const member = along_y ? &Four::max_y_mm : &Four::max_mm;
    for (const Case& c : cases) {
      const MeanSd stat = MeanSdOf(Values(c, member));
      const std::optional<double> published = Published(c.kind, along_y);
      rows.push_back(
          {fmt::format("4.3.1 largest deviation{}, {}, {}, {}", along_y ? " of moves along y" : "",
                       Name(c.kind), kPlantNames[c.plant], kNoiseNames[c.noise]),
           published, stat.mean, "mm", NoteOf(c, stat, published, member)});
    }
  }
}

void AddReadings(const std::vector<Case>& cases, std::vector<TableRow>& rows) {
  for (const Ch4Kind kind : {Ch4Kind::kStraight, Ch4Kind::kPrintedWithLine, Ch4Kind::kRod}) {
    const Case& c = Find(cases, kExactPlant, kAsStated, kind);
    rows.push_back({fmt::format("4.3.1 largest deviation of the measured tip, {}, noise as stated",
                                Name(kind)),
                    Published(kind, false), MeanSdOf(Values(c, &Four::measured_mm)).mean, "mm",
                    "what the controller believes of the tip, over the same runs"});
    rows.push_back(
        {fmt::format("4.3.1 updates a move, {}, noise as stated", Name(kind)),
         {},
         MeanSdOf(Values(c, &Four::updates)).mean,
         "",
         "until the tip is known to be 0.5 mm from the goal, at most 20; the thesis states "
         "no distance"});
  }
  const auto noise_free = [&](Ch4Kind kind) {
    return Find(cases, kExactPlant, kNoiseFree, kind).seeds[0].max_mm;
  };
  rows.push_back(
      {"4.5 reduction of the largest deviation, flexion as printed, phi repaired", 55.0,
       100.0 * (1.0 - noise_free(Ch4Kind::kPrintedWithLine) / noise_free(Ch4Kind::kStraight)), "%",
       "exact plant, noise-free"});
  rows.push_back({"4.5 reduction of the largest deviation, rod",
                  {},
                  100.0 * (1.0 - noise_free(Ch4Kind::kRod) / noise_free(Ch4Kind::kStraight)),
                  "%",
                  "exact plant, noise-free"});
}

/// Where the port is, seen from the tip at the start: the thesis has (-270, 110).
void AddGeometry(std::vector<TableRow>& rows) {
  for (const double length : {0.6, 0.56}) {
    simulation::PlantSetup setup;
    setup.instrument = Ch4Rod();
    setup.instrument.length_m = length;
    setup.p_RP = kPort;
    setup.load.constant_N = {0.0, -kForce_N, 0.0};
    const Eigen::Vector3d tip = Ch4Plant::Exact(setup).At(Eigen::Vector3d::Zero())->p_RE;
    Instrument instrument = setup.instrument;
    const Eigen::Vector3d beam =
        Ch4Plant::Beam(instrument, kPort, -kForce_N).At(Eigen::Vector3d::Zero())->p_RE;
    const std::string of = fmt::format("shaft of {:.0f} mm", 1e3 * length);
    const std::string note = "wrist 280 mm from the port along x, 2 N on the end";
    rows.push_back({"Fig. 4.2 port from the initial tip, x, exact, " + of, -270.0,
                    1e3 * (kPort - tip).x(), "mm", note});
    rows.push_back({"Fig. 4.2 port from the initial tip, y, exact, " + of, 110.0,
                    1e3 * (kPort - tip).y(), "mm", note});
    rows.push_back({"Fig. 4.2 port from the initial tip, x, beam, " + of, -270.0,
                    1e3 * (kPort - beam).x(), "mm", note});
    rows.push_back({"Fig. 4.2 port from the initial tip, y, beam, " + of, 110.0,
                    1e3 * (kPort - beam).y(), "mm", note});
  }
}

constexpr std::array<std::pair<Ch4Kind, const char*>, 3> kDrawn = {
    {{Ch4Kind::kStraight, "#d62728"},
     {Ch4Kind::kPrintedWithLine, "#1f77b4"},
     {Ch4Kind::kRod, "#2ca02c"}}};

report::Figure PathsFigure(std::uint64_t seed) {
  report::Figure figure;
  figure.name = "fig-4-2";
  figure.title = "Four moves of 10 mm by steps (Fig. 4.2)";
  figure.caption =
      "Exact plant, 2 N down on the tip, the port at (-295, 119). The thesis's noise in what "
      "the model is fitted to, not in the tip's error.";
  figure.x_label = "x (mm)";
  figure.y_label = "y (mm)";
  figure.equal_axes = true;
  const Ch4Plant plant = MakePlant(kExactPlant);
  for (const auto& [kind, color] : kDrawn) {
    for (int direction = 0; direction < 4; ++direction) {
      const Case c{kExactPlant, kInModel, kind, {}};
      const Ch4Run run = RunCh4Move(MoveOf(c, direction, seed), plant);
      report::FigureTrace trace = PathTrace(run.p_RE, run.p_RE.front());
      trace.name = direction == 0 ? Name(kind) : "";
      trace.color = color;
      figure.traces.push_back(trace);
      trace.name = "";
      trace.kind = report::FigureTrace::Kind::kPoints;
      figure.traces.push_back(trace);
    }
  }
  return figure;
}

report::FigureTrace Cumulative(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  report::FigureTrace trace;
  for (std::size_t i = 0; i < values.size(); ++i) {
    trace.x.push_back(values[i]);
    trace.y.push_back(static_cast<double>(i + 1) / static_cast<double>(values.size()));
  }
  return trace;
}

report::Figure SeedsFigure(const std::vector<Case>& cases) {
  report::Figure figure;
  figure.name = "fig-4-2-seeds";
  figure.title = "The largest deviation of four moves over 200 seeds";
  figure.caption =
      "Exact plant. Solid: 1.8 mm and 0.0087 rad on every sample. Dashed: 60 samples averaged "
      "for an update. Grey: the thesis's figures, flexion 0.8 and straight 1.8 mm.";
  figure.x_label = "largest deviation (mm)";
  figure.y_label = "share of the seeds below";
  for (const auto& [kind, color] : kDrawn) {
    for (const NoiseCase noise : {kAsStated, kAveraged}) {
      report::FigureTrace trace =
          Cumulative(Values(Find(cases, kExactPlant, noise, kind), &Four::max_mm));
      trace.name = fmt::format("{}{}", Name(kind), noise == kAveraged ? ", averaged" : "");
      trace.color = color;
      trace.dashed = noise == kAveraged;
      figure.traces.push_back(trace);
    }
  }
  for (const double published : {0.8, 1.8}) {
    report::FigureTrace line;
    line.x = {published, published};
    line.y = {0.0, 1.0};
    line.color = "#7f7f7f";
    figure.traces.push_back(line);
  }
  return figure;
}

}  // namespace

ChapterResult Ch4Simulation(const ReproduceOptions& options, const ChapterProgress& progress) {
  const std::vector<Case> cases = RunCases(options, progress);
  ChapterResult chapter;
  AddDeviations(cases, chapter.rows);
  AddReadings(cases, chapter.rows);
  AddGeometry(chapter.rows);
  chapter.figures = {PathsFigure(options.seed), SeedsFigure(cases)};
  return chapter;
}

}  // namespace flextip::reproduction
