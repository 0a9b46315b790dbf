#include "bench/vision/peer.h"

#include <algorithm>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>

#include "vision/tags/collar_pose.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip::bench {
namespace {

bool InCollar(const TagCollar& collar, int id) {
  return std::any_of(collar.tags.begin(), collar.tags.end(),
                     [&](const CollarTag& tag) { return tag.id == id; });
}

class AprilTagPeer : public VisionPeer {
 public:
  AprilTagPeer(const CameraCalibration& camera, const TagCollar& collar, double quad_decimate)
      : camera_(camera),
        collar_(collar),
        decimate_(quad_decimate),
        detector_(Options(collar.family, quad_decimate)) {}
  std::string Name() const override {
    return decimate_ == 1 ? "AprilTag 3 + PnP" : "AprilTag 3 + PnP, decimate 2";
  }
  PeerAnswer See(const Image& grey) override {
    PeerAnswer answer;
    answer.ms = TimeMs([&] {
      for (const TagDetection& tag : detector_.Detect(grey)) {
        if (InCollar(collar_, tag.id)) answer.corners_px.emplace(tag.id, tag.corners_px);
      }
    });
    answer.T_CE = PoseByPnp(camera_, collar_, answer.corners_px);
    return answer;
  }

 private:
  // The library's own corners, with its default settings but for the decimation.
  static TagDetectorOptions Options(const std::string& family, double quad_decimate) {
    TagDetectorOptions options;
    options.family = family;
    options.quad_decimate = quad_decimate;
    options.refine_edges = true;
    options.refine_corners = false;
    options.min_decision_margin = 0;
    return options;
  }
  CameraCalibration camera_;
  TagCollar collar_;
  double decimate_;
  TagDetector detector_;
};

class ArucoPeer : public VisionPeer {
 public:
  ArucoPeer(const CameraCalibration& camera, const TagCollar& collar, ArucoRefinement refinement)
      : camera_(camera),
        collar_(collar),
        refinement_(refinement),
        dictionary_(cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11)),
        parameters_(cv::aruco::DetectorParameters::create()) {
    parameters_->cornerRefinementMethod = refinement == ArucoRefinement::kSubpixel
                                              ? cv::aruco::CORNER_REFINE_SUBPIX
                                              : cv::aruco::CORNER_REFINE_APRILTAG;
    parameters_->cornerRefinementWinSize = 2;  // best of 1 to 5 on tags of 45 px; the default is 5
    parameters_->minMarkerPerimeterRate = 0.02;
  }
  std::string Name() const override {
    return refinement_ == ArucoRefinement::kSubpixel ? "ArUco (subpixel) + PnP"
                                                     : "ArUco (AprilTag 2) + PnP";
  }
  PeerAnswer See(const Image& grey) override {
    const cv::Mat view(grey.height_px, grey.width_px, CV_8UC1,
                       const_cast<std::uint8_t*>(grey.data.data()));
    PeerAnswer answer;
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids;
    // With its AprilTag search it passes on that library's pixel origin.
    const float origin_px = refinement_ == ArucoRefinement::kAprilTag ? 0.5f : 0.0f;
    answer.ms = TimeMs([&] {
      cv::aruco::detectMarkers(view, dictionary_, corners, ids, parameters_);
      for (std::size_t i = 0; i < ids.size(); ++i) {
        if (!InCollar(collar_, ids[i])) continue;
        TagCorners ordered;
        for (std::size_t k = 0; k < 4; ++k) {
          const cv::Point2f& c = corners[i][kOrder[k]];
          ordered[k] = {c.x - origin_px, c.y - origin_px};
        }
        answer.corners_px.emplace(ids[i], ordered);
      }
    });
    answer.T_CE = PoseByPnp(camera_, collar_, answer.corners_px);
    return answer;
  }

