#include "bench/tip_bound/fisher.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/linear_algebra.h"
#include "vision/camera_model.h"
#include "vision/tags/reprojection.h"

namespace flextip::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStep_px = 0.25;
constexpr double kBend_m2 = 20.0;     // standard deviation of the bend
constexpr double kPlateOfTag = 1.25;  // tag36h11 with its white rim, of the border's size
constexpr int kBand_px = 7;

cv::Mat View(simulation::LinearImage& image) {
  return {image.height_px, image.width_px, CV_32F, image.data.data()};
}

cv::Mat Blurred(const cv::Mat& light, double sigma_px) {
  cv::Mat result;
  cv::GaussianBlur(light, result, {0, 0}, sigma_px, sigma_px, cv::BORDER_REPLICATE);
  return result;
}

// Derivatives of the blurred linear light, one picture a parameter, and masks.
struct Pictures {
  cv::Mat light;               // blurred
  std::vector<cv::Mat> pose;   // 6
  std::vector<cv::Mat> bend;   // 2
  std::vector<cv::Mat> faces;  // light and dark of each face
  cv::Mat by_blur;
  cv::Mat collar, band;  // masks, 8 bit
};

cv::Point ToPoint(const Vector2d& px) {
  return {static_cast<int>(std::lround(px.x() * 16)), static_cast<int>(std::lround(px.y() * 16))};
}

// The plate of each tag that faces the camera, as a mask.
std::vector<cv::Mat> FaceMasks(const CameraModel& camera, const TagCollar& collar, const Pose& T_CE,
                               cv::Size size) {
  std::vector<cv::Mat> masks;
  for (const CollarTag& tag : collar.tags) {
    const Pose T_CG = T_CE * tag.T_EG;
    if (T_CG.R.col(2).dot(T_CG.p) <= 0) continue;
    const double h = 0.5 * kPlateOfTag * tag.size_m;
    std::vector<cv::Point> corners;
    for (const Vector3d& x_G :
         {Vector3d(-h, -h, 0), Vector3d(h, -h, 0), Vector3d(h, h, 0), Vector3d(-h, h, 0)}) {
      if (const auto px = camera.Project(T_CG * x_G)) corners.push_back(ToPoint(*px));
    }
    cv::Mat mask = cv::Mat::zeros(size, CV_8U);
    if (corners.size() == 4) cv::fillConvexPoly(mask, corners, 255, cv::LINE_8, 4);
    masks.push_back(mask);
  }
  return masks;
}

cv::Mat OutlineBand(const CameraModel& camera, const TubeShape& tube, const BoundScene& scene,
                    cv::Size size) {
  cv::Mat band = cv::Mat::zeros(size, CV_8U);
  for (const ContourPoint& p : TubeContour(camera, tube, scene.T_CE, scene.bend, 1500, 200)) {
    cv::circle(band, ToPoint(p.px), kBand_px * 8, 255, cv::FILLED, cv::LINE_8, 4);
  }
  return band;
}

Pictures Render(const simulation::Laparoscope& laparoscope, double blur_px, const TagCollar& collar,
                const TubeShape& tube, const BoundScene& scene) {
  const CameraCalibration calibration = BoundCamera();
  const CameraModel camera(calibration);
  const auto light_of = [&](const BoundScene& moved) {
    simulation::LinearImage image = laparoscope.RenderLight(CurveOf(moved, tube), 0);
    return View(image).clone();
  };
  const auto difference = [&](const BoundScene& ahead, const BoundScene& back, double step) {
    return cv::Mat((light_of(ahead) - light_of(back)) / (2 * step));
  };
  Pictures p;
  simulation::LinearImage sharp = laparoscope.RenderLinear(CurveOf(scene, tube), 0);
  p.light = light_of(scene);
  const double step_m = kStep_px * scene.T_CE.p.z() / calibration.fu_px;
  for (int k = 0; k < 6; ++k) {
    const double step = k < 3 ? step_m / 0.03 : (k == 5 ? 5 : 1) * step_m;
    const Eigen::Matrix<double, 6, 1> move = step * Eigen::Matrix<double, 6, 1>::Unit(k);
    p.pose.push_back(difference({MovePose(scene.T_CE, move), scene.bend},
                                {MovePose(scene.T_CE, -move), scene.bend}, step));
  }
  for (int k = 0; k < 2; ++k) {
    const Vector2d move = 5 * Vector2d::Unit(k);
    p.bend.push_back(
        difference({scene.T_CE, scene.bend + move}, {scene.T_CE, scene.bend - move}, 5));
  }
  p.by_blur = (Blurred(View(sharp), 1.02 * blur_px) - Blurred(View(sharp), 0.98 * blur_px)) /
              (0.04 * blur_px);
  p.collar = cv::Mat::zeros(p.light.size(), CV_8U);
  for (const cv::Mat& mask : FaceMasks(camera, collar, scene.T_CE, p.light.size())) {
    cv::Mat part, own;
    mask.convertTo(part, CV_32F, 1.0 / 255);
    p.faces.push_back(Blurred(part.mul(View(sharp)), blur_px));
    p.faces.push_back(Blurred(part, blur_px));
    p.collar |= mask;
  }
  cv::dilate(p.collar, p.collar, cv::Mat::ones(7, 7, CV_8U));
  p.band = OutlineBand(camera, tube, scene, p.light.size());
  return p;
}

