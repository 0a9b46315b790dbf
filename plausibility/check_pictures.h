// Checks a recording's pictures against its collar, camera and wrist.
#pragma once

#include <vector>

#include "plausibility/finding.h"
#include "recording/frames/frame_source.h"
#include "recording/recording.h"

namespace flextip::plausibility {

struct PictureOptions {
  std::size_t pictures = 6;  ///< looked at, spread over all
};

/// Finds tags of another family or size than stated, and pictures that stand still. `frames` are
/// those of cam0 from the first on. Throws InputError for an unreadable frame.
std::vector<Finding> CheckPictures(const Recording& recording, FrameSource& frames,
                                   const PictureOptions& options = {});

}  // namespace flextip::plausibility
