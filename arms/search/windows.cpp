#include "arms/search/windows.h"

#include <algorithm>

#include "core/linear_algebra.h"

namespace flextip::arms {
namespace {

// Widths of a window that are tried, in rad or 10 cm.
constexpr double kWidths[] = {0.0,  0.002, 0.004, 0.008, 0.015, 0.025, 0.04,
                              0.06, 0.09,  0.13,  0.18,  0.25,  0.35,  0.5};
constexpr double kMostOfRange = 0.5;  // a wider window is a line, as a scale is

}  // namespace

void WindowSearch::Set(const PlayHistory& history) {
  if (IsThere()) layout_.Blocks()[layout_.WindowBlock()].effect->SetHistory(history);
}

PlayHistory WindowSearch::History() const {
  return IsThere() ? layout_.Blocks()[layout_.WindowBlock()].effect->History() : PlayHistory{};
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
  PlayHistory history = History();
  Eigen::VectorXd& windows = history.windows;
  if (windows.size() < n) windows = Eigen::VectorXd::Zero(n);
  for (int j = 0; j < n; ++j) {
    if (!Moves(j)) continue;
    std::vector<int> columns;
    for (const int own : block.effect->OfWindow(data, j)) columns.push_back(block.first + own);
    const double range = Range(j);
    const double unit = data.TypicalOf(j, 1.0, 0.1);
    double best = 0.0, best_width = windows[j];
    const auto tell = [&](double width) {
      if (width >= kMostOfRange * range && width > 0.0) return;
      windows[j] = width;
      Set(history);
      Eigen::VectorXd theta = replay_.Theta();
      const double gain = Explained(theta, columns, noise);
      if (gain <= best) return;
      best = gain;
      best_width = width;
    };
    const Eigen::VectorXd theta = replay_.Theta();
    for (const double width : kWidths) tell(width * unit);
    for (const double by : {0.8, 0.9, 1.12, 1.25})
      if (best_width > 0.0) tell(best_width * by);
    windows[j] = best_width;
    Set(history);
    replay_.Evaluate(theta);
  }
}

void WindowSearch::LetGo() {
  PlayHistory history = History();
  history.carried.resize(0, 0);
  history.by_parameters = false;
  Set(history);
}

bool WindowSearch::Carry() {
  if (!IsThere()) return false;
  const Layout::Block& block = layout_.Blocks()[layout_.WindowBlock()];
  Eigen::VectorXd theta = replay_.Theta(), own = theta.segment(block.first, block.size);
  PlayHistory history = block.effect->Carrying(layout_.DataOf(block), own);
  if (history.carried.isZero(0.0)) return false;
  history.by_parameters = true;
  Set(history);
  theta.segment(block.first, block.size) = own;
  replay_.Evaluate(theta);
  return true;
}

}  // namespace flextip::arms
