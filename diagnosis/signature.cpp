#include "diagnosis/signature.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "diagnosis/evidence/generic_basis.h"

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kFewest = 30;

/// One row's residuals in standard deviations, where measured.
struct RowSeries {
  std::vector<double> value;
  std::vector<std::size_t> sample;
};

RowSeries SeriesOf(const Replay& replay, const std::vector<Rows>& free, int r) {
  RowSeries series;
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (!replay.Samples()[k].ok || !replay.Set().samples[k].present[r]) continue;
    series.value.push_back(free[k][r] / replay.RowNoise(k)[r]);
    series.sample.push_back(k);
  }
  return series;
}

double Autocorrelation(const std::vector<double>& v) {
  double mean = 0.0, num = 0.0, den = 0.0;
  for (const double x : v) mean += x / double(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    den += std::pow(v[i] - mean, 2);
    if (i > 0) num += (v[i] - mean) * (v[i - 1] - mean);
  }
  return den > 0.0 ? num / den : 0.0;
}

/// Share of the variance that a parabola in x explains.
double Explained(const RowSeries& series, const Eigen::VectorXd& regressor) {
  const auto n = Eigen::Index(series.value.size());
  Eigen::MatrixXd A(n, 3);
  Eigen::VectorXd y(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    A(i, 1) = regressor[Eigen::Index(series.sample[i])];
    y[i] = series.value[i];
  }
  const double sd = std::sqrt((A.col(1).array() - A.col(1).mean()).square().mean());
  if (sd <= 0.0) return 0.0;
  A.col(1) = (A.col(1).array() - A.col(1).mean()) / sd;
  A.col(0).setOnes();
  A.col(2) = A.col(1).array().square();
  y.array() -= y.mean();
  const double total = y.squaredNorm();
  if (total <= 0.0) return 0.0;
  const Eigen::VectorXd left = y - A * LeastSquares(A, y);
  return std::clamp(1.0 - left.squaredNorm() / total, 0.0, 1.0);
}

}  // namespace

std::vector<Signature> FindSignatures(const Replay& base) {
  const auto free = base.ForceFreeResiduals();
  const auto regressors = Regressors(base);
  std::vector<Signature> signatures;
  for (const Channel& channel : kChannels) {
    std::vector<double> best(regressors.size() + 1, 0.0);
    for (int r = channel.first_row; r < channel.first_row + channel.rows; ++r) {
      const RowSeries series = SeriesOf(base, free, r);
      if (series.value.size() < kFewest) continue;
      const double n = double(series.value.size()), rho = Autocorrelation(series.value);
      // A slow residual has fewer independent values than samples.
      const double independent =
          std::max(8.0, n * (1.0 - std::max(0.0, rho)) / (1.0 + std::max(0.0, rho)));
      for (std::size_t i = 0; i < regressors.size(); ++i) {
        const double share = Explained(series, regressors[i].value);
        best[i] =
            std::max(best[i], std::sqrt(independent * share / (1.0 - std::min(share, 0.999))));
      }
      best.back() = std::max(best.back(), std::abs(rho) * std::sqrt(n));
    }
    for (std::size_t i = 0; i < best.size(); ++i) {
      const std::string against = i < regressors.size() ? regressors[i].name : "previous_sample";
      if (best[i] > 0.0) signatures.push_back({channel.name, against, best[i]});
    }
  }
  std::stable_sort(signatures.begin(), signatures.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  return signatures;
}

ResidualTable MakeResidualTable(const Replay& base, const Replay& extended) {
  ResidualTable table;
  table.columns.emplace_back("t_s");
  const auto regressors = Regressors(base);
  for (const Regressor& r : regressors)
    if (r.name != "time") table.columns.push_back(r.name);
  const std::vector<Rows> free[2] = {base.ForceFreeResiduals(), extended.ForceFreeResiduals()};
  const Replay* replays[2] = {&base, &extended};
  std::bitset<row::kCount> seen;
  for (const auto& sample : base.Set().samples) seen |= sample.present;
  for (const char* model : {"base", "extended"})
    for (const Channel& channel : kChannels)
      for (int i = 0; i < channel.rows; ++i)
        if (seen[channel.first_row + i])
          table.columns.push_back(fmt::format("{}.{}.{}", model, channel.name, i));
  for (std::size_t k = 0; k < base.Samples().size(); ++k) {
    std::vector<double> values{base.Set().samples[k].t_s};
    for (const Regressor& r : regressors)
      if (r.name != "time") values.push_back(r.value[Eigen::Index(k)]);
    std::vector<bool> present(values.size(), true);
    for (int m = 0; m < 2; ++m) {
      const Rows sd = replays[m]->RowNoise(k);
      for (int r = 0; r < row::kCount; ++r) {
        if (!seen[r]) continue;
        const bool there = replays[m]->Samples()[k].ok && base.Set().samples[k].present[r];
        values.push_back(there ? free[m][k][r] / sd[r] : 0.0);
        present.push_back(there);
      }
    }
    table.rows.push_back(values);
    table.present.push_back(present);
  }
  return table;
}

}  // namespace flextip::diagnosis