 private:
  // ArUco goes clockwise from its top left; its AprilTag dictionary has the tags turned by 180 deg.
  static constexpr std::array<std::size_t, 4> kOrder = {1, 0, 3, 2};
  CameraCalibration camera_;
  TagCollar collar_;
  ArucoRefinement refinement_;
  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  cv::Ptr<cv::aruco::DetectorParameters> parameters_;
};

class FlextipPeer : public VisionPeer {
 public:
  FlextipPeer(const CameraCalibration& camera, const TagCollar& collar)
      : camera_(camera), collar_(collar) {}
  std::string Name() const override {
    return camera_.gamma ? "flextip" : "flextip, gamma not stated";
  }
  PeerAnswer See(const Image& grey) override {
    TipTracker tracker(camera_, collar_);
    PeerAnswer answer;
    TipTrack track;
    answer.ms = TimeMs([&] { track = tracker.Track(grey, 0); });
    for (const TagDetection& tag : track.tags) {
      if (InCollar(collar_, tag.id)) answer.corners_px.emplace(tag.id, tag.corners_px);
    }
    if (track.tip.status == TipStatus::kOk) answer.T_CE = camera_.T_RC.Inverse() * track.T_RE;
    return answer;
  }

 private:
  CameraCalibration camera_;
  TagCollar collar_;
};

class FlextipDetector : public VisionPeer {
 public:
  explicit FlextipDetector(const TagCollar& collar) : collar_(collar), detector_(Options(collar)) {}
  std::string Name() const override { return "flextip"; }
  PeerAnswer See(const Image& grey) override {
    PeerAnswer answer;
    answer.ms = TimeMs([&] {
      for (const TagDetection& tag : detector_.Detect(grey)) {
        if (InCollar(collar_, tag.id)) answer.corners_px.emplace(tag.id, tag.corners_px);
      }
    });
    return answer;
  }

 private:
  static TagDetectorOptions Options(const TagCollar& collar) {
    TagDetectorOptions options;
    options.family = collar.family;
    return options;
  }
  TagCollar collar_;
  TagDetector detector_;
};

Pose PoseOf(const cv::Vec3d& rotation, const cv::Vec3d& translation) {
  const Eigen::Vector3d w(rotation[0], rotation[1], rotation[2]);
  const double angle = w.norm();
  const Eigen::Vector3d axis = angle > 0 ? Eigen::Vector3d(w / angle) : Eigen::Vector3d::UnitX();
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(),
          {translation[0], translation[1], translation[2]}};
}

struct Correspondences {
  std::vector<cv::Point3d> x_E;
  std::vector<cv::Point2d> px;
  void Add(const std::array<Eigen::Vector3d, 4>& corners_E, const TagCorners& corners_px) {
    for (std::size_t k = 0; k < 4; ++k) {
      x_E.emplace_back(corners_E[k].x(), corners_E[k].y(), corners_E[k].z());
      px.emplace_back(corners_px[k].x(), corners_px[k].y());
    }
  }
};

struct StartPose {
  cv::Vec3d w, t;
};

