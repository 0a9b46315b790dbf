#include "diagnosis/several/joint_fit.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/search/parameter_scan.h"

namespace flextip::diagnosis {
namespace {

constexpr double kStepDown = 0.4;
constexpr double kHopeless = 40.0;   // log odds
constexpr double kMostUntold = 3.0;  // times a promise that may come beyond it, after one step
constexpr double kNoRival = 2.0;     // log odds behind what is worth it
constexpr double kStays = 0.1;  // of the log odds of rest: a recording's own that a move is about
constexpr double kFarthest = 6.0;  // typical sizes
constexpr double kPriorChange = 0.1;

/// What all share is about the same centre.
void ShareScanCentres(Fleet& fleet, std::size_t from) {
  Member& source = fleet.At(from);
  for (const int block : source.layout.ScannedBlocks())
    for (std::size_t r = 0; r < fleet.Size(); ++r)
      if (!fleet.SharedOf(block).empty())
        fleet.At(r).layout.MutableEffect(block).SetScanCentre(
            source.layout.Blocks()[block].effect->ScanCentre());
}

/// A place that the hypothesis allows: what does not change is the same in all.
std::vector<Eigen::VectorXd> Allowed(const Fleet& fleet, const JointHypothesis& h) {
  std::vector<Eigen::VectorXd> theta;
  for (std::size_t r = 0; r < fleet.Size(); ++r) theta.push_back(fleet.At(r).theta);
  const Eigen::VectorXd first = theta.front(), last = theta.back();
  for (int e = 0; e < fleet.EffectCount(); ++e) {
    if (std::ranges::any_of(h.changes, [&](const Change& c) { return c.effect == e; })) continue;
    const bool present = std::ranges::find(h.effects, e) != h.effects.end();
    for (const int s : fleet.SharedOf(e)) {
      const int j = fleet.Shared()[s];
      for (auto& own : theta) own[j] = present ? last[j] : first[j];
    }
  }
  return theta;
}

void MakePlausible(const Fleet& fleet, std::vector<Eigen::VectorXd>& theta) {
  for (std::size_t r = 0; r < fleet.Size(); ++r) {
    const ParameterLayout& layout = fleet.At(r).layout;
    for (int j = 0; j < layout.Size(); ++j) {
      const double limit =
          kFarthest * std::max(layout.Parameter(j).typical, layout.Tolerances()[j]);
      theta[r][j] = std::clamp(theta[r][j], -limit, limit);
    }
  }
}

/// How much a member's theta is from the place of its sums, in log odds.
double FromItsPlace(const Member& member) {
  const Eigen::VectorXd way = member.theta - member.place.theta;
  return 0.5 * way.dot(member.sums.H * way);
}

/// Towards `target` as far as that explains more than standing at `from`. Near the target a part of
/// the way gains its part of what the whole promises: given up where that is less than `least` log
/// odds. `first_part` of the way is tried first, and left as a good one to try next. Members to
/// which the way makes hardly a difference stay where their sums are.
bool MoveTowards(const MemberWorkers& workers, const JointFit& fit,
                 const std::vector<Eigen::VectorXd>& from,
                 const std::vector<Eigen::VectorXd>& target, double before, double least,
                 double rest, double& first_part) {
  Fleet& fleet = workers.Members();
  const JointPlace here = PlaceOf(fleet);
  for (double part = first_part; part > 0.1; part *= kStepDown) {
    const bool is_near = part < 1.0 && fit.promised < kHopeless;
    if (is_near && part * (2.0 - part) * fit.promised < least) break;
    std::vector<Eigen::VectorXd> theta(fleet.Size());
    std::vector<MemberTask> moves;
    for (std::size_t r = 0; r < fleet.Size(); ++r) {
      theta[r] = from[r] + part * (target[r] - from[r]);
      Member& member = fleet.At(r);
      member.theta = theta[r];
      if (FromItsPlace(member) > kStays * rest) moves.push_back({r, ToPlace{PlaceNow(member)}});
    }
    if (workers.Move(moves) && EvidenceHere(fleet).Merit(fit.weighed, theta) < before) {
      first_part = part == first_part ? 1.0 : part;
      return true;
    }
    GoTo(fleet, here);
  }
  return false;
}

}  // namespace

JointPlace PlaceOf(const Fleet& fleet) {
  JointPlace place;
  for (std::size_t r = 0; r < fleet.Size(); ++r) {
    place.places.push_back(fleet.At(r).place);
    place.sums.push_back(fleet.At(r).sums);
    place.theta.push_back(fleet.At(r).theta);
  }
  return place;
}

void GoTo(Fleet& fleet, const JointPlace& place) {
  for (std::size_t r = 0; r < fleet.Size(); ++r) {
    fleet.At(r).place = place.places[r];
    fleet.At(r).sums = place.sums[r];
    fleet.At(r).theta = place.theta[r];
    SetScanCentres(fleet.At(r).layout, place.places[r].scan_centres);
  }
}

void StandAtBase(const MemberWorkers& workers) {
  Fleet& fleet = workers.Members();
  const auto task = [&](std::size_t r, bool scan_shared) {
    return MemberTask{r, ToBase{scan_shared, ScanCentres(fleet.At(r).layout)}};
  };
  // What began in some recording is in the last one.
  const std::size_t last = fleet.Size() - 1;
  workers.Move({task(last, true)});
  ShareScanCentres(fleet, last);
  std::vector<MemberTask> others;
  for (std::size_t r = 0; r < last; ++r) others.push_back(task(r, false));
  workers.Move(others);
}

void FixMeasure(const MemberWorkers& workers) {
  workers.Take(workers.DoWhereTheyStand(
      [](std::size_t, Place place) -> MemberTask::What { return Remeasure{std::move(place)}; }));
}

JointEvidence EvidenceHere(const Fleet& fleet) {
  std::vector<NormalSums> sums;
  for (std::size_t r = 0; r < fleet.Size(); ++r) sums.push_back(fleet.At(r).sums);
  return {fleet, std::move(sums)};
}

double LogPrior(const JointHypothesis& h, const Fleet& fleet, const SelectionOptions& options) {
  const double common = LogPrior(Hypothesis{h.effects, h.unknown}, fleet.EffectCount(), options);
  if (fleet.Size() < 2) return common;
  if (h.changes.empty()) return common + std::log(1.0 - kPriorChange);
  const double each = kPriorChange / double(fleet.EffectCount()) / double(fleet.Size() - 1);
  return common + double(h.changes.size()) * std::log(each);
}

JointFit FitJointly(const MemberWorkers& workers, const JointHypothesis& hypothesis, int rounds,
                    double worth, double rest) {
  Fleet& fleet = workers.Members();
  JointFit fit;
  double first_part = 1.0;
  for (int round = 0; round < rounds; ++round) {
    const JointEvidence evidence = EvidenceHere(fleet);
    fit.weighed = evidence.Weigh(hypothesis);
    std::vector<Eigen::VectorXd> target = evidence.Mode(fit.weighed);
    const double least = evidence.Merit(fit.weighed, target);
    MakePlausible(fleet, target);
    const std::vector<Eigen::VectorXd> from = Allowed(fleet, hypothesis);
    const double before = evidence.Merit(fit.weighed, from);
    fit.promised = std::max(0.0, 0.5 * (before - least));
    fit.log_posterior =
        fit.weighed.log_evidence + LogPrior(hypothesis, fleet, workers.Options()) - fit.promised;
    fit.place = PlaceOf(fleet);
    if (round > 0 && fit.promised < rest) break;
    const double behind = worth - (fit.log_posterior + fit.promised);
    if (round > 1 && behind > kHopeless) break;
    if (round == 1 && behind > kHopeless + kMostUntold * fit.promised) break;
    if (round + 1 == rounds) break;
    const double gain_to_rival = behind + fit.promised - kNoRival;
    if (!MoveTowards(workers, fit, from, target, before, gain_to_rival, rest, first_part)) break;
  }
  return fit;
}

}  // namespace flextip::diagnosis
