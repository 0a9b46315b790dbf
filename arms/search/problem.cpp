#include "arms/search/problem.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace flextip::arms {
namespace {

constexpr int kKinds = 4;

std::vector<int> ComponentsByKind(const Replay& replay) {
  std::vector<int> components(kKinds, 0);
  for (const Channel& channel : replay.Channels())
    components[int(channel.kind)] =
        std::max(components[int(channel.kind)], int(channel.Components()));
  return components;
}

}  // namespace

Basis::Basis(const Replay& replay) {
  const auto& recordings = replay.GetLayout().Recordings();
  const int n = recordings.front().Size();
  functions_ = 3 * n + 2;
  for (const Channel& channel : replay.Channels()) {
    const ArmData& data = recordings[channel.recording];
    const bool followed = channel.kind == Kind::kFollowed;
    const Eigen::MatrixXd& q = followed ? data.command.values : data.joints.values;
    Eigen::MatrixXd values(channel.Rows(), functions_);
    const double end = std::max(1e-9, channel.t_s[channel.Rows() - 1] - channel.t_s[0]);
    for (Eigen::Index k = 0; k < channel.Rows(); ++k) {
      const Where& where = channel.where[k];
      // Where commands and efforts are off by a constant, the servo itself is.
      values(k, 3 * n + 1) = channel.kind == Kind::kSeen || channel.kind == Kind::kPose ? 1.0 : 0.0;
      values(k, 0) = std::sqrt(12.0) * ((channel.t_s[k] - channel.t_s[0]) / end - 0.5);
      for (int i = 0; i < n; ++i) {
        values(k, 1 + i) = At(q, where)[i];
        const Eigen::Index before = std::max<Eigen::Index>(0, where.row - 1);
        const double step = q(where.row, i) - q(before, i);
        values(k, 1 + 2 * n + i) = step > 0.0 ? 1.0 : step < 0.0 ? -1.0 : 0.0;
      }
    }
    for (int i = 0; i < n; ++i) {
      auto joint = values.col(1 + i);
      joint.array() -= joint.mean();
      const double size =
          std::sqrt(joint.squaredNorm() / double(std::max<Eigen::Index>(1, channel.Rows())));
      if (size > 1e-6)
        joint /= size;
      else
        joint.setZero();
      values.col(1 + n + i) =
          (joint.array().square() - joint.squaredNorm() / double(channel.Rows())) / 1.5;
    }
    values_.push_back(std::move(values));
  }
}

int FirstGeneric(const Replay& replay, const Basis& basis, Kind kind, int component) {
  const auto components = ComponentsByKind(replay);
  int first = 0;
  for (int k = 0; k < int(kind); ++k) first += components[k];
  return (first + component) * basis.Functions();
}

int GenericCount(const Replay& replay, const Basis& basis) {
  int count = 0;
  for (const int components : ComponentsByKind(replay)) count += components;
  return count * basis.Functions();
}

std::vector<Eigen::VectorXd> SizesOf(const Replay& replay, const Noise& noise) {
  std::vector<Eigen::VectorXd> sizes;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    Eigen::VectorXd size = Eigen::VectorXd::Zero(channel.Components());
    for (Eigen::Index c = 0; c < channel.Components(); ++c) {
      double squares = 0.0, count = 1e-9;
      for (Eigen::Index k = 0; k < channel.Rows(); ++k) {
        if (!noise[i].keep(k, c)) continue;
        squares += channel.residual(k, c) * channel.residual(k, c);
        count += 1.0;
      }
      size[c] = std::sqrt(squares / count);
    }
    sizes.push_back(size);
  }
  return sizes;
}

Problem MakeProblem(const Replay& replay, const Noise& noise, const Basis& basis,
                    const std::vector<Eigen::VectorXd>& sizes, int parts) {
  const auto& recordings = replay.GetLayout().Recordings();
  Problem problem;
  problem.parameters = replay.GetLayout().Size();
  problem.generics = GenericCount(replay, basis);
  const Eigen::Index P = problem.parameters, size = P + problem.generics;
  for (int r = 0; r < int(recordings.size()); ++r)
    for (int part = 0; part < parts; ++part)
      problem.blocks.push_back({r, part, diagnosis::NormalSums(size)});
  const int J = basis.Functions();
  tbb::parallel_for(std::size_t{0}, problem.blocks.size(), [&](std::size_t b) {
    ProblemBlock& block = problem.blocks[b];
    for (std::size_t i = 0; i < noise.size(); ++i) {
      const Channel& channel = replay.Channels()[i];
      if (channel.recording != block.recording) continue;
      const Eigen::Index rows = channel.Rows(), C = channel.Components();
      for (Eigen::Index c = 0; c < C; ++c) {
        // The smooth terms of other components are zero: their columns are left out.
        const int first = int(P) + FirstGeneric(replay, basis, channel.kind, int(c));
        std::vector<Eigen::Index> kept;
        for (Eigen::Index k = 0; k < rows; ++k)
          if (noise[i].keep(k, c) && PartOf(k, rows, parts) == block.place) kept.push_back(k);
        const auto m = Eigen::Index(kept.size());
        if (m == 0) continue;
        Eigen::MatrixXd X(m, P + J);
        Eigen::VectorXd z(m);
        const double by = 1.0 / noise[i].sd[c];
        for (Eigen::Index a = 0; a < m; ++a) {
          const Eigen::Index k = kept[a];
          X.row(a).head(P) = by * channel.derivative.row(k * C + c);
          z[a] = by * channel.residual(k, c) + X.row(a).head(P).dot(replay.Theta());
          X.row(a).tail(J) = by * sizes[i][c] * basis.Of(i).row(k);
        }
        const Eigen::MatrixXd H = X.transpose() * X;
        const Eigen::VectorXd g = X.transpose() * z;
        block.sums.H.topLeftCorner(P, P) += H.topLeftCorner(P, P);
        block.sums.H.block(0, first, P, J) += H.topRightCorner(P, J);
        block.sums.H.block(first, 0, J, P) += H.bottomLeftCorner(J, P);
        block.sums.H.block(first, first, J, J) += H.bottomRightCorner(J, J);
        block.sums.g.head(P) += g.head(P);
        block.sums.g.segment(first, J) += g.tail(J);
        block.sums.c += z.squaredNorm();
        block.sums.rows += long(m);
      }
    }
  });
  problem.total = diagnosis::NormalSums(size);
  for (const ProblemBlock& block : problem.blocks) problem.total.Add(block.sums);
  return problem;
}

}  // namespace flextip::arms
