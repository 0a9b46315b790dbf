// flextip calibrate hand-eye: where camera and board, or the tag collar, are on or beside the
// robot.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/calibrate/calibrate.h"
#include "apps/calibrate/hand_eye/output.h"
#include "apps/calibrate/verdict_json.h"
#include "apps/common/input/command_uses.h"
#include "apps/common/input/findings.h"
#include "apps/common/input/input_check.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "calibration/hand_eye/hand_eye.h"
#include "calibration/hand_eye/recorded_views.h"
#include "calibration/verdict/hand_eye.h"
#include "core/error.h"
#include "recording/cameras/camera_file.h"
#include "recording/frames/frames.h"
#include "recording/recording_reader.h"
#include "report/pages.h"

namespace flextip {
namespace {

constexpr std::size_t kPictures = 12;

struct HandEyeCommand {
  std::filesystem::path recording, out, camera;
  std::string board;
  bool eye_in_hand = false, refine_intrinsics = false, no_time_offset = false, force = false;
  bool no_check = false;
  int max_views = 80;
};

std::string CheckStreams(const HandEyeCommand& options, const Recording& recording) {
  const auto missing = [&](const std::string& what) {
    return InputError::At(options.recording.string(), 0, what);
  };
  if (!recording.cam0) throw missing("hand-eye needs cam0");
  if (!recording.wrist0) throw missing("hand-eye needs wrist0");
  const auto& wrist = recording.wrist0->samples;
  const bool turns = std::any_of(wrist.begin(), wrist.end(),
                                 [](const auto& sample) { return sample.value.q_RW.has_value(); });
  if (!turns) throw missing("wrist0 has no orientations, hand-eye needs them");
  if (!options.board.empty()) return "board";
  if (!recording.tags0) throw missing("no tags0 to calibrate with; give a --board");
  if (options.eye_in_hand)
    throw missing("--eye-in-hand needs a --board: the collar is on the wrist");
  return "tags0";
}

// The worst views first, then those spread evenly.
std::vector<std::size_t> ViewsToShow(const HandEyeResult& result) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < result.views.size(); ++i) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return result.views[a].chi2 > result.views[b].chi2;
  });
  if (order.size() > kPictures) order.resize(kPictures);
  std::sort(order.begin(), order.end());
  return order;
}

void WriteOverlays(const HandEyeCommand& options, const CameraStream& camera,
                   const std::vector<std::size_t>& frames, const HandEyeResult& result,
                   const std::filesystem::path& folder) {
  std::vector<std::size_t> shown_views = ViewsToShow(result), shown_frames;
  for (const std::size_t view : shown_views) shown_frames.push_back(frames[view]);
  std::size_t next = 0;
  ShowFrames(options.recording, camera, shown_frames, [&](std::size_t frame, const Image& image) {
    Image picture = ToColour(image);
    DrawHandEyeView(picture, result.views[shown_views[next++]]);
    WritePng(folder / "overlay" / fmt::format("{:05}.png", frame), picture);
  });
}

void WriteResults(const HandEyeCommand& options, const Recording& recording,
                  const std::string& target, const std::vector<std::size_t>& frames,
                  const HandEyeResult& result, OutputFolder& output, bool quiet) {
  const Calibration calibration = HandEyeCalibration(result, target);
  WriteCalibration(output.folder() / "calibration.yaml", calibration);
  WriteHandEyeTables(output.folder(), result);
  WriteOverlays(options, *recording.cam0, frames, result, output.folder());
  for (const HandEyeViewResult& view : result.views) {
    if (!view.used) output.Warn(fmt::format("{}: {}", view.name, view.reason));
  }
  for (const auto& u : calibration.unobservable) {
    output.Warn(fmt::format("{} is not known: {}", u.parameter, u.reason));
  }
  nlohmann::json summary = HandEyeSummary(result, calibration);
  summary["target"] = target == "board" ? options.board : "tags0";
  summary["verdict"] = VerdictJson(JudgeHandEye(result, calibration));
  summary["mount"] = options.eye_in_hand ? "eye-in-hand" : "eye-to-hand";
  output.WriteSummary(summary);
  report::WriteCalibrateReport(output.folder());
  output.Commit();
  if (!quiet) fmt::print("{}", HandEyeInWords(result, calibration));
}

