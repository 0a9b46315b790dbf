#include "diagnosis/model/catalogue.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/check.h"
#include "core/error.h"

namespace flextip::diagnosis {
namespace {

constexpr std::unique_ptr<Effect> (*kMakers[])() = {MakeStiffness,
                                                    MakeLength,
                                                    MakeSelfWeight,
                                                    MakePrecurvature,
                                                    MakePortOffset,
                                                    MakePortMotion,
                                                    MakePortCompliance,
                                                    MakePortFriction,
                                                    MakePortMoment,
                                                    MakeShaftLoad,
                                                    MakeWristCompliance,
                                                    MakeTipCompliance,
                                                    MakeBacklash,
                                                    MakeEmDistortion,
                                                    MakeEmLatency,
                                                    MakeCameraLatency,
                                                    MakeHandEye,
                                                    MakeFocalLength,
                                                    MakeTagOffset,
                                                    MakeStrainGain,
                                                    MakeStrainDrift,
                                                    MakeGageRotation,
                                                    MakeStrainCrosstalk,
                                                    MakeWristScale,
                                                    MakeEncoderEccentricity,
                                                    MakeEmClock,
                                                    MakeCameraClock,
                                                    MakeLoadScale,
                                                    MakeLoadRotation,
                                                    MakeLensRadial,
                                                    MakeCameraDrift,
                                                    MakeEmInterference};

/// Returns new effects: those of the catalogue, then those of `own`.
Catalogue AllEffects(const EffectMakers& own) {
  Catalogue all;
  for (const auto make : kMakers) all.push_back(make());
  for (const EffectMaker& make : own) {
    auto effect = make();
    FLEXTIP_CHECK(effect != nullptr, "a maker returns an effect");
    const std::string name = effect->Name();
    for (const auto& other : all)
      FLEXTIP_CHECK(other->Name() != name, "an own effect has a name of its own");
    all.push_back(std::move(effect));
  }
  return all;
}

}  // namespace

Catalogue MakeCatalogue(const SampleSet& samples, const std::vector<std::string>& without,
                        const EffectMakers& own) {
  Catalogue catalogue;
  for (auto& effect : AllEffects(own)) {
    const bool wanted = std::find(without.begin(), without.end(), effect->Name()) == without.end();
    if (wanted && effect->Applies(samples)) catalogue.push_back(std::move(effect));
  }
  return catalogue;
}

std::unique_ptr<Effect> MakeEffect(const std::string& name, const EffectMakers& own) {
  for (auto& effect : AllEffects(own))
    if (effect->Name() == name) return std::move(effect);
  return nullptr;
}

void RequireEffects(const std::vector<std::string>& without, const EffectMakers& own) {
  for (const std::string& effect : without) {
    if (MakeEffect(effect, own)) continue;
    throw InputError(
        fmt::format("{}, to be left out: no effect of that name is in the catalogue", effect));
  }
}

std::vector<std::string> EffectNames(const EffectMakers& own) {
  std::vector<std::string> names;
  for (const auto& effect : AllEffects(own)) names.push_back(effect->Name());
  return names;
}

}  // namespace flextip::diagnosis
