#include "plausibility/faults/fault_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "plausibility/faults/fault.h"
#include "plausibility/relations/relations.h"

namespace flextip::plausibility {
namespace {

constexpr int kMostFaults = 3;
constexpr double kNeeded = 0.7;    // of the misfit may be left
constexpr double kHandicap = 0.5;  // of faults with a fitted value: others go first

/// A scene with one more fault undone.
struct Attempt {
  Fault fault;
  Scene scene;
  std::vector<Relation> relations;
  double misfit = 0.0;
  std::size_t violated = 0;

  bool IsBetterThan(const Attempt& other) const {
    if ((violated == 0) != (other.violated == 0)) return violated == 0;
    constexpr double kRounding = 1e-9;
    return misfit < other.misfit - kRounding;
  }
};

class FaultSearch {
 public:
  FaultSearch(const Recording& recording, const Shifts& shifts, const Shifts& supposed,
              const std::set<std::string>& unknown)
      : recording_(recording),
        supposed_(supposed),
        shifts_(shifts),
        scene_(TakeScene(recording, shifts)) {
    scene_.unknown = unknown;
    // A camera whose lens was found wrong tells nothing of its view.
    if (scene_.camera && !(scene_.camera->fu_px > 0.0)) scene_.camera.reset();
    relations_ = RelationsOf(scene_);
  }

  void Run() {
    CheckIdentity();
    for (int fault = 0; fault < kMostFaults && CountViolated(relations_) > 0; ++fault) {
      auto best = BestAttempt();
      if (!best) break;
      const Relation* worst = WorstOf(relations_, best->fault.subject);
      if (worst == nullptr) worst = WorstOf(relations_);
      findings.push_back({Severity::kWrong, best->fault.id,
                          fmt::format("{}: {}", best->fault.looks, worst->text), best->fault.mend});
      scene_ = std::move(best->scene);
      relations_ = std::move(best->relations);
      if (best->fault.clock_shift_s != 0.0) {
        shifts_[best->fault.subject] = best->fault.clock_shift_s;
      } else {
        undone_.push_back(std::move(best->fault));
      }
    }
    if (CountViolated(relations_) > 0) Unexplained();
  }

  std::vector<Finding> findings;

 private:
  /// An identity stands where nobody wrote the camera's place. Tips that were found with it are in
  /// the camera's frame.
  void CheckIdentity() {
    if (!scene_.camera) return;
    const Eigen::Matrix4d T = scene_.camera->T_RC.Matrix();
    if ((T - Eigen::Matrix4d::Identity()).norm() > 1e-6) return;
    const Relation* misfit = WorstOf(relations_, "cam0.T_RC");
    if (misfit == nullptr) misfit = WorstOf(relations_, "vision0.frame");
    if (misfit == nullptr) return;
    const std::string text = misfit->text;
    scene_.camera.reset();
    relations_ = RelationsOf(scene_);
    std::string tips;
    if (WorstOf(relations_, "vision0.frame") != nullptr) {
      for (Instant& now : scene_.instants) now.tip.reset();
      std::erase(scene_.streams, "vision0");
      relations_ = RelationsOf(scene_);
      tips = ", and the tips of vision0 are in the camera's frame";
    }
    findings.push_back({Severity::kWrong, "cam0.identity",
                        fmt::format("cam0: T_RC is the identity, as where nobody calibrated the "
                                    "camera's pose{}: {}",
                                    tips, text),
                        "flextip calibrate hand-eye finds T_RC: --calibration "
                        "hand_eye/calibration.yaml, or write it in cam0/sensor.yaml" +
                            std::string(tips.empty() ? "" : "; then track again")});
  }

