#include "plausibility/check_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/median.h"
#include "plausibility/limits.h"
#include "plausibility/noise.h"
#include "plausibility/relations.h"
#include "plausibility/timing.h"
#include "plausibility/ways.h"

namespace flextip::plausibility {
namespace {

constexpr int kMostFaults = 3;

struct Attempt {
  Way way;
  Scene scene;
  std::vector<Relation> relations;
  double misfit = 0.0;
  std::size_t violated = 0;
};

std::size_t CountViolated(const std::vector<Relation>& relations) {
  return static_cast<std::size_t>(std::count_if(relations.begin(), relations.end(),
                                                [](const Relation& r) { return r.Violated(); }));
}

Attempt Try(const Scene& scene, const Way& way) {
  Attempt attempt{way, scene, {}, 0.0, 0};
  way.undo(attempt.scene);
  attempt.relations = RelationsOf(attempt.scene);
  attempt.misfit = TotalMisfit(attempt.relations);
  attempt.violated = CountViolated(attempt.relations);
  return attempt;
}

/// Clock shifts as ways, where motion alone does not tell them.
std::vector<Way> ClockWays(const Recording& recording, const Scene& scene, const Shifts& shifts) {
  std::vector<Way> ways;
  for (const char* stream : {"em0", "vision0", "strain0", "load0", "command0", "wrist0"}) {
    if (!scene.Has(stream) || shifts.contains(stream)) continue;
    for (int tenths = -50; tenths <= 50; ++tenths) {
      if (std::abs(tenths) < 3) continue;
      const double shift = 0.1 * tenths;
      Shifts with = shifts;
      with[stream] = shift;
      ways.push_back(
          {std::string(stream) + ".clock", stream,
           fmt::format("{}: its clock looks {:.1f} s {} that of the other streams", stream,
                       std::abs(shift), shift < 0.0 ? "ahead of" : "behind"),
           fmt::format("import with --clock {}={:+.1f}s", stream, shift), true,
           [with, &recording](Scene& s) { s.instants = TakeScene(recording, with).instants; }});
    }
  }
  return ways;
}

/// Without which stream do the others fit?
std::string Misfit(const Scene& scene, const std::vector<Relation>& relations) {
  std::string best;
  std::size_t least = CountViolated(relations);
  for (const std::string& stream : scene.streams) {
    const auto left = static_cast<std::size_t>(
        std::count_if(relations.begin(), relations.end(),
                      [&](const Relation& r) { return r.Violated() && !r.Names(stream); }));
    // The wrist is in nearly all of them.
    if (left < least || (left == least && best == "wrist0")) least = left, best = stream;
  }
  return best;
}

/// Finds what makes the streams fit, one fault after the other.
class FaultSearch {
 public:
  FaultSearch(const Recording& recording, const Shifts& shifts, const CameraCalibration* camera)
      : recording_(recording), shifts_(shifts), scene_(TakeScene(recording, shifts)) {
    if (camera != nullptr && !(camera->fu_px > 0.0)) scene_.camera.reset();
  }

  std::vector<Finding> findings;

  void Run() {
    auto relations = RelationsOf(scene_);
    CheckIdentity(relations);
    for (int fault = 0; fault < kMostFaults && AnyViolated(relations); ++fault) {
      const auto best = BestOf(relations);
      if (!best) break;
      const Relation* worst = WorstOf(relations, best->way.stream);
      if (worst == nullptr) worst = WorstOf(relations);
      findings.push_back({Severity::kWrong, best->way.id,
                          fmt::format("{}: {}", best->way.looks, worst->text), best->way.mend});
      scene_ = best->scene;
      relations = best->relations;
    }
    if (!AnyViolated(relations)) return;
    const Relation* worst = WorstOf(relations);
    const std::string stream = Misfit(scene_, relations);
    findings.push_back({Severity::kWrong,
                        (stream.empty() ? worst->streams.front() : stream) + ".unexplained",
                        fmt::format("{}: does not fit the others, and no cause was found: {}",
                                    stream.empty() ? worst->streams.front() : stream, worst->text),
                        ""});
  }

 private:
  /// An identity stands where nobody wrote the camera's place.
  void CheckIdentity(std::vector<Relation>& relations) {
    const auto view = std::find_if(relations.begin(), relations.end(),
                                   [](const Relation& r) { return r.name == "cam0.view"; });
    if (!scene_.camera || view == relations.end() || !view->Violated()) return;
    if ((scene_.camera->T_RC.Matrix() - Eigen::Matrix4d::Identity()).norm() > 1e-6) return;
    findings.push_back({Severity::kWrong, "cam0.identity",
                        fmt::format("cam0: T_RC is the identity: {}", view->text),
                        "T_RC in cam0/sensor.yaml: the camera's pose in R, by flextip calibrate "
                        "hand-eye"});
    scene_.camera.reset();
    relations = RelationsOf(scene_);
  }