// The pixels of `mask`; `columns` are the linear light's derivatives, the pose's first. Exposure
// and gamma come last.
PixelModel ModelOf(const Pictures& p, const std::vector<const cv::Mat*>& columns,
                   const cv::Mat& mask, const simulation::LaparoscopeOptions& o, double gamma) {
  PixelModel model;
  for (int i = 0; i < mask.rows * mask.cols; ++i) {
    if (mask.data[i] != 0 && p.light.ptr<float>()[i] < 1) model.pixels.push_back(i);
  }
  const auto rows = static_cast<Eigen::Index>(model.pixels.size());
  const auto n = static_cast<Eigen::Index>(columns.size());
  model.J.resize(rows, n + 2);
  model.mean.resize(rows);
  model.per_code.resize(rows);
  const double read = std::pow(o.read_noise_electrons / o.full_well_electrons, 2);
  for (Eigen::Index r = 0; r < rows; ++r) {
    const int i = model.pixels[static_cast<std::size_t>(r)];
    const double light = std::max(1e-4f, p.light.ptr<float>()[i]);
    const double code = 255 * std::pow(light, 1 / gamma), slope = code / (gamma * light);
    const double variance = slope * slope * (light / o.full_well_electrons + read) + 1.0 / 12;
    for (Eigen::Index k = 0; k < n; ++k) {
      model.J(r, k) = slope * columns[static_cast<std::size_t>(k)]->ptr<float>()[i];
    }
    model.J(r, n) = slope * light;
    model.J(r, n + 1) = -code * std::log(light) / (gamma * gamma);
    model.mean[r] = code;
    model.per_code[r] = 1 / std::sqrt(variance);
    model.J.row(r) *= model.per_code[r];
  }
  return model;
}

}  // namespace

// Brightness, exposure and gamma are not all independent: a prior as wide as themselves keeps the
// inverse finite.
PoseBound PixelModel::Bound(bool others_known) const {
  Eigen::MatrixXd information = J.transpose() * J;
  if (others_known) return {information.topLeftCorner<6, 6>().inverse()};
  for (Eigen::Index k = 6; k < information.rows(); ++k) information(k, k) += 1;
  return {Eigen::MatrixXd(information.inverse()).topLeftCorner<6, 6>()};
}

Eigen::Matrix<double, 6, 1> PixelModel::Step(const Image& grey) const {
  Eigen::VectorXd off(mean.size());
  for (Eigen::Index r = 0; r < off.size(); ++r) {
    off[r] = per_code[r] *
             (grey.data[static_cast<std::size_t>(pixels[static_cast<std::size_t>(r)])] - mean[r]);
  }
  const auto of_pose = J.leftCols<6>();
  return Ldlt(of_pose.transpose() * of_pose).Solve(of_pose.transpose() * off);
}

PixelModels ModelPixels(const simulation::Laparoscope& laparoscope,
                        const simulation::LaparoscopeOptions& options, const TagCollar& collar,
                        const TubeShape& tube, const BoundScene& scene) {
  Pictures p = Render(laparoscope, options.blur_sigma_px, collar, tube, scene);
  for (cv::Mat& by_bend : p.bend) by_bend *= kBend_m2;  // so that its prior is one, too
  std::vector<const cv::Mat*> columns;
  for (const auto* pictures : {&p.pose, &p.faces}) {
    for (const cv::Mat& picture : *pictures) columns.push_back(&picture);
  }
  columns.push_back(&p.by_blur);
  PixelModels models;
  models.collar = ModelOf(p, columns, p.collar, options, laparoscope.Gamma());
  for (const cv::Mat& by_bend : p.bend) columns.push_back(&by_bend);
  models.all = ModelOf(p, columns, p.collar | p.band, options, laparoscope.Gamma());
  return models;
}

TipBounds BoundTip(const PixelModels& models) {
  return {models.collar.Bound(true), models.all.Bound(true), models.collar.Bound(false),
          models.all.Bound(false)};
}

}  // namespace flextip::bench
