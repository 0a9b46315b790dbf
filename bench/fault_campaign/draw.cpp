#include "bench/fault_campaign/draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>

namespace flextip::bench {
namespace {

using simulation::Fault;
using simulation::FaultKind;
using simulation::FaultStream;

constexpr int kNoiseSeeds = 4;     // healthy runs of a base are shared by many faulted ones
constexpr int kPairsPerRound = 6;  // beside one of each single fault
constexpr std::array kDurations_s{0.1, 0.3, 1.0};
constexpr std::array kStarts{0.1, 0.3, 0.5, 0.65};

enum class Factor { kWhich, kSecond, kSize, kDuration, kStart, kMove, kFloor, kKind, kSuite };

/// Of each round through the values one permutation, by the factor's own seed: the values are even,
/// and factors have nothing to do with one another.
int Even(std::uint64_t seed, Factor factor, int number, int values) {
  const auto key =
      static_cast<std::uint64_t>(factor) << 32 | static_cast<std::uint64_t>(number / values);
  std::mt19937_64 rng(simulation::FaultSeed(seed, key));
  std::vector<int> order(static_cast<std::size_t>(values));
  std::iota(order.begin(), order.end(), 0);
  for (int i = values - 1; i > 0; --i) {  // std::shuffle is not the same in every library
    const auto j = static_cast<int>(rng() % static_cast<std::uint64_t>(i + 1));
    std::swap(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(j)]);
  }
  return order[static_cast<std::size_t>(number % values)];
}

std::vector<FaultChoice> MakeChoices() {
  using K = FaultKind;
  using S = FaultStream;
  std::vector<FaultChoice> all;
  for (const S stream : {S::kWrist, S::kTip, S::kEm0, S::kStrain, S::kLoad}) {
    const auto sized = [&](double strain, double load, const FaultChoice& places) {
      FaultChoice choice = places;
      const double unit = stream == S::kStrain ? strain : stream == S::kLoad ? load : 1.0;
      for (double& size : choice.sizes) size *= unit;
      all.push_back(choice);
    };
    all.push_back({K::kStuck, stream, {0, 0, 0, 0}});
    // In m; in Nm and N what a force of as many hundred newtons would give.
    sized(5.0, 100.0, {K::kSpike, stream, {0.002, 0.005, 0.02, 0.5}});
    sized(5.0, 100.0, {K::kSpikes, stream, {0.001, 0.005, 0.02, 0.5}});
    sized(5.0, 100.0, {K::kOffset, stream, {0.001, 0.004, 0.015, 0.2}});
    sized(5.0, 100.0, {K::kDrift, stream, {0.001, 0.004, 0.015, 0.1}});
    all.push_back({K::kScale, stream, {1.01, 1.05, 1.5, 10.0}});
    all.push_back({K::kSwappedAxes, stream, {0, 1, 2, 2}});
    all.push_back({K::kUnits, stream, {0.001, 1000.0, 0.001, 1000.0}});
    all.push_back({K::kNotFinite, stream, {0, 0, 0, 0}});
    all.push_back({K::kDelayed, stream, {0.035, 0.1, 0.3, 1.0}});
    all.push_back({K::kDropped, stream, {0.3, 0.6, 0.9, 1.0}});
    all.push_back({K::kRepeated, stream, {1, 3, 10, 30}});
    all.push_back({K::kOutOfOrder, stream, {1, 3, 10, 30}});
    all.push_back({K::kStampJump, stream, {-0.05, 0.05, -1.0, 1000.0}});
    all.push_back({K::kOtherClock, stream, {1.001, 1.05, 1.5, 0.0}});
  }
  const std::vector<FaultChoice> own{{K::kWrongTag, S::kTip, {0.003, 0.006, 0.012, 0.03}},
                                     {K::kSecondInstrument, S::kTip, {0.005, 0.02, 0.05, 0.2}},
                                     {K::kTagsCovered, S::kTip, {0, 0, 0, 0}},
                                     {K::kMetal, S::kEm0, {0.001, 0.004, 0.015, 0.05}},
                                     {K::kGageBroken, S::kStrain, {0.0, 0.1, 0.5, 10.0}},
                                     {K::kWristStands, S::kRobot, {0, 0, 0, 0}},
                                     {K::kEncoderSlip, S::kRobot, {0.0005, 0.002, 0.008, 0.03}},
                                     {K::kRobotRate, S::kRobot, {0.3, 0.1, 0.03, 0.01}},
                                     {K::kCommandsLost, S::kRobot, {0.2, 0.5, 0.9, 1.0}},
                                     {K::kCycleLate, S::kRobot, {0.02, 0.05, 0.2, 1.0}},
                                     {K::kPortMoved, S::kPlant, {0.002, 0.005, 0.010, 0.025}},
                                     {K::kTissueLetsGo, S::kPlant, {0.3, 0.6, 0.9, 1.0}},
                                     {K::kTipCaught, S::kPlant, {50, 200, 1000, 5000}},
                                     {K::kShaftGrasped, S::kPlant, {0.3, 1.0, 3.0, 8.0}}};
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

/// The suites that have the stream.
std::vector<Suite> SuitesWith(const std::vector<Fault>& faults) {
  std::vector<Suite> suites;
  for (int i = 0; i < kSuites; ++i) {
    const auto suite = static_cast<Suite>(i);
    if (std::all_of(faults.begin(), faults.end(),
                    [&](const Fault& fault) { return Has(suite, fault.stream); }))
      suites.push_back(suite);
  }
  return suites;
}

Fault Drawn(const FaultChoice& choice, int size, double duration_s) {
  return {choice.kind, choice.stream, 0.0, duration_s, choice.sizes[size]};
}

}  // namespace

const char* SizeName(int size) {
  constexpr std::array names{"subtle", "plain", "strong", "absurd"};
  return names[static_cast<std::size_t>(size)];
}

const std::vector<FaultChoice>& FaultChoices() {
  static const std::vector<FaultChoice> choices = MakeChoices();
  return choices;
}

bool Has(Suite suite, FaultStream stream) {
  if (stream == FaultStream::kEm0) return suite != Suite::kVision;
  if (stream == FaultStream::kStrain || stream == FaultStream::kLoad) return suite == Suite::kAll;
  return true;
}

std::string FaultRun::FaultText() const {
  std::string text;
  for (const Fault& fault : faults) {
    text += fmt::format("{}{} {}", text.empty() ? "" : " + ", simulation::Name(fault.kind),
                        simulation::Name(fault.stream));
  }
  return text;
}

FaultRun DrawRun(std::uint64_t seed, int number) {
  const std::vector<FaultChoice>& choices = FaultChoices();
  const auto singles = static_cast<int>(choices.size());
  const auto even = [&](Factor factor, int values) { return Even(seed, factor, number, values); };
  FaultRun run;
  run.number = number;
  run.size = even(Factor::kSize, kSizes);
  const double duration_s = kDurations_s[static_cast<std::size_t>(even(Factor::kDuration, 3))];
  const int which = even(Factor::kWhich, singles + kPairsPerRound);
  const auto second = static_cast<std::size_t>(even(Factor::kSecond, singles));
  const std::size_t first = which < singles
                                ? static_cast<std::size_t>(which)
                                : (second + 17 + static_cast<std::size_t>(which)) % choices.size();
  run.faults.push_back(Drawn(choices[first], run.size, duration_s));
  if (which >= singles) run.faults.push_back(Drawn(choices[second], run.size, duration_s));
  run.start_part = kStarts[static_cast<std::size_t>(even(Factor::kStart, 4))];
  run.base.move = static_cast<Move>(even(Factor::kMove, kMoves));
  run.base.fixture = even(Factor::kFloor, 2) == 1;
  run.base.controller = static_cast<ControllerKind>(even(Factor::kKind, kControllerKinds));
  const std::vector<Suite> suites = SuitesWith(run.faults);
  run.base.suite =
      suites[static_cast<std::size_t>(even(Factor::kSuite, static_cast<int>(suites.size())))];
  run.base.seed = simulation::FaultSeed(seed, static_cast<std::size_t>(number % kNoiseSeeds));
  return run;
}

void StartAt(double healthy_s, FaultRun& run) {
  // Every run at a moment of its own between two cycles.
  const double own = static_cast<double>(run.number % 97) / 97.0;
  run.faults.front().start_s = healthy_s * (run.start_part + 0.1 * own);
  for (std::size_t i = 1; i < run.faults.size(); ++i) {
    run.faults[i].start_s =
        run.faults.front().start_s + 0.5 * static_cast<double>(run.number % 89) / 89.0;
  }
}

}  // namespace flextip::bench
