// CameraInfo messages as cameras.
#pragma once

#include <optional>
#include <string>

#include "exchange/bags/messages.h"
#include "recording/cameras/camera_formats.h"

namespace flextip::exchange {

/// The camera of pictures from `picture_topic`; of rectified ones (a topic with "rect" in its name)
/// that of P, without distortion. Empty for a driver without a calibration (K of zeros). Throws
/// InputError, which begins with `topic`, for a lens that a recording cannot hold.
std::optional<CameraDescription> CameraOf(const CameraInfoMessage& info, const std::string& topic,
                                          const std::string& picture_topic);

}  // namespace flextip::exchange
