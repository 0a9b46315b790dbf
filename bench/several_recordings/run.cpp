#include "bench/several_recordings/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <random>

#include "bench/diagnosis_matrix/separable.h"
#include "core/error.h"
#include "diagnosis/prediction/predict.h"
#include "diagnosis/several/diagnose_several.h"
#include "testdata/hidden/recording.h"

namespace flextip::bench {
namespace {

using Names = std::vector<std::string>;

const Names& SharedEffects() {
  static const Names names = [] {
    Names all = simulation::CatalogueEffects();
    for (const char* own : {"port_motion", "strain_drift", "camera_drift", "em_interference"})
      std::erase(all, own);
    return all;
  }();
  return names;
}

std::vector<diagnosis::NamedRecording> Named(const std::vector<hidden::HiddenRecording>& all) {
  std::vector<diagnosis::NamedRecording> named;
  for (std::size_t r = 0; r < all.size(); ++r)
    named.push_back({fmt::format("rec_{}", r), all[r].recording});
  return named;
}

hidden::HiddenSeries Draw(const SeveralCase& one, SeveralRecord& record) {
  std::seed_seq sequence{one.first_seed, std::uint64_t(one.index), std::uint64_t(one.part.size()),
                         std::uint64_t(one.part[0])};
  std::mt19937_64 rng(sequence);
  record.seed = rng() >> 33;
  hidden::HiddenSeries series;
  series.recordings = one.part == "pairs" ? 3 : one.part == "predict" ? 2 : 4;
  series.options.scene.duration_s = one.duration_s;
  series.options.scene.family = hidden::MotionFamily::kAny;
  record.load = one.part == "pairs" ? rng() % 4 == 0 : rng() % 2 == 0;
  series.options.with_load = record.load;
  if (one.part == "healthy") return series;
  const bool subtle = one.part == "pairs" && rng() % 2 == 0;
  record.size = subtle ? "subtle" : "plain";
  series.options.size = subtle ? hidden::EffectSize::kSubtle : hidden::EffectSize::kPlain;
  const Names& from = one.part == "pairs" ? SharedEffects() : simulation::CatalogueEffects();
  do {
    record.effect = from[rng() % from.size()];
  } while (!record.load && hidden::SensorOf(record.effect) == "load0");
  if (one.part == "changes") {
    record.begin = 1 + int(rng() % 3);
    series.begin = record.begin;
    series.later = {record.effect};
  } else {
    series.options.effects = {record.effect};
  }
  return series;
}

/// Separation in the first `count` recordings together; nothing where they show different effects.
std::optional<Separation> Together(const std::vector<hidden::HiddenRecording>& all) {
  std::optional<Eigen::MatrixXd> sum;
  std::vector<std::unique_ptr<TrueModel>> truths;
  for (const hidden::HiddenRecording& one : all) {
    truths.push_back(std::make_unique<TrueModel>(one.recording, one));
    TrueModel& truth = *truths.back();
    if (!truth.not_shown.empty() || truth.layout.Size() != truths[0]->layout.Size()) return {};
    const auto information = InformationAtTruth(truth);
    if (!information) return {};
    sum = sum ? Eigen::MatrixXd(*sum + *information) : *information;
  }
  return NearestRival(*sum, truths[0]->parameters.theta, truths[0]->layout, truths[0]->present);
}

bool Qualifies(const std::vector<hidden::HiddenRecording>& all, SeveralRecord& record) {
  if (record.part == "healthy") return true;
  const hidden::HiddenRecording& one = all[std::size_t(record.begin)];
  TrueModel truth(one.recording, one);
  const Separation alone = MeasureSeparation(truth);
  record.separation_of_one = alone.value;
  record.rival = alone.rival;
  if (record.part != "pairs") return !alone.rival.empty() && alone.value >= kSeparable;
  if (alone.rival.empty() || alone.value >= kSeparable) return false;
  const auto together = Together(all);
  record.separation_of_all = together ? together->value : 0.0;
  return record.separation_of_all >= kSeparable;
}

void Diagnose(const std::vector<hidden::HiddenRecording>& all, SeveralRecord& record) {
  const auto named = Named(all);
  const auto start = std::chrono::steady_clock::now();
  const auto several = diagnosis::DiagnoseSeveral(named, {.measure_gain = false});
  record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  record.verdict = several.common.verdict;
  for (const diagnosis::FoundChange& change : several.changes)
    record.changes.push_back(fmt::format("{}@{}", change.effect, change.first_in));
  if (record.part != "pairs") return;
  record.alone = diagnosis::Diagnose(named[0].recording, "alone", {.measure_gain = false}).verdict;
}

void Predict(const std::vector<hidden::HiddenRecording>& all, SeveralRecord& record) {
  const auto model = [&](std::size_t r) {
    const auto result = diagnosis::Diagnose(all[r].recording, "fitted", {.measure_gain = false});
    if (r == 0) record.verdict = result.verdict;
    return diagnosis::FromResult(result);
  };
  const auto ratio = [&](std::size_t r) {
    return diagnosis::Predict(all[1].recording, "predicted", model(r)).gain.heldout_error_ratio;
  };
  record.ratio = ratio(0);
  record.ratio_of_own_fit = ratio(1);
}

}  // namespace

std::string SeveralCase::Key() const {
  return fmt::format("{}/{}s/seed_{}/{:04}", part, duration_s, first_seed, index);
}

bool SeveralRecord::IsRight() const {
  if (part == "healthy") return verdict == Names{"none"} && changes.empty();
  if (begin == 0) return verdict == Names{effect} && changes.empty();
  return verdict == Names{"none"} && changes == Names{fmt::format("{}@{}", effect, begin)};
}

int SeveralRecord::FalseChanges() const {
  const std::string right = fmt::format("{}@{}", effect, begin);
  return int(std::ranges::count_if(
      changes, [&](const std::string& change) { return begin == 0 || change != right; }));
}

SeveralRecord RunSeveralCase(const SeveralCase& one) {
  SeveralRecord record;
  record.key = one.Key();
  record.part = one.part;
  try {
    const hidden::HiddenSeries series = Draw(one, record);
    const auto all = hidden::MakeHiddenSeries(series, record.seed);
    record.qualifies = Qualifies(all, record);
    if (!record.qualifies) return record;
    record.part == "predict" ? Predict(all, record) : Diagnose(all, record);
  } catch (const InputError& error) {
    record.error = error.what();
  } catch (const WorkError& error) {
    record.error = error.what();
  }
  return record;
}

}  // namespace flextip::bench
