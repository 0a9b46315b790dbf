#include "reproduction/chapter5/groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace flextip::reproduction {
namespace {

constexpr double kFirmArm_N_m = 1e5;
constexpr ControllerKind kKinds[kThesisControllers] = {
    ControllerKind::kFlexTrack, ControllerKind::kStraightTrack, ControllerKind::kFlexCalculate,
    ControllerKind::kStraightCalculate};

TrialSetup Setup(ControllerKind kind) {
  TrialSetup setup;
  setup.kind = kind;
  return setup;
}

/// Latency: half an exposure, a frame to read out, 10 ms to find the tags.
TrialSetup Vision(ControllerKind kind, double rate_hz) {
  TrialSetup setup = Setup(kind);
  setup.sense = TipSense::kVision;
  setup.update_rate_hz = rate_hz;
  setup.vision_latency_s = rate_hz < 45.0 ? 0.050 : 0.030;
  setup.occlusions = true;
  return setup;
}

StudyGroup Full(const std::string& name, const TrialSetup& setup) {
  StudyGroup group{name, setup};
  group.outline = true;
  return group;
}

/// Half the operators, a third of a minute: for comparisons.
StudyGroup Short(const std::string& name, TrialSetup setup) {
  setup.seconds = 20.0;
  StudyGroup group{name, setup};
  group.operators = 5;
  return group;
}

void AddOurs(std::vector<StudyGroup>& groups) {
  TrialSetup blind = Setup(ControllerKind::kFlexCalculate);
  blind.chord_measured = false;
  groups.push_back(Full("Flex-Calculate by orientations", blind));
  groups.push_back(Full("Rod-Track", Setup(ControllerKind::kRodTrack)));
  groups.push_back(Full("Rod-Calculate", Setup(ControllerKind::kRodCalculate)));
  TrialSetup changed = Setup(ControllerKind::kRodTrack);
  changed.tissue_response = false;
  groups.push_back({"Rod-Track without tissue", changed});
  changed.tissue_response = true;
  changed.margin_sd = 3.0;
  groups.push_back({"Rod-Track with margin", changed});
  changed.margin_sd = 0.0;
  changed.level_tip = true;
  groups.push_back({"Rod-Track levelled", changed});
}

void AddVision(std::vector<StudyGroup>& groups) {
  const std::pair<const char*, ControllerKind> kinds[] = {
      {"Straight-Track", ControllerKind::kStraightTrack},
      {"Flex-Track", ControllerKind::kFlexTrack},
      {"Rod-Track", ControllerKind::kRodTrack}};
  for (const double rate : {60.0, 30.0}) {
    for (const auto& [name, kind] : kinds) {
      groups.push_back({fmt::format("{} vision {:.0f} Hz", name, rate), Vision(kind, rate)});
    }
  }
  for (const auto& [name, kind] : kinds) {
    if (kind == ControllerKind::kStraightTrack) continue;
    TrialSetup clear = Vision(kind, 30.0);
    clear.occlusions = false;
    groups.push_back({fmt::format("{} vision 30 Hz unhidden", name), clear});
  }
}

TrialSetup WithWrongData(TrialSetup setup) {
  setup.stiffness_error = -0.05;
  setup.length_error_m = 0.0005;
  setup.port_error_m = 0.001;
  return setup;
}

void AddWrongData(std::vector<StudyGroup>& groups) {
  const std::pair<const char*, ControllerKind> kinds[] = {
      {"Flex-Track", ControllerKind::kFlexTrack},
      {"Rod-Calculate", ControllerKind::kRodCalculate},
      {"Rod-Track", ControllerKind::kRodTrack}};
  for (const auto& [name, kind] : kinds) {
    groups.push_back(Short(fmt::format("{} wrong data", name), WithWrongData(Setup(kind))));
  }
  for (TrialSetup setup :
       {Setup(ControllerKind::kRodTrack), Vision(ControllerKind::kRodTrack, 30.0)}) {
    const char* sensor = setup.sense == TipSense::kVision ? " vision 30 Hz" : "";
    if (setup.sense == TipSense::kVision)
      groups.push_back(Short("Rod-Track vision 30 Hz wrong data", WithWrongData(setup)));
    setup.level_tip = true;
    groups.push_back(
        Short(fmt::format("Rod-Track levelled{} wrong data", sensor), WithWrongData(setup)));
  }
}

void AddVariations(std::vector<StudyGroup>& groups) {
  for (int i = 0; i < kThesisControllers; ++i) {
    const auto add = [&](const std::string& change, double TrialSetup::*what, double value) {
      TrialSetup setup = Setup(kKinds[i]);
      setup.*what = value;
      groups.push_back(Short(fmt::format("{} {}", ThesisName(i), change), setup));
    };
    for (const double scale : {0.5, 1.0, 2.0, 3.0}) {
      add(fmt::format("silicone x{}", scale), &TrialSetup::silicone_scale, scale);
    }
    if (UsesTipMeasurement(kKinds[i])) {
      add("soft arm", &TrialSetup::arm_stiffness_N_m, 300.0);
      add("firm arm", &TrialSetup::arm_stiffness_N_m, kFirmArm_N_m);
      add("less noise", &TrialSetup::em_position_noise_m, 1.3e-4 / std::sqrt(3.0));
      add("late", &TrialSetup::em_latency_s, 0.020);
    } else {
      add("EM off", &TrialSetup::em_offset_m, 0.002);
    }
  }
  TrialSetup firm = Setup(ControllerKind::kRodTrack);
  firm.arm_stiffness_N_m = kFirmArm_N_m;
  groups.push_back(Short("Rod-Track firm arm", firm));
  firm = Setup(ControllerKind::kRodTrack);
  firm.silicone_scale = 2.0;
  groups.push_back(Short("Rod-Track silicone x2", firm));
}

void AddCurve(std::vector<StudyGroup>& groups) {
  for (const auto& name : CurveControllers()) {
    for (const double rate : CurveRates()) {
      TrialSetup setup = Setup(name == "Straight-Track" ? ControllerKind::kStraightTrack
                               : name == "Flex-Track"   ? ControllerKind::kFlexTrack
                                                        : ControllerKind::kRodTrack);
      setup.tissue_response = name != "Rod-Track without tissue";
      setup.update_rate_hz = rate;
      setup.em_position_noise_m = 1e-6;  // what the rate does by itself: next to no noise, and an
      setup.em_orientation_noise_rad = 1e-5;  // arm that gives way to nothing
      setup.arm_stiffness_N_m = kFirmArm_N_m;
      setup.seconds = 10.0;
      StudyGroup group{CurveGroup(name, rate), setup};
      group.operators = 3;
      groups.push_back(group);
    }
  }
}

}  // namespace

