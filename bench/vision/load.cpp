// The time of a tracked frame over AprilTag's, and the tip's error, against the size and the number
// of the tags.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "bench/tool.h"
#include "bench/vision/clip.h"
#include "bench/vision/peer.h"
#include "core/linear_algebra.h"
#include "core/median.h"
#include "recording/text/text.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip::bench {
namespace {

constexpr TimeNs kStep_ns = 33'333'333;
constexpr int kWarmUp = 10;  // frames in which the tracker learns the prints and the blur

struct Arguments {
  int frames = 90, repeats = 3, peer_every = 10, first = 0;
  std::vector<double> sizes_px = {30, 45, 70, 100, 140};
  std::vector<int> tags = {0, 1, 2, 4, 8};
  std::filesystem::path out;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--frames", a.frames, "Of each case")->check(CLI::Range(kWarmUp + 10, 1000));
  app.add_option("--repeats", a.repeats, "Each frame's least time of so many")
      ->check(CLI::PositiveNumber);
  app.add_option("--peer-every", a.peer_every, "AprilTag sees every frame of so many; 0: none")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--first", a.first, "The number of the first frame: other poses, other noise");
  app.add_option("--sizes", a.sizes_px, "Sides of the tags (px)")->delimiter(',');
  app.add_option("--tags", a.tags, "Tags in a plane: 1, 2, 4 or 8; 0: a hexagon around the shaft")
      ->delimiter(',')
      ->check(CLI::IsMember({0, 1, 2, 4, 8}));
  app.add_option("-o,--out", a.out, "Folder for load.json, load.md")->required();
  app.footer("Example:\n  flextip_vision_load -o load\n");
}

struct LoadFigures {
  std::string tags;
  double tag_px = 0;
  int frames = 0, ok = 0, slow = 0;  // slow: more than thrice the median
  double median_ms = 0, p99_ms = 0, largest_ms = 0;
  double times_full = 0, times_half = 0;  // AprilTag's time over the tracker's
  double mean_um = 0, p95_um = 0, rms_um = 0, nees = 0;
};

bool AllSeen(const ClipCase& one, const Clip& clip) {
  const CameraModel camera(clip.camera);
  return std::all_of(clip.T_CE.begin(), clip.T_CE.end(), [&](const Pose& T_CE) {
    const auto seen = TagsInView(camera, clip.collar, T_CE, 70 * M_PI / 180);
    return static_cast<int>(seen.size()) >= std::max(1, one.tags);
  });
}

class Measurement {
 public:
  Measurement(const Clip& clip, int frames)
      : clip_(clip),
        ms_(frames, HUGE_VAL),
        full_ms_(frames, HUGE_VAL),
        half_ms_(frames, HUGE_VAL) {}

  void Run(const Arguments& a, bool score) {
    TipTracker tracker(clip_.camera, clip_.collar);
    const auto full = MakeAprilTagPeer(clip_.camera, clip_.collar, 1);
    const auto half = MakeAprilTagPeer(clip_.camera, clip_.collar, 2);
    for (std::size_t i = 0; i < clip_.frames.size(); ++i) {
      TipTrack track;
      const double ms = TimeMs(
          [&] { track = tracker.Track(clip_.frames[i], static_cast<TimeNs>(i) * kStep_ns); });
      ms_[i] = std::min(ms_[i], ms);
      if (score && i >= kWarmUp) Score(track, i);
      if (a.peer_every == 0 || i % a.peer_every != 0) continue;
      full_ms_[i] = std::min(full_ms_[i], full->See(clip_.frames[i]).ms);
      half_ms_[i] = std::min(half_ms_[i], half->See(clip_.frames[i]).ms);
    }
  }

