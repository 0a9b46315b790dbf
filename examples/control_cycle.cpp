// One control cycle on made-up sensors: samples in, the wrist's command out.
#include <fmt/format.h>

#include <flextip/pipeline/instrument_controller.h>

using namespace flextip;

int main() {
  // A steel rod of 600 mm through a port 170 mm above the origin of R.
  const Instrument rod{0.6, 0.00238, 0.304, 0.0351};
  const Eigen::Vector3d p_RP(0.0, 0.0, 0.17), gravity_m_s2(0.0, 0.0, -9.81);

  InstrumentControllerOptions options;
  options.estimator = EstimatorOptionsFor(rod, p_RP, gravity_m_s2);
  options.control.kind = ControllerKind::kRodTrack;
  InstrumentController controller(options);

  // The newest sample of each sensor, with its noise: here the wrist and the tip by vision.
  ControllerInputs inputs;
  inputs.t_ns = 1'000'000;
  WristMeasurement wrist;
  wrist.p_RW = {-0.2457, 0.0, 0.3421};
  wrist.position_noise_m = 5e-5;
  inputs.sensors.wrist = {inputs.t_ns, wrist};
  TipMeasurement tip;
  tip.tip.status = TipStatus::kOk;
  tip.tip.p_RE = {0.245, 0.001, 0.002};
  tip.tip.covariance_m2 = 1e-8 * Eigen::Matrix3d::Identity();
  inputs.sensors.tip = {inputs.t_ns, tip};
  inputs.p_RE_desired = tip.tip.p_RE + Eigen::Vector3d(0.0, 0.0, -0.001);

  const ControllerCommand command = controller.Step(inputs);
  const Eigen::Vector3d to_mm = 1e3 * command.p_RW_command;
  const Eigen::Vector3d& force_N = command.estimate.model.f_tip_N;
  fmt::print("wrist to {:.2f} {:.2f} {:.2f} mm, {}\n", to_mm.x(), to_mm.y(), to_mm.z(),
             Name(command.status));
  fmt::print("force on the tip {:.2f} {:.2f} {:.2f} N, {}\n", force_N.x(), force_N.y(), force_N.z(),
             Name(command.estimate.status));
}
