// What the vision benches compare: each finds tags in a grey picture and, where it can, the pose of
// the collar.
#pragma once

#include <ctime>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/tag_collar.h"
#include "vision/tags/detector.h"

namespace flextip::bench {

/// By id, in the order and with the pixel origin of TagDetection.
using TagsFound = std::multimap<int, TagCorners>;

struct PeerAnswer {
  /// Tags of the collar alone.
  TagsFound corners_px;
  std::optional<Pose> T_CE;
  /// Of the search for tags alone where the pose is PnP's or ViSP's from corners; of all where it
  /// is the tracker's. Conversion of the image's type is left out.
  double ms = 0;
};

class VisionPeer {
 public:
  virtual ~VisionPeer() = default;
  virtual std::string Name() const = 0;
  /// A single picture, without memory of others.
  virtual PeerAnswer See(const Image& grey) = 0;
};

/// Detectors with a pose by least squares over the corners of all tags; one thread each.
std::unique_ptr<VisionPeer> MakeAprilTagPeer(const CameraCalibration& camera,
                                             const TagCollar& collar, double quad_decimate);
enum class ArucoRefinement { kSubpixel, kAprilTag };
std::unique_ptr<VisionPeer> MakeArucoPeer(const CameraCalibration& camera, const TagCollar& collar,
                                          ArucoRefinement refinement);
/// Null where ViSP is not installed.
std::unique_ptr<VisionPeer> MakeVispPeer(const CameraCalibration& camera, const TagCollar& collar,
                                         double quad_decimate);
/// The tracker, afresh for every picture. Its name says so where the camera's gamma is not stated.
std::unique_ptr<VisionPeer> MakeFlextipPeer(const CameraCalibration& camera,
                                            const TagCollar& collar);
/// flextip's detection of tags alone, without a pose.
std::unique_ptr<VisionPeer> MakeFlextipDetector(const TagCollar& collar);

/// All of them that are there: AprilTag 3, ViSP, ArUco with both refinements, flextip, and flextip
/// without the camera's gamma where that is stated.
std::vector<std::unique_ptr<VisionPeer>> MakePeers(const CameraCalibration& camera,
                                                   const TagCollar& collar);

/// Of the collar from the corners of all tags by OpenCV, with the camera's lens model: SQPNP, and
/// both IPPE poses of each tag, each refined by Levenberg-Marquardt on all corners; the least
/// residual. Empty without tags.
std::optional<Pose> PoseByPnp(const CameraCalibration& camera, const TagCollar& collar,
                              const TagsFound& corners_px);

/// ViSP's model-based tracker, of edges on the outlines of a collar's tags and of points within. It
/// follows a pose; its pictures must be free of lens distortion. Null where ViSP is not installed.
class VispTracker {
 public:
  virtual ~VispTracker() = default;
  virtual void Start(const Image& grey, const Pose& T_CE) = 0;
  /// Empty where it gives up.
  virtual std::optional<Pose> Track(const Image& grey, double& ms) = 0;
};
std::unique_ptr<VispTracker> MakeVispTracker(const CameraCalibration& camera,
                                             const TagCollar& collar);

/// Milliseconds of processor time of a call, of all threads: other work on the machine does not
/// count.
template <class Work>
double TimeMs(Work&& work) {
  const auto now_ms = [] {
    std::timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
  };
  const double start_ms = now_ms();
  work();
  return now_ms() - start_ms;
}

}  // namespace flextip::bench
