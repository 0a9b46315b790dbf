// Messages that viewers know, as JSON: Foxglove's, with JSON schemas of the same names
// (docs.foxglove.dev, schemas).
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "core/camera.h"
#include "exports/timed_table.h"

namespace flextip::exports {

/// A schema's name and its text.
struct MessageSchema {
  std::string name, text;
};

const MessageSchema& PoseSchema();         ///< foxglove.PoseInFrame
const MessageSchema& PathSchema();         ///< foxglove.PosesInFrame
const MessageSchema& ImageSchema();        ///< foxglove.CompressedImage
const MessageSchema& AnnotationsSchema();  ///< foxglove.ImageAnnotations
const MessageSchema& CameraSchema();       ///< foxglove.CameraCalibration
const MessageSchema& TransformSchema();    ///< foxglove.FrameTransform
/// A table's columns but the time, as numbers or texts: what plots show.
MessageSchema TableSchema(const TimedTable& table);

std::string PoseMessage(const TimedPose& pose, const std::string& frame);
std::string PathMessage(const std::vector<TimedPose>& poses, const std::string& frame);
/// `format`: "png" or "jpeg".
std::string ImageMessage(TimeNs t_ns, const std::string& frame, const std::string& bytes,
                         const std::string& format);
std::string CameraMessage(TimeNs t_ns, const std::string& frame, const CameraCalibration& camera);
std::string TransformMessage(TimeNs t_ns, const std::string& parent, const std::string& child,
                             const Pose& pose);
/// A row of a table: its finite numbers, and its texts.
std::string RowMessage(const TimedTable& table, std::size_t row);

/// What is drawn over a picture, in px.
struct Annotations {
  struct Outline {
    std::vector<Eigen::Vector2d> corners;
    bool closed = true;
    std::string text = {};  ///< at the first corner
  };
  std::vector<Outline> outlines;
  std::vector<Eigen::Vector2d> marks;  ///< circles
};
std::string AnnotationsMessage(TimeNs t_ns, const Annotations& annotations);

}  // namespace flextip::exports
