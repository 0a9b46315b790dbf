#include "diagnosis/model/catalogue.h"

#include <algorithm>

namespace flextip::diagnosis {
namespace {

using Maker = std::unique_ptr<Effect> (*)();
constexpr Maker kMakers[] = {
    MakeStiffness,       MakeLength,         MakeSelfWeight,   MakePrecurvature, MakePortOffset,
    MakePortMotion,      MakePortCompliance, MakePortFriction, MakePortMoment,   MakeShaftLoad,
    MakeWristCompliance, MakeTipCompliance,  MakeBacklash,     MakeEmDistortion, MakeEmLatency,
    MakeCameraLatency,   MakeHandEye,        MakeFocalLength,  MakeTagOffset,    MakeStrainGain,
    MakeStrainDrift};

}  // namespace

Catalogue MakeCatalogue(const SampleSet& samples, const std::vector<std::string>& without) {
  Catalogue catalogue;
  for (const Maker make : kMakers) {
    auto effect = make();
    const bool wanted = std::find(without.begin(), without.end(), effect->Name()) == without.end();
    if (wanted && effect->Applies(samples)) catalogue.push_back(std::move(effect));
  }
  return catalogue;
}

std::unique_ptr<Effect> MakeEffect(const std::string& name) {
  for (const Maker make : kMakers) {
    auto effect = make();
    if (effect->Name() == name) return effect;
  }
  return nullptr;
}

}  // namespace flextip::diagnosis
