// ViSP, for machines that have it (libvisp-dev).
#include <visp3/core/vpCameraParameters.h>
#include <visp3/core/vpPixelMeterConversion.h>
#include <visp3/detection/vpDetectorAprilTag.h>
#include <visp3/mbt/vpMbGenericTracker.h>
#include <visp3/vision/vpPose.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <opencv2/imgproc.hpp>

#include "bench/vision/peer.h"
#include "vision/camera_model.h"
#include "vision/tags/collar_pose.h"

namespace flextip::bench {
namespace {

vpImage<unsigned char> ToVisp(const Image& grey) {
  return {const_cast<unsigned char*>(grey.data.data()), static_cast<unsigned>(grey.height_px),
          static_cast<unsigned>(grey.width_px), true};
}

Pose ToPose(const vpHomogeneousMatrix& M) {
  Pose T;
  for (unsigned i = 0; i < 3; ++i) {
    for (unsigned j = 0; j < 3; ++j) T.R(i, j) = M[i][j];
    T.p[i] = M[i][3];
  }
  return T;
}

vpHomogeneousMatrix FromPose(const Pose& T) {
  vpHomogeneousMatrix M;
  for (unsigned i = 0; i < 3; ++i) {
    for (unsigned j = 0; j < 3; ++j) M[i][j] = T.R(i, j);
    M[i][3] = T.p[i];
  }
  return M;
}

// Its AprilTag detector, and the pose of all corners by virtual visual servoing from Dementhon's or
// Lagrange's, as its manual has it. Its lens model has one coefficient, so that the corners are
// freed from distortion by the camera's own before.
class VispPeer : public VisionPeer {
 public:
  VispPeer(const CameraCalibration& camera, const TagCollar& collar, double quad_decimate)
      : camera_(camera), collar_(collar), detector_(vpDetectorAprilTag::TAG_36h11) {
    detector_.setAprilTagQuadDecimate(static_cast<float>(quad_decimate));
    detector_.setAprilTagNbThreads(1);
    detector_.setAprilTagRefineEdges(true);
  }
  std::string Name() const override { return "ViSP"; }
  PeerAnswer See(const Image& grey) override {
    const vpImage<unsigned char> view = ToVisp(grey);
    PeerAnswer answer;
    answer.ms = TimeMs([&] {
      if (!detector_.detect(view)) return;
      const auto corners = detector_.getTagsCorners();
      const auto ids = detector_.getTagsId();
      for (std::size_t i = 0; i < ids.size(); ++i) AddTag(ids[i], corners[i], answer);
    });
    answer.T_CE = PoseOf(answer);
    return answer;
  }

 private:
  void AddTag(int id, const std::vector<vpImagePoint>& corners, PeerAnswer& answer) const {
    const bool ours = std::any_of(collar_.tags.begin(), collar_.tags.end(),
                                  [&](const CollarTag& tag) { return tag.id == id; });
    if (!ours) return;
    TagCorners px;
    // It passes on AprilTag's pixel origin, centres at +0.5, where its camera has 0 as OpenCV's.
    for (std::size_t k = 0; k < 4; ++k)
      px[k] = {corners[k].get_u() - 0.5, corners[k].get_v() - 0.5};
    answer.corners_px.emplace(id, px);
  }
  std::optional<Pose> PoseOf(const PeerAnswer& answer) const {
    vpPose pose;
    int points = 0;
    for (const CollarTag& tag : collar_.tags) {
      const auto found = answer.corners_px.find(tag.id);
      if (found == answer.corners_px.end()) continue;
      const auto x_E = CornersInE(tag);
      for (std::size_t k = 0; k < 4; ++k) {
        const auto ray = camera_.Unproject(found->second[k]);
        if (!ray) continue;
        vpPoint point(x_E[k].x(), x_E[k].y(), x_E[k].z());
        point.set_x(ray->x() / ray->z());
        point.set_y(ray->y() / ray->z());
        pose.addPoint(point);
        ++points;
      }
    }
    if (points < 4) return {};
    try {
      vpHomogeneousMatrix cMo, other;  // of both, the one that leaves less
      pose.computePose(vpPose::DEMENTHON_VIRTUAL_VS, cMo);
      pose.computePose(vpPose::LAGRANGE_VIRTUAL_VS, other);
      if (!(pose.computeResidual(cMo) <= pose.computeResidual(other))) cMo = other;
      const Pose T_CE = ToPose(cMo);
      if (!T_CE.R.allFinite() || !T_CE.p.allFinite()) return {};
      return T_CE;
    } catch (const vpException&) {
      return {};
    }
  }
  CameraModel camera_;
  TagCollar collar_;
  vpDetectorAprilTag detector_;
};

// The outlines of the tags as a model in its CAO format.
std::string CaoModel(const TagCollar& collar) {
  std::string points, faces;
  int count = 0;
  for (const CollarTag& tag : collar.tags) {
    // Seen from outside, against the clock.
    for (const Eigen::Vector3d& x : CornersInE(tag)) {
      points +=
          std::to_string(x.x()) + ' ' + std::to_string(x.y()) + ' ' + std::to_string(x.z()) + '\n';
    }
    faces += "4";
    for (int k = 0; k < 4; ++k) faces += ' ' + std::to_string(count + k);
    faces += '\n';
    count += 4;
  }
  return "V1\n" + std::to_string(count) + '\n' + points + "0\n0\n" +
         std::to_string(collar.tags.size()) + '\n' + faces + "0\n0\n";
}

// Its model loader writes to std::cout whatever it is told.
class QuietOutput {
 public:
  QuietOutput() : kept_(std::cout.rdbuf(nullptr)) {}
  ~QuietOutput() {
    std::cout.rdbuf(kept_);
    std::cout.clear();
  }
  QuietOutput(const QuietOutput&) = delete;
  QuietOutput& operator=(const QuietOutput&) = delete;

