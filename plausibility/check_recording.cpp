#include "plausibility/check_recording.h"

#include <algorithm>

#include "plausibility/faults/fault_search.h"
#include "plausibility/limits/hung_mass.h"
#include "plausibility/limits/limits.h"
#include "plausibility/noise.h"
#include "plausibility/relations/relations.h"
#include "plausibility/timing/clocks.h"
#include "plausibility/timing/pace.h"
#include "plausibility/timing/stuck.h"
#include "plausibility/timing/time_units.h"

namespace flextip::plausibility {
namespace {

/// Returns the streams whose values are not what they say: their noise says nothing.
std::vector<std::string> SpoiltStreams(const std::vector<Finding>& findings) {
  std::vector<std::string> streams;
  for (const Finding& f : findings) {
    const std::string kind = f.id.substr(f.id.find('.') + 1);
    if (kind != "rate" && kind != "gap" && kind != "clock" && kind != "stations")
      streams.push_back(f.Subject());
  }
  return streams;
}

bool Contains(const std::vector<Finding>& findings, const std::string& id) {
  return std::any_of(findings.begin(), findings.end(),
                     [&](const Finding& f) { return f.id == id; });
}

/// Runs the checks in an order in which each can rely on those before: `repaired_` is the recording
/// with the faults found so far undone.
class RecordingCheck {
 public:
  RecordingCheck(const Recording& recording, const CheckOptions& options)
      : unknown_(options.unknown), repaired_(recording) {}

  CheckResult Run() {
    std::vector<Rows> rows = RowsOf(repaired_);
    for (const Rows& r : rows) result_.streams.push_back(FactsOf(r, FindRows(rows, "wrist0")));
    const std::vector<Finding> units = CheckTimeUnits(rows, repaired_);
    if (!units.empty()) rows = RowsOf(repaired_);
    Add(CheckStuck(rows, repaired_));
    std::vector<Finding> rates = CheckRates(rows);
    std::erase_if(rates, [&](const Finding& f) {  // a rate by wrong times
      return Contains(units, f.Subject() + ".time_unit");
    });
    Add(units);
    Add(rates);
    Add(CheckGaps(rows));
    Add(CheckLimits(unknown_, repaired_));
    Shifts shifts;
    const std::set<std::string> unknown = UnknownOfMotion();
    Shifts supposed;
    Add(CheckClocks(repaired_, rows, unknown, shifts, supposed));
    Replace(CheckForceClocks(repaired_, unknown, supposed, shifts));
    if (repaired_.wrist0) Faults(shifts, supposed);
    Add(CheckHungMass(repaired_, result_.findings));
    std::vector<std::string> spoilt = SpoiltStreams(result_.findings);
    spoilt.insert(spoilt.end(), unknown_.begin(), unknown_.end());
    Add(CheckNoise(repaired_, spoilt));
    SortFindings(result_.findings);
    return std::move(result_);
  }

 private:
  void Add(const std::vector<Finding>& more) {
    result_.findings.insert(result_.findings.end(), more.begin(), more.end());
  }

  /// Puts findings in the place of those of the same id.
  void Replace(const std::vector<Finding>& more) {
    std::erase_if(result_.findings, [&](const Finding& f) { return Contains(more, f.id); });
    Add(more);
  }

  /// A wrist that does not fit the port makes no motion to compare clocks by.
  std::set<std::string> UnknownOfMotion() const {
    std::set<std::string> unknown = unknown_;
    Scene scene = TakeScene(repaired_);
    scene.unknown = unknown_;
    RelationList wrist(scene);
    AddWristRelations(wrist);
    const std::vector<Relation> relations = wrist.Take();
    if (WorstOf(relations, "port") != nullptr) unknown.insert("port");
    return unknown;
  }

  void Faults(const Shifts& shifts, const Shifts& supposed) {
    const std::vector<Finding> faults = SearchFaults(repaired_, shifts, supposed, unknown_);
    // A force that a unit mends is not large.
    if (Contains(faults, "load0.unit"))
      std::erase_if(result_.findings, [](const Finding& f) { return f.id == "load0.large"; });
    Add(faults);
  }

  const std::set<std::string>& unknown_;
  Recording repaired_;
  CheckResult result_;
};

}  // namespace

CheckResult CheckRecording(const Recording& recording, const CheckOptions& options) {
  return RecordingCheck(recording, options).Run();
}

}  // namespace flextip::plausibility
