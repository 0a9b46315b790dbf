// Milliseconds of a tracked frame against full detection by others, in one run, with the recall of
// each on the same frames.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/utility.hpp>

#include "bench/tool.h"
#include "bench/vision/clip.h"
#include "bench/vision/figures.h"
#include "bench/vision/plot.h"
#include "core/median.h"
#include "recording/text/text.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip::bench {
namespace {

constexpr TimeNs kStep_ns = 33'333'333;

struct Arguments {
  int frames = 60, repeats = 3;
  std::filesystem::path out;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--frames", a.frames, "Of each case")->check(CLI::Range(5, 1000));
  app.add_option("--repeats", a.repeats, "Each frame's least time of so many")
      ->check(CLI::PositiveNumber);
  app.add_option("-o,--out", a.out, "Folder for speed.json, speed.md, vision_speed.svg")
      ->required();
  app.footer("Example:\n  flextip_vision_speed -o speed\n");
}

struct SpeedFigures {
  std::string name;
  double median_ms = 0, largest_ms = 0;
  PeerFigures seen;
};

class Contender {
 public:
  virtual ~Contender() = default;
  virtual std::string Name() const = 0;
  virtual void Restart() {}
  virtual PeerAnswer See(const Clip& clip, std::size_t frame) = 0;
};

class Detecting : public Contender {
 public:
  explicit Detecting(std::unique_ptr<VisionPeer> peer) : peer_(std::move(peer)) {}
  std::string Name() const override { return peer_->Name(); }
  PeerAnswer See(const Clip& clip, std::size_t frame) override {
    return peer_->See(clip.frames[frame]);
  }

 private:
  std::unique_ptr<VisionPeer> peer_;
};

class FlextipTracking : public Contender {
 public:
  explicit FlextipTracking(const Clip& clip) : clip_(clip) { Restart(); }
  std::string Name() const override { return "flextip"; }
  void Restart() override { tracker_.emplace(clip_.camera, clip_.collar); }
  PeerAnswer See(const Clip& clip, std::size_t frame) override {
    PeerAnswer answer;
    TipTrack track;
    answer.ms = TimeMs([&] {
      track = tracker_->Track(clip.frames[frame], static_cast<TimeNs>(frame) * kStep_ns);
    });
    if (track.tip.status == TipStatus::kOk) {
      answer.T_CE = clip.camera.T_RC.Inverse() * track.T_RE;
    }
    return answer;
  }

 private:
  const Clip& clip_;
  std::optional<TipTracker> tracker_;
};

// On frames freed from distortion beforehand; set to the true pose in the first frame and wherever
// it was lost.
class VispTracking : public Contender {
 public:
  explicit VispTracking(const Clip& clip) : clip_(clip) {
    const CameraCalibration& c = clip.camera;
    const cv::Matx33d K(c.fu_px, 0, c.cu_px, 0, c.fv_px, c.cv_px, 0, 0, 1);
    for (const Image& frame : clip.frames) {
      const cv::Mat view(frame.height_px, frame.width_px, CV_8UC1,
                         const_cast<std::uint8_t*>(frame.data.data()));
      Image flat(frame.width_px, frame.height_px, 1);
      cv::Mat out(frame.height_px, frame.width_px, CV_8UC1, flat.data.data());
      cv::undistort(view, out, K, c.distortion_coefficients);
      flat_.push_back(std::move(flat));
    }
    Restart();
  }
  std::string Name() const override { return "ViSP model tracker"; }
  void Restart() override {
    tracker_ = MakeVispTracker(clip_.camera, clip_.collar);
    lost_ = true;
  }
  PeerAnswer See(const Clip& clip, std::size_t frame) override {
    PeerAnswer answer;
    if (lost_)
      tracker_->Start(flat_[frame == 0 ? 0 : frame - 1], clip.T_CE[frame == 0 ? 0 : frame - 1]);
    answer.T_CE = tracker_->Track(flat_[frame], answer.ms);
    lost_ = !answer.T_CE || (answer.T_CE->p - clip.T_CE[frame].p).norm() > kFalsePose_m;
    return answer;
  }

