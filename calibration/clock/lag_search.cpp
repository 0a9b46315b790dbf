#include "calibration/clock/lag_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kSpeedStep_s = 0.02, kProfileStep_s = 0.05, kApart_s = 0.1;
constexpr std::size_t kMostSamples = 1500;
constexpr double kRidge = 1e-6;  // of a feature's variance

std::vector<double> Speeds(const SmoothMotion& motion, int rows) {
  std::vector<double> speeds;
  for (double t = motion.BeginSeconds(); t <= motion.EndSeconds(); t += kSpeedStep_s) {
    speeds.push_back(motion.SpeedAt(t, rows));
  }
  return speeds;
}

/// Pearson's correlation of `a[i]` with `b[i + shift]` where both are known; NaN below `least`
/// pairs or without change.
double Correlation(const std::vector<double>& a, const std::vector<double>& b, long shift,
                   double least) {
  double n = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  const long from = std::max(0L, -shift);
  const long to = std::min(static_cast<long>(a.size()), static_cast<long>(b.size()) - shift);
  for (long i = from; i < to; ++i) {
    const double x = a[static_cast<std::size_t>(i)], y = b[static_cast<std::size_t>(i + shift)];
    if (std::isnan(x) || std::isnan(y)) continue;
    n += 1;
    sa += x, sb += y, saa += x * x, sbb += y * y, sab += x * y;
  }
  if (n < least) return kNone;
  const double va = saa - sa * sa / n, vb = sbb - sb * sb / n;
  return va > 0.0 && vb > 0.0 ? (sab - sa * sb / n) / std::sqrt(va * vb) : kNone;
}

/// Sums of a linear prediction of the target by the reference, with a constant.
struct PredictionSums {
  static constexpr int kMost = 13;  // features and rows of any stream
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  Matrix xx, xy;
  Vector yy;
  double count = 0.0, first_s = 0.0, last_s = 0.0;

  PredictionSums(Eigen::Index features, Eigen::Index rows)
      : xx(Matrix::Zero(features + 1, features + 1)),
        xy(Matrix::Zero(features + 1, rows)),
        yy(Vector::Zero(rows)) {}

  void Add(double t_s, const Vector& x, const Vector& y) {
    Vector with_constant(x.size() + 1);
    with_constant << x, 1.0;
    xx.noalias() += with_constant * with_constant.transpose();
    xy.noalias() += with_constant * y.transpose();
    yy += y.cwiseAbs2();
    if (count == 0.0) first_s = t_s;
    last_s = t_s;
    count += 1.0;
  }

  double Misfit() const {
    const Eigen::Index n = xx.rows() - 1;
    const Eigen::VectorXd mean_x = xx.col(n).head(n) / count, mean_y = xy.row(n) / count;
    Eigen::MatrixXd variance = xx.topLeftCorner(n, n) - count * mean_x * mean_x.transpose();
    variance.diagonal() *= 1.0 + kRidge;
    variance.diagonal().array() += 1e-18 * count;
    const Eigen::MatrixXd shared = xy.topRows(n) - count * mean_x * mean_y.transpose();
    const double all = (yy - count * mean_y.cwiseAbs2()).sum();
    const double told = shared.cwiseProduct(Eigen::MatrixXd(Ldlt(variance).Solve(shared))).sum();
    return all > 0.0 ? std::clamp(1.0 - told / all, 0.0, 1.0) : 1.0;
  }
};

/// The misfit at one offset; NaN where the overlap is too short.
double MisfitAt(const Motion& target, const SmoothMotion& reference, double offset_s,
                double least_overlap_s) {
  const std::size_t every = 1 + target.Count() / kMostSamples;
  std::optional<PredictionSums> sums;
  Eigen::VectorXd x, velocity;
  for (std::size_t i = 0; i < target.Count(); i += every) {
    if (!reference.At(target.t_s[i] + offset_s, x, velocity)) continue;
    if (!sums) sums.emplace(x.size(), target.own_rows);
    sums->Add(target.t_s[i], x,
              target.values.col(static_cast<Eigen::Index>(i)).head(target.own_rows));
  }
  const bool enough = sums && sums->last_s - sums->first_s >= least_overlap_s &&
                      sums->count >= 5.0 * static_cast<double>(sums->xx.rows());
  return enough ? sums->Misfit() : kNone;
}

}  // namespace

std::vector<double> LikelyOffsets(const SmoothMotion& target, int target_rows,
                                  const SmoothMotion& reference, int reference_rows,
                                  double most_offset_s, double least_overlap_s, std::size_t count) {
  const auto a = Speeds(target, target_rows), b = Speeds(reference, reference_rows);
  const double begins_s = target.BeginSeconds() - reference.BeginSeconds();
  const auto most = static_cast<long>(most_offset_s / kSpeedStep_s);
  std::vector<std::pair<double, double>> peaks;  // correlation, offset
  double before = kNone, at = kNone;
  for (long k = -most - 1; k <= most + 1; ++k) {
    const double offset_s = kSpeedStep_s * static_cast<double>(k);
    const long shift = std::lround((begins_s + offset_s) / kSpeedStep_s);
    const double after = Correlation(a, b, shift, least_overlap_s / kSpeedStep_s);
    const bool is_peak = !std::isnan(at) && !(before > at) && !(after > at);
    // The shift is rounded to the grid: the offset it stands for is not that of `k` exactly.
    if (is_peak) {
      peaks.emplace_back(-at, kSpeedStep_s * static_cast<double>(shift - 1) - begins_s);
    }
    before = at;
    at = after;
  }
  std::sort(peaks.begin(), peaks.end());
  std::vector<double> offsets;
  for (const auto& peak : peaks) {
    const double offset_s = peak.second;
    const bool is_new = std::none_of(offsets.begin(), offsets.end(), [&](double other) {
      return std::abs(other - offset_s) < kApart_s;
    });
    if (is_new && offsets.size() < count) offsets.push_back(offset_s);
  }
  return offsets;
}

MisfitProfile MisfitOver(const Motion& target, const SmoothMotion& reference, double most_offset_s,
                         double least_overlap_s) {
  MisfitProfile profile;
  const auto steps = static_cast<int>(std::round(most_offset_s / kProfileStep_s));
  for (int k = -steps; k <= steps; ++k) {
    profile.offset_s.push_back(kProfileStep_s * k);
    profile.misfit.push_back(MisfitAt(target, reference, profile.offset_s.back(), least_overlap_s));
  }
  return profile;
}

std::vector<double> BestOffsets(const MisfitProfile& profile, std::size_t count) {
  const auto& m = profile.misfit;
  std::vector<std::pair<double, double>> minima;  // misfit, offset
  for (std::size_t i = 0; i < m.size(); ++i) {
    const bool falls = i == 0 || !(m[i - 1] < m[i]),
               rises = i + 1 == m.size() || !(m[i + 1] < m[i]);
    if (!std::isnan(m[i]) && falls && rises) minima.emplace_back(m[i], profile.offset_s[i]);
  }
  std::sort(minima.begin(), minima.end());
  std::vector<double> offsets;
  for (const auto& minimum : minima) {
    if (offsets.size() < count) offsets.push_back(minimum.second);
  }
  return offsets;
}

}  // namespace flextip
