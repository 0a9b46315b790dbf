// What efforts need that no file states, shared by all recordings of an arm: masses, first moments
// and inertias of the links, inertias of the motors, springs (cables and hoses), zeros of the
// efforts, and what a bar of a parallelogram adds to its link. A nuisance with wide priors; stated
// masses are the base, and the rest stays narrow.
#include "arms/effects/effects.h"
#include "arms/model/dynamics.h"

namespace flextip::arms {
namespace {

constexpr double kAcross_m = 0.1;  // of a bar's place out of the plane, that its torque is felt by

class Masses : public PlainEffect {
 public:
  std::string Name() const override { return "masses"; }
  std::string Summary() const override { return "masses and springs that no file states"; }
  bool Applies(const ArmData& data) const override { return data.torque.Any(); }
  bool IsAnswer() const override { return false; }

  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    const bool stated = !data.arm.links.empty();
    std::vector<FitParameter> parameters;
    for (int i = 0; i < data.Size(); ++i) {
      const double mass = stated ? 0.001 : 3.0, moment = stated ? 0.0002 : 0.7,
                   inertia = stated ? 0.003 : 0.3;
      parameters.push_back({mass});
      for (int j = 0; j < 3; ++j) parameters.push_back({moment});
      for (int j = 0; j < 6; ++j) parameters.push_back({inertia});
    }
    for (int i = 0; i < data.Size(); ++i)
      parameters.push_back({data.TypicalOf(i, stated ? 0.03 : 0.1, stated ? 2.0 : 3.0)});
    for (int i = 0; i < data.Size(); ++i)
      parameters.push_back({stated ? data.TypicalOf(i, 0.002, 0.2) : data.TypicalOf(i, 0.5, 10.0)});
    for (int i = 0; i < data.Size(); ++i)
      parameters.push_back({stated ? data.TypicalOf(i, 0.005, 0.05) : data.TypicalOf(i, 0.1, 1.0)});
    for (const PayloadPlace& place : data.arm.payload_places)
      if (place.keeps_orientation_of > 0) parameters.push_back({stated ? 0.001 : 3.0});
    return parameters;
  }

  void ActOnEffort(const ArmData& data, EffortStage& stage) const override {
    const int n = data.Size();
    const auto& torque = data.torque;
    const Eigen::Index rows = torque.track.Rows(), joints = torque.track.values.cols();
    const auto empty = [&] { return Eigen::MatrixXd(Eigen::MatrixXd::Zero(rows, joints)); };
    std::vector<Eigen::MatrixXd> links(kLinkNumbers * n, empty());
    std::vector<Eigen::MatrixXd> bars;
    for (const PayloadPlace& place : data.arm.payload_places)
      if (place.keeps_orientation_of > 0) bars.push_back(empty());
    for (Eigen::Index k = 0; k < rows; ++k) {
      const Motion motion = MotionAt(data, torque.where[k]);
      const Eigen::MatrixXd regressor = EffortRegressor(data.nominal, motion, data.gravity_m_s2);
      for (int j = 0; j < kLinkNumbers * n; ++j)
        links[j].row(k) = regressor.col(j).head(joints).transpose();
      std::size_t bar = 0;
      for (const PayloadPlace& place : data.arm.payload_places)
        if (place.keeps_orientation_of > 0)
          bars[bar++].row(k) = BarEffort(data, place, motion).head(joints).transpose();
    }
    for (int j = 0; j < kLinkNumbers * n; ++j) stage.Add(j, std::move(links[j]));
    AddPerJoint(data, stage, kLinkNumbers * n, joints);
    for (std::size_t b = 0; b < bars.size(); ++b)
      stage.Add((kLinkNumbers + 3) * n + int(b), std::move(bars[b]));
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override {
    const int n = data.Size();
    std::vector<Named> names{{"link_numbers", kLinkNumbers * n},
                             {"motor_inertia", n},
                             {"spring", n},
                             {"effort_zero", n}};
    int bars = 0;
    for (const PayloadPlace& place : data.arm.payload_places)
      bars += place.keeps_orientation_of > 0 ? 1 : 0;
    if (bars > 0) names.push_back({"bar_kg", bars});
    return names;
  }

 private:
  static Motion MotionAt(const ArmData& data, const Where& where) {
    return {At(data.smooth, where).transpose(), At(data.rate, where).transpose(),
            At(data.acceleration, where).transpose()};
  }

  /// What a bar has that no mass on its link has: its place out of the swing's centre.
  static Eigen::VectorXd BarEffort(const ArmData& data, const PayloadPlace& place,
                                   const Motion& motion) {
    const Eigen::VectorXd hung = PayloadEffort(data.nominal, place, motion, data.gravity_m_s2);
    const int kept = place.keeps_orientation_of;
    Arm moved = data.arm;
    moved.joints[kept].before.p.x() += kAcross_m;
    return PayloadEffort(Kinematics(moved), place, motion, data.gravity_m_s2) - hung;
  }

  static void AddPerJoint(const ArmData& data, EffortStage& stage, int first, Eigen::Index joints) {
    const auto& torque = data.torque;
    const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(torque.track.Rows(), joints);
    for (int i = 0; i < int(joints); ++i) {
      Eigen::MatrixXd motor = none, spring = none, zero = none;
      for (Eigen::Index k = 0; k < motor.rows(); ++k) {
        motor(k, i) = At(data.acceleration, torque.where[k])[i];
        spring(k, i) = At(data.smooth, torque.where[k])[i];
        zero(k, i) = 1.0;
      }
      stage.Add(first + i, std::move(motor));
      stage.Add(first + data.Size() + i, std::move(spring));
      stage.Add(first + 2 * data.Size() + i, std::move(zero));
    }
  }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeMasses() { return std::make_unique<Masses>(); }

}  // namespace flextip::arms
