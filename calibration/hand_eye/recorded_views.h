// The views of a hand-eye calibration from a recording's pictures.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "calibration/hand_eye/hand_eye.h"
#include "core/image.h"
#include "recording/recording.h"

namespace flextip {

/// A board, or the collar of `recording.tags0` where there is none, looked for in at most
/// `max_views` pictures of cam0, spread evenly. `progress` is told how many were looked at, of how
/// many. `frames` gets each view's place among cam0's pictures.
std::vector<HandEyeView> FindHandEyeViews(
    const std::filesystem::path& folder, const Recording& recording,
    const std::optional<BoardSpec>& board, int max_views, std::vector<std::size_t>& frames,
    const std::function<void(std::size_t, std::size_t)>& progress);

/// Calls `show` with each of these pictures of cam0 (places in rising order).
void ShowFrames(const std::filesystem::path& folder, const CameraStream& camera,
                const std::vector<std::size_t>& frames,
                const std::function<void(std::size_t, Image)>& show);

}  // namespace flextip