const char* ThesisName(int condition) {
  constexpr const char* kNames[kThesisControllers] = {"Flex-Track", "Straight-Track",
                                                      "Flex-Calculate", "Straight-Calculate"};
  return kNames[condition];
}

const std::vector<double>& CurveRates() {
  static const std::vector<double> rates{36, 72, 144, 288, 576};
  return rates;
}

const std::vector<std::string>& CurveControllers() {
  static const std::vector<std::string> names{"Straight-Track", "Flex-Track",
                                              "Rod-Track without tissue", "Rod-Track"};
  return names;
}

std::string CurveGroup(const std::string& controller, double rate_hz) {
  return fmt::format("{} at {:.0f} Hz", controller, rate_hz);
}

std::vector<StudyGroup> StudyGroups(bool quick) {
  std::vector<StudyGroup> groups;
  for (int i = 0; i < kThesisControllers; ++i) {
    StudyGroup group = Full(ThesisName(i), Setup(kKinds[i]));
    group.position = i;
    group.keep_paths = true;
    groups.push_back(group);
  }
  AddOurs(groups);
  AddVision(groups);
  AddWrongData(groups);
  AddVariations(groups);
  AddCurve(groups);
  if (quick) {
    for (StudyGroup& group : groups) {
      group.operators = 2;
      group.setup.seconds = group.position >= 0 ? 6.0 : 3.0;
    }
  }
  return groups;
}

const GroupResult& Find(const std::vector<GroupResult>& results, const std::string& name) {
  const auto found = std::find_if(results.begin(), results.end(), [&](const GroupResult& result) {
    return result.group.name == name;
  });
  if (found == results.end()) throw WorkError(fmt::format("no group of trials \"{}\"", name));
  return *found;
}

}  // namespace flextip::reproduction
