// An effect of an arm as its diagnosis knows it: parameters, priors, and its action on what is
// commanded, on the joints, on the outside pose or on the efforts. One file an effect.
#pragma once

#include <Eigen/Dense>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "arms/data/arm_data.h"
#include "arms/effects/play.h"
#include "diagnosis/evidence/priors.h"

namespace flextip::arms {

using diagnosis::FitParameter;

/// One parameter as reported: values with deviations, a number or a list under one name.
struct ArmParameter {
  std::string name;
  std::vector<double> value, sd;
};

/// Joints on a time line and their derivatives, for effects to write. `parameter` counts within the
/// effect.
class JointStage {
 public:
  struct Column {
    int parameter = 0, joint = 0;
    Eigen::VectorXd values;
  };

  JointStage(const Track& input, const Eigen::MatrixXd& effort, Eigen::MatrixXd& output,
             std::vector<Column>* columns)
      : input(input), effort(effort), output(output), columns_(columns) {}

  /// Adds `factor` times the shape to a joint, with its derivative by the parameter.
  void Linear(int parameter, int joint, double value, const Eigen::VectorXd& shape) {
    output.col(joint) += value * shape;
    Derivative(parameter, joint, shape);
  }
  void Derivative(int parameter, int joint, const Eigen::VectorXd& shape) {
    if (columns_ != nullptr) columns_->push_back({first_ + parameter, joint, shape});
  }
  /// The same for one of the parameters of all effects.
  void DerivativeOfAny(int parameter, int joint, Eigen::VectorXd shape) {
    if (columns_ != nullptr) columns_->push_back({parameter, joint, std::move(shape)});
  }
  bool WantsDerivatives() const { return columns_ != nullptr; }
  int First() const { return first_; }
  void SetFirst(int first) { first_ = first; }

  const Track& input;             ///< as measured or commanded
  const Eigen::MatrixXd& effort;  ///< known efforts on the same rows
  Eigen::MatrixXd& output;        ///< starts as the input
  /// Where plays stand at the first row, in widths (PlayState); empty: in the middle. And the first
  /// of their parameters among those of all effects.
  Eigen::VectorXd play_start;
  int first_play_start = 0;
  /// By how many widths of its play a spring draws a joint back, per unit of the joint; and the
  /// first of these parameters.
  Eigen::VectorXd pull_back;
  int first_pull_back = 0;

 private:
  int first_ = 0;
  std::vector<Column>* columns_;
};

/// What places a tracked marker: each number is moved by a parameter.
struct PoseStage {
  enum Slot {
    kTrackerRotation = 0,
    kTracker = 3,
    kMarkerRotation = 6,
    kMarker = 9,
    kGeometry = 12
  };
  explicit PoseStage(int joints) : values(Eigen::VectorXd::Zero(kGeometry + 3 * joints)) {}

  void Add(int parameter, int slot, double value) {
    values[slot] += value;
    moved.push_back({first + parameter, slot});
  }
  struct Moved {
    int parameter, slot;
  };
  Eigen::VectorXd values;
  std::vector<Moved> moved;
  int first = 0;
};

/// Shapes of efforts, linear in parameters; rows and joints of `ArmData::torque`.
struct EffortStage {
  struct Column {
    int parameter = 0;
    Eigen::MatrixXd shape;  ///< rows x measured joints
  };
  void Add(int parameter, Eigen::MatrixXd shape) {
    columns.push_back({first + parameter, std::move(shape)});
  }
  std::vector<Column> columns;
  int first = 0;
};

class ArmEffect {
 public:
  virtual ~ArmEffect() = default;
  virtual std::string Name() const = 0;
  /// Returns one line for reports.
  virtual std::string Summary() const = 0;
  /// Returns whether the recording has what could show the effect.
  virtual bool Applies(const ArmData& data) const = 0;
  /// Returns the fitted parameters, as many for any recording of the same arm.
  virtual std::vector<FitParameter> Parameters(const ArmData& data) const = 0;

