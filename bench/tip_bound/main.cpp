// The Cramer-Rao bound of the tip in rendered frames, and how near the tracker comes.
#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/tip_bound/fisher.h"
#include "bench/tip_bound/measure.h"
#include "bench/tool.h"

namespace flextip::bench {
namespace {

struct Arguments {
  int poses = 20, frames = 20;
  double blur_px = 0.7, tag_m = 0.005;
  std::uint64_t seed = 1;
  std::string json;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--poses", a.poses, "scenes")->capture_default_str();
  app.add_option("--frames", a.frames, "noisy frames of each")->capture_default_str();
  app.add_option("--blur", a.blur_px, "of the lens (px)")->capture_default_str();
  app.add_option("--tag", a.tag_m, "size of a tag (m)")->capture_default_str();
  app.add_option("--seed", a.seed, "of the scenes")->capture_default_str();
  app.add_option("--json", a.json, "file for the figures");
}

nlohmann::json ToJson(const TipScore& s) {
  return {{"frames", s.frames},
          {"found", s.found},
          {"rms_mm", 1e3 * s.rms_m},
          {"bias_mm", 1e3 * s.bias_m},
          {"nees", s.nees}};
}

nlohmann::json Row(const TipBounds& b, const TipScore& tracker, const TipScore& contour) {
  return {{"bound_mm",
           {{"collar_known", 1e3 * b.collar_known.TipRms()},
            {"all_known", 1e3 * b.all_known.TipRms()},
            {"collar", 1e3 * b.collar.TipRms()},
            {"all", 1e3 * b.all.TipRms()}}},
          {"tracker", ToJson(tracker)},
          {"contour", ToJson(contour)}};
}

// Sums over the scenes in which both the bound and the estimate are there.
struct Total {
  double squares = 0, bounds = 0, nees = 0;
  int scenes = 0;
  void Add(const TipScore& score, double bound_m) {
    if (score.found == 0) return;
    squares += score.rms_m * score.rms_m;
    bounds += bound_m * bound_m;
    nees += score.nees;
    ++scenes;
  }
  nlohmann::json Json() const {
    if (scenes == 0) return nullptr;
    return {{"scenes", scenes},
            {"rms_mm", 1e3 * std::sqrt(squares / scenes)},
            {"rms_over_bound", std::sqrt(squares / bounds)},
            {"nees", nees / scenes}};
  }
};

void Run(Arguments& a) {
  const TagCollar collar = BoundCollar(a.tag_m);
  const TubeShape tube = BoundTube(collar);
  const simulation::LaparoscopeOptions options = BoundScope(a.blur_px);
  const simulation::Laparoscope laparoscope(BoundCamera(), collar, options);
  nlohmann::json rows = nlohmann::json::array();
  Total tracker_collar, tracker_all;
  fmt::print(
      "tip, mm | bound, all else known: collar, with outline | not known: collar, with outline"
      " | tracker RMS, bias, NEES (3), found | outline alone RMS, NEES (3), found\n");
  for (const BoundScene& scene : DrawScenes(a.poses, a.seed)) {
    const TipBounds b = BoundTip(ModelPixels(laparoscope, options, collar, tube, scene));
    const TipScore t = MeasureTracker(laparoscope, options, collar, tube, scene, a.frames);
    const TipScore c = MeasureContour(laparoscope, options, tube, scene, a.frames);
    tracker_collar.Add(t, b.collar.TipRms());
    tracker_all.Add(t, b.all.TipRms());
    rows.push_back(Row(b, t, c));
    fmt::print(
        "{:7.4f} {:7.4f} | {:7.4f} {:7.4f} | {:7.4f} {:7.4f} {:9.2f} {:3d}/{} | {:7.4f} {:6.2f} "
        "{:3d}\n",
        1e3 * b.collar_known.TipRms(), 1e3 * b.all_known.TipRms(), 1e3 * b.collar.TipRms(),
        1e3 * b.all.TipRms(), 1e3 * t.rms_m, 1e3 * t.bias_m, t.nees, t.found, t.frames,
        1e3 * c.rms_m, c.nees, c.found);
  }
  const nlohmann::json summary = {{"tracker_over_collar", tracker_collar.Json()},
                                  {"tracker_over_all", tracker_all.Json()}};
  fmt::print("{}\n", summary.dump());
  if (a.json.empty()) return;
  std::ofstream out(a.json);
  out << nlohmann::json{{"summary", summary}, {"scenes", rows}}.dump(2) << '\n';
  if (!out) throw InputError(fmt::format("{}: cannot be written", a.json));
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool<flextip::bench::Arguments>(
      argc, argv, "Cramer-Rao bound of the tip in rendered frames, and the tracker's error over it",
      flextip::bench::AddOptions, flextip::bench::Run);
}
