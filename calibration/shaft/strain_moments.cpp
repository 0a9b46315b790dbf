#include "calibration/shaft/strain_moments.h"

namespace flextip {

Eigen::Matrix4d StatedMoments::Covariance(const LoadHold& hold) const {
  const auto square = [](double x) { return x * x; };
  return square(hold.force_noise_N) * by_force * by_force.transpose() +
         square(hold.wrist_noise_m) * by_wrist * by_wrist.transpose() +
         square(hold.wrist_turn_noise_rad) * by_roll * by_roll.transpose();
}

MomentModel::MomentModel(const Instrument& instrument, const Eigen::Vector3d& p_RP,
                         const Eigen::Vector3d& gravity_m_s2, const double (&stations_m)[2])
    : stations_{{stations_m[0]}, {stations_m[1]}} {
  problem_.rod.length_m = instrument.length_m;
  problem_.rod.bending_stiffness_Nm2 = instrument.bending_stiffness_Nm2;
  problem_.rod.stiffness_taper = instrument.stiffness_taper;
  problem_.rod.p_port = p_RP;
  problem_.rod.q_weight = instrument.mass_per_length_kg_m * gravity_m_s2;
}

std::optional<StatedMoments> MomentModel::At(const LoadHold& hold) {
  if (!hold.R_RW) return {};
  problem_.rod.p_wrist = hold.p_RW;
  problem_.rod.f_tip = hold.f_tip_N;
  problem_.effects.y_wrist = hold.R_RW->col(1);
  const EffectRodState rod = solver_.Solve(problem_, stations_);
  if (!rod.IsUsable()) return {};
  StatedMoments stated;
  stated.s_port_m = rod.s_port_m;
  for (int i = 0; i < 2; ++i) {
    const EffectRodSection& s = rod.stations[i];
    const Eigen::Vector3d z = s.t.cross(s.y);
    stated.m_Nm.segment<2>(2 * i) << s.m.dot(s.y), s.m.dot(z);
    stated.by_roll.segment<2>(2 * i) << s.m.dot(z), -s.m.dot(s.y);
    Eigen::Matrix<double, 2, rod_input::kCount> d;
    d.row(0) = s.y.transpose() * s.dm + s.m.transpose() * s.dy;
    // m . d(t x y) = (y x m) . dt + (m x t) . dy
    d.row(1) = z.transpose() * s.dm + s.y.cross(s.m).transpose() * s.dt +
               s.m.cross(s.t).transpose() * s.dy;
    stated.by_wrist.middleRows<2>(2 * i) = d.middleCols<3>(rod_input::kWrist);
    stated.by_port.middleRows<2>(2 * i) = d.middleCols<3>(rod_input::kPort);
    stated.by_force.middleRows<2>(2 * i) = d.middleCols<3>(rod_input::kForce);
  }
  return stated;
}

}  // namespace flextip