  std::optional<Attempt> BestOf(const std::vector<Relation>& relations) const {
    const double before = TotalMisfit(relations);
    const std::size_t violated = CountViolated(relations);
    std::optional<Attempt> best;
    const auto consider = [&](const Way& way, double handicap) {
      Attempt attempt = Try(scene_, way);
      attempt.misfit += handicap;
      if (attempt.violated >= violated || attempt.misfit > 0.7 * before) return;
      if (!best || Better(attempt, *best)) best = std::move(attempt);
    };
    for (const Way& way : WaysFor(scene_)) consider(way, 0.0);
    if (!best || best->violated > 0) {
      for (const Way& way : SearchedWaysFor(scene_)) consider(way, 0.5);
      for (const Way& way : ClockWays(recording_, scene_, shifts_)) consider(way, 0.5);
    }
    return best;
  }

  static bool Better(const Attempt& a, const Attempt& b) {
    if ((a.violated == 0) != (b.violated == 0)) return a.violated == 0;
    return a.misfit < b.misfit;
  }

  const Recording& recording_;
  const Shifts& shifts_;
  Scene scene_;
};

/// A mass that hangs on the tip pulls along gravity.
void CheckHungMass(const Recording& r, const std::vector<Finding>& found,
                   std::vector<Finding>& findings) {
  if (!r.load0 || r.gravity_m_s2.norm() == 0.0 || r.load0->f_tip_N.size() < 20) return;
  for (const Finding& f : found)
    if (f.id.starts_with("load0.")) return;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& f : r.load0->f_tip_N) mean += f.value;
  mean /= static_cast<double>(r.load0->f_tip_N.size());
  double squares = 0.0;
  for (const auto& f : r.load0->f_tip_N) squares += (f.value - mean).squaredNorm();
  const double sd = std::sqrt(squares / static_cast<double>(3 * r.load0->f_tip_N.size()));
  constexpr double kLeast_N = 0.05;
  const bool constant =
      mean.norm() > kLeast_N && sd < std::max(2.0 * r.load0->force_noise_N, 0.01 * mean.norm());
  if (!constant) return;
  const double cosine = mean.dot(r.gravity_m_s2) / (mean.norm() * r.gravity_m_s2.norm());
  if (cosine > -0.995) return;
  findings.push_back(
      {Severity::kWrong, "gravity.sign",
       fmt::format(
           "gravity_m_s2 looks upside down: load0 is constant, {:.3g} N, and points against "
           "it, as a hung mass never does",
           mean.norm()),
       fmt::format("gravity_m_s2: [{:.4g}, {:.4g}, {:.4g}] in recording.yaml", -r.gravity_m_s2.x(),
                   -r.gravity_m_s2.y(), -r.gravity_m_s2.z())});
}

/// Returns the streams whose values are not what they say: their noise says nothing.
std::vector<std::string> Spoilt(const std::vector<Finding>& findings) {
  std::vector<std::string> streams;
  for (const Finding& f : findings) {
    const std::string kind = f.id.substr(f.id.find('.') + 1);
    if (kind == "rate" || kind == "gap" || kind == "clock" || kind == "stations") continue;
    streams.push_back(f.id.substr(0, f.id.find('.')));
  }
  return streams;
}

}  // namespace

const char* Name(Severity severity) { return severity == Severity::kWrong ? "wrong" : "doubtful"; }

void SortFindings(std::vector<Finding>& findings) {
  std::set<std::string> seen;
  std::vector<Finding> sorted;
  for (const Severity severity : {Severity::kWrong, Severity::kDoubtful}) {
    for (Finding& f : findings) {
      if (f.severity == severity && seen.insert(f.id).second) sorted.push_back(std::move(f));
    }
  }
  findings = std::move(sorted);
}

CheckResult CheckRecording(const Recording& recording) {
  CheckResult result;
  const std::vector<Rows> rows = RowsOf(recording);
  const auto wrist =
      std::find_if(rows.begin(), rows.end(), [](const Rows& r) { return r.name == "wrist0"; });
  for (const Rows& r : rows)
    result.streams.push_back(FactsOf(r, wrist == rows.end() ? nullptr : &*wrist));
  std::vector<Finding>& findings = result.findings;
  const auto add = [&](std::vector<Finding> more) {
    findings.insert(findings.end(), more.begin(), more.end());
  };

  Recording repaired;
  Shifts shifts;
  add(CheckTimes(recording, rows, repaired, shifts));
  add(CheckLimits(recording, repaired));
  add(CheckLags(repaired, shifts));
  if (repaired.wrist0) {
    FaultSearch search(repaired, shifts, repaired.cam0 ? &repaired.cam0->calibration : nullptr);
    search.Run();
    // What is mended by a unit is not large.
    const bool named = std::any_of(search.findings.begin(), search.findings.end(),
                                   [](const Finding& f) { return f.id == "load0.unit"; });
    if (named) std::erase_if(findings, [](const Finding& f) { return f.id == "load0.large"; });
    add(std::move(search.findings));
  }
  const std::vector<Finding> so_far = findings;
  CheckHungMass(repaired, so_far, findings);
  add(CheckNoise(repaired, Spoilt(findings)));
  SortFindings(findings);
  return result;
}

}  // namespace flextip::plausibility
