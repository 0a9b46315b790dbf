#include "reproduction/chapter5/rows.h"

#include <fmt/format.h>

#include "reproduction/chapter5/groups.h"
#include "reproduction/chapter5/thesis.h"

namespace flextip::reproduction {
namespace {

using Value = double (*)(const OperatorResult&);

/// A measure of 5.3 in its unit.
struct Measure {
  const char* name;
  const char* unit;
  Value recorded;
  const ThesisNumbers* thesis;
  double thesis_p;
};
const Measure kMeasures[] = {
    {"time in the forbidden region", "%",
     [](const OperatorResult& o) { return 100.0 * o.recorded.time_part; }, kThesisTime, 0.002},
    {"maximum depth in the forbidden region", "mm",
     [](const OperatorResult& o) { return 1e3 * o.recorded.max_depth_m; }, kThesisDepth, 0.011},
    {"area swept in the forbidden region", "mm^2",
     [](const OperatorResult& o) { return 1e6 * o.recorded.swept_area_m2; }, kThesisSwept, 0.013},
    {"area of the outlines on two planes", "mm^2",
     [](const OperatorResult& o) { return 1e6 * o.recorded.outline_area_m2; }, kThesisOutline,
     0.014}};

const char* NoteOf(int condition) {
  constexpr const char* kNotes[kThesisControllers] = {
      "As the EM sensor recorded it, as in the thesis. Most of it is the sensor's own noise: see "
      "the true "
      "tip's rows.",
      "Little worse than Flex-Track at the flexion of ours (15 mm); at silicone three times as "
      "strong it is: "
      "see the rows \"5.3 if\".",
      "The chord's direction is measured, (5.4) and (5.13), so an exact registration leaves only "
      "the beam's "
      "length. What EM is off along the shaft adds to it as it is: see \"5.3 if the EM field is 2 "
      "mm off\".",
      "Grows with the square of the flexion: at forces twice as high it comes near the thesis's. "
      "See \"5.3 if "
      "the silicone is\"."};
  return kNotes[condition];
}

TableRow Row(std::string quantity, std::optional<double> thesis, double ours, const char* unit,
             std::string note = {}) {
  return {std::move(quantity), thesis, ours, unit, std::move(note)};
}

void AddMeasure(const Measure& measure, const std::vector<GroupResult>& results,
                std::vector<TableRow>& rows) {
  std::vector<MeanSd> ours, theirs;
  for (int i = 0; i < kThesisControllers; ++i) {
    const MeanSd value = Find(results, ThesisName(i)).Of(measure.recorded);
    const ThesisNumbers& thesis = measure.thesis[i];
    const std::string name = fmt::format("5.3 {}, {}", measure.name, ThesisName(i));
    rows.push_back(Row(name + ", mean", thesis.mean, value.mean, measure.unit, NoteOf(i)));
    rows.push_back(Row(name + ", standard deviation", thesis.sd, value.sd, measure.unit));
    ours.push_back(value);
    theirs.push_back({.mean = thesis.mean, .sd = thesis.sd, .count = 10});
  }
  rows.push_back(
      Row(fmt::format("5.3 {}, largest p of the six differences", measure.name), measure.thesis_p,
          LargestP(ours), "",
          "Student's t-test, two-sided, independent samples, one variance. Ours: the three that "
          "know the tip's position are at the sensor's noise and differ little."));
  rows.push_back(Row(fmt::format("5.3 {}, largest p from the thesis's own figures", measure.name),
                     measure.thesis_p, LargestP(theirs), "",
                     "The same test on the printed means and deviations: this is the test that "
                     "the thesis used."));
}

Value Worst() {
  return [](const OperatorResult& o) { return 1e3 * o.worst_m; };
}
Value TrueTime() {
  return [](const OperatorResult& o) { return 100.0 * o.truth.time_part; };
}
Value RecordedDepth() { return kMeasures[1].recorded; }
Value RecordedTime() { return kMeasures[0].recorded; }

void AddTruth(const std::vector<GroupResult>& results, const std::string& name,
              std::vector<TableRow>& rows, const std::string& note = {}) {
  const GroupResult& group = Find(results, name);
  rows.push_back(
      Row(fmt::format("5.3 true tip, time inside, {}", name), {}, group.Of(TrueTime()).mean, "%"));
  rows.push_back(Row(fmt::format("5.3 true tip, deepest place beyond the wall, {}", name), {},
                     group.Of(Worst()).mean, "mm",
                     note.empty() ? "Negative: how far it stayed from the wall." : note));
}

void AddPhysics(const std::vector<GroupResult>& results, std::vector<TableRow>& rows) {
  for (int i = 0; i < kThesisControllers; ++i) {
    const GroupResult& group = Find(results, ThesisName(i));
    const auto add = [&](const char* what, Value value, const char* unit) {
      rows.push_back(
          Row(fmt::format("5.3 {}, {}", what, ThesisName(i)), {}, group.Of(value).mean, unit));
    };
    add(
        "flexion at the tip, RMS", [](const OperatorResult& o) { return 1e3 * o.rms_flexion_m; },
        "mm");
    add(
        "flexion at the tip, largest",
        [](const OperatorResult& o) { return 1e3 * o.max_flexion_m; }, "mm");
    add(
        "side force at the tip, RMS", [](const OperatorResult& o) { return o.rms_side_force_N; },
        "N");
    add(
        "side force at the tip, largest",
        [](const OperatorResult& o) { return o.max_side_force_N; }, "N");
    add(
        "push along the shaft, largest", [](const OperatorResult& o) { return o.max_push_N; }, "N");
    add(
        "part of the outline's silicone cut",
        [](const OperatorResult& o) { return 100.0 * o.cut_part; }, "%");
  }
}

/// Largest recorded depth and time for the four controllers under one change.
void AddVariation(const std::vector<GroupResult>& results, const std::string& change,
                  const std::string& words, std::vector<TableRow>& rows) {
  for (int i = 0; i < kThesisControllers; ++i) {
    const std::string name = fmt::format("{} {}", ThesisName(i), change);
    bool there = false;
    for (const auto& result : results) there |= result.group.name == name;
    if (!there) continue;
    const GroupResult& group = Find(results, name);
    const double flexion =
        group.Of([](const OperatorResult& o) { return 1e3 * o.max_flexion_m; }).mean;
    rows.push_back(Row(fmt::format("5.3 if {}: maximum depth, {}", words, ThesisName(i)),
                       kThesisDepth[i].mean, group.Of(RecordedDepth()).mean, "mm",
                       fmt::format("Five operators, 20 s. Flexion up to {:.0f} mm.", flexion)));
    rows.push_back(Row(fmt::format("5.3 if {}: time inside, {}", words, ThesisName(i)),
                       kThesisTime[i].mean, group.Of(RecordedTime()).mean, "%"));
  }
}

}  // namespace

std::vector<TableRow> ThesisRows(const std::vector<GroupResult>& results) {
  std::vector<TableRow> rows;
  for (const Measure& measure : kMeasures) AddMeasure(measure, results, rows);
  for (int i = 0; i < kThesisControllers; ++i) AddTruth(results, ThesisName(i), rows);
  AddPhysics(results, rows);
  return rows;
}

std::vector<TableRow> ReductionRows(const std::vector<GroupResult>& results) {
  constexpr const char* kBy[] = {"flexion kinematics and tip tracking", "tip tracking",
                                 "flexion kinematics"};
  constexpr double kDepth[] = {83, 67, 28}, kOutline[] = {96, 76, 35};
  const auto mean = [&](int condition, const Measure& measure) {
    return Find(results, ThesisName(condition)).Of(measure.recorded).mean;
  };
  std::vector<TableRow> rows;
  for (int i = 2; i >= 0; --i) {
    for (const auto& [measure, published] :
         {std::pair(kMeasures[1], kDepth[i]), std::pair(kMeasures[3], kOutline[i])}) {
      const double part = mean(i, measure) / mean(3, measure);
      rows.push_back(Row(fmt::format("5.4 reduction by {}, {}", kBy[i], measure.name), published,
                         100.0 * (1.0 - part), "%", "Against Straight-Calculate."));
    }
  }
  rows.push_back(
      Row("6.2 reduction of maximum depth by tip tracking, with flexion kinematics", 70,
          100.0 * (1.0 - mean(0, kMeasures[1]) / mean(2, kMeasures[1])), "%",
          "Ours has little left to reduce: Flex-Calculate is as exact as its registration."));
  rows.push_back(Row("6.2 reduction of time inside by tip tracking, straight kinematics", 50,
                     100.0 * (1.0 - mean(1, kMeasures[0]) / mean(3, kMeasures[0])), "%"));
  rows.push_back(Row("6.2 reduction of outline area by tip tracking, straight kinematics", 75,
                     100.0 * (1.0 - mean(1, kMeasures[3]) / mean(3, kMeasures[3])), "%"));
  return rows;
}

std::vector<TableRow> OursRows(const std::vector<GroupResult>& results) {
  std::vector<TableRow> rows;
  for (const char* name : {"Flex-Calculate by orientations", "Rod-Calculate", "Rod-Track"}) {
    for (const Measure& measure : kMeasures) {
      const MeanSd value = Find(results, name).Of(measure.recorded);
      rows.push_back(Row(fmt::format("5.3 {}, {}, mean", measure.name, name), {}, value.mean,
                         measure.unit, fmt::format("Standard deviation {:.3g}.", value.sd)));
    }
    AddTruth(results, name, rows);
  }
  AddTruth(results, "Rod-Track without tissue", rows);
  AddTruth(results, "Rod-Track levelled", rows,
           "Lasting differences between the fitted rod's tip and the sensor's go to the sensor.");
  AddTruth(results, "Rod-Track with margin", rows,
           "The wall taken three standard deviations of the estimated tip early.");
  for (const char* kind : {"Straight-Track", "Flex-Track", "Rod-Track"}) {
    for (const char* rate : {"60 Hz", "30 Hz"}) {
      AddTruth(results, fmt::format("{} vision {}", kind, rate), rows,
               "Tip by a tracker (0.1 mm across, 0.6 mm in depth), 30 or 50 ms late, hidden 5 % of "
               "the time.");
    }
  }
  for (const char* kind : {"Flex-Track", "Rod-Track"}) {
    AddTruth(results, fmt::format("{} vision 30 Hz unhidden", kind), rows);
  }
  for (const char* name :
       {"Flex-Track wrong data", "Rod-Calculate wrong data", "Rod-Track wrong data",
        "Rod-Track vision 30 Hz wrong data", "Rod-Track levelled wrong data",
        "Rod-Track levelled vision 30 Hz wrong data"}) {
    AddTruth(results, name, rows,
             "Stiffness 5 % less, length 0.5 mm more, port 1 mm off; five operators, 20 s.");
  }
  AddTruth(results, "Rod-Track firm arm", rows,
           "The arm's servo has 100 kN/m: it no longer gives way outward. Five operators, 20 s.");
  AddTruth(results, "Rod-Track silicone x2", rows, "Five operators, 20 s.");
  for (const auto& name : CurveControllers()) {
    for (const double rate : CurveRates()) {
      rows.push_back(
          Row(fmt::format("5.4 deepest place of the true tip at {:.0f} Hz, {}", rate, name), {},
              Find(results, CurveGroup(name, rate)).Of(Worst()).mean, "mm",
              "Without noise, firm arm; three operators, 10 s. The thesis expects zero from "
              "much faster updates or a modelled response."));
    }
  }
  return rows;
}

std::vector<TableRow> VariationRows(const std::vector<GroupResult>& results) {
  std::vector<TableRow> rows;
  AddVariation(results, "silicone x0.5", "the silicone is half as strong", rows);
  AddVariation(results, "silicone x1", "nothing is changed", rows);
  AddVariation(results, "silicone x2", "the silicone is twice as strong", rows);
  AddVariation(results, "silicone x3", "the silicone is three times as strong", rows);
  AddVariation(results, "firm arm", "the arm's servo has 100 kN/m for 1", rows);
  AddVariation(results, "late", "EM is 20 ms late", rows);
  AddVariation(results, "soft arm", "the arm's servo has 0.3 kN/m for 1", rows);
  AddVariation(results, "less noise", "0.13 mm is the noise of all three axes together", rows);
  AddVariation(results, "EM off", "the EM field is 2 mm off along the shaft", rows);
  return rows;
}

TableRow HoldRow(const ReproduceOptions& options) {
  TrialSetup setup;
  setup.kind = ControllerKind::kFlexTrack;
  setup.hold_still = true;
  setup.seconds = options.quick ? 3.0 : 20.0;
  setup.noise_seed = options.seed;
  const Trial trial = RunTrial(setup);
  return Row(
      "5.2.6 RMS tip error when holding still, tip tracking", 0.16,
      1e3 * trial.rms_recorded_error_m, "mm",
      fmt::format("Per axis, as recorded. The true tip's is {:.3f} mm: the arm smooths the noise.",
                  1e3 * trial.rms_error_m));
}

}  // namespace flextip::reproduction
