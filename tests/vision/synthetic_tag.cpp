#include "tests/vision/synthetic_tag.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <algorithm>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/draw_vector.h"
#include "core/rotation.h"
#include "vision/camera_model.h"

namespace flextip {
namespace {

constexpr int kCells = 10, kBorderCells = 8;  // tag36h11 with its white rim
constexpr int kSub = 8;                       // samples per pixel and axis

std::vector<std::vector<bool>> Pattern(int id) {
  apriltag_family_t* family = tag36h11_create();
  image_u8_t* picture = apriltag_to_image(family, id);
  std::vector<std::vector<bool>> white(kCells, std::vector<bool>(kCells));
  for (int y = 0; y < kCells; ++y) {
    for (int x = 0; x < kCells; ++x) white[y][x] = picture->buf[y * picture->stride + x] > 127;
  }
  std::free(picture->buf);  // the library does not export its image_u8_destroy
  std::free(picture);
  tag36h11_destroy(family);
  return white;
}

struct Painter {
  const CameraModel& model;
  const SyntheticOptions& o;
  cv::Mat_<float>& canvas;

  Eigen::Vector3d Ray(double x, double y) const {
    const auto ray = model.Unproject({x, y});
    return ray ? Eigen::Vector3d(*ray / ray->z()) : Eigen::Vector3d(1e9, 1e9, 1);
  }

  static constexpr int kOutside = -1, kRim = kCells * kCells;

  // The cell that is seen along `ray`: its number, kRim beside the pattern, or kOutside.
  int Cell(const PlacedTag& tag, const Eigen::Vector3d& ray) const {
    const Eigen::Vector3d normal = tag.T_CG.R.col(2);
    const double depth = normal.dot(tag.T_CG.p) / normal.dot(ray);
    if (!(depth > 0)) return kOutside;
    const Eigen::Vector3d x_G = tag.T_CG.R.transpose() * (depth * ray - tag.T_CG.p);
    const double u = x_G.x() / tag.size_m * kBorderCells, v = x_G.y() / tag.size_m * kBorderCells;
    const double rim = kBorderCells / 2.0 + o.margin_cells;
    if (std::abs(u) > rim || std::abs(v) > rim) return kOutside;
    const int cx = static_cast<int>(std::floor(u + kCells / 2.0));
    const int cy = static_cast<int>(std::floor(v + kCells / 2.0));
    const bool inside = cx >= 0 && cy >= 0 && cx < kCells && cy < kCells;
    return inside ? cy * kCells + cx : kRim;
  }

  void Paint(const PlacedTag& tag) const {
    const auto white = Pattern(tag.id);
    PlacedTag rim = tag;
    rim.size_m *= 1 + 2 * o.margin_cells / kBorderCells;
    double x0 = canvas.cols, x1 = -1, y0 = canvas.rows, y1 = -1;
    for (const Eigen::Vector2d& c : TrueCorners(model.Calibration(), rim)) {
      x0 = std::min(x0, c.x()), x1 = std::max(x1, c.x());
      y0 = std::min(y0, c.y()), y1 = std::max(y1, c.y());
    }
    const int from_x = std::max(0, static_cast<int>(x0) - 3),
              from_y = std::max(0, static_cast<int>(y0) - 3);
    const int to_x = std::min(canvas.cols, static_cast<int>(x1) + 4);
    const int to_y = std::min(canvas.rows, static_cast<int>(y1) + 4);
    for (int y = from_y; y < to_y; ++y) {
      for (int x = from_x; x < to_x; ++x) PaintPixel(tag, white, x, y);
    }
  }

