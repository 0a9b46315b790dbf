// The predicted grey values of a tag's pixels and their derivatives.
#include "vision/photometric/face.h"

#include <gtest/gtest.h>

#include "core/derivative_check.h"
#include "core/rotation.h"
#include "vision/tags/collar_faces.h"

namespace flextip {
namespace {

CameraCalibration TinyCamera() {
  CameraCalibration c;
  c.width_px = 120;
  c.height_px = 100;
  c.fu_px = 600;
  c.fv_px = 595;
  c.cu_px = 60.3;
  c.cv_px = 48.8;
  c.distortion_coefficients = {-0.22, 0.08, 0.0006, -0.0004};
  return c;
}

// A tag alone, 55 px wide in the middle of the picture when it faces the camera.
TagCollar OneTag() {
  CollarTag tag{3, 0.0055, {}};
  tag.T_EG.p = {0.001, -0.002, 0.0005};
  return {"tag36h11", {tag}};
}
Pose Turned(const Eigen::Vector3d& turn) {
  return {ExpRotation(turn) * ExpRotation({0, 0, 0.4}), {0.0003, 0.001, 0.06}};
}

// The sums over the pixels of a picture tell a pixel's own row: once the picture is black, and once
// it is black but for that pixel. The residual is measured less predicted.
class OnePixelAtATime {
 public:
  OnePixelAtATime(const Pose& T_CE, const Optics& optics)
      : model_(TinyCamera()),
        lens_(model_),
        T_CE_(T_CE),
        optics_(optics),
        black_(FaceOf({-1, -1})) {
    levels_ << 0.05, 0.01, -0.02, 0.5, -0.1, 0.06;
    const double square = Sums(black_, Parameters::Zero())(kR, kR);
    const CameraCalibration& c = model_.Calibration();
    for (int i = 0; i < c.width_px * c.height_px; i += 61) {
      const PhotometricFace lit = FaceOf({i % c.width_px, i / c.width_px});
      const bool takes_part = std::abs(Sums(lit, Parameters::Zero())(kR, kR) - square) > 1;
      if (takes_part) lit_.push_back(lit);
    }
  }

  static constexpr int kParameters = 17;
  using Parameters = Eigen::Matrix<double, kParameters, 1>;
  /// What one unit of a parameter is, so that each changes grey values by some ten.
  static Parameters Scale() {
    Parameters s;
    s << Eigen::Vector3d::Constant(5e-3), Eigen::Vector3d(2e-5, 2e-5, 3e-4),
        Eigen::Vector3d::Constant(0.2), 0.1, 3e-4, Eigen::Matrix<double, 6, 1>::Constant(0.05);
    return s;
  }

  std::size_t Pixels() const { return lit_.size(); }
  /// The predicted grey values with the parameters moved by `x` times their scale.
  Eigen::VectorXd Predicted(const Parameters& x) const {
    const double black = Sums(black_, x)(kR, kR);
    Eigen::VectorXd grey(lit_.size());
    for (std::size_t i = 0; i < lit_.size(); ++i) {
      grey[static_cast<int>(i)] = (kGrey * kGrey + black - Sums(lit_[i], x)(kR, kR)) / (2 * kGrey);
    }
    return grey;
  }
  /// The rows of derivatives, by the scaled parameters.
  Eigen::MatrixXd Rows() const {
    const auto column = [this](const PhotometricFace& face) -> Parameters {
      return Sums(face, Parameters::Zero()).col(kR).head<kParameters>();
    };
    Eigen::MatrixXd J(lit_.size(), kParameters);
    for (std::size_t i = 0; i < lit_.size(); ++i) {
      const Parameters row = (column(lit_[i]) - column(black_)) / kGrey;
      J.row(static_cast<int>(i)) = row.cwiseProduct(Scale()).transpose();
    }
    return J;
  }

 private:
  static constexpr int kR = FaceColumns::kResidual;
  static constexpr int kGrey = 200;
  using SumMatrix = Eigen::Matrix<double, FaceColumns::kSize, FaceColumns::kSize>;

