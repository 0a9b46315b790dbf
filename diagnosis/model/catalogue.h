// Every effect the diagnosis knows (conventions: docs/method/diagnosis.md), one file each in
// effects/.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

std::unique_ptr<Effect> MakeStiffness();
std::unique_ptr<Effect> MakeLength();
std::unique_ptr<Effect> MakeSelfWeight();
std::unique_ptr<Effect> MakePrecurvature();
std::unique_ptr<Effect> MakePortOffset();
std::unique_ptr<Effect> MakePortMotion();
std::unique_ptr<Effect> MakePortCompliance();
std::unique_ptr<Effect> MakePortFriction();
std::unique_ptr<Effect> MakePortMoment();
std::unique_ptr<Effect> MakeShaftLoad();
std::unique_ptr<Effect> MakeWristCompliance();
std::unique_ptr<Effect> MakeTipCompliance();
std::unique_ptr<Effect> MakeBacklash();
std::unique_ptr<Effect> MakeEmDistortion();
std::unique_ptr<Effect> MakeEmLatency();
std::unique_ptr<Effect> MakeCameraLatency();
std::unique_ptr<Effect> MakeHandEye();
std::unique_ptr<Effect> MakeFocalLength();
std::unique_ptr<Effect> MakeTagOffset();
std::unique_ptr<Effect> MakeStrainGain();
std::unique_ptr<Effect> MakeStrainDrift();
std::unique_ptr<Effect> MakeGageRotation();
std::unique_ptr<Effect> MakeStrainCrosstalk();
std::unique_ptr<Effect> MakeWristScale();
std::unique_ptr<Effect> MakeEncoderEccentricity();
std::unique_ptr<Effect> MakeEmClock();
std::unique_ptr<Effect> MakeCameraClock();
std::unique_ptr<Effect> MakeLoadScale();
std::unique_ptr<Effect> MakeLoadRotation();
std::unique_ptr<Effect> MakeLensRadial();
std::unique_ptr<Effect> MakeCameraDrift();
std::unique_ptr<Effect> MakeEmInterference();

using Catalogue = std::vector<std::unique_ptr<Effect>>;

/// Returns the effects that `samples` could show, in the order of docs, without those named in
/// `without`. The objects are new: some hold values that a diagnosis finds on its way (a
/// frequency).
Catalogue MakeCatalogue(const SampleSet& samples, const std::vector<std::string>& without = {},
                        const EffectMakers& own = {});

/// Returns the effect of that name; null for an unknown name.
std::unique_ptr<Effect> MakeEffect(const std::string& name, const EffectMakers& own = {});

/// Throws InputError for a name in `without` that no effect has.
void RequireEffects(const std::vector<std::string>& without, const EffectMakers& own = {});

/// Returns the names of all effects, in the order of docs.
std::vector<std::string> EffectNames(const EffectMakers& own = {});

}  // namespace flextip::diagnosis
