// How a tracker does on frames in which the tip hides: rendered sequences with smoke, blood, blur
// and the like, scored against their truth. Resumes where it stopped.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/campaign/campaign.h"
#include "bench/tool.h"
#include "bench/vision/score.h"
#include "bench/vision/sequence.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "recording/text/text.h"
#include "vision/outline/tube_geometry.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip::bench {
namespace {

struct Arguments {
  int frames = 10000, frames_each = 100, width_px = 640, only = -1, jobs = 1;
  std::uint64_t seed = 1;
  std::vector<std::string> events, families = {"tag36h11", "tag25h9", "tagStandard41h12"};
  bool wrist = false, outline = false, summarize = false;
  double drift_mm = 1.0, drift_deg = 1.0;
  std::filesystem::path out, pictures, sheet;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--frames", a.frames, "Frames in all")->check(CLI::PositiveNumber);
  app.add_option("--frames-each", a.frames_each, "Of one sequence")->check(CLI::Range(20, 100000));
  app.add_option("--width", a.width_px, "Of the pictures, in pixels; 16:9")
      ->check(CLI::Range(160, 3840));
  app.add_option("--seed", a.seed, "Another one gives other sequences");
  app.add_option("--events", a.events, fmt::format("{}", fmt::join(VisionEvents(), ",")))
      ->delimiter(',')
      ->check(CLI::IsMember(VisionEvents()));
  app.add_option("--families", a.families, "Tag families to draw from")->delimiter(',');
  app.add_flag("--wrist", a.wrist, "Give the tracker a model's prediction of each frame");
  app.add_flag("--outline", a.outline, "Give the tracker the shaft's outline");
  app.add_option("--drift-mm", a.drift_mm, "Standard error of the prediction, per axis");
  app.add_option("--drift-deg", a.drift_deg, "Of its rotation, per axis");
  app.add_option("--sequence", a.only, "Only the sequence of this number");
  app.add_option("--pictures", a.pictures, "Folder for PNGs of the frames");
  app.add_option("--sheet", a.sheet, "Only writes this picture: a frame of each event");
  app.add_option("--jobs", a.jobs, "Sequences at a time; times of frames want 1")
      ->check(CLI::PositiveNumber);
  app.add_flag("--summarize", a.summarize, "Only read sequences.jsonl");
  app.add_option("-o,--out", a.out,
                 "Folder for sequences.jsonl, summary.json, table.txt, wrong.txt")
      ->required();
  app.footer("Example:\n  flextip_vision_hard --frames 10000 -o hard\n");
}

// A model's prediction: the truth with an error that drifts as an Ornstein-Uhlenbeck process of the
// standard deviation stated in the covariance, with a time constant of 2 s.
class WristModel {
 public:
  WristModel(double sd_rad, double sd_m, std::uint64_t seed) : random_(seed) {
    sd_ << Eigen::Vector3d::Constant(sd_rad), Eigen::Vector3d::Constant(sd_m);
    error_ = sd_.cwiseProduct(Normal());
  }
  TipPrediction Predict(const Pose& T_RE) {
    const double kept = std::exp(-1.0 / (2.0 * VisionSequence::kRate_hz));
    error_ = kept * error_ + std::sqrt(1 - kept * kept) * sd_.cwiseProduct(Normal());
    TipPrediction prediction;
    prediction.T_RE = {ExpRotation(error_.head<3>()) * T_RE.R, T_RE.p + error_.tail<3>()};
    prediction.covariance = sd_.cwiseAbs2().asDiagonal();
    return prediction;
  }

