// Something hangs on a link or on a bar, at a place that the arm's file names. Where the arm's
// masses are unknown, a payload that is always there is a part of them: only its coming and going
// shows.
#include "arms/effects/effects.h"
#include "arms/model/dynamics.h"

namespace flextip::arms {
namespace {

class Payload : public PlainEffect {
 public:
  explicit Payload(int place) : place_(place) {}
  std::string Name() const override { return "payload"; }
  std::string Summary() const override { return "something hangs on a link"; }
  bool Applies(const ArmData& data) const override { return data.torque.Any(); }
  bool MayChange() const override { return true; }
  bool OnlyChanges() const override { return masses_unknown_; }
  bool ComesAndGoes() const override { return true; }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    return {{ToleranceOf(data, "payload.mass_kg", 0.01, 1)[0], 0.15, true}};
  }
  void ActOnEffort(const ArmData& data, EffortStage& stage) const override {
    const auto& torque = data.torque;
    Eigen::MatrixXd shape(torque.track.Rows(), torque.track.values.cols());
    for (Eigen::Index k = 0; k < shape.rows(); ++k) {
      const Where& where = torque.where[k];
      const Motion motion{At(data.smooth, where).transpose(), At(data.rate, where).transpose(),
                          At(data.acceleration, where).transpose()};
      shape.row(k) =
          PayloadEffort(data.nominal, data.arm.payload_places[place_], motion, data.gravity_m_s2)
              .head(shape.cols())
              .transpose();
    }
    stage.Add(0, std::move(shape));
  }
  void SetMassesUnknown(bool unknown) { masses_unknown_ = unknown; }

  std::vector<ArmParameter> Report(const ArmData& data, const Eigen::VectorXd& theta,
                                   const Eigen::MatrixXd& covariance) const override {
    auto reported = PlainEffect::Report(data, theta, covariance);
    const PayloadPlace& place = data.arm.payload_places[place_];
    const double lever = place.keeps_orientation_of > 0 ? place.bar_m.norm() : place.p_m.norm();
    reported.push_back({"link", {double(place.MovesWith())}, {0.0}});
    reported.push_back({"place", {double(place_ + 1)}, {0.0}});
    reported.push_back(
        {"first_moment_kg_m", {lever * reported[0].value[0]}, {lever * reported[0].sd[0]}});
    return reported;
  }

 protected:
  std::vector<Named> Names(const ArmData&) const override { return {{"mass_kg", 1}}; }

 private:
  int place_;
  bool masses_unknown_ = false;
};

}  // namespace

std::unique_ptr<ArmEffect> MakePayload(const Arm& arm, int place) {
  auto payload = std::make_unique<Payload>(place);
  payload->SetMassesUnknown(arm.links.empty());
  return payload;
}

}  // namespace flextip::arms
