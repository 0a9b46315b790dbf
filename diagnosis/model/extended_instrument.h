// An extended model at each instant in turn: its changes of the shaft, and the sensors' effects
// undone.
#pragma once

#include <memory>
#include <vector>

#include "diagnosis/model/extended_model.h"
#include "diagnosis/replay/sample_input.h"
#include "diagnosis/samples/sample_set.h"
#include "estimation/instrument_model.h"

namespace flextip::diagnosis {

/// Made for one run: effects have a memory. Advance does the work of diagnosis/model/geometry,
/// Correct that of sensor_prediction, backwards. The doubt in what is within tolerance of a sensor
/// adds to the sensor's noise.
class ExtendedInstrument : public InstrumentModel {
 public:
  /// Takes instrument, port, gravity and the camera's pose from `base`. Throws InputError for an
  /// effect that is neither in the catalogue nor in `own`.
  ExtendedInstrument(const ExtendedModel& model, const Recording& base,
                     const EffectMakers& own = {});
  ~ExtendedInstrument() override;

  void Advance(TimeNs t_ns, const Measurements& measured, const Eigen::Vector3d& f_tip_N) override;
  const ShaftChange& Shaft() const override { return shaft_; }
  Measurements Correct(const Measurements& measured) const override;
  double LengthSd() const override;
  void VisitState(StateText& state) override;

  /// Returns the inputs at this instant, delays among them.
  const SampleInputs& Inputs() const { return inputs_; }

 private:
  struct Acting;  // an effect with its parameters and memory
  void SetSample(TimeNs t_ns, const Measurements& measured, const Eigen::Vector3d& f_tip_N);
  void Apply(Acting& acting, double s_port_free_m, double ds_port_dfriction_m);
  void SolveShaft();
  void FillShaft();
  void CorrectEm(const SampleInputs& u, EmMeasurement& em) const;
  void CorrectTip(const SampleInputs& u, Measurements& z) const;
  Measurements CorrectBy(const SampleInputs& u, const Measurements& measured) const;
  void FactorTolerance(const ExtendedModel& model);

  SampleSet set_;  // of one sample: now
  TimeNs start_ns_;
  std::vector<Acting> acting_;
  std::vector<InputChange::Column> columns_;  // what the effects write of their derivatives
  SampleInputs inputs_ = SampleInputs::Zero();
  /// What is within tolerance may move the inputs so, each column by one standard deviation.
  Eigen::Matrix<double, sample_input::kCount, Eigen::Dynamic> spread_;
  ShaftChange shaft_;
  bool needs_port_place_ = false;
  double friction_ = 0.0;  // the last instant's
  EffectRodSolver solver_;
  double s_port_free_m_ = 0.0, ds_port_dfriction_m_ = 0.0;
  std::unique_ptr<SolvedSample> solved_;  // the last shape, once there is one
  bool has_shape_ = false;
  Eigen::Matrix3d R_RE_ = Eigen::Matrix3d::Identity();
};

}  // namespace flextip::diagnosis
