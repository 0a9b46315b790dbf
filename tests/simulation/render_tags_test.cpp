// The AprilTag library reads the collar in rendered frames, and its corners give the collar's pose.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/rotation.h"
#include "tests/simulation/render_test_scene.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

namespace flextip::simulation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using namespace render_test;

struct Detection {
  int id;
  Vector2d corner_px[4];  // at G's (-,+), (+,+), (+,-), (-,-)
};

std::vector<Detection> Detect(const Image& image) {
  cv::Mat grey(image.height_px, image.width_px, CV_8UC3, const_cast<std::uint8_t*>(image.Row(0)));
  cv::Mat single;
  cv::cvtColor(grey, single, cv::COLOR_BGR2GRAY);
  const std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family(tag36h11_create(),
                                                                                tag36h11_destroy);
  const std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector(
      apriltag_detector_create(), apriltag_detector_destroy);
  apriltag_detector_add_family(detector.get(), family.get());
  detector->quad_decimate = 1;
  image_u8_t view{single.cols, single.rows, static_cast<int>(single.step), single.data};
  zarray_t* found = apriltag_detector_detect(detector.get(), &view);
  std::vector<Detection> detections;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* d = nullptr;
    zarray_get(found, i, &d);
    Detection detection{d->id, {}};
    for (int k = 0; k < 4; ++k) {  // its pixel (0, 0) has its centre at (0.5, 0.5)
      detection.corner_px[k] = Vector2d(d->p[k][0] - 0.5, d->p[k][1] - 0.5);
    }
    detections.push_back(detection);
  }
  apriltag_detections_destroy(found);
  return detections;
}

std::vector<Vector3d> Corners_E(const CollarTag& tag) {
  const double h = 0.5 * tag.size_m;
  return {tag.T_EG * Vector3d(-h, h, 0), tag.T_EG * Vector3d(h, h, 0),
          tag.T_EG * Vector3d(h, -h, 0), tag.T_EG * Vector3d(-h, -h, 0)};
}

// The angle between the view and a tag's normal decides whether it is seen well.
double Facing(const CollarTag& tag, const Pose& T_CE) {
  const Vector3d at = T_CE * tag.T_EG.p;
  return (T_CE.R * tag.T_EG.R.col(2)).dot(at.normalized());
}

struct Frame {
  ShaftCurve curve;
  Pose T_CE;
};
// A shaft in the sample camera's view, turned about its axis and moved with the frame's number.
Frame MakeFrame(const CameraCalibration& camera, int number) {
  Frame frame;
  Pose T_RE;
  T_RE.R = ExpRotation({0, 0.03 * number, 0.12 * std::sin(1.0 * number)}) *
           ExpRotation({0.9 + 0.35 * number, 0, 0});
  T_RE.p = {0.218 - 0.002 * number, 0.003 * std::cos(2.0 * number), 0.0015 * number};
  frame.curve = ArcShaft(T_RE, 0.42, 0.9, 0.005);
  frame.T_CE = camera.T_RC.Inverse() * T_RE;
  return frame;
}

LaparoscopeOptions SampleOptions() {
  LaparoscopeOptions o;
  o.tissue.point_R = {0.2, 0, -0.045};
  return o;
}

TEST(RenderTags, EveryTagThatFacesTheCameraIsReadInPlace) {
  const CameraCalibration camera = SampleCamera();
  const TagCollar collar = HexagonCollar();
  const Laparoscope scope(camera, collar, SampleOptions());
  int read = 0;
  for (int number = 0; number < 8; ++number) {
    const Frame frame = MakeFrame(camera, number);
    const std::vector<Detection> detections = Detect(scope.Render(frame.curve, number));
    for (const CollarTag& tag : collar.tags) {
      const auto found = std::find_if(detections.begin(), detections.end(),
                                      [&](const Detection& d) { return d.id == tag.id; });
      if (Facing(tag, frame.T_CE) > 0.5) {
        EXPECT_NE(found, detections.end()) << "frame " << number << " tag " << tag.id;
      }
      if (found == detections.end()) continue;
      EXPECT_GT(Facing(tag, frame.T_CE), 0) << "a tag that cannot be seen";
      ++read;
      std::vector<Vector3d> corners_C;
      for (const Vector3d& x : Corners_E(tag)) corners_C.push_back(frame.T_CE * x);
      const std::vector<Vector2d> expected = Project(camera, corners_C);
      for (int k = 0; k < 4; ++k) {
        EXPECT_LT((found->corner_px[k] - expected[static_cast<std::size_t>(k)]).norm(), 1.0)
            << "frame " << number << " tag " << tag.id << " corner " << k;
      }
    }
    EXPECT_TRUE(std::all_of(detections.begin(), detections.end(),
                            [](const Detection& d) { return d.id < 6; }));
  }
  EXPECT_GE(read, 16);
}

