// What plain regressions leave of an arm's recording that is not fitted, beside its diagnosis.
#include <fmt/format.h>

#include <filesystem>

#include "arms/diagnose/diagnose.h"
#include "arms/diagnose/predict.h"
#include "bench/arm_regressions/regress.h"
#include "bench/tool.h"
#include "recording/recording_reader.h"

namespace flextip::bench {
namespace {

struct Arguments {
  std::vector<std::filesystem::path> fitted;
  std::filesystem::path other;
  bool halves = false;
};

void AddOptions(CLI::App& app, Arguments& arguments) {
  app.add_option("FITTED", arguments.fitted, "Recordings to fit")->required();
  app.add_option("--on", arguments.other, "The recording to predict");
  app.add_flag("--halves", arguments.halves, "Fit each half of FITTED's last, predict the other");
  app.footer("Example:\n  flextip_arm_regressions wrist_a wrist_b --on random_motion");
}

/// Rows of every stream of the arm within two parts of the recording's time.
arms::ArmData PartOf(Recording recording, double from, double to, const std::string& name) {
  const auto& all = recording.joints_command0 ? recording.joints_command0 : recording.joints0;
  const TimeNs begin = all->q.front().t_ns;
  const double whole = double(all->q.back().t_ns - begin);
  const auto cut = [&](auto& samples) {
    std::erase_if(samples, [&](const auto& sample) {
      const double at = double(sample.t_ns - begin) / whole;
      return at < from || at > to;
    });
  };
  for (auto* joints : {&recording.joints0, &recording.joints_seen0, &recording.joints_command0})
    if (*joints) cut((*joints)->q);
  if (recording.torque0) cut(recording.torque0->tau);
  if (recording.pose0) cut(recording.pose0->samples);
  return {recording, name};
}

void Compare(const std::vector<arms::ArmData>& fitted, const arms::ArmData& other) {
  if (!other.seen.Any() && !other.followed.Any())
    throw InputError(
        fmt::format("{}: expected joints_seen0, or joints0 with commands", other.name));
  const arms::ArmPrediction found = Predict(other, arms::Diagnose(fitted).model);
  std::vector<Left> all =
      other.seen.Any() ? RegressSeen(fitted, other) : RegressFollowed(fitted, other);
  Left diagnosis{"diagnosis", found.extended_tip_rms_m, Eigen::VectorXd::Zero(other.Size())};
  for (int i = 0; i < other.Size(); ++i) {
    const bool turns = other.arm.joints[std::size_t(i)].type == JointType::kRevolute;
    diagnosis.joints[i] = found.extended_rms.at(fmt::format(
        "{}_q{}_{}", other.seen.Any() ? "joints_seen0" : "joints0", i + 1, turns ? "rad" : "m"));
  }
  all.push_back(diagnosis);
  fmt::print("\nleft of {}\n\n| fitted | tip, mm |", other.name);
  for (int i = 0; i < other.Size(); ++i) fmt::print(" joint {} |", i + 1);
  fmt::print("\n|---|---|");
  for (int i = 0; i < other.Size(); ++i) fmt::print("---|");
  for (const Left& left : all) {
    fmt::print("\n| {} | {:.2f} |", left.name, 1e3 * left.tip_m);
    for (const double joint : left.joints) fmt::print(" {:.2f} |", 1e3 * joint);
  }
  fmt::print("\n");
}

void Run(Arguments& arguments) {
  if (arguments.other.empty() && !arguments.halves)
    throw InputError("expected --on OTHER or --halves: what is to be predicted");
  std::vector<arms::ArmData> fitted;
  for (const auto& folder : arguments.fitted)
    fitted.emplace_back(ReadRecording(folder).recording, folder.filename().string());
  if (!arguments.other.empty()) {
    Compare(fitted,
            {ReadRecording(arguments.other).recording, arguments.other.filename().string()});
  }
  if (!arguments.halves) return;
  const Recording last = ReadRecording(arguments.fitted.back()).recording;
  const std::string name = fitted.back().name;
  fitted.pop_back();
  const arms::ArmData first = PartOf(last, 0.0, 0.5, name + ", first half"),
                      second = PartOf(last, 0.5, 1.0, name + ", second half");
  for (const bool turned : {false, true}) {
    auto with = fitted;
    with.push_back(turned ? second : first);
    Compare(with, turned ? first : second);
  }
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool<flextip::bench::Arguments>(
      argc, argv, "What plain regressions of an arm's joints leave, beside its diagnosis",
      flextip::bench::AddOptions, flextip::bench::Run);
}
