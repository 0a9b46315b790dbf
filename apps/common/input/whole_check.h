// The check of a whole recording, its pictures included, whatever a command will use of it.
#pragma once

#include <filesystem>

#include "plausibility/check_recording.h"
#include "recording/recording.h"

namespace flextip {

/// Checks `recording`, read from `folder`, and the pictures of its cam0 where `with_pictures`. A
/// picture that cannot be read, or of another size than stated, is a finding.
plausibility::CheckResult CheckWhole(const std::filesystem::path& folder,
                                     const Recording& recording, bool with_pictures);

}  // namespace flextip
