// How well a calibrated camera knows where a point is seen, as the calibrate commands write it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/uncertainty/next_view.h"
#include "calibration/uncertainty/projection_uncertainty.h"
#include "report/figure.h"

namespace flextip {

/// Over the picture, at the depth the boards were at and at infinity.
struct CameraUncertainty {
  std::string camera;  ///< "cam0"
  UncertaintyMap near, far;
  std::vector<NextView> next;  ///< the best ones first; empty where none was looked for
};

/// Empty where the views do not determine the camera. `x_B`: the board's corners; empty: no next
/// view is looked for.
std::optional<CameraUncertainty> FindUncertainty(const CameraSolution& solution,
                                                 const std::vector<Eigen::Vector3d>& x_B);
/// Of one of two cameras that were calibrated together.
std::optional<CameraUncertainty> FindUncertainty(const StereoSolution& solution, int eye);

/// `working_distance_m`, of both maps mean, largest and centre, and `next_views`.
nlohmann::json UncertaintyJson(const CameraUncertainty& uncertainty);
/// Two fields, at the working distance and at infinity, with a line around the corners seen.
std::vector<report::Figure> UncertaintyFigures(const CameraUncertainty& uncertainty,
                                               const std::vector<SolvedView>& views);
/// `#x [px],y [px],depth [m],sd [px],sd_across [mm]`; at infinity depth and sd_across are empty.
std::string UncertaintyTable(const CameraUncertainty& uncertainty);

/// Writes FOLDER/cam0_uncertainty.csv and adds its figures to `figures` and
/// `projection_uncertainty`, with the views to add next, to a summary. Nothing where the views do
/// not determine the camera.
void AddUncertainty(const std::filesystem::path& folder, const CameraSolution& solution,
                    const std::vector<Eigen::Vector3d>& x_B, nlohmann::json& summary,
                    std::vector<report::Figure>& figures);

}  // namespace flextip