  /// Acts on commands: what a perfect servo would make of them.
  virtual void ActOnCommand(const ArmData&, const double*, JointStage&) const {}
  /// Says how plays stand when a recording begins and what pulls at them, before any effect acts
  /// between encoders and joints.
  virtual void StartPlay(const ArmData&, const double*, JointStage&) const {}
  /// Acts between encoders and true joints.
  virtual void ActOnJoints(const ArmData&, const double*, JointStage&) const {}
  virtual void ActOnPose(const ArmData&, const double*, PoseStage&) const {}
  virtual void ActOnEffort(const ArmData&, EffortStage&) const {}

  virtual std::vector<ArmParameter> Report(const ArmData& data, const Eigen::VectorXd& theta,
                                           const Eigen::MatrixXd& covariance) const = 0;
  /// Returns theta from reported values. Throws InputError where a list has another length.
  virtual Eigen::VectorXd FromReported(const ArmData& data,
                                       const std::vector<ArmParameter>& reported) const = 0;

  /// Returns how plays are replayed: nothing set where there are none. With parameters of zero it
  /// does nothing.
  virtual PlayHistory History() const { return {}; }
  virtual void SetHistory(const PlayHistory& /*history*/) {}
  /// Returns the parameters that a joint's window carries: its own width first.
  virtual std::vector<int> OfWindow(const ArmData&, int /*joint*/) const { return {}; }
  /// Returns the history in which joints drag each other as the parameters say. Gives `theta` a
  /// width where a joint that is dragged has none.
  virtual PlayHistory Carrying(const ArmData&, Eigen::VectorXd& /*theta*/) const {
    return History();
  }

  /// Returns whether one recording may have the effect where one before had none.
  virtual bool MayChange() const { return false; }
  /// Returns whether it only shows where it changes: alone it cannot be told from the base.
  virtual bool OnlyChanges() const { return false; }
  /// Returns whether a change lasts for one recording, not for all after it.
  virtual bool ComesAndGoes() const { return false; }
  /// Returns whether springs that pull at plays look like it (play_spring.cpp).
  virtual bool IsLikeSprings() const { return false; }
  /// Returns whether it is an answer, not a nuisance that is always there.
  virtual bool IsAnswer() const { return true; }
  /// Returns how far from zero its numbers may be. At a bound they stay, and nothing moves with
  /// them.
  virtual double Bound() const { return std::numeric_limits<double>::infinity(); }
  /// Returns whether each recording has its own values.
  virtual bool OwnInEach() const { return false; }

 protected:
  ArmEffect() = default;
  ArmEffect(const ArmEffect&) = delete;
  ArmEffect& operator=(const ArmEffect&) = delete;
};

/// An effect whose parameters act as they are, under names with sizes.
class PlainEffect : public ArmEffect {
 public:
  std::vector<ArmParameter> Report(const ArmData& data, const Eigen::VectorXd& theta,
                                   const Eigen::MatrixXd& covariance) const override;
  Eigen::VectorXd FromReported(const ArmData& data,
                               const std::vector<ArmParameter>& reported) const override;

 protected:
  struct Named {
    std::string name;
    int size = 1;
    double nominal = 0.0;
  };
  virtual std::vector<Named> Names(const ArmData& data) const = 0;
};

/// Returns the reported list of that name. Throws InputError where it has another length; one that
/// is absent is empty.
std::vector<double> ListOf(const std::string& effect, const std::vector<ArmParameter>& reported,
                           const std::string& name, int size);

/// One parameter a joint: tolerance and typical size by the joint's unit; the recording's own
/// tolerance for `effect.parameter` first.
struct JointSizes {
  double tolerance_rad, tolerance_m, typical_rad, typical_m;
  bool positive = false;
};
std::vector<FitParameter> PerJoint(const ArmData& data, const std::string& key,
                                   const JointSizes& sizes);

/// The recording's own tolerances for `key`, or `fallback`, as `size` numbers. Throws InputError
/// where the recording has another number of them.
std::vector<double> ToleranceOf(const ArmData& data, const std::string& key, double fallback,
                                int size);

/// The off-diagonal entry `m` of a square matrix, row by row.
struct Entry {
  int row, column;
};
Entry OffDiagonal(int size, int m);

/// How much larger a number is that makes unit of joint `i` from unit of joint `j`.
double UnitRatio(const ArmData& data, int i, int j);

using Effects = std::vector<std::unique_ptr<ArmEffect>>;

}  // namespace flextip::arms
