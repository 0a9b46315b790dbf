#include "apps/calibrate/board_json.h"

#include "calibration/camera/camera_board_shape.h"

namespace flextip {

nlohmann::json BoardShapeJson(const BoardShape& shape, const std::string& reason) {
  nlohmann::json json = {{"estimated", shape.sd_m > 0}, {"reason", reason}};
  if (!(shape.sd_m > 0)) return json;
  const auto [rms_m, longest_m] = SizeOf(shape);
  json.update({{"rms_m", rms_m}, {"longest_m", longest_m}, {"prior_sd_m", shape.sd_m}});
  for (const auto& [id, offset] : shape.offset_B) {
    json["offsets_m"].push_back({id, offset.x(), offset.y(), offset.z()});
  }
  return json;
}

}  // namespace flextip
