#include "apps/track/check.h"

#include <fmt/format.h>

#include <memory>

#include "apps/common/input/command_uses.h"
#include "apps/common/input/input_check.h"

namespace flextip {
namespace {

/// Opens the pictures once more, to look at a few; null where they come but once.
std::unique_ptr<FrameSource> PicturesOf(const TrackOptions& options, const TrackInput& input) {
  if (!options.live.empty()) return nullptr;
  const auto& range = options.black_white;
  const GreyRange grey = range.empty() ? GreyRange{} : GreyRange{range[0], range[1]};
  const CameraStream& camera = *input.recording.cam0;
  if (options.IsRecording()) return OpenRecordedFrames(options.source, "cam0", camera, grey);
  std::optional<double> rate_hz;
  if (options.rate_hz > 0) rate_hz = options.rate_hz;
  return OpenPlainFrames(options.source, camera.calibration, rate_hz, grey);
}

/// A folder's pictures are decoded one by one, a video's all that come before: only its beginning
/// is looked at.
double ShareOf(const TrackOptions& options, const TrackInput& input) {
  constexpr double kBeginning = 0.1;
  const bool video = options.IsRecording() ? !input.recording.cam0->video.empty()
                                           : std::filesystem::is_regular_file(options.source);
  return video ? kBeginning : 1.0;
}

}  // namespace

std::vector<plausibility::Finding> CheckTrackInput(const TrackOptions& options, TrackInput& input,
                                                   bool quiet) {
  plausibility::CommandUse use = UseOfTrack(!options.no_model && input.recording.wrist0);
  if (!options.IsRecording()) use.unknown = {"port", "length", "stiffness", "cam0.T_RC"};
  const InputCheck check{options.no_check, quiet};
  const auto frames = options.no_check ? nullptr : PicturesOf(options, input);
  if (!input.recording.cam0->has_T_RC) use.unknown.insert("cam0.T_RC");
  return CheckInput(check, use, input.recording, {frames.get(), ShareOf(options, input)});
}

}  // namespace flextip
