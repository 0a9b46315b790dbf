#include "apps/common/input/whole_check.h"

#include <fmt/format.h>

#include "core/error.h"
#include "plausibility/pictures/check_pictures.h"
#include "recording/frames/frame_source.h"

namespace flextip {

plausibility::CheckResult CheckWhole(const std::filesystem::path& folder,
                                     const Recording& recording, bool with_pictures) {
  plausibility::CheckResult result = plausibility::CheckRecording(recording);
  if (!with_pictures || !recording.cam0) return result;
  if (recording.cam0->filenames.empty() && recording.cam0->frame_numbers.empty()) return result;
  try {
    const auto frames = OpenRecordedFrames(folder, "cam0", *recording.cam0);
    plausibility::CheckPictures(recording, *frames, {}, {}, result);
  } catch (const InputError& error) {
    result.findings.push_back(
        {plausibility::Severity::kWrong, "cam0.frames", fmt::format("cam0: {}", error.what()), ""});
    plausibility::SortFindings(result.findings);
  }
  return result;
}

}  // namespace flextip
