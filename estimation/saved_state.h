// Measurements and models as parts of a saved state (core/state_text.h).
#pragma once

#include "core/state_text.h"
#include "estimation/measurements.h"
#include "estimation/shaft_change.h"
#include "estimation/shaft_model.h"
#include "estimation/shaft_rod.h"

namespace flextip {

void VisitState(TipObservation& tip, StateText& state);
void VisitState(EmMeasurement& em, StateText& state);
void VisitState(StrainMeasurement& strain, StateText& state);
void VisitState(LoadMeasurement& load, StateText& state);
void VisitState(Measurements& measurements, StateText& state);
void VisitState(ShaftProblem& problem, StateText& state);
void VisitState(ShaftChange& change, StateText& state);
void VisitState(ShaftModel& model, StateText& state);

}  // namespace flextip
