// Errors by physics that the catalogue has no effect for and the diagnosis's library of forms was
// not written from: drawn in sizes that matter, and what a right discovery of each may say.
#pragma once

#include <Eigen/Dense>
#include <random>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "simulation/plant/effects.h"
#include "testdata/hidden/scene.h"

namespace flextip::hidden {

/// What is right of a form: every list holds answers that mean the same.
struct FormTruth {
  std::string name;
  std::vector<std::string> channels, variables, forms;
  bool needs_load = false;  ///< shows with load0 alone
};

/// OtherForms' and those of this file.
const std::vector<FormTruth>& FormTruths();
/// Names of this file's forms.
const std::vector<std::string>& LaterForms();

/// One of LaterForms with all that it leaves open drawn.
class HiddenForm {
 public:
  HiddenForm(std::string name, const HiddenScene& scene, std::mt19937_64& rng);

  /// Changes the plant's effects to those of time `t_s` (s since the begin); `at_rest` are those
  /// without the form.
  void ActOnPlant(double t_s, const simulation::PlantEffects& at_rest,
                  simulation::PlantEffects& effects) const;
  /// Whether the plant changes in time.
  bool IsOfPlant() const;
  /// Changes what the sensors read.
  void ActOnReadings(Recording& recording) const;

 private:
  std::string name_;
  double size_ = 0.0, rate_ = 0.0, time_s_ = 0.0, second_s_ = 0.0, phase_rad_ = 0.0;
  Eigen::Vector3d direction_ = Eigen::Vector3d::UnitX();
  Eigen::Vector4d gages_ = Eigen::Vector4d::Zero();
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();
};

}  // namespace flextip::hidden
