// What cameras of videos and of bags have in common.
#pragma once

#include <string>

#include "exchange/formats/formats.h"
#include "recording/cameras/camera_formats.h"

namespace flextip::exchange {

/// Reads `plan.camera` and the pose: that of `plan.pose`, else the camera file's. `width_px` and
/// `height_px` are the frames'; a camera of another size is refused. A pose that nobody states
/// stays unknown, which is said. Throws InputError.
CameraStream ReadCameraOf(const std::string& name, const CameraPlan& plan, int width_px,
                          int height_px, ImportLog& log);

/// The same with a camera that was read already.
CameraStream PlaceCamera(const std::string& name, const CameraPlan& plan,
                         const CameraDescription& camera, ImportLog& log);

/// Takes the rate from the times of the frames.
void TakeFrameRate(CameraStream& camera);

/// Adds the tags of `plan.collar`, where it is told.
void ReadCollar(ImportPlan& plan, Recording& recording, ImportLog& log);

}  // namespace flextip::exchange
