#include "plausibility/check_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/median.h"
#include "plausibility/scene.h"
#include "vision/tags/collar_pose.h"
#include "vision/tags/detector.h"

namespace flextip::plausibility {
namespace {

using Detections = std::vector<std::vector<TagDetection>>;  // a list a picture

std::vector<Frame> SomeFrames(FrameSource& source, std::size_t count) {
  std::vector<Frame> frames;
  const std::size_t all = source.Count();
  const std::size_t stride = all > count && count > 0 ? all / count : 1;
  while (frames.size() < count) {
    auto frame = source.Next();
    if (!frame) break;
    frames.push_back(std::move(*frame));
    source.Skip(stride - 1);
  }
  return frames;
}

Detections Detect(const std::vector<Frame>& frames, const std::string& family) {
  TagDetectorOptions options;
  options.family = family;
  // Small families have codes everywhere: only those that need no correction count.
  if (family != "tag36h11") options.max_hamming = 0;
  TagDetector detector(options);
  Detections detections;
  for (const Frame& frame : frames) detections.push_back(detector.Detect(frame.image));
  return detections;
}

std::size_t WithTags(const Detections& detections) {
  return static_cast<std::size_t>(std::count_if(detections.begin(), detections.end(),
                                                [](const auto& tags) { return !tags.empty(); }));
}

class PictureCheck {
 public:
  PictureCheck(const Recording& recording, std::vector<Frame> frames)
      : recording_(recording), frames_(std::move(frames)) {}

  std::vector<Finding> findings;

  void Run() {
    if (frames_.empty()) return;
    StandStill();
    if (!recording_.tags0 || recording_.tags0->tags.empty()) return;
    const Detections found = Detect(frames_, recording_.tags0->family);
    if (2 * WithTags(found) < frames_.size()) {
      OtherFamily(WithTags(found));
      if (WithTags(found) == 0) return;
    }
    OtherIds(found);
    Sizes(found);
  }

 private:
  void Wrong(const std::string& id, std::string text, std::string mend) {
    findings.push_back({Severity::kWrong, id, std::move(text), std::move(mend)});
  }

  void StandStill() {
    std::size_t equal = 0, moved = 0;
    double most = 0.0;
    for (std::size_t i = 1; i < frames_.size(); ++i) {
      const Instant a = InstantAt(recording_, frames_[i - 1].t_ns),
                    b = InstantAt(recording_, frames_[i].t_ns);
      if (!a.wrist || !b.wrist || (a.wrist->p - b.wrist->p).norm() < 5e-4) continue;
      ++moved;
      most = std::max(most, (a.wrist->p - b.wrist->p).norm());
      if (frames_[i - 1].image.data == frames_[i].image.data) ++equal;
    }
    if (equal < 2 || 3 * equal < moved) return;
    Wrong(
        "cam0.frozen",
        fmt::format("cam0: {} of {} pictures are the same as the one before, while the wrist moves "
                    "by up to {:.1f} mm",
                    equal, moved, 1e3 * most),
        "leave out these frames, or record again");
  }

  void OtherFamily(std::size_t with_stated) {
    const std::string& stated = recording_.tags0->family;
    std::string best;
    std::size_t most = with_stated;
    for (const char* family : {"tag36h11", "tag25h9", "tag16h5", "tagStandard41h12"}) {
      if (family == stated) continue;
      const Detections found = Detect(frames_, family);
      if (WithTags(found) > most) most = WithTags(found), best = family;
    }
    if (!best.empty() && 2 * most >= frames_.size()) {
      Wrong("tags0.family",
            fmt::format("tags0: {} of {} pictures show tags of the family {}, {} of {} as stated",
                        most, frames_.size(), best, with_stated, stated),
            fmt::format("family: {} in tags0/sensor.yaml", best));
    } else if (with_stated == 0) {
      findings.push_back({Severity::kDoubtful, "tags0.none",
                          fmt::format("tags0: no tag of the family {} was found in {} pictures",
                                      stated, frames_.size()),
                          "family and focus; flextip detect shows what is found"});
    }
  }

