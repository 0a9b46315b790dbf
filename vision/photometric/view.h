// The collar's tags in one camera's picture: all faces, and the optics they share.
#pragma once

#include <memory>
#include <vector>

#include "core/image.h"
#include "vision/photometric/face.h"

namespace flextip {

/// Normal equations JtJ step = Jtr of one Gauss-Newton step on (dw, dp) as in MovePose, in grey
/// values squared. The picture's own unknowns (light, blur, gamma) are eliminated.
struct PoseTerm {
  Eigen::Matrix<double, 6, 6> JtJ = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> Jtr = Eigen::Matrix<double, 6, 1>::Zero();
  double weight = 0;  ///< sum of the pixels' weights
  int pixels = 0;
};

/// The agreement of a face with its pixels.
struct FaceFit {
  int tag_id = 0;
  int pixels = 0;
  double inliers = 0;       ///< mean weight of its pixels
  double correlation = 0;   ///< of measured and predicted grey values
  double contrast = 0;      ///< white less black (grey values)
  double contradicted = 0;  ///< FaceSums::Contradicted
};

/// Prior knowledge of a picture's optics.
struct OpticsPrior {
  Optics mean;
  double blur_sd_px2 = 1.0;  ///< in either direction; of one direction against the other, half
  double gamma_sd = 0.0;     ///< 0: known
  double print_offset_sd_m = 0.0;  ///< 0: known
  double noise_grey = 0.0;         ///< of the film alone; 0: not known
};

class PhotometricView {
 public:
  /// Takes the faces of a collar. The camera and its map must outlive the view.
  PhotometricView(const CameraModel& camera, const LensMap& lens,
                  std::vector<PhotometricFace> faces);

  /// Starts a picture (grey or colour): the faces seen from T_CE take part.
  void Begin(const Image& image, const Pose& T_CE, const OpticsPrior& prior);

  /// Chooses pixels anew: about `pixels` of them all over the faces where `few`, else all that say
  /// something, or about `pixels` of those. `extra_blur_px2` widens the model's blur, and with that
  /// the reach of a step. The first time, faces whose light correlates less than `least_likeness`
  /// with their pattern at T_CE are left out.
  void Select(const Pose& T_CE, int pixels, bool few, double extra_blur_px2,
              double least_likeness = 0);

  /// Returns the scatter of the pose's gradient over the patches of the faces in the last
  /// Linearise, on (dw, dp), in grey values to the fourth. `white` gets its size for independent
  /// pixels, over JtJ and the noise squared.
  Eigen::Matrix<double, 6, 6> ScoreScatter(double& white) const;

  /// Leaves out faces that do not look like their tags; returns the number of the others.
  int DropFaces(double min_correlation, double min_contrast, double max_contradicted);
  int Faces() const;
  /// Returns the number of faces that look well enough toward the camera at T_CE and lie wholly in
  /// the picture.
  int FacesInView(const Pose& T_CE) const;
  std::vector<FaceFit> FaceFits() const;
  /// Returns the normals (toward the camera) of the faces that take part, in E.
  std::vector<Eigen::Vector3d> Normals() const;

  /// Returns the sums at T_CE, by the scale of residuals known so far.
  PoseTerm Linearise(const Pose& T_CE, Robustness kind);
  /// Moves light, blur and gamma with the pose's step, that of the last Linearise. Returns false
  /// where the blur still changed by more than a tenth.
  bool Step(const Eigen::Matrix<double, 6, 1>& step);

  /// Returns the optics as fitted, as a prior for the next picture. Lasting properties have the
  /// standard deviation that they are known to by now. `covariance` is that of the pose (dw, dp) in
  /// C.
  OpticsPrior Learned(const Eigen::Matrix<double, 6, 6>& covariance) const;
  /// Returns the corners of the faces that take part, in E (m).
  std::vector<Eigen::Vector3d> Corners() const;

  /// Returns the shift of an edge (px) by residuals beyond the film's noise: light that the model
  /// lacks.
  double ExcessNoisePx() const;

  /// Returns the robust standard deviation of a pixel's residual (grey values) in the last
  /// Linearise.
  double NoiseGrey() const { return noise_grey_; }

 private:
  using Vector11 = Eigen::Matrix<double, 11, 1>;
  using Matrix11 = Eigen::Matrix<double, 11, 11>;
  /// x_eliminated = constant - by_rest * rest.
  template <int N, int Rest>
  struct Elimination {
    Eigen::Matrix<double, N, 1> constant = Eigen::Matrix<double, N, 1>::Zero();
    Eigen::Matrix<double, N, Rest> by_rest = Eigen::Matrix<double, N, Rest>::Zero();
  };
  struct SeenFace {
    std::size_t face;
    bool active = true, has_levels = false;
    FaceSums sums;
    Elimination<6, 11> levels;
  };
  void EliminateLevels(SeenFace& seen, Matrix11& A, Vector11& b) const;
  PoseTerm EliminateOptics(Matrix11 A, Vector11 b);
  PhotometricFace::Choice ChoiceOf(const Pose& T_CE, int pixels, bool few, double area_px2) const;
  Optics Widened() const;
  void LearnNoise();

  const CameraModel& camera_;
  const LensMap& lens_;
  std::vector<PhotometricFace> faces_;
  std::vector<SeenFace> seen_;
  const Image* image_ = nullptr;
  OpticsPrior prior_;
  Optics optics_;
  ToneCurve tone_;
  double extra_blur_px2_ = 0, noise_grey_ = 0;
  Eigen::Matrix<double, 6, 6> to_pivot_ = Eigen::Matrix<double, 6, 6>::Identity();
  Elimination<5, 6> optics_elimination_;
  Eigen::Matrix<double, 5, 1> optics_variance_ = Eigen::Matrix<double, 5, 1>::Zero();
};

}  // namespace flextip
