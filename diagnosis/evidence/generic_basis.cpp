#include "diagnosis/evidence/generic_basis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flextip::diagnosis {
namespace {

constexpr double kSlow_m_s = 0.004;      // sliding is told from rest at about this speed
constexpr int kWaves = 4;                // half periods over the recording
constexpr Eigen::Index kNeighbours = 4;  // on either side, that say what an unknown force is

/// Central differences over two samples.
Eigen::VectorXd Rate(const SampleSet& samples, const Eigen::VectorXd& value) {
  const auto n = value.size();
  Eigen::VectorXd rate = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto a = std::max<Eigen::Index>(0, k - 1), b = std::min(n - 1, k + 1);
    rate[k] = (value[b] - value[a]) / (samples.samples[b].t_s - samples.samples[a].t_s);
  }
  return rate;
}

/// The mean of the samples around each, without itself: an unknown force is found from the sample's
/// own sensors, and with their noise in it any of them would seem to follow it.
Eigen::VectorXd OfNeighbours(const Eigen::VectorXd& value) {
  const auto n = value.size();
  Eigen::VectorXd around = value;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Index first = std::max<Eigen::Index>(0, k - kNeighbours);
    const Eigen::Index count = std::min(n - 1, k + kNeighbours) - first;
    if (count > 0) around[k] = (value.segment(first, count + 1).sum() - value[k]) / double(count);
  }
  return around;
}

void Append(std::vector<Eigen::VectorXd>& columns, const Eigen::VectorXd& column) {
  columns.push_back(column);
}

/// Zero mean and unit variance; zeros where it hardly varies.
Eigen::VectorXd Standard(const Eigen::VectorXd& v) {
  const Eigen::VectorXd centred = v.array() - v.mean();
  const double sd = std::sqrt(centred.squaredNorm() / double(v.size()));
  return sd > 1e-9 * (1e-9 + std::abs(v.mean())) ? Eigen::VectorXd(centred / sd)
                                                 : Eigen::VectorXd::Zero(v.size());
}

}  // namespace

std::vector<Regressor> Regressors(const Replay& replay) {
  const SampleSet& set = replay.Set();
  const auto n = Eigen::Index(set.samples.size());
  Eigen::VectorXd depth(n), time(n), port_force(n), load(n), wrist_speed(n);
  Eigen::MatrixXd direction(n, 3), wrist(n, 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    const DiagnosisSample& z = set.samples[k];
    const Eigen::Vector3d to_port = set.p_RP - z.p_RW;
    depth[k] = set.instrument.length_m - to_port.norm();
    direction.row(k) = to_port.normalized().transpose();
    wrist.row(k) = z.p_RW.transpose();
    time[k] = z.t_s;
    port_force[k] = replay.Samples()[k].solved.lateral_force_N;
    load[k] = replay.Samples()[k].f_tip_N.norm();
  }
  for (int i = 0; i < 3; ++i) {
    const Eigen::VectorXd rate = Rate(set, wrist.col(i));
    wrist_speed = i == 0 ? rate.cwiseAbs2().eval() : (wrist_speed + rate.cwiseAbs2()).eval();
  }
  if (!set.has_load) {
    port_force = OfNeighbours(port_force);
    load = OfNeighbours(load);
  }
  const Eigen::Vector3d mean = direction.colwise().mean().transpose().normalized();
  Eigen::Index along = 0;
  mean.cwiseAbs().maxCoeff(&along);
  std::vector<Regressor> regressors = {{"insertion_depth", depth},
                                       {"sliding_velocity", Rate(set, depth)},
                                       {"wrist_speed", wrist_speed.cwiseSqrt()},
                                       {"port_force", port_force},
                                       {"load", load},
                                       {"time", time}};
  const char* axes[3] = {"direction_x", "direction_y", "direction_z"};
  const char* speeds[3] = {"turning_x", "turning_y", "turning_z"};
  for (int i = 0; i < 3; ++i) {
    if (i == along) continue;
    regressors.push_back({axes[i], direction.col(i)});
    regressors.push_back({speeds[i], Rate(set, direction.col(i))});
  }
  return regressors;
}

Eigen::MatrixXd GenericBasis(const Replay& replay) {
  const auto regressors = Regressors(replay);
  const bool timed = replay.Set().resolved_in_time;
  std::vector<Eigen::VectorXd> columns = {
      Eigen::VectorXd::Ones(Eigen::Index(replay.Samples().size()))};
  std::vector<Eigen::VectorXd> places;  // depth and direction
  for (const Regressor& r : regressors) {
    const Eigen::VectorXd x = Standard(r.value);
    const bool is_rate = r.name == "sliding_velocity" || r.name.starts_with("turning");
    if (r.name == "insertion_depth" || r.name.starts_with("direction")) places.push_back(x);
    if (is_rate && timed) {
      Append(columns, x);
      if (r.name == "sliding_velocity")
        Append(columns, (r.value / kSlow_m_s).array().tanh().matrix());
    }
    if (r.name == "load" || r.name == "port_force") Append(columns, x);
    if (r.name == "time" && timed) {
      const double span = std::max(1e-9, r.value.maxCoeff() - r.value.minCoeff());
      for (int w = 1; w <= kWaves; ++w)
        Append(columns, ((r.value.array() - r.value[0]) * (w * std::numbers::pi / span)).cos());
    }
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    Append(columns, places[i]);
    for (std::size_t j = i; j < places.size(); ++j)
      Append(columns, places[i].cwiseProduct(places[j]));
  }
  // Gram-Schmidt; what the others already contain is dropped.
  std::vector<Eigen::VectorXd> kept;
  const double n = double(columns[0].size());
  for (Eigen::VectorXd column : columns) {
    const double before = column.norm();
    for (int twice = 0; twice < 2; ++twice)
      for (const auto& other : kept) column -= column.dot(other) / n * other;
    if (column.norm() > 0.05 * before && before > 0.0)
      kept.emplace_back(column * std::sqrt(n) / column.norm());
  }
  Eigen::MatrixXd basis(columns[0].size(), Eigen::Index(kept.size()));
  for (std::size_t j = 0; j < kept.size(); ++j) basis.col(Eigen::Index(j)) = kept[j];
  return basis;
}

}  // namespace flextip::diagnosis