 private:
  Eigen::Matrix<double, 6, 1> Normal() {
    Eigen::Matrix<double, 6, 1> v;
    for (double& x : v) x = normal_(random_);
    return v;
  }
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  Eigen::Matrix<double, 6, 1> sd_, error_;
};

FrameScore ScoreFrame(const VisionSequence& s, int frame, const TipTrack& track) {
  const Pose T_RE = s.motion.TipAt(frame / VisionSequence::kRate_hz);
  const Pose T_CE = s.camera.T_RC.Inverse() * T_RE;
  FrameScore score;
  score.status = Name(track.tip.status);
  score.in_event = s.InEvent(frame);
  score.in_view = !TagsInView(CameraModel(s.camera), s.collar, T_CE, 70 * M_PI / 180).empty();
  if (track.tip.status == TipStatus::kLost) return score;
  const Eigen::Vector3d e = track.tip.p_RE - T_RE.p;
  score.error_mm = 1e3 * e.norm();
  score.nees = MahalanobisSquared(e, track.tip.covariance_m2);
  if (track.tip.status == TipStatus::kOk) {
    score.turn_deg = LogRotation(track.T_RE.R * T_RE.R.transpose()).norm() * 180 / M_PI;
  }
  return score;
}

void WritePicture(const Image& image, const std::filesystem::path& folder, int number, int frame) {
  std::filesystem::create_directories(folder);
  const cv::Mat view(image.height_px, image.width_px, CV_8UC(image.channels),
                     const_cast<std::uint8_t*>(image.data.data()));
  cv::imwrite((folder / fmt::format("{:04}_{:03}.png", number, frame)).string(), view);
}

VisionSequence SequenceOf(const Arguments& a, int number) {
  return DrawSequence(a.seed, number, a.frames_each, a.width_px, a.families,
                      a.events.empty() ? VisionEvents() : a.events);
}

// The middle of each event, four in a row.
void WriteSheet(const Arguments& a) {
  constexpr int kColumns = 4;
  const std::size_t events = a.events.empty() ? VisionEvents().size() : a.events.size();
  std::vector<cv::Mat> rows, row;
  for (std::size_t i = 0; i < events; ++i) {
    VisionSequence s = SequenceOf(a, static_cast<int>(i));
    const simulation::Laparoscope scope(s.camera, s.collar, s.options);
    const simulation::FrameRange range =
        s.in_event.empty() ? simulation::FrameRange{0, a.frames_each} : s.in_event[0];
    const int last = std::min(range.last, a.frames_each - 1);
    Image image = s.Render(scope, (range.first + last) / 2);
    cv::Mat view = cv::Mat(image.height_px, image.width_px, CV_8UC3, image.data.data()).clone();
    cv::putText(view, fmt::format("{}", fmt::join(s.events, " + ")), {10, 28},
                cv::FONT_HERSHEY_SIMPLEX, 0.8, {255, 255, 255}, 2, cv::LINE_AA);
    row.push_back(view);
    if (row.size() < kColumns && i + 1 < events) continue;
    while (row.size() < kColumns) row.push_back(cv::Mat::zeros(view.size(), view.type()));
    cv::hconcat(row, rows.emplace_back());
    row.clear();
  }
  cv::Mat sheet;
  cv::vconcat(rows, sheet);
  cv::resize(sheet, sheet, {}, 0.6, 0.6, cv::INTER_AREA);
  cv::imwrite(a.sheet.string(), sheet, {cv::IMWRITE_JPEG_QUALITY, 88});
}

SequenceScore RunSequence(const Arguments& a, int number) {
  const VisionSequence s = SequenceOf(a, number);
  const simulation::Laparoscope scope(s.camera, s.collar, s.options);
  TrackerOptions options;
  if (a.outline) options.tube = TubeOf(s.collar, s.shaft_diameter_m, true);
  TipTracker tracker(s.camera, s.collar, options);
  WristModel model(a.drift_deg * M_PI / 180, 1e-3 * a.drift_mm, a.seed + number);
  SequenceScore score{
      number, s.events, s.collar.family, s.tag_px, s.speed_m_s, a.wrist, s.camera.gamma.has_value(),
      {}};
  for (int frame = 0; frame < a.frames_each; ++frame) {
    const Image image = s.Render(scope, frame);
    const auto t_ns = static_cast<TimeNs>(frame * 1e9 / VisionSequence::kRate_hz);
    std::optional<TipPrediction> prediction;
    if (a.wrist) prediction = model.Predict(s.motion.TipAt(frame / VisionSequence::kRate_hz));
    const auto start = std::chrono::steady_clock::now();
    const TipTrack track = tracker.Track(image, t_ns, prediction);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    score.frames.push_back(ScoreFrame(s, frame, track));
    score.frames.back().ms = took.count();
    if (!a.pictures.empty()) WritePicture(image, a.pictures, number, frame);
  }
  return score;
}

void Summarize(const std::filesystem::path& out) {
  const std::vector<SequenceScore> scores = ReadScores(out / "sequences.jsonl");
  if (scores.empty()) throw InputError((out / "sequences.jsonl").string() + ": holds no sequence");
  const std::string table = ScoreTable(scores);
  WriteTextFile(out / "summary.json", ScoreJson(scores));
  WriteTextFile(out / "table.txt", table);
  WriteTextFile(out / "wrong.txt", WrongFrames(scores));
  fmt::print("{}", table);
}

CaseResult RunOne(const Arguments& a, int number) {
  const SequenceScore score = RunSequence(a, number);
  int ok = 0, wrong = 0;
  for (const FrameScore& f : score.frames) {
    ok += f.status == "ok";
    wrong += f.IsFalseOk() || f.IsWrongOk();
  }
  return {JsonLine(score), fmt::format("{:>4}  {:<28} {:<17} {:>3.0f} px  ok {:>3}  wrong {}",
                                       number, fmt::format("{}", fmt::join(score.events, "+")),
                                       score.family, score.tag_px, ok, wrong)};
}

bool RunAll(const Arguments& a) {
  Campaign campaign{.records = a.out / "sequences.jsonl", .jobs = a.jobs};
  for (const SequenceScore& s : ReadScores(campaign.records)) {
    campaign.done.insert(std::to_string(s.number));
  }
  std::vector<int> numbers;
  for (int number = 0; number * a.frames_each < a.frames; ++number) {
    if (a.only < 0 || number == a.only) numbers.push_back(number);
  }
  for (const int number : numbers) campaign.names.push_back(std::to_string(number));
  campaign.run = [&](std::size_t index) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    cv::setNumThreads(1);
    return RunOne(a, numbers[index]);
  };
  return RunCampaign(campaign);
}

void Run(Arguments& arguments) {
  if (!arguments.sheet.empty()) {
    WriteSheet(arguments);
    return;
  }
  std::filesystem::create_directories(arguments.out);
  if (!arguments.summarize && !RunAll(arguments)) return;
  Summarize(arguments.out);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "How a tracker does on frames in which the tip hides",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