  void OtherIds(const Detections& found) {
    std::set<int> stated, seen;
    for (const CollarTag& tag : recording_.tags0->tags) stated.insert(tag.id);
    bool any = false;
    for (const auto& tags : found)
      for (const TagDetection& tag : tags) {
        if (stated.contains(tag.id))
          any = true;
        else
          seen.insert(tag.id);
      }
    if (any || seen.empty()) return;
    Wrong("tags0.ids",
          fmt::format("tags0: the tags found have the ids {}, none is on the collar",
                      fmt::join(seen, ", ")),
          "id of each tag in tags0/sensor.yaml");
  }

  TagCollar Resized(double factor) const {
    TagCollar collar = *recording_.tags0;
    for (CollarTag& tag : collar.tags) tag.size_m *= factor;
    return collar;
  }

  /// The distance of corners (RMS, px) where tags are `factor` times as large on the same collar.
  double Rms(const CameraModel& camera, const Detections& found, double factor) const {
    CollarPoseOptions options;
    options.max_rms_px = 1e6;
    const TagCollar collar = Resized(factor);
    double squares = 0.0;
    int dof = 0;
    for (const auto& tags : found) {
      const CollarPose pose = EstimateCollarPose(camera, collar, tags, options);
      if (!pose.IsUsable() || pose.tags_used < 2) continue;
      squares += pose.squared_error_px2;
      dof += pose.dof;
    }
    return dof > 0 ? std::sqrt(squares / dof) : -1.0;
  }

  void Sizes(const Detections& found) {
    if (!recording_.cam0 || !(recording_.cam0->calibration.fu_px > 0.0)) return;
    const CameraModel camera(recording_.cam0->calibration);
    const double stated_rms = Rms(camera, found, 1.0);
    if (stated_rms > 0.0) {
      double best = 1.0, least = stated_rms;
      for (int i = -40; i <= 40; ++i) {
        const double factor = std::exp(0.02 * i);
        const double rms = Rms(camera, found, factor);
        if (rms > 0.0 && rms < least) least = rms, best = factor;
      }
      constexpr double kAlike = 0.05;  // of the size
      if (least < 0.5 * stated_rms && std::abs(std::log(best)) > kAlike) {
        const double size = recording_.tags0->tags.front().size_m;
        Wrong(
            "tags0.size",
            fmt::format("tags0: found tags of this family; they fit a size of {:.2f} mm, the file "
                        "says {:.2f} mm (corners {:.2f} px off in place of {:.2f} px)",
                        1e3 * size * best, 1e3 * size, least, stated_rms),
            fmt::format("size_m: {:.4g} in tags0/sensor.yaml", size * best));
        return;
      }
    }
    Distances(camera, found);
  }

  /// A collar that is large in all its numbers is far away: the wrist says how far the tip is.
  void Distances(const CameraModel& camera, const Detections& found) {
    std::vector<double> ratios;
    const Pose T_CR = recording_.cam0->calibration.T_RC.Inverse();
    for (std::size_t i = 0; i < found.size(); ++i) {
      const CollarPose pose = EstimateCollarPose(camera, *recording_.tags0, found[i]);
      const Instant now = InstantAt(recording_, frames_[i].t_ns);
      if (!pose.IsUsable() || !now.wrist) continue;
      const Eigen::Vector3d along = (recording_.p_RP - now.wrist->p).normalized();
      const Eigen::Vector3d tip = T_CR * (now.wrist->p + recording_.instrument.length_m * along);
      if (tip.z() > 0.01) ratios.push_back(pose.T_CE.p.norm() / tip.norm());
    }
    if (ratios.size() < 2) return;
    const double ratio = Median(ratios);
    constexpr double kMost = 1.8;
    if (ratio < kMost && ratio > 1.0 / kMost) return;
    Wrong(
        "tags0.scale",
        fmt::format(
            "tags0: by their size the tags are {:.2f} times as far from the camera as wrist "
            "and port have the tip",
            ratio),
        fmt::format("size_m and T_EG in tags0/sensor.yaml: {:.2f} times as large; or T_RC of cam0",
                    1.0 / ratio));
  }

  const Recording& recording_;
  std::vector<Frame> frames_;
};

}  // namespace

std::vector<Finding> CheckPictures(const Recording& recording, FrameSource& frames,
                                   const PictureOptions& options) {
  PictureCheck check(recording, SomeFrames(frames, options.pictures));
  check.Run();
  return check.findings;
}

}  // namespace flextip::plausibility
