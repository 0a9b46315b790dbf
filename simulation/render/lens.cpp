#include "simulation/render/lens.h"

#include <opencv2/imgproc.hpp>

#include "core/check.h"

namespace flextip::simulation::render {

CameraCalibration Finer(const CameraCalibration& camera, int parts) {
  CameraCalibration finer = camera;
  finer.width_px *= parts;
  finer.height_px *= parts;
  finer.fu_px *= parts;
  finer.fv_px *= parts;
  finer.cu_px = (camera.cu_px + 0.5) * parts - 0.5;
  finer.cv_px = (camera.cv_px + 0.5) * parts - 0.5;
  return finer;
}

void Blur(LinearImage& light, double sigma_px) {
  if (sigma_px <= 0) return;
  cv::Mat view(light.height_px, light.width_px, CV_32FC(light.channels), light.data.data());
  cv::GaussianBlur(view, view, {0, 0}, sigma_px, sigma_px, cv::BORDER_REPLICATE);
}

LinearImage MeansOver(const LinearImage& fine, int parts) {
  FLEXTIP_CHECK(fine.width_px % parts == 0 && fine.height_px % parts == 0, "whole pixels");
  LinearImage means{fine.width_px / parts, fine.height_px / parts, fine.channels, {}};
  means.data.resize(fine.data.size() / (static_cast<std::size_t>(parts) * parts));
  const cv::Mat from(fine.height_px, fine.width_px, CV_32FC(fine.channels),
                     const_cast<float*>(fine.data.data()));
  cv::Mat to(means.height_px, means.width_px, from.type(), means.data.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  return means;
}

}  // namespace flextip::simulation::render
