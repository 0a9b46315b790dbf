// How well a calibrated camera knows where a point is seen, as the calibrate commands write it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/uncertainty/camera_uncertainty.h"
#include "report/figure.h"

namespace flextip {

/// `working_distance_m`, of both maps mean, largest and centre, and `next_views`.
nlohmann::json UncertaintyJson(const CameraUncertainty& uncertainty);

/// Writes FOLDER/CAMERA_uncertainty.csv: `#x [px],y [px],depth [m],sd [px],sd_across [mm]`, at
/// infinity without depth and sd_across. Adds two fields to `figures`, at the working distance and
/// at infinity, with a line around the corners of `views`. `camera`: "cam0".
void WriteUncertainty(const std::filesystem::path& folder, const std::string& camera,
                      const CameraUncertainty& uncertainty, const std::vector<SolvedView>& views,
                      std::vector<report::Figure>& figures);

}  // namespace flextip
