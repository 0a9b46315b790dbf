#include "bench/diagnosis_matrix/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "recording/text/text.h"

namespace flextip::bench {

// Every member under its own name.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MatrixCase, part, effects, drawn, size, load, left_out, without,
                                   family, duration_s, index, seed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JudgedParameter, effect, parameter, entry, truth, value, sd,
                                   bound)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MatrixRecord, made, key, motion, load, attempt, label, form,
                                   separation, rival, error, verdict, probabilities, p_verdict,
                                   p_truth, truth_in_credible_set, credible_set_size,
                                   indistinguishable, terms, full_verdict, full_indistinguishable,
                                   parameters, gain_measured, heldout_error_ratio, tip_error_ratio,
                                   extended_weighted_rms, heldout_over_true, base_chi2_per_dof,
                                   extended_chi2_per_dof, fits, converged, seconds, warnings)

namespace {

using Json = nlohmann::json;

bool Holds(const EffectNames& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

bool MatrixRecord::IsRightOrDeclared() const {
  if (IsRight()) return true;
  if (verdict.size() != label.size()) return false;
  return std::all_of(label.begin(), label.end(), [&](const std::string& truth) {
    return Holds(verdict, truth) ||
           std::any_of(indistinguishable.begin(), indistinguishable.end(),
                       [&](const EffectNames& group) { return Holds(group, truth); });
  });
}

std::string JoinedNames(const EffectNames& names) {
  return fmt::format("{}", fmt::join(names, "+"));
}

std::string JsonLine(const MatrixRecord& record) {
  return Json(record).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::vector<MatrixRecord> ReadRecords(const std::filesystem::path& file) {
  std::vector<MatrixRecord> records;
  if (!std::filesystem::exists(file)) return records;
  const std::string text = ReadTextFile(file);
  std::istringstream lines(text.substr(0, text.rfind('\n') + 1));
  std::string line;
  for (long number = 1; std::getline(lines, line); ++number) {
    try {
      records.push_back(Json::parse(line).get<MatrixRecord>());
    } catch (const Json::exception&) {
      throw InputError::At(file.string(), number, "not a case of the matrix");
    }
  }
  return records;
}

}  // namespace flextip::bench
