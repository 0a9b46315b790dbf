// An effect as the diagnosis knows it: its parameters, their priors, and its action on the rod or
// on a sensor. Every effect of the catalogue is one file in effects/. The rest of the diagnosis
// asks an effect for its properties and knows none by name (docs/usage/add_an_effect.md
// shows how to add one).
#pragma once

#include <Eigen/Dense>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/evidence/priors.h"
#include "diagnosis/replay/sample_input.h"
#include "diagnosis/samples/sample_set.h"

namespace flextip::diagnosis {

struct SolvedSample;

/// One parameter as reported. Some effects are fitted in another form than they are named in.
struct ReportedParameter {
  std::string name;
  std::vector<double> value, sd;
  bool may_be_missing = false;  ///< from a model.yaml of an older version: then of no effect
};

/// The sample on which an effect acts, and the port's place as the last replay found it.
struct Instant {
  const SampleSet& samples;
  std::size_t k = 0;                     ///< index of the sample
  double t_s = 0.0;                      ///< since the recording's start
  double s_port_free_m = 0.0;            ///< of the port on the shaft if it had no friction
  double ds_port_dfriction_m = 0.0;      ///< by rod_input::kPortFriction; 0 where not known yet
  const SolvedSample* solved = nullptr;  ///< the shape as last found; null: not known yet
};

/// The memory of an effect from sample to sample.
using EffectMemory = std::array<double, 12>;

/// The sample's inputs and their derivatives by the effect's parameters, for an effect to write.
class InputChange {
 public:
  struct Column {
    int parameter = 0, input = 0;
    double value = 0.0;
  };

  InputChange(const double* theta, int first, SampleInputs& inputs, std::vector<Column>& columns)
      : theta_(theta), first_(first), inputs_(inputs), columns_(columns) {}

  /// Adds `factor` times the effect's parameter `j` to the input.
  void Linear(int j, int input, double factor) {
    Add(input, factor * theta_[j]);
    Derivative(j, input, factor);
  }
  void Add(int input, double value) { inputs_[input] += value; }
  /// Returns the input as the earlier effects left it.
  double Input(int input) const { return inputs_[input]; }
  void Derivative(int j, int input, double value) {
    if (value != 0.0) columns_.push_back({first_ + j, input, value});
  }

 private:
  const double* theta_;
  int first_;
  SampleInputs& inputs_;
  std::vector<Column>& columns_;
};

/// A parameter in which the model is far from linear, such as a frequency. The search scans it
/// over a range with two shapes in some of a sample's inputs; the fit corrects it about the value
/// found.
struct ScannedParameter {
  double lowest = 0.0, highest = 0.0;
  double resolution = 0.0;  ///< values nearer than this look alike in the recording
  int correction = 0;       ///< index among the effect's parameters: the value less the centre
  int first_input = 0;      ///< inputs from here on are moved by the shapes
  int inputs = 3;
};

class Effect {
 public:
  virtual ~Effect() = default;
  virtual std::string Name() const = 0;
  /// Returns one line for reports.
  virtual std::string Summary() const = 0;
  /// Returns whether the recording has the sensors and the motion that could show the effect.
  virtual bool Applies(const SampleSet& samples) const = 0;
  /// Returns the fitted parameters. Their number is the same for any samples, an empty set too.
  virtual std::vector<FitParameter> Parameters(const SampleSet& samples) const = 0;
  /// Acts on a sample. Called sample after sample in order of time; `memory` starts as zeros.
  virtual void Apply(const double* theta, const Instant& now, EffectMemory& memory,
                     InputChange& change) const = 0;
  /// Returns the reported form of the fitted parameters; `covariance` is of theta.
  virtual std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                                const Eigen::MatrixXd& covariance) const = 0;
  /// Returns theta from reported values, in the order of Report's parameters.
  virtual Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const = 0;

  /// Returns why reported values mean nothing; empty where they do mean something.
  virtual std::string WhatIsWrong(const std::vector<std::vector<double>>& values) const;

  /// Returns the parameter to scan; empty for most effects.
  virtual std::optional<ScannedParameter> Scanned(const SampleSet&) const { return {}; }
  /// Returns the phase at `now` per unit of the scanned parameter: the inputs are moved by its sine
  /// and its cosine, times amplitudes.
  virtual double ScannedPhase(const Instant& /*now*/) const { return 0.0; }
  /// Returns the value about which the scanned parameter is fitted.
  virtual double ScanCentre() const { return 0.0; }
  virtual void SetScanCentre(double /*value*/) {}

  /// Returns the fitted parameters that are each recording's own: a rate of drift, a phase, where
  /// a play stood, what hangs on how its motion was seen. All others are the instrument's and the
  /// room's.
  virtual std::vector<int> OwnParameters() const { return {}; }
  /// Returns those of them that are a state, which a prediction finds again.
  virtual std::vector<int> StateParameters() const { return {}; }
  /// Returns whether the effect has a phase, which a prediction finds again.
  virtual bool HasPhase() const { return false; }
  /// Returns theta with the phase turned by `turn_rad`.
  virtual Eigen::VectorXd TurnPhase(const Eigen::VectorXd& theta, double /*turn_rad*/) const {
    return theta;
  }

  /// Returns the input that the effect moves by a hysteresis of the insertion depth, or -1: a term
  /// without a name of that shape is the effect.
  virtual int HysteresisInput() const { return -1; }

  /// Returns whether Apply needs the port's place in `Instant`.
  virtual bool NeedsPortPlace() const { return false; }
  /// Returns the input by which the first parameter delays a sensor (kEmDelay, kCameraDelay), or
  /// -1.
  virtual int DelayInput() const { return -1; }
  /// Returns whether that parameter is a clock's rate: the delay is -rate times the time.
  virtual bool DelayGrows() const { return false; }
  /// Returns the width (m) of the play between measured and true wrist.
  virtual double WristPlay(const Eigen::VectorXd& /*theta*/) const { return 0.0; }

 protected:
  Effect() = default;
  Effect(const Effect&) = delete;
  Effect& operator=(const Effect&) = delete;
};

/// Makes an effect of the user's own, besides those of the catalogue.
using EffectMaker = std::function<std::unique_ptr<Effect>()>;
using EffectMakers = std::vector<EffectMaker>;

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
    double nominal = 0.0;  ///< added to the fitted value when reported
    bool may_be_missing = false;
  };
  virtual std::vector<Named> Names() const = 0;
};

/// Returns the recording's own tolerance for `effect`.`parameter`, or `fallback`, as `size`
/// numbers. Throws InputError where the recording has another number of them.
std::vector<double> ToleranceOf(const SampleSet& samples, const std::string& effect,
                                const std::string& parameter, double fallback, int size = 1);

/// Returns `tolerances` with one typical size for all.
std::vector<FitParameter> WithTypical(const std::vector<double>& tolerances, double typical);

/// Returns the same parameters, none of which may be negative.
std::vector<FitParameter> Positive(std::vector<FitParameter> parameters);

}  // namespace flextip::diagnosis
