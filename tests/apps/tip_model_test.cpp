// The predicted tip against the truth of simulated recordings.
#include "apps/tip_model.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "core/rotation.h"
#include "simulation/hidden_recording.h"

namespace flextip {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

Vector6 Error(const Pose& T_RE, const Pose& truth) {
  Vector6 e;
  e << LogRotation(truth.R * T_RE.R.transpose()), truth.p - T_RE.p;
  return e;
}
double Nees(const TipPrediction& p, const Pose& truth) {
  const Vector6 e = Error(p.T_RE, truth);
  return e.dot(p.covariance.ldlt().solve(e));
}

HiddenRecording Make(LoadKind load, std::uint64_t seed, std::vector<std::string> left_out, bool exact) {
  HiddenOptions options;
  options.exact = exact;
  options.with_load = false;
  options.left_out = std::move(left_out);
  options.scene.load = load;
  options.scene.duration_s = 10.0;
  options.tick_rate_hz = 50;
  return MakeHidden(options, seed);
}

struct Sum { double np = 0, nd = 0, nees = 0, p2 = 0, sd2 = 0; int n = 0; double worst = 0; };

TEST(TipModel, Study) {
  for (const LoadKind load : {LoadKind::kNone, LoadKind::kHungMass, LoadKind::kTissue, LoadKind::kVarying}) {
   for (const bool exact : {true, false}) for (const bool bare : {true, false}) {
    std::map<int, Sum> sums;  // by time hidden in ms; -1 never seen
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const auto hidden = Make(load, seed, bare ? std::vector<std::string>{"em0", "strain0", "vision0", "wrist0_orientation"} : std::vector<std::string>{"em0", "strain0", "vision0"}, exact);
      std::mt19937 rng(3); std::normal_distribution<double> n01;
      Vector6 sd; sd << 0.002, 0.002, 0.002, 1e-4, 1e-4, 3e-4;
      const Eigen::Matrix<double, 6, 6> cov = sd.cwiseAbs2().asDiagonal();
      TipModel never(hidden.recording);
      const auto& truth = hidden.truth;
      const auto pose = [&](std::size_t i) { return Pose::FromQuaternion(truth[i].value.q_RE, truth[i].value.p_RE); };
      for (std::size_t i = 20; i + 120 < truth.size(); i += 23) {
        if (const auto p = never.Predict(truth[i].t_ns)) {
          auto& s = sums[-1]; const double e = Nees(*p, pose(i)); s.nees += e; { const Vector6 d = Error(p->T_RE, pose(i)); s.np += d.tail<3>().dot(p->covariance.bottomRightCorner<3,3>().ldlt().solve(d.tail<3>())); s.nd += d.head<3>().dot(p->covariance.topLeftCorner<3,3>().ldlt().solve(d.head<3>())); } s.worst = std::max(s.worst, e); s.p2 += (p->T_RE.p - pose(i).p).squaredNorm(); s.sd2 += p->covariance.bottomRightCorner<3,3>().trace(); ++s.n;
        }
        TipModel model(hidden.recording);
        for (std::size_t k = i - 10; k <= i; k += 2) {
          Pose seen = pose(k);
          Vector6 noise; for (int j = 0; j < 6; ++j) noise[j] = sd[j] * n01(rng);
          seen.R = ExpRotation(noise.head<3>()) * seen.R; seen.p += noise.tail<3>();
          model.Seen(truth[k].t_ns, seen, cov);
        }
        for (const int ms : {20, 100, 200, 500, 1000, 2000}) {
          const std::size_t j = i + static_cast<std::size_t>(ms / 20);
          const auto p = model.Predict(truth[j].t_ns);
          if (!p) continue;
          auto& s = sums[ms]; const double e = Nees(*p, pose(j)); s.nees += e; { const Vector6 d = Error(p->T_RE, pose(j)); s.np += d.tail<3>().dot(p->covariance.bottomRightCorner<3,3>().ldlt().solve(d.tail<3>())); s.nd += d.head<3>().dot(p->covariance.topLeftCorner<3,3>().ldlt().solve(d.head<3>())); } s.worst = std::max(s.worst, e); s.p2 += (p->T_RE.p - pose(j).p).squaredNorm(); s.sd2 += p->covariance.bottomRightCorner<3,3>().trace(); ++s.n;
        }
      }
    }
    for (const auto& [ms, s] : sums) std::printf("%-9s exact %d bare %d %5d ms: nees %.2f (p %.2f, w %.2f) worst %.0f, rms %.2f mm, stated %.2f mm (%d)\n", Name(load), exact, bare, ms, s.nees / s.n, s.np/s.n, s.nd/s.n, s.worst, 1e3*std::sqrt(s.p2/s.n), 1e3*std::sqrt(s.sd2/s.n), s.n);
   }
  }
}

}  // namespace
}  // namespace flextip
