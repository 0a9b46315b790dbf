#include "diagnosis/running/watched_parameters.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace flextip::diagnosis::running {
namespace {

constexpr double kTypicalDrift_m_s = 0.0003, kLeastDrift_m_s = 0.00001;
constexpr std::array<double, kParameters> kNone{};

/// Whether the effect's parameters move the port: their prior is the port's registration.
bool MovesPort(const Effect& effect, const SampleSet& set) {
  EffectMemory memory{};
  SampleInputs inputs = SampleInputs::Zero();
  std::vector<InputChange::Column> columns;
  InputChange change(kNone.data(), 0, inputs, columns);
  effect.Apply(kNone.data(), {set, 0, 0.0, 0.0, 0.0}, memory, change);
  return !columns.empty() && columns.front().input == sample_input::kPort;
}

}  // namespace

WatchedParameters::WatchedParameters(const SampleSet& set, double port_prior_m) {
  int column = 0;
  for (const WatchedEffect& row : WatchedEffects()) {
    if (row.drift != nullptr) {
      AddDrift(row);
      continue;
    }
    WatchedBlock block;
    block.row = &row;
    block.effect = row.make();
    const std::vector<FitParameter> fitted = block.effect->Parameters(set);
    block.first = column;
    block.count = static_cast<int>(fitted.size());
    if (row.says != nullptr) block.widened = row.widened > 0 ? row.widened : block.count;
    FLEXTIP_CHECK(block.widened <= kMostWidened && column + block.count <= kParameters,
                  "room for every watched parameter");
    block.positive = fitted[0].positive;
    const bool port = MovesPort(*block.effect, set);
    for (int i = 0; i < block.count; ++i) {
      const FitParameter& parameter = fitted[static_cast<std::size_t>(i)];
      const double tolerance =
          port ? std::max(parameter.tolerance, port_prior_m) : parameter.tolerance;
      tolerance_[column + i] = tolerance;
      if (i < block.widened)
        block.typical[static_cast<std::size_t>(i)] = parameter.typical / tolerance;
    }
    column += block.count;
    blocks_.push_back(std::move(block));
  }
  FLEXTIP_CHECK(blocks_.size() <= kMostCauses, "room for every cause");
  columns_.reserve(4 * kParameters);
}

/// A drift has the columns of the offset.
void WatchedParameters::AddDrift(const WatchedEffect& row) {
  WatchedBlock block;
  block.row = &row;
  block.drifts = true;
  for (const WatchedBlock& other : blocks_)
    if (other.row->make == row.make) block.first = other.first + row.first;
  block.count = block.widened = row.count;
  const double tolerance = tolerance_[block.first];
  block.least = kLeastDrift_m_s / tolerance;
  for (int i = 0; i < block.count; ++i)
    block.typical[static_cast<std::size_t>(i)] = kTypicalDrift_m_s / tolerance;
  blocks_.push_back(std::move(block));
}

const std::vector<InputChange::Column>& WatchedParameters::ColumnsAt(const SampleSet& set,
                                                                     double s_port_m,
                                                                     double ds_port_dfriction_m,
                                                                     double port_friction) {
  const Instant now{set, 0, set.samples[0].t_s, s_port_m - ds_port_dfriction_m * port_friction,
                    ds_port_dfriction_m};
  columns_.clear();
  SampleInputs unused = SampleInputs::Zero();
  for (WatchedBlock& block : blocks_) {
    if (block.drifts) continue;
    InputChange change(kNone.data(), block.first, unused, columns_);
    block.effect->Apply(kNone.data(), now, block.memory, change);
  }
  return columns_;
}

}  // namespace flextip::diagnosis::running
