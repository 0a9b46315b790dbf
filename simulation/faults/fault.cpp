#include "simulation/faults/fault.h"

#include <array>

namespace flextip::simulation {
namespace {

constexpr std::array<const char*, kFaultKinds> kKindNames{"stuck",
                                                          "spike",
                                                          "spikes",
                                                          "offset",
                                                          "drift",
                                                          "scale",
                                                          "swapped-axes",
                                                          "units",
                                                          "not-finite",
                                                          "delayed",
                                                          "dropped",
                                                          "repeated",
                                                          "out-of-order",
                                                          "stamp-jump",
                                                          "other-clock",
                                                          "wrong-tag",
                                                          "second-instrument",
                                                          "tags-covered",
                                                          "metal",
                                                          "gage-broken",
                                                          "wrist-stands",
                                                          "encoder-slip",
                                                          "robot-rate",
                                                          "commands-lost",
                                                          "cycle-late",
                                                          "port-moved",
                                                          "tissue-lets-go",
                                                          "tip-caught",
                                                          "shaft-grasped"};
constexpr std::array<const char*, kFaultStreams> kStreamNames{"wrist", "tip",   "em0",  "strain",
                                                              "load",  "robot", "plant"};

template <class Enum, std::size_t N>
std::optional<Enum> Named(const std::array<const char*, N>& names, std::string_view name) {
  for (std::size_t i = 0; i < N; ++i)
    if (names[i] == name) return static_cast<Enum>(i);
  return {};
}

}  // namespace

const char* Name(FaultKind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }
const char* Name(FaultStream stream) { return kStreamNames[static_cast<std::size_t>(stream)]; }

std::optional<FaultKind> FaultKindNamed(std::string_view name) {
  return Named<FaultKind>(kKindNames, name);
}
std::optional<FaultStream> FaultStreamNamed(std::string_view name) {
  return Named<FaultStream>(kStreamNames, name);
}

bool CanHave(FaultStream stream, FaultKind kind) {
  if (kind <= FaultKind::kOtherClock)
    return stream != FaultStream::kRobot && stream != FaultStream::kPlant;
  if (kind <= FaultKind::kTagsCovered) return stream == FaultStream::kTip;
  if (kind == FaultKind::kMetal) return stream == FaultStream::kEm0;
  if (kind == FaultKind::kGageBroken) return stream == FaultStream::kStrain;
  if (kind <= FaultKind::kCycleLate) return stream == FaultStream::kRobot;
  return stream == FaultStream::kPlant;
}

std::uint64_t FaultSeed(std::uint64_t seed, std::size_t fault) {
  // SplitMix64 (Steele et al. 2014): neighbouring seeds give numbers that have nothing in common.
  std::uint64_t z = seed + 0x9e3779b97f4a7c15u * (fault + 1);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

}  // namespace flextip::simulation
