#include "bench/discovery/judge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "bench/diagnosis_matrix/form.h"
#include "core/error.h"
#include "recording/recording_reader.h"

namespace flextip::bench {
namespace {

using diagnosis::DiagnosisResult;

/// As read from a folder without the label.
Recording Written(const hidden::HiddenRecording& hidden) {
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("flextip_discovery_{}", ::getpid());
  std::filesystem::remove_all(folder);
  hidden::WriteHidden(folder, hidden);
  Recording recording = ReadRecording(folder).recording;
  std::filesystem::remove_all(folder);
  return recording;
}

bool Has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Of the terms, the one that explains most, and what it could be as well.
void JudgeForm(const DiagnosisResult& result, const hidden::FormTruth& truth,
               DiscoveryRecord& record) {
  const auto right = [&](const diagnosis::TermName& name) {
    bool variable = name.depends_on.empty();
    for (const std::string& on : name.depends_on) variable |= Has(truth.variables, on);
    const bool channel = Has(truth.channels, name.channel);
    record.channel |= channel;
    record.form |= channel && Has(truth.forms, name.form);
    record.variable |= channel && variable && Has(truth.forms, name.form);
  };
  if (result.discovered.empty()) return;
  const auto first = std::min_element(
      result.discovered.begin(), result.discovered.end(), [](const auto& a, const auto& b) {
        return a.gain.heldout_error_ratio < b.gain.heldout_error_ratio;
      });
  right(first->name);
  for (const auto& other : first->could_be) right(other);
}

/// The extended models' held-out errors, channel by channel, as a root mean square of ratios.
double Over(const DiagnosisResult& result, const DiagnosisResult& reference) {
  double squares = 0.0, count = 0.0;
  for (const auto& [channel, rms] : result.extended.heldout_rms) {
    const auto own = reference.extended.heldout_rms.find(channel);
    if (own == reference.extended.heldout_rms.end() || !(own->second > 0.0)) continue;
    squares += std::pow(rms / own->second, 2);
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

/// What the whole catalogue answered itself, or could not tell from its answer.
bool IsAlias(const DiagnosisResult& full, const diagnosis::Verdict& verdict) {
  return std::all_of(verdict.begin(), verdict.end(), [&](const std::string& name) {
    return Has(full.verdict, name) ||
           std::any_of(full.indistinguishable.begin(), full.indistinguishable.end(),
                       [&](const auto& group) { return Has(group, name); });
  });
}

/// The same recording without its form: of all forms of a seed the same.
struct Healthy {
  int attempt = 0;
  DiagnosisResult result;
};

const Healthy& HealthyOf(const DiscoveryCase& one) {
  static std::map<std::pair<std::uint64_t, bool>, Healthy> all;
  const auto key = std::pair(one.seed, one.options.with_load);
  const auto at = all.find(key);
  if (at != all.end()) return at->second;
  hidden::HiddenOptions without = one.options;
  without.effects.clear();
  const hidden::HiddenRecording healthy = hidden::MakeHidden(without, one.seed);
  return all[key] = {healthy.attempt,
                     diagnosis::Diagnose(Written(healthy), "recording", {.discover = false})};
}

}  // namespace

bool DiscoveryRecord::IsApart() const { return separation >= kSeparable; }

DiscoveryRecord RunDiscovery(const DiscoveryCase& one) {
  DiscoveryRecord record;
  record.made = one;
  try {
    const hidden::HiddenRecording hidden = hidden::MakeHidden(one.options, one.seed);
    const Recording recording = Written(hidden);
    diagnosis::DiagnoseOptions options;
    if (one.part == "deleted") options.without = {one.name};
    const auto start = std::chrono::steady_clock::now();
    const DiagnosisResult result = diagnosis::Diagnose(recording, "recording", options);
    record.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    record.verdict = diagnosis::Joined(result.verdict);
    record.unknown = result.verdict == diagnosis::Verdict{"unknown"};
    record.terms = int(result.discovered.size());
    for (const auto& term : result.discovered)
      record.text += (record.text.empty() ? "" : "; ") + term.text;
    if (one.part == "forms") {
      record.separation = MeasureForm(recording, hidden.attempt, one.options, one.seed).value;
      for (const hidden::FormTruth& truth : hidden::FormTruths())
        if (truth.name == one.name) JudgeForm(result, truth, record);
      const Healthy& healthy = HealthyOf(one);
      if (healthy.attempt == hidden.attempt)
        record.heldout_over_true = Over(result, healthy.result);
    }
    if (one.part == "deleted" && !record.unknown && record.terms == 0)
      record.alias = IsAlias(
          diagnosis::Diagnose(recording, "recording", {.discover = false, .measure_gain = false}),
          result.verdict);
  } catch (const InputError& error) {
    record.error = error.what();
  } catch (const WorkError& error) {
    record.error = error.what();
  }
  return record;
}

}  // namespace flextip::bench
