#include "plausibility/pictures/check_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "plausibility/pictures/collar_places.h"
#include "plausibility/pictures/collar_views.h"
#include "plausibility/scene.h"
#include "vision/tags/collar_pose.h"

namespace flextip::plausibility {
namespace {

class PictureCheck {
 public:
  PictureCheck(const Recording& recording, std::vector<Frame> frames, const CheckOptions& known,
               std::vector<Finding>& findings)
      : recording_(recording), frames_(std::move(frames)), known_(known), findings_(findings) {}

  void Run() {
    if (frames_.empty()) return;
    StandStill();
    if (!recording_.tags0 || recording_.tags0->tags.empty()) return;
    const Detections found = DetectTags(frames_, recording_.tags0->family);
    if (2 * PicturesWithTags(found) < frames_.size() && Family(PicturesWithTags(found))) return;
    if (TagsIn(found) == 0 || Ids(found)) return;
    if (!recording_.cam0 || !(recording_.cam0->calibration.fu_px > 0.0)) return;
    const CameraModel camera(recording_.cam0->calibration);
    if (Size(camera, found)) return;
    if (known_.unknown.contains("cam0.T_RC") || known_.unknown.contains("port")) return;
    CheckCollarPlaces(recording_, PosesOf(camera, found), findings_);
  }

 private:
  void Add(Severity severity, const std::string& id, std::string text, std::string mend) {
    findings_.push_back({severity, id, std::move(text), std::move(mend)});
  }

  void StandStill() {
    constexpr double kMoved_m = 5e-4;
    std::size_t equal = 0, moved = 0;
    double most = 0.0;
    for (std::size_t i = 1; i < frames_.size(); ++i) {
      const auto a = PlaceAt(recording_, "wrist0", frames_[i - 1].t_ns);
      const auto b = PlaceAt(recording_, "wrist0", frames_[i].t_ns);
      if (!a || !b || (*a - *b).norm() < kMoved_m) continue;
      ++moved;
      most = std::max(most, (*a - *b).norm());
      if (frames_[i - 1].image.data == frames_[i].image.data) ++equal;
    }
    if (equal < 2 || 3 * equal < moved) return;
    Add(Severity::kWrong, "cam0.frozen",
        fmt::format("cam0: {} of {} pictures are the same as the one before, while the wrist moves "
                    "by up to {:.1f} mm",
                    equal, moved, 1e3 * most),
        "leave out these frames, or record again");
  }

  /// Few tags of the stated family, or none: is there another one?
  bool Family(std::size_t with_stated) {
    const std::string& stated = recording_.tags0->family;
    if (const auto other = OtherFamily(frames_, stated, with_stated)) {
      Add(Severity::kWrong, "tags0.family",
          fmt::format("tags0: the pictures show tags of the family {}, the file says {} (in {} of "
                      "{} pictures)",
                      *other, stated, with_stated, frames_.size()),
          fmt::format("family: {} in tags0/sensor.yaml", *other));
      return true;
    }
    if (with_stated > 0) return false;
    Add(Severity::kDoubtful, "tags0.none",
        fmt::format("tags0: no tag of the family {} was found in {} pictures", stated,
                    frames_.size()),
        "family and focus; flextip detect shows what is found");
    return true;
  }

  bool Ids(const Detections& found) {
    std::set<int> stated, seen;
    for (const CollarTag& tag : recording_.tags0->tags) stated.insert(tag.id);
    for (const auto& tags : found) {
      for (const TagDetection& tag : tags) {
        if (stated.contains(tag.id)) return false;
        seen.insert(tag.id);
      }
    }
    Add(Severity::kWrong, "tags0.ids",
        fmt::format("tags0: the tags found have the ids {}, none is on the collar",
                    fmt::join(seen, ", ")),
        "id of each tag in tags0/sensor.yaml");
    return true;
  }

  bool Size(const CameraModel& camera, const Detections& found) {
    constexpr double kAlike = 0.05, kBetter = 0.5;  // of the size, of the distance
    const TagCollar& collar = *recording_.tags0;
    const auto fit = FitSize(camera, collar, found);
    if (!fit || fit->rms_px > kBetter * fit->stated_rms_px) return false;
    if (std::abs(std::log(fit->factor)) < kAlike) return false;
    const double stated = collar.tags.front().size_m, size = fit->factor * stated;
    Add(Severity::kWrong, "tags0.size",
        fmt::format("tags0: found {} tags of this family; they fit a tag of {:.1f} mm, the file "
                    "says {:.1f} (corners {:.2f} px off in place of {:.2f} px)",
                    TagsIn(found), 1e3 * size, 1e3 * stated, fit->rms_px, fit->stated_rms_px),
        fmt::format("size_m: {:.4f} in tags0/sensor.yaml (the black border's outer edge)", size));
    return true;
  }

  CollarPoses PosesOf(const CameraModel& camera, const Detections& found) const {
    CollarPoses poses;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const CollarPose pose = EstimateCollarPose(camera, *recording_.tags0, found[i]);
      if (pose.IsUsable()) poses.push_back({frames_[i].t_ns, pose.T_CE});
    }
    return poses;
  }

  const Recording& recording_;
  const std::vector<Frame> frames_;
  const CheckOptions& known_;
  std::vector<Finding>& findings_;
};

}  // namespace

void CheckPictures(const Recording& recording, FrameSource& frames, const CheckOptions& known,
                   const PictureOptions& options, CheckResult& so_far) {
  PictureCheck check(recording, SomeFrames(frames, options.pictures, options.share), known,
                     so_far.findings);
  check.Run();
  SortFindings(so_far.findings);
}

}  // namespace flextip::plausibility