 private:
  std::streambuf* kept_;
};

class VispHybridTracker : public VispTracker {
 public:
  VispHybridTracker(const CameraCalibration& camera, const TagCollar& collar)
      : tracker_(1, vpMbGenericTracker::EDGE_TRACKER | vpMbGenericTracker::KLT_TRACKER) {
    SetFeatures();
    vpCameraParameters parameters;
    parameters.initPersProjWithoutDistortion(camera.fu_px, camera.fv_px, camera.cu_px,
                                             camera.cv_px);
    tracker_.setCameraParameters(parameters);
    tracker_.setAngleAppear(vpMath::rad(75));
    tracker_.setAngleDisappear(vpMath::rad(80));
    tracker_.setNearClippingDistance(0.005);
    tracker_.setFarClippingDistance(2.0);
    const auto file = std::filesystem::temp_directory_path() / "flextip_collar.cao";
    std::ofstream(file) << CaoModel(collar);
    {
      const QuietOutput quiet;
      tracker_.loadModel(file.string());
    }
    std::filesystem::remove(file);
  }
  void Start(const Image& grey, const Pose& T_CE) override {
    const QuietOutput quiet;
    tracker_.initFromPose(ToVisp(grey), FromPose(T_CE));
  }
  std::optional<Pose> Track(const Image& grey, double& ms) override {
    const vpImage<unsigned char> view = ToVisp(grey);
    bool failed = false;
    ms = TimeMs([&] {
      try {
        tracker_.track(view);
      } catch (const vpException&) {
        failed = true;
      }
    });
    vpHomogeneousMatrix cMo;
    tracker_.getPose(cMo);
    const Pose T_CE = ToPose(cMo);
    if (failed || !T_CE.p.allFinite() || !T_CE.R.allFinite()) return {};
    return T_CE;
  }

 private:
  // As its tutorial on tracking from AprilTags has them; points may be nearer to each other and to
  // a face's rim, for tags of 45 px.
  void SetFeatures() {
    vpMe me;
    me.setMaskSize(5);
    me.setMaskNumber(180);
    me.setRange(12);
    me.setThreshold(10000);
    me.setMu1(0.5);
    me.setMu2(0.5);
    me.setSampleStep(4);
    tracker_.setMovingEdge(me);
    vpKltOpencv points;
    points.setMaxFeatures(300);
    points.setWindowSize(5);
    points.setQuality(0.015);
    points.setMinDistance(4);
    points.setHarrisFreeParameter(0.01);
    points.setBlockSize(3);
    points.setPyramidLevels(3);
    tracker_.setKltOpencv(points);
    tracker_.setKltMaskBorder(2);
  }
  vpMbGenericTracker tracker_;
};

}  // namespace

std::unique_ptr<VisionPeer> MakeVispPeer(const CameraCalibration& camera, const TagCollar& collar,
                                         double quad_decimate) {
  return std::make_unique<VispPeer>(camera, collar, quad_decimate);
}

std::unique_ptr<VispTracker> MakeVispTracker(const CameraCalibration& camera,
                                             const TagCollar& collar) {
  return std::make_unique<VispHybridTracker>(camera, collar);
}

}  // namespace flextip::bench