void RunHandEye(const HandEyeCommand& options, bool quiet) {
  std::optional<BoardSpec> board;
  if (!options.board.empty()) board = ParseBoardSpec(options.board);
  ReadResult read = ReadRecording(options.recording);
  const Recording& recording = read.recording;
  const std::string target = CheckStreams(options, recording);
  const auto findings =
      CheckInput({options.no_check, quiet}, UseOfHandEye(target == "tags0"), read.recording);
  OutputFolder output(options.out, "calibrate hand-eye",
                      {.force = options.force,
                       .inputs = {options.recording},
                       .paths = {.recording = options.recording}});
  output.Warn(read.warnings);
  output.Beware(FindingsJson(findings));

  HandEyeInput input;
  input.mount = options.eye_in_hand ? HandEyeMount::kEyeInHand : HandEyeMount::kEyeToHand;
  input.camera =
      options.camera.empty() ? recording.cam0->calibration : ReadCameraCalibration(options.camera);
  input.wrist = *recording.wrist0;
  std::vector<std::size_t> frames;
  input.views = FindHandEyeViews(options.recording, recording, board, options.max_views, frames,
                                 ProgressFunction("pictures", quiet));
  const HandEyeResult result =
      CalibrateHandEye(input, {.estimate_time_offset = !options.no_time_offset,
                               .refine_intrinsics = options.refine_intrinsics});
  if (!result.IsUsable()) {
    std::string message = fmt::format("calibrate hand-eye: {}", result.message);
    if (result.fits_other_mount) {
      message += options.eye_in_hand ? " (without --eye-in-hand)" : " (--eye-in-hand)";
    }
    for (const HandEyeViewResult& view : result.views) {
      if (view.reason.empty()) continue;
      message += fmt::format("; {}: {}", view.name, view.reason);
      break;  // one line; the first says what is wrong
    }
    throw WorkError(message);
  }
  WriteResults(options, recording, target, frames, result, output, quiet);
}

}  // namespace

void AddCalibrateHandEye(CLI::App& calibrate, AppContext& context) {
  auto* command = calibrate.add_subcommand(
      "hand-eye", "The camera in the robot's frame, and the board or tag collar on the wrist");
  auto options = std::make_shared<HandEyeCommand>();
  command->add_option("recording", options->recording, "Folder with cam0 and wrist0")
      ->required()
      ->type_name("RECORDING");
  command->add_option("-o,--output", options->out, "Folder for the results")->required();
  command
      ->add_option("--board", options->board,
                   "As in calibrate camera; without it the tag collar of tags0 is the target")
      ->type_name("SPEC");
  command->add_flag("--eye-in-hand", options->eye_in_hand,
                    "The camera is on the wrist and the board stands still");
  command->add_option("--camera", options->camera, "A sensor.yaml in the place of cam0's");
  command->add_flag("--refine-intrinsics", options->refine_intrinsics,
                    "Fit focal lengths and principal point too");
  command->add_flag("--no-time-offset", options->no_time_offset,
                    "Camera and robot are stamped by one clock");
  command->add_option("--views", options->max_views, "Most pictures to use, spread evenly")
      ->check(CLI::Range(3, 1000))
      ->capture_default_str();
  AddNoCheckOption(*command, options->no_check);
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Example:\n"
      "  flextip calibrate hand-eye RECORDING --board chessboard:9x6:0.025 -o hand_eye\n");
  OnRun(*command, context, [options, &context] { RunHandEye(*options, context.quiet); });
}

}  // namespace flextip