  // The mean over the pixel's square, rays interpolated between its corners. A pixel whose corners
  // see one cell of the pattern is of that cell's grey.
  void PaintPixel(const PlacedTag& tag, const std::vector<std::vector<bool>>& white, int x,
                  int y) const {
    const auto grey = [&](int cell) {
      if (cell == kOutside) return static_cast<double>(canvas(y, x));
      return cell == kRim || white[cell / kCells][cell % kCells] ? o.bright : o.dark;
    };
    const Eigen::Vector3d r00 = Ray(x - 0.5, y - 0.5), r10 = Ray(x + 0.5, y - 0.5);
    const Eigen::Vector3d r01 = Ray(x - 0.5, y + 0.5), r11 = Ray(x + 0.5, y + 0.5);
    const int cell = Cell(tag, r00);
    const bool uniform = cell >= 0 && cell < kRim && Cell(tag, r10) == cell &&
                         Cell(tag, r01) == cell && Cell(tag, r11) == cell;
    double sum = 0;
    for (int j = 0; j < kSub && !uniform; ++j) {
      const double v = (j + 0.5) / kSub;
      for (int i = 0; i < kSub; ++i) {
        const double u = (i + 0.5) / kSub;
        const Eigen::Vector3d ray =
            (1 - v) * ((1 - u) * r00 + u * r10) + v * ((1 - u) * r01 + u * r11);
        sum += grey(Cell(tag, ray));
      }
    }
    canvas(y, x) = static_cast<float>(uniform ? grey(cell) : sum / (kSub * kSub));
  }
};

}  // namespace

std::vector<TagDetection> NoisyTags(const CameraCalibration& camera, const TagCollar& collar,
                                    const Pose& T_CE, double noise_px, std::mt19937& random,
                                    double max_angle_rad) {
  std::normal_distribution<double> noise(0, 1);
  std::vector<TagDetection> tags;
  for (const PlacedTag& placed : FacingTags(collar, T_CE, max_angle_rad)) {
    TagDetection tag;
    tag.id = placed.id;
    const auto corners = TrueCorners(camera, placed);
    for (int i = 0; i < 4; ++i) {
      tag.corners_px[i] = corners[i] + noise_px * DrawVector<2>(noise, random);
    }
    tags.push_back(tag);
  }
  return tags;
}

CameraCalibration TestCamera(bool distorted) {
  CameraCalibration c;
  c.width_px = 1280;
  c.height_px = 720;
  c.fu_px = c.fv_px = 950;
  c.cu_px = 646.5;
  c.cv_px = 355.5;
  if (distorted) c.distortion_coefficients = {-0.22, 0.08, 0.0006, -0.0004};
  c.T_RC = {ExpRotation({2.0, 0.3, -0.4}), {0.1, -0.05, 0.2}};
  return c;
}

TagCollar PrismCollar(int count, double size_m, double apothem_m, double centre_x_m) {
  TagCollar collar;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * i / count;
    const Eigen::Vector3d out(0, std::cos(angle), std::sin(angle)), along(1, 0, 0);
    Pose T_EG;
    T_EG.R.col(0) = along;
    T_EG.R.col(2) = -out;
    T_EG.R.col(1) = T_EG.R.col(2).cross(along);
    T_EG.p = centre_x_m * along + apothem_m * out;
    collar.tags.push_back({i, size_m, T_EG});
  }
  return collar;
}

std::vector<PlacedTag> FacingTags(const TagCollar& collar, const Pose& T_CE, double max_angle_rad) {
  std::vector<PlacedTag> facing;
  for (const CollarTag& tag : collar.tags) {
    const Pose T_CG = T_CE * tag.T_EG;
    const double cosine = T_CG.R.col(2).dot(T_CG.p.normalized());  // z points into the tag
    if (cosine > std::cos(max_angle_rad)) facing.push_back({tag.id, tag.size_m, T_CG});
  }
  return facing;
}

std::vector<Eigen::Vector2d> TrueCorners(const CameraCalibration& camera, const PlacedTag& tag) {
  const CameraModel model(camera);
  const double h = tag.size_m / 2;
  std::vector<Eigen::Vector2d> corners;
  for (const auto& [x, y] : {std::pair{-h, h}, {h, h}, {h, -h}, {-h, -h}}) {
    corners.push_back(model.Project(tag.T_CG * Eigen::Vector3d(x, y, 0)).value());
  }
  return corners;
}

Image RenderTags(const CameraCalibration& camera, const std::vector<PlacedTag>& tags,
                 const SyntheticOptions& options) {
  cv::Mat_<float> canvas(camera.height_px, camera.width_px, static_cast<float>(options.background));
  const CameraModel model(camera);
  const Painter painter{model, options, canvas};
  for (const PlacedTag& tag : tags) painter.Paint(tag);
  if (options.blur_px > 0) {
    cv::GaussianBlur(canvas, canvas, cv::Size(0, 0), options.blur_px, options.blur_px,
                     cv::BORDER_REPLICATE);
  }
  std::mt19937 random(options.seed);
  std::normal_distribution<double> noise(0, 1);
  Image image(camera.width_px, camera.height_px, 1);
  for (int y = 0; y < camera.height_px; ++y) {
    for (int x = 0; x < camera.width_px; ++x) {
      const double light = 1 + options.shading * (static_cast<double>(x) / camera.width_px - 0.5);
      const double grey = canvas(y, x) * light + options.noise * noise(random);
      image.Row(y)[x] = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
    }
  }
  return image;
}

}  // namespace flextip
