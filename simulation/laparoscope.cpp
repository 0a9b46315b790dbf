#include "simulation/laparoscope.h"

namespace flextip {

struct Laparoscope::Impl {
  CameraCalibration camera;
  LaparoscopeOptions options;
};

Laparoscope::Laparoscope(const CameraCalibration& camera, const TagCollar&,
                         const LaparoscopeOptions& options)
    : impl_(new Impl{camera, options}) {}
Laparoscope::~Laparoscope() = default;
Laparoscope::Laparoscope(Laparoscope&&) noexcept = default;
Laparoscope& Laparoscope::operator=(Laparoscope&&) noexcept = default;

Image Laparoscope::Render(const ShaftCurve&, int) const {
  return Image(impl_->camera.width_px, impl_->camera.height_px, impl_->options.grey ? 1 : 3);
}

LinearImage Laparoscope::RenderLinear(const ShaftCurve&, int) const { return {}; }

double Laparoscope::Gamma() const { return impl_->camera.gamma.value_or(impl_->options.gamma); }

}  // namespace flextip