  std::optional<Attempt> BestAttempt() const {
    std::optional<Attempt> best;
    const double before = TotalMisfit(relations_);
    const std::size_t violated = CountViolated(relations_);
    const auto consider = [&](const Fault& fault, double handicap) {
      Attempt attempt{fault, scene_, {}, 0.0, 0};
      fault.undo(attempt.scene);
      attempt.relations = RelationsOf(attempt.scene);
      attempt.misfit = TotalMisfit(attempt.relations) + handicap;
      attempt.violated = CountViolated(attempt.relations);
      if (attempt.violated >= violated || attempt.misfit > kNeeded * before) return;
      if (!best || attempt.IsBetterThan(*best)) best = std::move(attempt);
    };
    for (const auto& [stream, shift_s] : supposed_)
      if (!shifts_.contains(stream)) consider(ClockFault(stream, shift_s), 0.0);
    for (const Fault& fault : FaultsOf(scene_)) consider(fault, 0.0);
    if (best && best->violated == 0) return best;
    for (const Fault& fault : SearchedFaultsOf(scene_)) consider(fault, kHandicap);
    for (const Fault& fault : ClockFaults()) consider(fault, kHandicap);
    return best;
  }

  /// Clock shifts up to 5 s, where motion alone did not tell them.
  std::vector<Fault> ClockFaults() const {
    std::vector<Fault> faults;
    for (const char* stream : {"em0", "vision0", "strain0", "load0", "command0", "wrist0"}) {
      if (!scene_.Has(stream) || shifts_.contains(stream)) continue;
      if (stream == std::string("wrist0") && !IsWristsFault()) continue;
      for (int tenths = -50; tenths <= 50; ++tenths) {
        if (std::abs(tenths) < 3) continue;
        faults.push_back(ClockFault(stream, 0.1 * tenths));
      }
    }
    return faults;
  }

  Fault ClockFault(const std::string& stream, double shift_s) const {
    Shifts with = shifts_;
    with[stream] = shift_s;
    return {stream + ".clock",
            stream,
            fmt::format("{}: its clock looks {:.1f} s {} that of the other streams", stream,
                        std::abs(shift_s), shift_s < 0.0 ? "ahead of" : "behind"),
            fmt::format("import with --offset {}={:.1f}", stream, shift_s),
            [this, with](Scene& s) {
              s.instants = TakeScene(recording_, with).instants;
              if (!s.Has("vision0"))
                for (Instant& now : s.instants) now.tip.reset();
              for (const Fault& fault : undone_) fault.undo(s);
            },
            shift_s};
  }

  /// A wrist whose clock is off fits none of the others: two of them have to say so.
  bool IsWristsFault() const {
    std::set<std::string> against;
    for (const Relation& r : relations_) {
      if (!r.Violated()) continue;
      for (const std::string& stream : scene_.streams)
        if (stream != "wrist0" && r.IsAbout("wrist0") && r.IsAbout(stream)) against.insert(stream);
    }
    return against.size() > 1;
  }

  /// Names the stream without which the others fit.
  void Unexplained() {
    std::string culprit;
    std::size_t least = CountViolated(relations_);
    for (const std::string& stream : scene_.streams) {
      const auto left = static_cast<std::size_t>(
          std::count_if(relations_.begin(), relations_.end(),
                        [&](const Relation& r) { return r.Violated() && !r.IsAbout(stream); }));
      // The wrist is in nearly all of them.
      if (left < least || (left == least && culprit == "wrist0")) least = left, culprit = stream;
    }
    // A clock that is doubted explains it.
    for (const auto& supposed : supposed_) {
      const std::string& stream = supposed.first;
      if (std::all_of(relations_.begin(), relations_.end(),
                      [&](const Relation& r) { return !r.Violated() || r.IsAbout(stream); }))
        return;
    }
    const Relation* worst = WorstOf(relations_, culprit);
    if (worst == nullptr) worst = WorstOf(relations_);
    if (culprit.empty()) culprit = worst->about.front();
    findings.push_back({Severity::kWrong, culprit + ".unexplained",
                        fmt::format("{}: does not fit the other streams, and no cause was found: "
                                    "{}",
                                    culprit, worst->text),
                        ""});
  }

  const Recording& recording_;
  const Shifts& supposed_;
  Shifts shifts_;
  Scene scene_;
  std::vector<Relation> relations_;
  std::vector<Fault> undone_;  // but for clocks
};

}  // namespace

std::vector<Finding> SearchFaults(const Recording& recording, const Shifts& shifts,
                                  const Shifts& supposed, const std::set<std::string>& unknown) {
  FaultSearch search(recording, shifts, supposed, unknown);
  search.Run();
  return search.findings;
}

}  // namespace flextip::plausibility
