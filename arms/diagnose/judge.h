// The answer on an arm in a sentence, with what to be careful of and the next step.
#pragma once

#include "arms/diagnose/diagnose.h"
#include "arms/diagnose/predict.h"
#include "core/judgement.h"

namespace flextip::arms {

Judgement JudgeArm(const ArmResult& result);
Judgement JudgeArmPrediction(const ArmPrediction& prediction);

}  // namespace flextip::arms