  // The pixels chosen in a picture that is black but for one.
  PhotometricFace FaceOf(const Eigen::Vector2i& at) const {
    Image image(model_.Calibration().width_px, model_.Calibration().height_px, 1);
    if (at.x() >= 0) image.Row(at.y())[at.x()] = kGrey;
    PhotometricFace face = MakeFaces(OneTag()).at(0);
    face.SelectPixels(model_, lens_, image, T_CE_, optics_, {});
    return face;
  }
  SumMatrix Sums(PhotometricFace face, const Parameters& x) const {
    const Eigen::Vector3d pivot(0.001, -0.0005, 0.061);
    const Parameters d = x.cwiseProduct(Scale());
    const Eigen::Matrix3d turn = ExpRotation(d.head<3>());
    const Pose T_CE{turn * T_CE_.R, turn * (T_CE_.p - pivot) + pivot + d.segment<3>(3)};
    Optics optics = optics_;
    optics.blur_px2 += d.segment<3>(FaceColumns::kBlur);
    optics.gamma += d[FaceColumns::kGamma];
    optics.print_offset_m += d[FaceColumns::kOffset];
    face.levels = levels_ + d.tail<6>();
    FaceSums sums;
    face.Accumulate(model_, T_CE, pivot, optics, ToneCurve(optics.gamma),
                    RobustRule(1e6, Robustness::kHuber), sums);
    return sums.A();
  }

  CameraModel model_;
  LensMap lens_;
  Pose T_CE_;
  Optics optics_;
  FaceLevels levels_ = FaceLevels::Zero();
  PhotometricFace black_;
  std::vector<PhotometricFace> lit_;
};

// The largest difference in each column over the column's largest entry.
OnePixelAtATime::Parameters RelativeErrors(const Pose& T_CE) {
  Optics optics;
  optics.blur_px2 = {0.7, 0.0, 0.7};
  const OnePixelAtATime face(T_CE, optics);
  EXPECT_GT(face.Pixels(), 15u);
  const auto f = [&](const Eigen::VectorXd& x) { return face.Predicted(x); };
  const Eigen::MatrixXd J = face.Rows();
  const Eigen::MatrixXd numeric = NumericJacobian(f, OnePixelAtATime::Parameters::Zero(), 0.1);
  OnePixelAtATime::Parameters errors;
  for (int k = 0; k < errors.size(); ++k) {
    const double largest = numeric.col(k).cwiseAbs().maxCoeff();
    EXPECT_GT(largest, 0.3) << k;
    errors[k] = (J.col(k) - numeric.col(k)).cwiseAbs().maxCoeff() / largest;
  }
  return errors;
}

// The blur is cut at 3.5 sigma, which weighs most where it is dark: 2 %.
TEST(PhotometricFace, RowsAreTheDerivativesOfThePrediction) {
  const auto errors = RelativeErrors(Turned({0, 0, 0}));
  EXPECT_LT(errors.maxCoeff(), 0.03) << errors.transpose();
  EXPECT_LT(errors.tail<6>().maxCoeff(), 0.001) << errors.transpose();
}

// Seen aslant the blur's axes are correlated on the tag, which the derivatives leave out: 8 %.
TEST(PhotometricFace, RowsAreNearlySoAslant) {
  for (const Eigen::Vector3d& turn : {Eigen::Vector3d(0.7, 0, 0), Eigen::Vector3d(0.4, 0.5, 0)}) {
    const auto errors = RelativeErrors(Turned(turn));
    EXPECT_LT(errors.maxCoeff(), 0.12) << errors.transpose();
    EXPECT_LT(errors.tail<6>().maxCoeff(), 0.001) << errors.transpose();
  }
}

TEST(FaceSums, CountsWhateverAStrayFitPredicts) {
  FaceSums sums;
  for (const float residual : {0.0f, -3.0f, 31.9f, 32.5f, -5e8f, 1e30f, HUGE_VALF}) {
    sums.CountError(residual);
  }
  FaceSums::Histogram errors{};
  sums.AddErrorsTo(errors);
  EXPECT_EQ(errors[0], 1);
  EXPECT_EQ(errors[3 * FaceSums::kBinsPerGrey], 1);
  EXPECT_EQ(errors[FaceSums::kBins - 1], 5);
  EXPECT_EQ(sums.Pixels(), 7);
}

}  // namespace
}  // namespace flextip
