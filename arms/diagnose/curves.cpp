#include "arms/diagnose/curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "arms/search/problem.h"

namespace flextip::arms {
namespace {

constexpr Eigen::Index kMostPoints = 600;  // of a curve
constexpr Eigen::Index kMostRows = 3000;   // of the table of residuals

}  // namespace

Residuals ResidualsOf(const Replay& replay) {
  Residuals all;
  for (const Channel& channel : replay.Channels()) all.push_back(channel.residual);
  return all;
}

void FillCurves(const Replay& replay, const Residuals& base, const Residuals& extended,
                std::vector<ComponentCurve>& curves) {
  const auto& recordings = replay.GetLayout().Recordings();
  for (std::size_t i = 0; i < replay.Channels().size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    const ArmData& data = recordings[channel.recording];
    if (channel.kind == Kind::kPose) continue;
    const bool torque = channel.kind == Kind::kTorque;
    const Measured& measured = torque                        ? data.torque
                               : channel.kind == Kind::kSeen ? data.seen
                                                             : data.followed;
    const Eigen::MatrixXd& input =
        channel.kind == Kind::kFollowed ? data.command.values : data.joints.values;
    const Eigen::Index every = 1 + channel.Rows() / kMostPoints;
    for (Eigen::Index c = 0; c < channel.Components(); ++c) {
      ComponentCurve curve;
      curve.channel = Name(channel.kind);
      curve.component = channel.components[c];
      curve.recording = channel.recording;
      for (Eigen::Index k = 0; k < channel.Rows(); k += every) {
        const double z = measured.track.values(k, c);
        curve.t_s.push_back(channel.t_s[k]);
        curve.input.push_back(At(input, channel.where[k])[c]);
        curve.measured.push_back(z);
        curve.base.push_back(z - base[i](k, c));
        curve.extended.push_back(z - extended[i](k, c));
      }
      curves.push_back(std::move(curve));
    }
  }
}

diagnosis::ResidualTable ResidualTableOf(const Replay& replay, const Residuals& base,
                                         const Residuals& extended, const Noise& noise) {
  diagnosis::ResidualTable table;
  table.columns = {"t_s"};
  std::vector<std::size_t> first(replay.Channels().size(), 0);
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    if (channel.recording != 0) continue;
    first[i] = table.columns.size();
    for (const char* model : {"base", "extended"})
      for (Eigen::Index c = 0; c < channel.Components(); ++c)
        table.columns.push_back(fmt::format("{}.{}.{}", model, Name(channel.kind), c + 1));
  }
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    if (channel.recording != 0) continue;
    const Eigen::Index C = channel.Components(), every = 1 + channel.Rows() / kMostRows;
    for (Eigen::Index k = 0; k < channel.Rows(); k += every) {
      std::vector<double> row(table.columns.size(), 0.0);
      std::vector<bool> present(table.columns.size(), false);
      row[0] = channel.t_s[k];
      present[0] = true;
      for (Eigen::Index c = 0; c < C; ++c) {
        if (!noise[i].keep(k, c)) continue;
        const std::size_t at = first[i] + std::size_t(c);
        row[at] = base[i](k, c) / noise[i].floor[c];
        row[at + std::size_t(C)] = extended[i](k, c) / noise[i].floor[c];
        present[at] = present[at + std::size_t(C)] = true;
      }
      table.rows.push_back(std::move(row));
      table.present.push_back(std::move(present));
    }
  }
  return table;
}

void FillSignatures(const Replay& base, const Noise& noise, diagnosis::DiagnosisResult& answer) {
  const Basis basis(base);
  const ArmData& data = base.GetLayout().Recordings().front();
  std::vector<std::string> names{"time"};
  for (int i = 0; i < data.Size(); ++i) names.push_back(fmt::format("q{}", i + 1));
  for (int i = 0; i < data.Size(); ++i) names.push_back(fmt::format("q{}_squared", i + 1));
  for (int i = 0; i < data.Size(); ++i) names.push_back(fmt::format("q{}_direction", i + 1));
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const Channel& channel = base.Channels()[i];
    for (Eigen::Index c = 0; c < channel.Components(); ++c)
      for (std::size_t f = 0; f < names.size(); ++f) {
        double xy = 0.0, xx = 0.0, yy = 0.0, count = 0.0;
        for (Eigen::Index k = 0; k < channel.Rows(); ++k) {
          if (!noise[i].keep(k, c)) continue;
          const double x = basis.Of(i)(k, Eigen::Index(f)), y = channel.residual(k, c);
          xy += x * y;
          xx += x * x;
          yy += y * y;
          count += 1.0;
        }
        if (xx * yy <= 0.0) continue;
        const double score = std::abs(xy) / std::sqrt(xx * yy) * std::sqrt(count);
        if (score > 3.0)
          answer.signatures.push_back(
              {std::string(Name(channel.kind)) + "_" + channel.components[c], names[f], score});
      }
  }
  std::stable_sort(answer.signatures.begin(), answer.signatures.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  if (answer.signatures.size() > 40) answer.signatures.resize(40);
}

}  // namespace flextip::arms
