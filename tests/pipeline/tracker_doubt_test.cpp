// What the tracker calls `ok` is held against wrist and shaft: rendered pictures of a press, made
// wrong as pictures of real setups are (docs/notes/sight.md).
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "pipeline/instrument_tracker.h"
#include "simulation/closed_loop/closed_loop.h"
#include "simulation/closed_loop/scenario_run.h"

namespace flextip {
namespace {

using namespace simulation;

struct Press {
  Recording recording;
  TrackerOptions tracker;
  std::vector<Image> pictures;
  std::vector<TimeNs> times;
  Series<Eigen::Vector3d> truth;  // p_RE
};

/// Returns 10 mm down and 6 mm aside, through the laparoscope, rendered once.
const Press& ThePress() {
  static const Press press = [] {
    Scenario scenario =
        ReadScenario(std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/press.yaml");
    scenario.loop.controller.kind = ControllerKind::kRodTrack;
    const Laparoscope laparoscope = LaparoscopeOf(scenario);
    Press made;
    made.tracker = scenario.tracker;
    const LoopCamera camera{laparoscope, scenario.tracker, [&](TimeNs t_ns, const Image& image) {
                              made.times.push_back(t_ns);
                              made.pictures.push_back(image);
                            }};
    LoopResult result = RunClosedLoop(scenario.loop, &camera);
    made.recording = std::move(result.recording);
    for (const auto& [t_ns, truth] : result.truth) made.truth.push_back({t_ns, truth.p_RE});
    return made;
  }();
  return press;
}

using Pictures = std::vector<Image>;

struct Score {
  int frames = 0, ok = 0, wrong = 0, doubted = 0;
  double worst_m = 0.0;
  std::map<TipDoubt, int> doubts;
};

Score Track(const char* name, const Pictures& pictures, const TagCollar* collar = nullptr,
            bool with_model = true) {
  const Press& press = ThePress();
  InstrumentTrackerSetup setup = TrackerSetupOf(press.recording, press.tracker, with_model);
  if (collar != nullptr) setup.collar = *collar;
  if (std::getenv("FLEXTIP_NO_GATE")) setup.tracker.max_wrist_deviations = 1e300;
  InstrumentTracker tracker(setup);
  Score score;
  double most_sd = 0.0, sum_sd = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Image* const one[] = {&pictures[i]};
    const TimeNs t_ns = press.times[i];
    const TipTrack track = tracker.Follow(one, t_ns, ReadingsAt(press.recording, t_ns));
    ++score.frames;
    ++score.doubts[track.doubt];
    score.doubted += track.doubt != TipDoubt::kNone;
    if (track.wrist_deviations)
      most_sd = std::max(most_sd, *track.wrist_deviations), sum_sd += *track.wrist_deviations;
    if (track.tip.status != TipStatus::kOk) continue;
    ++score.ok;
    const Eigen::Vector3d error = track.tip.p_RE - *ValueAt(press.truth, t_ns);
    score.worst_m = std::max(score.worst_m, error.norm());
    score.wrong += MahalanobisSquared(error, track.tip.covariance_m2) > 36.0;
  }
  fmt::print("{:28} frames {} ok {} wrong {} worst {:.2f} mm, deviations mean {:.1f} most {:.1f};",
             name, score.frames, score.ok, score.wrong, 1e3 * score.worst_m, sum_sd / score.frames,
             most_sd);
  for (const auto& [doubt, n] : score.doubts) fmt::print(" {}={}", Name(doubt), n);
  fmt::print("\n");
  return score;
}

/// Returns the pictures with pixel (x, y) taken from `from(x, y)`; black where that is outside.
Pictures Warped(const std::function<Eigen::Vector2d(double, double)>& from) {
  Pictures warped;
  for (const Image& image : ThePress().pictures) {
    Image out(image.width_px, image.height_px, image.channels);
    for (int y = 0; y < out.height_px; ++y) {
      for (int x = 0; x < out.width_px; ++x) {
        const Eigen::Vector2d at = from(x, y);
        const int x0 = static_cast<int>(std::floor(at.x())),
                  y0 = static_cast<int>(std::floor(at.y()));
        if (x0 < 0 || y0 < 0 || x0 + 1 >= image.width_px || y0 + 1 >= image.height_px) continue;
        const double u = at.x() - x0, v = at.y() - y0;
        for (int c = 0; c < out.channels; ++c) {
          const auto grey = [&](int dx, int dy) {
            return static_cast<double>(image.Row(y0 + dy)[(x0 + dx) * image.channels + c]);
          };
          const double value = (1 - v) * ((1 - u) * grey(0, 0) + u * grey(1, 0)) +
                               v * ((1 - u) * grey(0, 1) + u * grey(1, 1));
          out.Row(y)[x * out.channels + c] = static_cast<std::uint8_t>(std::lround(value));
        }
      }
    }
    warped.push_back(std::move(out));
  }
  return warped;
}

/// Returns the pictures in the order of `of(i)`.
Pictures Reordered(const std::function<int(int)>& of) {
  const Pictures& pictures = ThePress().pictures;
  Pictures out;
  for (int i = 0; i < static_cast<int>(pictures.size()); ++i)
    out.push_back(pictures[std::clamp(of(i), 0, static_cast<int>(pictures.size()) - 1)]);
  return out;
}

Pictures Mixed(
    const std::function<std::uint8_t(int row, std::uint8_t now, std::uint8_t other)>& mix,
    const std::function<int(int)>& other_of) {
  Pictures out = ThePress().pictures;
  const Pictures others = Reordered(other_of);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t row = static_cast<std::size_t>(out[i].width_px) * out[i].channels;
    for (std::size_t k = 0; k < out[i].data.size(); ++k)
      out[i].data[k] = mix(static_cast<int>(k / row), out[i].data[k], others[i].data[k]);
  }
  return out;
}

TEST(TrackerDoubt, Table) {
  const double w = 1280, h = 720;
  Track("as rendered", ThePress().pictures);
  Track("as rendered, no model", ThePress().pictures, nullptr, false);
  Track("upside down",
        Warped([&](double x, double y) { return Eigen::Vector2d(w - 1 - x, h - 1 - y); }));
  Track("shifted by 40 px", Warped([&](double x, double y) { return Eigen::Vector2d(x - 40, y); }));
  Track("zoomed by 1.2", Warped([&](double x, double y) {
          return Eigen::Vector2d(w / 2 + (x - w / 2) / 1.2, h / 2 + (y - h / 2) / 1.2);
        }));
  Track("scaled by a half", Warped([&](double x, double y) {
          return Eigen::Vector2d(w / 2 + (x - w / 2) * 2, h / 2 + (y - h / 2) * 2);
        }));
  Track("rolled half a picture",
        Warped([&](double x, double y) { return Eigen::Vector2d(std::fmod(x + w / 2, w), y); }));
  Track("doubled with a far frame",
        Mixed([](int, std::uint8_t a,
                 std::uint8_t b) { return static_cast<std::uint8_t>((a + b) / 2); },
              [](int i) { return (i + 30) % 60; }));
  Track("frozen for 20 frames", Reordered([](int i) { return i >= 15 && i < 35 ? 15 : i; }));
  Track("half a second late", Reordered([](int i) { return i - 15; }));
  Track("shuffled", Reordered([](int i) { return (i * 37) % 60; }));
  for (int back : {1, 3, 10})
    Track(fmt::format("torn, {} frames", back).c_str(),
          Mixed([](int row, std::uint8_t a, std::uint8_t b) { return row < 360 ? a : b; },
                [back](int i) { return i - back; }));
  for (bool model : {false, true}) {
    TagCollar collar = *ThePress().recording.tags0;
    for (std::size_t k = 0; k < collar.tags.size(); ++k) {
      TagCollar off = collar;
      off.tags[k].T_EG.p.x() += 0.003;
      Track(fmt::format("tag {} 3 mm off{}", k, model ? "" : ", no model").c_str(),
            ThePress().pictures, &off, model);
    }
    for (CollarTag& tag : collar.tags) tag.size_m = 0.004;
    Track(model ? "size 4 for 5" : "size 4 for 5, no model", ThePress().pictures, &collar, model);
  }
}

}  // namespace
}  // namespace flextip
