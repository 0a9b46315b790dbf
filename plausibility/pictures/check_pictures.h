// Checks a recording's pictures against its collar, its camera and its wrist.
#pragma once

#include "plausibility/check_recording.h"
#include "plausibility/finding.h"
#include "recording/frames/frame_source.h"
#include "recording/recording.h"

namespace flextip::plausibility {

struct PictureOptions {
  std::size_t pictures = 6;  ///< looked at
  double share = 1.0;        ///< of all pictures that these are spread over, from the first on
};

/// Finds tags of another family, other ids or another size than stated, pictures that stand still,
/// and tips that lie elsewhere, or at another time, than wrist and port have them. Adds the
/// findings to those of CheckRecording in `so_far`, and takes a doubt of the camera's clock away
/// that the pictures refute. `frames` are those of cam0 from the first on. Throws InputError for an
/// unreadable frame.
void CheckPictures(const Recording& recording, FrameSource& frames, const CheckOptions& known,
                   const PictureOptions& options, CheckResult& so_far);

}  // namespace flextip::plausibility
