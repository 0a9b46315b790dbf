// What an effect is to the diagnosis: its parameters, their priors, and what it does to the rod or
// to a channel. Every effect of the catalogue is one file in effects/ (docs/usage/add_an_effect.md
// shows how to add one).
#pragma once

#include <Eigen/Dense>
#include <array>
#include <string>
#include <vector>

#include "diagnosis/replay/model_input.h"
#include "diagnosis/samples/sample_set.h"

namespace flextip::diagnosis {

/// One parameter as reported: some effects are fitted in another form than they are named in.
struct ReportedParameter {
  std::string name;
  std::vector<double> value, sd;
};

/// What an effect may know when it acts on a sample: the sample and what the last replay found.
struct Moment {
  const SampleSet& samples;
  std::size_t k = 0;
  double t_s = 0.0;                  ///< since the recording's start
  double s_port_free_m = 0.0;        ///< of the port on the shaft were it frictionless
  double ds_port_dfriction_m = 0.0;  ///< by rod_input::kPortFriction; 0 where not known yet
};

/// What an effect remembers from sample to sample.
using EffectMemory = std::array<double, 8>;

/// Where an effect writes: the sample's inputs, and their derivatives by the effect's parameters.
class InputChange {
 public:
  struct Column {
    int parameter = 0, input = 0;
    double value = 0.0;
  };

  InputChange(const double* theta, int first, ModelInputs& inputs, std::vector<Column>& columns)
      : theta_(theta), first_(first), inputs_(inputs), columns_(columns) {}

  /// Input `input` grows by `factor` times the effect's parameter `j`.
  void Linear(int j, int input, double factor) {
    Add(input, factor * theta_[j]);
    Derivative(j, input, factor);
  }
  void Add(int input, double value) { inputs_[input] += value; }
  /// As the effects before this one left it.
  double Input(int input) const { return inputs_[input]; }
  void Derivative(int j, int input, double value) {
    if (value != 0.0) columns_.push_back({first_ + j, input, value});
  }

 private:
  const double* theta_;
  int first_;
  ModelInputs& inputs_;
  std::vector<Column>& columns_;
};

/// One fitted parameter. Its prior is normal about zero, which is the base simulation: with
/// `tolerance` while the effect is not thought present, with `typical` (and a third and three times
/// of it) while it is.
struct FitParameter {
  double tolerance = 0.0;
  double typical = 0.0;
  bool positive = false;  ///< a negative value has no meaning
};

class Effect {
 public:
  virtual ~Effect() = default;
  virtual std::string Name() const = 0;
  /// One line for reports.
  virtual std::string Summary() const = 0;
  /// Whether the recording has the sensors and the motion that could show it.
  virtual bool Applies(const SampleSet& samples) const = 0;
  virtual std::vector<FitParameter> Parameters(const SampleSet& samples) const = 0;
  /// Called sample after sample in order of time; `memory` starts as zeros.
  virtual void Apply(const double* theta, const Moment& now, EffectMemory& memory,
                     InputChange& change) const = 0;
  /// From fitted to reported parameters; `covariance` is of theta.
  virtual std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                                const Eigen::MatrixXd& covariance) const = 0;
  /// And back, from model.yaml: values in the order of Report's parameters.
  virtual Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const = 0;

 protected:
  Effect() = default;
  Effect(const Effect&) = delete;
  Effect& operator=(const Effect&) = delete;
};

/// An effect whose parameters act as they are, each one number or a list under one name.
class DirectEffect : public Effect {
 public:
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override;
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override;

 protected:
  struct Named {
    std::string name;
    int size = 1;
    double nominal = 0.0;  ///< added to what was fitted when reported
  };
  virtual std::vector<Named> Names() const = 0;
};

/// The recording's own tolerance for `effect`.`parameter`, or `fallback`, as `size` numbers.
std::vector<double> ToleranceOf(const SampleSet& samples, const std::string& effect,
                                const std::string& parameter, double fallback, int size = 1);

/// `tolerances` with one typical size for all.
std::vector<FitParameter> WithTypical(const std::vector<double>& tolerances, double typical);

/// The same parameters, none of which may be negative.
std::vector<FitParameter> Positive(std::vector<FitParameter> parameters);

}  // namespace flextip::diagnosis
