#include "bench/arm_regressions/regress.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "arms/effects/play.h"

namespace flextip::bench {
namespace {

using arms::ArmData;

constexpr int kWidths = 40;
constexpr double kStandsStill = 1e-3;  // of the largest column
constexpr double kLongest_s = 0.1, kDelay_s = 5e-4;

/// Columns of a joint's regression on all rows of joints.
using Columns = std::function<Eigen::MatrixXd(const Eigen::MatrixXd& x, int joint)>;

Eigen::MatrixXd AtSeen(const ArmData& data, const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd seen(data.seen.track.Rows(), rows.cols());
  for (Eigen::Index k = 0; k < seen.rows(); ++k)
    seen.row(k) = arms::At(rows, data.seen.where[std::size_t(k)]);
  return seen;
}

Eigen::VectorXd Behind(const ArmData& data, int joint) {
  return data.seen.track.values.col(joint) - AtSeen(data, data.joints.values).col(joint);
}

struct Fit {
  Eigen::VectorXd weights;
  double squares = 0.0;
};

Fit FitJoint(const std::vector<ArmData>& fitted, int joint, const Columns& columns) {
  Eigen::Index rows = 0;
  for (const ArmData& data : fitted) rows += data.seen.track.Rows();
  Eigen::MatrixXd A;
  Eigen::VectorXd b(rows);
  Eigen::Index at = 0;
  for (const ArmData& data : fitted) {
    const Eigen::MatrixXd own = AtSeen(data, columns(data.joints.values, joint));
    if (at == 0) A.resize(rows, own.cols());
    A.middleRows(at, own.rows()) = own;
    b.segment(at, own.rows()) = Behind(data, joint);
    at += own.rows();
  }
  // Joints that stand still in all of them get no weight of their own.
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(kStandsStill);
  decomposition.compute(A);
  Fit fit{decomposition.solve(b), 0.0};
  fit.squares = (b - A * fit.weights).squaredNorm();
  return fit;
}

Eigen::MatrixXd WithOffset(const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd all(columns.rows(), columns.cols() + 1);
  all << Eigen::VectorXd::Ones(columns.rows()), columns;
  return all;
}

Columns Play(double width) {
  return [width](const Eigen::MatrixXd& x, int joint) {
    return WithOffset(arms::PlayState(x.col(joint), width));
  };
}

/// The width of a joint's play that leaves least.
Columns BestPlay(const std::vector<ArmData>& fitted, int joint) {
  double range = 0.0;
  for (const ArmData& data : fitted) {
    const auto q = data.joints.values.col(joint);
    range = std::max(range, q.maxCoeff() - q.minCoeff());
  }
  double best = 0.0, least = FitJoint(fitted, joint, Play(0.0)).squares;
  for (int i = 1; i <= kWidths && range > 0.0; ++i) {
    const double width = 0.7 * range * std::pow(double(i) / kWidths, 2);
    const double squares = FitJoint(fitted, joint, Play(width)).squares;
    if (squares >= least) continue;
    least = squares;
    best = width;
  }
  return Play(best);
}

Left LeftOf(const std::string& name, const ArmData& data, const Eigen::MatrixXd& predicted,
            const Eigen::MatrixXd& measured) {
  const Eigen::MatrixXd off = measured - predicted;
  Left left{name, 0.0, (off.colwise().squaredNorm() / double(off.rows())).cwiseSqrt().transpose()};
  const Eigen::Vector3d marker = data.arm.T_LK.value_or(Pose{}).p;
  for (Eigen::Index k = 0; k < off.rows(); ++k)
    left.tip_m += (data.nominal.Last(measured.row(k).transpose()) * marker -
                   data.nominal.Last(predicted.row(k).transpose()) * marker)
                      .squaredNorm();
  left.tip_m = std::sqrt(left.tip_m / double(off.rows()));
  return left;
}

/// Commands as they were `delay_s` before the encoders' rows.
Eigen::MatrixXd Delayed(const ArmData& data, double delay_s) {
  const Eigen::VectorXd& t = data.command.t_s;
  Eigen::MatrixXd rows(data.followed.track.Rows(), data.Size());
  Eigen::Index row = 0;
  for (Eigen::Index k = 0; k < rows.rows(); ++k) {
    const double at = std::max(t[0], data.followed.track.t_s[k] - delay_s);
    while (row + 2 < t.size() && t[row + 1] <= at) ++row;
    const double fraction = std::clamp((at - t[row]) / (t[row + 1] - t[row]), 0.0, 1.0);
    rows.row(k) = arms::At(data.command.values, {row, fraction});
  }
  return rows;
}

}  // namespace

std::vector<Left> RegressSeen(const std::vector<ArmData>& fitted, const ArmData& other) {
  const Columns offset = [](const Eigen::MatrixXd& x, int) {
    return Eigen::MatrixXd(Eigen::VectorXd::Ones(x.rows()));
  };
  const Columns scale = [](const Eigen::MatrixXd& x, int joint) {
    return WithOffset(x.col(joint));
  };
  const Columns matrix = [](const Eigen::MatrixXd& x, int) { return WithOffset(x); };
  const Eigen::MatrixXd told = AtSeen(other, other.joints.values), seen = other.seen.track.values;
  std::vector<Left> all{LeftOf("nothing", other, told, seen)};
  const auto regress = [&](const std::string& name, const auto& of_joint) {
    Eigen::MatrixXd predicted = told;
    for (int i = 0; i < other.Size(); ++i) {
      const Columns columns = of_joint(i);
      predicted.col(i) +=
          AtSeen(other, columns(other.joints.values, i)) * FitJoint(fitted, i, columns).weights;
    }
    all.push_back(LeftOf(name, other, predicted, seen));
  };
  regress("offset", [&](int) { return offset; });
  regress("offset, scale", [&](int) { return scale; });
  regress("offset, matrix", [&](int) { return matrix; });
  regress("offset, sign", [&](int) { return Play(0.0); });
  regress("offset, play", [&](int i) { return BestPlay(fitted, i); });
  return all;
}

std::vector<Left> RegressFollowed(const std::vector<ArmData>& fitted, const ArmData& other) {
  double best = 0.0, least = std::numeric_limits<double>::infinity();
  for (double delay_s = 0.0; delay_s <= kLongest_s; delay_s += kDelay_s) {
    double squares = 0.0;
    for (const ArmData& data : fitted)
      squares += (data.followed.track.values - Delayed(data, delay_s)).squaredNorm();
    if (squares >= least) continue;
    least = squares;
    best = delay_s;
  }
  const Eigen::MatrixXd& measured = other.followed.track.values;
  return {LeftOf("nothing", other, Delayed(other, 0.0), measured),
          LeftOf("one delay", other, Delayed(other, best), measured)};
}

}  // namespace flextip::bench