// Distances of the pose by cv::solvePnP from the truth, the worst of eight frames.
struct PoseError {
  double distance_mm = 0, angle_deg = 0;
};
PoseError WorstPoseError(double blur_sigma_px) {
  CameraCalibration camera = SampleCamera();
  camera.gamma = 1.0;
  const TagCollar collar = HexagonCollar();
  LaparoscopeOptions o = SampleOptions();
  o.full_well_electrons = 0;
  o.blur_sigma_px = blur_sigma_px;
  PoseError worst;
  const Laparoscope scope(camera, collar, o);
  const cv::Matx33d K(camera.fu_px, 0, camera.cu_px, 0, camera.fv_px, camera.cv_px, 0, 0, 1);
  for (int number = 0; number < 8; ++number) {
    const Frame frame = MakeFrame(camera, number);
    std::vector<cv::Point3d> x_E;
    std::vector<cv::Point2d> px;
    for (const Detection& d : Detect(scope.Render(frame.curve, number))) {
      const std::vector<Vector3d> corners = Corners_E(collar.tags[static_cast<std::size_t>(d.id)]);
      for (int k = 0; k < 4; ++k) {
        const Vector3d& x = corners[static_cast<std::size_t>(k)];
        x_E.emplace_back(x.x(), x.y(), x.z());
        px.emplace_back(d.corner_px[k].x(), d.corner_px[k].y());
      }
    }
    EXPECT_GE(x_E.size(), 8u) << "frame " << number;
    cv::Vec3d rotation, position;
    EXPECT_TRUE(cv::solvePnP(x_E, px, K, camera.distortion_coefficients, rotation, position, false,
                             cv::SOLVEPNP_SQPNP));
    cv::solvePnPRefineLM(x_E, px, K, camera.distortion_coefficients, rotation, position);
    const Vector3d w(rotation[0], rotation[1], rotation[2]);
    const Pose found_CE{ExpRotation(w), {position[0], position[1], position[2]}};
    const Vector3d collar_E(-0.03, 0, 0);
    const double distance_mm = 1e3 * (found_CE * collar_E - frame.T_CE * collar_E).norm();
    const double angle_deg =
        LogRotation(found_CE.R.transpose() * frame.T_CE.R).norm() * 180 / std::numbers::pi;
    worst.distance_mm = std::max(worst.distance_mm, distance_mm);
    worst.angle_deg = std::max(worst.angle_deg, angle_deg);
  }
  return worst;
}

TEST(RenderTags, CornersOfSharpFramesGiveTheCollarsPose) {
  const PoseError worst = WorstPoseError(0.0);
  EXPECT_LT(worst.distance_mm, 0.1);
  EXPECT_LT(worst.angle_deg, 0.3);
}

TEST(RenderTags, CornersOfBlurredFramesAreOffByTheLibrarysBias) {
  // The library's edges are drawn toward the dark side where blur reaches across the narrow white
  // margin (0.39 mm, 3 to 4 px): up to 0.3 px at a corner beside the end of a face.
  const PoseError worst = WorstPoseError(0.7);
  EXPECT_LT(worst.distance_mm, 0.2);
  EXPECT_LT(worst.angle_deg, 0.3);
}

}  // namespace
}  // namespace flextip::simulation