 private:
  const Clip& clip_;
  std::vector<Image> flat_;
  std::unique_ptr<VispTracker> tracker_;
  bool lost_ = true;
};

std::vector<std::unique_ptr<Contender>> Contenders(const Clip& clip) {
  std::vector<std::unique_ptr<Contender>> all;
  all.push_back(std::make_unique<FlextipTracking>(clip));
  all.push_back(std::make_unique<Detecting>(MakeAprilTagPeer(clip.camera, clip.collar, 1)));
  all.push_back(std::make_unique<Detecting>(MakeAprilTagPeer(clip.camera, clip.collar, 2)));
  all.push_back(std::make_unique<Detecting>(
      MakeArucoPeer(clip.camera, clip.collar, ArucoRefinement::kSubpixel)));
  if (MakeVispTracker(clip.camera, clip.collar))
    all.push_back(std::make_unique<VispTracking>(clip));
  return all;
}

SpeedFigures Measure(const Clip& clip, Contender& contender, int repeats) {
  std::vector<double> ms(clip.frames.size(), 1e300);
  PeerScore score(clip.camera, clip.collar);
  const CameraModel camera(clip.camera);
  for (int round = 0; round < repeats; ++round) {
    contender.Restart();
    for (std::size_t i = 0; i < clip.frames.size(); ++i) {
      const PeerAnswer answer = contender.See(clip, i);
      ms[i] = std::min(ms[i], answer.ms);
      if (round > 0) continue;
      PictureTruth truth{{}, clip.T_CE[i]};
      for (const auto& tag : TagsInView(camera, clip.collar, clip.T_CE[i], 70 * M_PI / 180)) {
        truth.corners_px.insert(tag);
      }
      score.Add(answer, truth);
    }
  }
  ms.erase(ms.begin());  // the first frame is found, not tracked
  return {contender.Name(), Median(ms), LowerQuantile(ms, 1.0), score.Figures(contender.Name())};
}

std::string Table(const std::vector<SpeedFigures>& all) {
  std::string table =
      "| | median ms | largest ms | times flextip | poses right | tip RMS mm |\n"
      "|---|---|---|---|---|---|\n";
  for (const SpeedFigures& f : all) {
    table += fmt::format("| {} | {:.3f} | {:.2f} | {:.1f} | {} of {} | {:.3f} |\n", f.name,
                         f.median_ms, f.largest_ms, f.median_ms / all[0].median_ms,
                         f.seen.GoodPoses(), f.seen.pictures, f.seen.tip_rms_mm);
  }
  return table;
}

void AddTo(Panel& plot, double x, const std::vector<SpeedFigures>& all) {
  for (const SpeedFigures& f : all) {
    auto line = std::find_if(plot.lines.begin(), plot.lines.end(),
                             [&](const PlotLine& l) { return l.name == f.name; });
    if (line == plot.lines.end()) line = plot.lines.insert(plot.lines.end(), {f.name, {}});
    line->points.emplace_back(x, f.median_ms);
    std::sort(line->points.begin(), line->points.end());
  }
}

// The first one is in the plots against the picture's size and the tags'.
std::vector<ClipCase> Cases() {
  std::vector<ClipCase> cases = {{"1280x720, 45 px tags, 5 px a frame"},
                                 {"30 px a frame", 1280, 30}};
  for (const int width : {640, 960, 1600, 1920}) {
    cases.push_back({fmt::format("{}x{}", width, width * 9 / 16), width});
  }
  for (const double tag_px : {20.0, 30.0, 70.0, 100.0}) {
    cases.push_back({fmt::format("{} px tags", tag_px), 1280, 5, 0, tag_px});
  }
  for (int tags = 1; tags <= 4; ++tags) {
    cases.push_back({fmt::format("{} tags seen", tags), 1280, 5, tags});
  }
  return cases;
}

struct Plots {
  Panel by_size{"Size of the picture", "megapixels", "ms a frame", true, true, {}};
  Panel by_tag_px{"Size of the tags", "side of a tag, px", "ms a frame", true, true, {}};
  Panel by_tags{"Tags seen", "tags", "ms a frame", false, true, {}};

  void Add(const ClipCase& c, const Clip& clip, const std::vector<SpeedFigures>& all) {
    const ClipCase base;
    if (c.step_px != base.step_px) return;
    if (c.tags > 0) {
      AddTo(by_tags, c.tags, all);
      return;
    }
    if (c.tag_px == base.tag_px) AddTo(by_size, 1e-6 * c.width_px * clip.camera.height_px, all);
    if (c.width_px == base.width_px) AddTo(by_tag_px, c.tag_px, all);
  }
};

nlohmann::json Json(const std::vector<SpeedFigures>& all) {
  nlohmann::json json;
  for (const SpeedFigures& f : all) {
    json[f.name] = {{"median_ms", f.median_ms},
                    {"largest_ms", f.largest_ms},
                    {"times_flextip", f.median_ms / all[0].median_ms},
                    {"frames", f.seen.pictures},
                    {"right", f.seen.GoodPoses()},
                    {"tip_rms_mm", f.seen.tip_rms_mm}};
  }
  return json;
}

void Run(Arguments& a) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  cv::setNumThreads(1);
  Plots plots;
  nlohmann::json json;
  std::string page;
  for (const ClipCase& c : Cases()) {
    const Clip clip = MakeClip(c, a.frames);
    std::vector<SpeedFigures> all;
    for (const auto& contender : Contenders(clip))
      all.push_back(Measure(clip, *contender, a.repeats));
    const std::string text = fmt::format("\n### {}\n\n{}", c.name, Table(all));
    fmt::print("{}", text);
    std::fflush(stdout);
    page += text;
    json[c.name] = Json(all);
    plots.Add(c, clip, all);
  }
  WriteTextFile(a.out / "speed.json", json.dump(2) + "\n");
  WriteTextFile(a.out / "speed.md", page);
  WriteTextFile(
      a.out / "vision_speed.svg",
      PlotsSvg({plots.by_size, plots.by_tag_px, plots.by_tags}, "Time of a frame, one thread", 2));
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv,
                                 "Time of a tracked frame against full detection by others",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
