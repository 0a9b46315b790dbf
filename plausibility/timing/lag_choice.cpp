#include "plausibility/timing/lag_choice.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "plausibility/relations/relations.h"

namespace flextip::plausibility {
namespace {

using Misfits = std::map<std::string, double>;  // by the relation's name

Misfits MisfitsOf(const Recording& recording, const std::string& stream, const Shifts& shifts,
                  const std::set<std::string>& unknown) {
  constexpr double kMost = 8.0;
  Scene scene = TakeScene(recording, shifts);
  scene.unknown = unknown;
  Misfits misfits;
  for (const Relation& r : RelationsOf(scene))
    if (r.IsAbout(stream)) misfits[r.name] = std::min(r.misfit, kMost);
  return misfits;
}

/// The sum of the squares of the relations that all have.
double TotalOf(const Misfits& misfits, const std::vector<Misfits>& all) {
  double sum = 0.0;
  for (const auto& misfit : misfits) {
    const auto has = [&](const Misfits& m) { return m.contains(misfit.first); };
    if (std::all_of(all.begin(), all.end(), has)) sum += misfit.second * misfit.second;
  }
  return sum;
}

/// What a shaft's bending takes from the correlation, it takes from each period of the motion. At
/// the expected place more is allowed: the bending is not the same in every period.
bool IsCandidate(const Lag& lag, const Lag& best, double expected_s) {
  constexpr double kElsewhere = 2.5, kExpected = 10.0;
  const bool expected = std::abs(lag.seconds - expected_s) < kLatency_s;
  return 1.0 - lag.correlation <= (expected ? kExpected : kElsewhere) * (1.0 - best.correlation);
}

}  // namespace

std::optional<Lag> ChooseLag(const Recording& recording, const std::string& stream,
                             const std::vector<Lag>& lags, const Shifts& shifts,
                             const std::set<std::string>& unknown, double expected_s) {
  constexpr double kAlike = 0.9;
  if (lags.empty()) return {};
  std::vector<Lag> candidates;
  for (const Lag& lag : lags)
    if (IsCandidate(lag, lags.front(), expected_s)) candidates.push_back(lag);
  if (candidates.size() < 2) return lags.front();
  std::stable_sort(candidates.begin(), candidates.end(), [&](const Lag& a, const Lag& b) {
    return std::abs(a.seconds - expected_s) < std::abs(b.seconds - expected_s);
  });
  std::vector<Misfits> misfits;
  for (const Lag& lag : candidates) {
    Shifts with = shifts;
    with[stream] = -lag.seconds;
    misfits.push_back(MisfitsOf(recording, stream, with, unknown));
  }
  std::size_t best = 0;
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    if (TotalOf(misfits[i], misfits) < kAlike * TotalOf(misfits[best], misfits)) best = i;
  }
  return candidates[best];
}

}  // namespace flextip::plausibility
