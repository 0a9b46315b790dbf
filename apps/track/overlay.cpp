#include "apps/track/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/common/drawing.h"
#include "core/linear_algebra.h"
#include "vision/camera_model.h"

namespace flextip {
namespace {

constexpr Colour kGreen{80, 220, 60}, kYellow{40, 220, 240}, kOrange{0, 140, 255};
constexpr Colour kWhite{255, 255, 255}, kCyan{255, 230, 0}, kDimCyan{140, 125, 20},
    kRed{70, 70, 255};
constexpr std::size_t kPicturesOfReport = 6, kPicturesOfOverlay = 24, kEveryOfUnknown = 150;
constexpr int kLargestWhole_px = 700;
constexpr double kAxis_m = 0.01;
constexpr double kChi2Of99Percent = 9.21;  // two degrees of freedom

bool Near(const Eigen::Vector2d& px, const CameraModel& model) {
  const CameraCalibration& camera = model.Calibration();
  return px.cwiseAbs().maxCoeff() < 4.0 * std::max(camera.width_px, camera.height_px);
}

void Quad(Drawing& drawing, const TagCorners& corners, const Colour& color) {
  for (int i = 0; i < 4; ++i) drawing.Line(corners[i], corners[(i + 1) % 4], color);
}

// Every face's outline; those turned away first, so that the near ones lie over them.
void DrawCollar(Drawing& drawing, const CameraModel& model, const TagCollar& collar,
                const Pose& T_CE) {
  for (const bool away : {true, false}) {
    for (const CollarTag& tag : collar.tags) {
      const Pose T_CG = T_CE * tag.T_EG;
      if ((T_CG.R.col(2).dot(T_CG.p) <= 0) != away) continue;
      TagCorners corners;
      bool seen = true;
      const auto corners_E = CornersInE(tag);
      for (int i = 0; i < 4; ++i) {
        const auto px = model.Project(T_CE * corners_E[i]);
        seen = seen && px && Near(*px, model);
        if (px) corners[i] = *px;
      }
      if (seen) Quad(drawing, corners, away ? kDimCyan : kCyan);
    }
  }
}

void DrawAxes(Drawing& drawing, const CameraModel& model, const Pose& T_CE) {
  const auto origin = model.Project(T_CE.p);
  constexpr Colour colors[] = {{60, 60, 240}, {60, 200, 60}, {240, 120, 40}};
  for (int axis = 0; axis < 3; ++axis) {
    const auto end = model.Project(T_CE * Eigen::Vector3d(kAxis_m * Eigen::Vector3d::Unit(axis)));
    if (origin && end && Near(*origin, model) && Near(*end, model)) {
      drawing.Line(*origin, *end, colors[axis], 2);
    }
  }
}

const Colour& ColorOf(TipStatus status) {
  if (status == TipStatus::kOk) return kWhite;
  return status == TipStatus::kPredicted ? kOrange : kRed;
}

// The covariance seen through the lens: J C J^T.
void DrawTip(Drawing& drawing, const CameraModel& model, const TipObservation& tip) {
  const Pose T_CR = model.Calibration().T_RC.Inverse();
  Eigen::Matrix<double, 2, 3> J;
  const auto px = model.Project(T_CR * tip.p_RE, &J);
  if (!px || !Near(*px, model)) return;
  const Eigen::Matrix<double, 2, 3> J_R = J * T_CR.R;
  const SymmetricEigen axes(J_R * tip.covariance_m2 * J_R.transpose());
  const Eigen::Vector2d half = (kChi2Of99Percent * axes.values.cwiseMax(0)).cwiseSqrt();
  const Eigen::Vector2d minor_axis = axes.vectors.col(0);
  const double angle_deg = std::atan2(minor_axis.y(), minor_axis.x()) * 180 / M_PI;
  const Colour& color = ColorOf(tip.status);
  drawing.Cross(*px, 3, color);
  drawing.Ellipse(*px, half.cwiseMin(1000.0).cwiseMax(1.0), angle_deg, color);
}

std::string Describe(const TipTrack& track) {
  if (track.tip.status == TipStatus::kLost) return "lost";
  if (track.tip.status == TipStatus::kPredicted) {
    return fmt::format("predicted, {:.1f} mm", 1e3 * std::sqrt(track.tip.covariance_m2.trace()));
  }
  return track.source == TrackSource::kPixels
             ? fmt::format("ok, {} tags, {:.1f} grey levels", track.tags_used, track.noise_grey)
             : fmt::format("ok, {} tags, {:.2f} px", track.tags_used, track.rms_px);
}

}  // namespace

void DrawTags(Image& image, const std::vector<TagDetection>& tags) {
  Drawing drawing(image);
  for (const TagDetection& tag : tags) {
    const Colour& color = tag.refined ? kGreen : kYellow;
    Quad(drawing, tag.corners_px, color);
    // The first corner is where the tag's own bottom left is.
    drawing.Ring(tag.corners_px[0], 2, color);
    Eigen::Vector2d right = tag.corners_px[0];
    for (const Eigen::Vector2d& c : tag.corners_px) right = c.x() > right.x() ? c : right;
    const Eigen::Vector2i at(static_cast<int>(right.x()) + 3, static_cast<int>(right.y()) + 3);
    drawing.Text(std::to_string(tag.id), at, 0.4, color);
  }
}

void DrawTrack(Image& image, const TipTrack& track, const CameraCalibration& camera,
               const TagCollar& collar) {
  DrawTags(image, track.tags);
  const CameraModel model(camera);
  Drawing drawing(image);
  if (track.tip.status == TipStatus::kOk) {
    const Pose T_CE = camera.T_RC.Inverse() * track.T_RE;
    DrawCollar(drawing, model, collar, T_CE);
    DrawAxes(drawing, model, T_CE);
  }
  if (track.tip.status != TipStatus::kLost) DrawTip(drawing, model, track.tip);
}

void DrawStatus(Image& image, const TipTrack& track) {
  Drawing drawing(image);
  const double scale = 0.6 * std::max(1.0, image.width_px / 960.0);
  drawing.Text(Describe(track), {8, 4 + static_cast<int>(30 * scale)}, scale,
               ColorOf(track.tip.status));
}

namespace {

/// Half the picture's width and height where it is large, around a point.
Image Cut(const Image& image, const Eigen::Vector2d& centre_px) {
  if (image.width_px <= kLargestWhole_px) return image;
  Image part(image.width_px / 2, image.height_px / 2, image.channels);
  const auto start = [](double centre, int whole, int size) {
    return std::clamp(static_cast<int>(centre) - size / 2, 0, whole - size);
  };
  const int x = start(centre_px.x(), image.width_px, part.width_px);
  const int y = start(centre_px.y(), image.height_px, part.height_px);
  for (int row = 0; row < part.height_px; ++row) {
    std::copy_n(image.Row(y + row) + x * image.channels, part.width_px * part.channels,
                part.Row(row));
  }
  return part;
}

}  // namespace

OverlayWriter::OverlayWriter(const std::filesystem::path& folder, std::size_t frames,
                             double rate_hz, bool video)
    : folder_(folder), pictures_(video ? kPicturesOfOverlay : kPicturesOfReport) {
  every_ = frames == 0 ? kEveryOfUnknown
                       : std::max<std::size_t>(1, (frames + pictures_ - 1) / pictures_);
  if (video) video_.emplace(folder / "overlay.mp4", rate_hz);
}

// Around the tip, or half-way between it and the tags.
void OverlayWriter::FollowWindow(const TipTrack& track, const CameraCalibration& camera) {
  const auto px = CameraModel(camera).Project(camera.T_RC.Inverse() * track.tip.p_RE);
  if (!px) return;
  const Eigen::Vector2d middle(0.5 * camera.width_px, 0.5 * camera.height_px);
  const Eigen::Vector2d tags = track.tags.empty() ? *px : track.tags.front().corners_px[0];
  window_px_ = (0.5 * (*px + tags)).cwiseMax(0.0).cwiseMin(2.0 * middle);
}

bool OverlayWriter::WantsPicture(TipStatus status) {
  const bool changed = last_status_ && *last_status_ != status;
  last_status_ = status;
  const bool spread = count_ % every_ == 0 && count_ / every_ < pictures_;
  ++count_;
  return spread || (changed && of_changes_++ < kPicturesOfReport);
}

void OverlayWriter::Add(const FrameSet& frames, const TipTrack& track,
                        const CameraCalibration& camera, const TagCollar& collar) {
  if (!frames.images[0]) return;
  const bool picture = WantsPicture(track.tip.status);
  if (!picture && !video_) return;
  Image image = ToColour(*frames.images[0]);
  DrawTrack(image, track, camera, collar);
  if (picture) {
    if (track.tip.status != TipStatus::kLost) FollowWindow(track, camera);
    Image part = Cut(image, window_px_);
    DrawStatus(part, track);
    WritePng(folder_ / "overlay" / fmt::format("{}.png", frames.t_ns), part);
  }
  if (!video_) return;
  DrawStatus(image, track);
  video_->Add(image);
}

void OverlayWriter::Finish() {
  if (video_ && count_ > 0) video_->Finish();
}

}  // namespace flextip