  LoadFigures Figures() const {
    LoadFigures f;
    const std::vector<double> ms(ms_.begin() + 1, ms_.end());  // the first frame is found
    f.frames = frames_;
    f.ok = static_cast<int>(error_um_.size());
    f.median_ms = Median(ms);
    f.p99_ms = Quantile(ms, 0.99);
    f.largest_ms = Quantile(ms, 1);
    f.slow = static_cast<int>(
        std::count_if(ms.begin(), ms.end(), [&](double t) { return t > 3 * f.median_ms; }));
    f.times_full = MedianOfSeen(full_ms_) / f.median_ms;
    f.times_half = MedianOfSeen(half_ms_) / f.median_ms;
    double sum = 0, squares = 0, nees = 0;
    for (const double e : error_um_) sum += e, squares += e * e;
    for (const double n : nees_) nees += n;
    const double n = std::max<double>(1, f.ok);
    f.mean_um = sum / n;
    f.rms_um = std::sqrt(squares / n);
    f.p95_um = Quantile(error_um_, 0.95);
    f.nees = nees / n;
    return f;
  }

 private:
  void Score(const TipTrack& track, std::size_t frame) {
    ++frames_;
    if (track.tip.status != TipStatus::kOk) return;
    const Eigen::Vector3d error = track.tip.p_RE - (clip_.camera.T_RC * clip_.T_CE[frame]).p;
    error_um_.push_back(1e6 * error.norm());
    nees_.push_back(MahalanobisSquared(error, track.tip.covariance_m2));
  }
  static double MedianOfSeen(std::vector<double> ms) {
    std::erase_if(ms, [](double t) { return !std::isfinite(t); });
    return Median(ms);
  }

  const Clip& clip_;
  std::vector<double> ms_, full_ms_, half_ms_, error_um_, nees_;
  int frames_ = 0;
};

std::string Row(const LoadFigures& f) {
  return fmt::format(
      "| {} | {:.0f} | {:.3f} | {:.2f} | {:.2f} | {} | {:.0f} | {:.1f} | {} of {} | {:.2f} | "
      "{:.2f} "
      "| {:.2f} | {:.2f} |\n",
      f.tags, f.tag_px, f.median_ms, f.p99_ms, f.largest_ms, f.slow, f.times_full, f.times_half,
      f.ok, f.frames, f.mean_um, f.p95_um, f.rms_um, f.nees);
}

constexpr const char* kHead =
    "| tags | px | median ms | 99 % ms | largest ms | slow | AprilTag 3, times | decimate 2, times "
    "| ok | tip mean um | 95 % um | RMS um | NEES (3) |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

nlohmann::json Json(const LoadFigures& f) {
  return {{"tags", f.tags},
          {"tag_px", f.tag_px},
          {"median_ms", f.median_ms},
          {"p99_ms", f.p99_ms},
          {"largest_ms", f.largest_ms},
          {"slow", f.slow},
          {"times_full", f.times_full},
          {"times_half", f.times_half},
          {"frames", f.frames},
          {"ok", f.ok},
          {"tip_mean_um", f.mean_um},
          {"tip_p95_um", f.p95_um},
          {"tip_rms_um", f.rms_um},
          {"nees", f.nees}};
}

void Run(Arguments& a) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  cv::setNumThreads(1);
  nlohmann::json json = nlohmann::json::array();
  std::string page = kHead;
  fmt::print("{}", kHead);
  for (const int tags : a.tags) {
    for (const double tag_px : a.sizes_px) {
      const ClipCase one{"", 1280, 5, tags, tag_px, tags > 2 ? 2 : 1, 60, a.first};
      const Clip clip = MakeClip(one, a.frames);
      if (!AllSeen(one, clip)) continue;
      Measurement measurement(clip, a.frames);
      for (int round = 0; round < a.repeats; ++round) measurement.Run(a, round == 0);
      LoadFigures f = measurement.Figures();
      f.tags = tags == 0 ? "hexagon" : fmt::format("{}", tags);
      f.tag_px = tag_px;
      fmt::print("{}", Row(f));
      std::fflush(stdout);
      page += Row(f);
      json.push_back(Json(f));
    }
  }
  WriteTextFile(a.out / "load.json", json.dump(2) + "\n");
  WriteTextFile(a.out / "load.md", page);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(
      argc, argv, "Time of a tracked frame over AprilTag's, against size and number of tags",
      flextip::bench::AddOptions, flextip::bench::Run);
}
