// What flextip calibrate hand-eye writes.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "calibration/hand_eye/hand_eye.h"
#include "core/image.h"

namespace flextip {

nlohmann::json HandEyeSummary(const HandEyeResult& result, const Calibration& calibration);

/// residuals.csv, a row a view, and figures.json.
void WriteHandEyeTables(const std::filesystem::path& folder, const HandEyeResult& result);

/// Corners as seen (green) and as the chain has them (red), with the view's error.
void DrawHandEyeView(Image& image, const HandEyeViewResult& view);

/// A line or two for a terminal.
std::string HandEyeInWords(const HandEyeResult& result, const Calibration& calibration);

}  // namespace flextip
