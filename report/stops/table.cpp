#include "report/stops/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

constexpr double kMmPerM = 1000.0;
constexpr double kMostBits = 65535.0;
constexpr std::array kReactions{"none", "limit", "hold", "fault"};

class TableReader {
 public:
  explicit TableReader(const std::filesystem::path& file)
      : file_(file), table_(ReadResultTable(file)) {}

  const std::vector<double>& Numbers(const std::string& name) const {
    const auto* column = table_.Column(name);
    if (column == nullptr) Lacks(name);
    return *column;
  }

  std::vector<int> Bits(const std::string& name) const {
    std::vector<int> bits;
    for (const double number : Numbers(name))
      bits.push_back(number >= 0.0 && number <= kMostBits ? static_cast<int>(number) : 0);
    return bits;
  }

  PlaceOverTime Place(const std::string& name) const {
    const std::vector<double>& t_s = Numbers("time");
    std::array<const std::vector<double>*, 3> p{};
    for (std::size_t a = 0; a < 3; ++a) p[a] = &Numbers(name + "_" + std::string(1, "xyz"[a]));
    PlaceOverTime place;
    for (std::size_t i = 0; i < t_s.size(); ++i) {
      if (!std::isfinite((*p[0])[i] + (*p[1])[i] + (*p[2])[i])) continue;
      place.t_s.push_back(t_s[i]);
      for (std::size_t a = 0; a < 3; ++a) place.p_mm[a].push_back(kMmPerM * (*p[a])[i]);
    }
    return place;
  }

  std::vector<int> Reactions() const {
    const auto* texts = table_.Texts("reaction");
    if (texts == nullptr) Lacks("reaction");
    std::vector<int> reactions;
    for (std::size_t i = 0; i < texts->size(); ++i) {
      const auto at = std::find(kReactions.begin(), kReactions.end(), (*texts)[i]);
      if (at == kReactions.end()) {
        throw InputError::At(
            file_.string(), static_cast<long>(i) + 2,
            fmt::format("reaction: found '{}', expected none, limit, hold or fault", (*texts)[i]));
      }
      reactions.push_back(static_cast<int>(at - kReactions.begin()));
    }
    return reactions;
  }

 private:
  [[noreturn]] void Lacks(const std::string& name) const {
    throw InputError::At(file_.string(), 1,
                         fmt::format("has no column {}, the picture needs it", name));
  }

  std::filesystem::path file_;
  ResultTable table_;
};

}  // namespace

StopRows ReadStopRows(const std::filesystem::path& file) {
  const TableReader table(file);
  StopRows rows;
  rows.t_s = table.Numbers("time");
  rows.wanted = table.Place("p_RE_wanted");
  rows.used = table.Place("p_RE_used");
  rows.rest = table.Place("p_RE_rest");
  for (std::size_t i = 0; i < kStopSensors.size(); ++i)
    rows.by[i] = table.Place(fmt::format("p_RE_{}", kStopSensors[i]));
  rows.there = table.Bits("sensors");
  rows.out = table.Bits("out");
  rows.reaction = table.Reactions();
  const auto &chi2 = table.Numbers("chi2"), &limit = table.Numbers("chi2_limit");
  for (std::size_t i = 0; i < chi2.size(); ++i)
    rows.ratio.push_back(limit[i] > 0.0 ? chi2[i] / limit[i] : std::nan(""));
  return rows;
}

}  // namespace flextip::report
