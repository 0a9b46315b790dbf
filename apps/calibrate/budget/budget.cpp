// flextip calibrate budget: what each calibration contributes to the tip's error.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "apps/calibrate/budget/output.h"
#include "apps/calibrate/calibrate.h"
#include "apps/common/input/command_uses.h"
#include "apps/common/input/findings.h"
#include "apps/common/input/recording_input.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "apps/common/vector_option.h"
#include "core/error.h"
#include "kinematics/tip_bending.h"
#include "recording/frames/frame_source.h"
#include "recording/resample.h"

namespace flextip {
namespace {

struct CalibrateBudgetOptions {
  RecordingInput input;
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  bool force_given = false;
  int frames = 50;
  bool force = false;
};

// The command that makes the calibration of a part.
const char* CommandFor(const std::string& part) {
  static const std::map<std::string, const char*> commands = {{"lens", "camera"},
                                                              {"hand-eye", "hand-eye"},
                                                              {"tip offset", "tip"},
                                                              {"stiffness", "stiffness"}};
  return commands.at(part);
}

std::vector<UnknownPart> UnknownParts(const CalibrateBudgetOptions& options,
                                      const Recording& recording, const StatedChain& chain) {
  std::vector<UnknownPart> unknown;
  for (const auto& [part, parameter] : chain.missing) {
    unknown.push_back(
        {part,
         fmt::format("no calibration with a covariance of {} was given (flextip calibrate {})",
                     parameter, CommandFor(part))});
  }
  if (!options.force_given && !recording.load0) {
    unknown.push_back({"bending", "no force on the tip is known: load0 or --tip-force"});
  }
  return unknown;
}

std::optional<TipBending> BendingAt(const CalibrateBudgetOptions& options,
                                    const Recording& recording, const StatedChain& chain,
                                    TimeNs t_ns) {
  const FreeEnd end = FreeEndOf(recording.instrument, *recording.tags0, recording.gravity_m_s2);
  TipBending bending{.f_R = options.force_N,
                     .weight_N_m = end.weight_N_m,
                     .stiffness_Nm2 = end.bending_stiffness_Nm2,
                     .stiffness_sd_Nm2 = chain.stiffness_sd_Nm2};
  if (options.force_given) return bending;
  const auto load = recording.load0 ? LoadAt(*recording.load0, t_ns) : std::nullopt;
  if (!load) return {};
  bending.f_R = *load;
  bending.corrected = true;  // by the tracker, which reads the same load
  bending.force_noise_N = recording.load0->force_noise_N;
  return bending;
}

// The tracker's own covariance, where it found the tip in that frame: it knows more than corners.
// The load's part is in it.
void UseTrackedCovariance(const Recording& recording, TimeNs t_ns, TipBudget& budget) {
  const auto tip = recording.vision0 ? TipAt(*recording.vision0, t_ns) : std::nullopt;
  if (!tip || tip->value.status != TipStatus::kOk) return;
  for (BudgetPart& part : budget.parts) {
    if (part.name == "pixels") part.covariance_R = tip->value.covariance_m2;
    if (part.name == "load") part.in_total = false;
  }
}

// `options.frames` frames, spread over the recording.
std::vector<TimedBudget> Budgets(const CalibrateBudgetOptions& options, const Recording& recording,
                                 const StatedChain& chain, bool quiet) {
  TagDetectorOptions detector_options;
  detector_options.family = recording.tags0->family;
  TagDetector detector(detector_options);
  const auto frames = OpenRecordedFrames(options.input.recording, "cam0", *recording.cam0);
  const std::size_t count = std::max<std::size_t>(1, frames->Count());
  const std::size_t step = std::max<std::size_t>(1, count / options.frames);
  std::vector<TimedBudget> budgets;
  Progress progress("frames", count, quiet);
  std::size_t at = 0;
  while (const auto frame = frames->Next()) {
    const auto tags = detector.Detect(frame->image);
    auto budget = BudgetOfTip(recording.cam0->calibration, *recording.tags0, tags, chain.covariance,
                              BendingAt(options, recording, chain, frame->t_ns));
    if (budget) {
      UseTrackedCovariance(recording, frame->t_ns, *budget);
      budgets.push_back({frame->t_ns, *budget});
    }
    frames->Skip(step - 1);
    at += step;
    progress.Update(std::min(at, count));
  }
  return budgets;
}

void RunCalibrateBudget(const CalibrateBudgetOptions& options, bool quiet) {
  OutputFolder output(
      options.input.out, "calibrate budget",
      {.force = options.force, .inputs = options.input.Files(), .paths = options.input.Paths()});
  const InputRead read = ReadInput(options.input, UseOfBudget(), quiet);
  if (!read.recording.cam0 || !read.recording.tags0) {
    throw InputError::At(options.input.recording.string(), 0,
                         "has no cam0 or no tags0: the tip is seen by neither");
  }
  if (!read.recording.cam0->has_T_RC) {
    throw InputError::At(options.input.recording.string(), 0,
                         "cam0: T_RC is unknown, expected --calibration of calibrate hand-eye");
  }
  output.Warn(read.warnings);
  output.Beware(FindingsJson(read.findings));
  std::vector<const Calibration*> calibrations;
  for (const UsedCalibration& used : read.calibrations) calibrations.push_back(&used.calibration);
  const StatedChain chain = GatherChain(calibrations);
  const auto budgets = Budgets(options, read.recording, chain, quiet);
  if (budgets.empty()) throw WorkError("calibrate budget: the collar is seen in no frame");
  WriteBudgetResults(output, budgets, UnknownParts(options, read.recording, chain),
                     CalibrationsJson(read.calibrations));
  if (quiet) return;
  fmt::print("{}", BudgetText(budgets));
}

}  // namespace

void AddCalibrateBudget(CLI::App& calibrate, AppContext& context) {
  auto* command = calibrate.add_subcommand(
      "budget", "What lens, hand-eye, tip offset and bending contribute to the tip's error");
  auto options = std::make_shared<CalibrateBudgetOptions>();
  AddRecordingInput(*command, options->input);
  auto* force = AddVectorOption(*command, "--tip-force", options->force_N,
                                "Force on the tip in R (N), in place of load0");
  command->add_option("--frames", options->frames, "So many, spread over the recording")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Example:\n"
      "  flextip calibrate budget RECORDING --calibration lens/calibration.yaml \\\n"
      "    --calibration hand_eye/calibration.yaml --tip-force 0,0.2,0 -o budget\n");
  OnRun(*command, context, [options, force, &context] {
    options->force_given = force->count() > 0;
    RunCalibrateBudget(*options, context.quiet);
  });
}

}  // namespace flextip