// Both poses of one tag, as poses of the collar.
void AddPlanarStarts(const CollarTag& tag, const TagCorners& corners_px, const cv::Matx33d& K,
                     const std::vector<double>& lens, std::vector<StartPose>& starts) {
  // IPPE_SQUARE has y up and z toward the viewer, its corners from the top left clockwise.
  const double h = 0.5 * tag.size_m;
  const std::vector<cv::Point3d> square = {{-h, h, 0}, {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
  std::vector<cv::Point2d> px;
  for (const std::size_t k : {3, 2, 1, 0}) px.emplace_back(corners_px[k].x(), corners_px[k].y());
  std::vector<cv::Vec3d> ws, ts;
  cv::solvePnPGeneric(square, px, K, lens, ws, ts, false, cv::SOLVEPNP_IPPE_SQUARE);
  const Pose T_GS{Eigen::Vector3d(1, -1, -1).asDiagonal(), {0, 0, 0}};
  for (std::size_t i = 0; i < ws.size(); ++i) {
    const Pose T_CE = PoseOf(ws[i], ts[i]) * (tag.T_EG * T_GS).Inverse();
    const Eigen::AngleAxisd turn(T_CE.R);
    const Eigen::Vector3d w = turn.angle() * turn.axis();
    starts.push_back({{w.x(), w.y(), w.z()}, {T_CE.p.x(), T_CE.p.y(), T_CE.p.z()}});
  }
}

}  // namespace

std::optional<Pose> PoseByPnp(const CameraCalibration& camera, const TagCollar& collar,
                              const TagsFound& corners_px) {
  Correspondences all;
  std::vector<StartPose> starts;
  const cv::Matx33d K(camera.fu_px, 0, camera.cu_px, 0, camera.fv_px, camera.cv_px, 0, 0, 1);
  const std::vector<double>& lens = camera.distortion_coefficients;
  try {
    for (const CollarTag& tag : collar.tags) {
      const auto found = corners_px.lower_bound(tag.id);
      if (found == corners_px.end() || found->first != tag.id) continue;
      all.Add(CornersInE(tag), found->second);
      AddPlanarStarts(tag, found->second, K, lens, starts);
    }
    if (all.x_E.empty()) return {};
    StartPose sqpnp;
    if (cv::solvePnP(all.x_E, all.px, K, lens, sqpnp.w, sqpnp.t, false, cv::SOLVEPNP_SQPNP)) {
      starts.push_back(sqpnp);
    }
    double least = 1e300;
    std::optional<Pose> best;
    for (StartPose& start : starts) {
      cv::solvePnPRefineLM(all.x_E, all.px, K, lens, start.w, start.t);
      std::vector<cv::Point2d> seen;
      cv::projectPoints(all.x_E, start.w, start.t, K, lens, seen);
      const double left = cv::norm(seen, all.px, cv::NORM_L2);
      const Pose T_CE = PoseOf(start.w, start.t);
      if (!(left < least) || !T_CE.R.allFinite() || !T_CE.p.allFinite() || T_CE.p.z() <= 0)
        continue;
      least = left;
      best = T_CE;
    }
    return best;
  } catch (const cv::Exception&) {
    return {};
  }
}

std::unique_ptr<VisionPeer> MakeAprilTagPeer(const CameraCalibration& camera,
                                             const TagCollar& collar, double quad_decimate) {
  return std::make_unique<AprilTagPeer>(camera, collar, quad_decimate);
}

std::unique_ptr<VisionPeer> MakeArucoPeer(const CameraCalibration& camera, const TagCollar& collar,
                                          ArucoRefinement refinement) {
  return std::make_unique<ArucoPeer>(camera, collar, refinement);
}

std::unique_ptr<VisionPeer> MakeFlextipPeer(const CameraCalibration& camera,
                                            const TagCollar& collar) {
  return std::make_unique<FlextipPeer>(camera, collar);
}

std::unique_ptr<VisionPeer> MakeFlextipDetector(const TagCollar& collar) {
  return std::make_unique<FlextipDetector>(collar);
}

std::vector<std::unique_ptr<VisionPeer>> MakePeers(const CameraCalibration& camera,
                                                   const TagCollar& collar) {
  std::vector<std::unique_ptr<VisionPeer>> peers;
  peers.push_back(MakeAprilTagPeer(camera, collar, 1));
  if (auto visp = MakeVispPeer(camera, collar, 1)) peers.push_back(std::move(visp));
  peers.push_back(MakeArucoPeer(camera, collar, ArucoRefinement::kSubpixel));
  peers.push_back(MakeArucoPeer(camera, collar, ArucoRefinement::kAprilTag));
  peers.push_back(MakeFlextipPeer(camera, collar));
  if (camera.gamma) {
    CameraCalibration silent = camera;
    silent.gamma.reset();
    peers.push_back(MakeFlextipPeer(silent, collar));
  }
  return peers;
}

}  // namespace flextip::bench
