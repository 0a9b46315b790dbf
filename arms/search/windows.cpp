#include "arms/search/windows.h"

#include <algorithm>

#include "core/linear_algebra.h"

namespace flextip::arms {
namespace {

constexpr double kWorthCarrying = 20.0;  // squared residual
// Widths of a window that are tried, in rad or 10 cm.
constexpr double kWidths[] = {0.0,  0.002, 0.004, 0.008, 0.015, 0.025, 0.04,
                              0.06, 0.09,  0.13,  0.18,  0.25,  0.35,  0.5};

}  // namespace

void WindowSearch::Set(const Eigen::VectorXd& windows) {
  if (IsThere()) layout_.Blocks()[layout_.WindowBlock()].effect->SetWindows(windows);
}

Eigen::VectorXd WindowSearch::Windows() const {
  return IsThere() ? layout_.Blocks()[layout_.WindowBlock()].effect->Windows() : Eigen::VectorXd();
}

bool WindowSearch::Moves(int joint) const { return Range(joint) > 1e-4; }

double WindowSearch::Range(int joint) const {
  double range = 0.0;
  for (const ArmData& data : layout_.Recordings()) {
    const auto q = data.joints.values.col(joint);
    range = std::max(range, q.maxCoeff() - q.minCoeff());
  }
  return range;
}

/// How much of the squared residual `columns` take with them, of what stays without them.
double WindowSearch::Explained(const Eigen::VectorXd& at, const std::vector<int>& columns,
                               const Noise& noise) {
  Eigen::VectorXd theta = at;
  for (const int c : columns) theta[c] = 0.0;
  replay_.Evaluate(theta);
  const auto size = Eigen::Index(columns.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const Channel& channel = replay_.Channels()[i];
    const Eigen::Index C = channel.Components();
    if (channel.kind != Kind::kSeen && channel.kind != Kind::kPose) continue;
    for (Eigen::Index k = 0; k < channel.Rows(); ++k)
      for (Eigen::Index c = 0; c < C; ++c) {
        if (!noise[i].keep(k, c)) continue;
        const double by = 1.0 / noise[i].sd[c];
        Eigen::VectorXd row(size);
        for (Eigen::Index a = 0; a < size; ++a)
          row[a] = by * channel.derivative(k * C + c, columns[a]);
        H.noalias() += row * row.transpose();
        g.noalias() += by * channel.residual(k, c) * row;
      }
  }
  for (Eigen::Index a = 0; a < size; ++a) {
    const auto& p = layout_.Prior().Parameter(columns[a]);
    H(a, a) += 1.0 / (9.0 * p.typical * p.typical);
  }
  return g.dot(Llt(H).Solve(g));
}

void WindowSearch::Scan(const Noise& noise) {
  if (!IsThere()) return;
  const Layout::Block& block = layout_.Blocks()[layout_.WindowBlock()];
  const ArmData& data = layout_.DataOf(block);
  const int n = data.Size();
  Eigen::VectorXd windows = Windows();
  if (windows.size() < n) windows = Eigen::VectorXd::Zero(n);
  for (int j = 0; j < n; ++j) {
    if (!Moves(j)) continue;
    std::vector<int> columns;
    for (const int own : block.effect->OfWindow(data, j)) columns.push_back(block.first + own);
    const double range = Range(j);
    const double unit = data.TypicalOf(j, 1.0, 0.1);
    double best = 0.0, best_width = windows[j];
    const auto tell = [&](double width) {
      windows[j] = width;
      Set(windows);
      Eigen::VectorXd theta = replay_.Theta();
      const double gain = Explained(theta, columns, noise);
      if (gain <= best) return;
      best = gain;
      best_width = width;
    };
    const Eigen::VectorXd theta = replay_.Theta();
    for (const double width : kWidths)
      if (width * unit < 0.7 * range || width == 0.0) tell(width * unit);
    for (const double by : {0.8, 0.9, 1.12, 1.25})
      if (best_width > 0.0) tell(best_width * by);
    windows[j] = best_width;
    Set(windows);
    replay_.Evaluate(theta);
  }
}

void WindowSearch::TryCarrying(const Noise& noise) {
  if (!IsThere()) return;
  const Layout::Block& block = layout_.Blocks()[layout_.WindowBlock()];
  const ArmData& data = layout_.DataOf(block);
  const Eigen::VectorXd theta = replay_.Theta(), before = Windows();
  std::vector<int> columns;
  for (int j = 0; j < data.Size(); ++j)
    for (const int own : block.effect->OfWindow(data, j))
      if (Moves(j)) columns.push_back(block.first + own);
  if (columns.empty()) return;
  const double plain = Explained(theta, columns, noise);
  Set(block.effect->Carrying(data, theta.segment(block.first, block.size)));
  const double carried = Explained(theta, columns, noise);
  if (carried < plain + kWorthCarrying) Set(before);
  replay_.Evaluate(theta);
}

}  // namespace flextip::arms
