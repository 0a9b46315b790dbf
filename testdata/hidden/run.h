// The plant's run along a hidden recording's motion.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "simulation/plant/plant.h"
#include "testdata/hidden/forms.h"
#include "testdata/hidden/recording.h"

namespace flextip::hidden {

/// What the plant was at every tick, from a lead-in before the recording on.
struct Run {
  std::vector<double> t_s;
  std::vector<simulation::PlantShape> shapes;
};

/// Empty where the plant loses its equilibrium, or bends as no instrument is bent.
std::optional<Run> RunPlant(const HiddenScene& scene, const simulation::PlantEffects& effects,
                            const std::vector<HiddenForm>& forms, const HiddenOptions& options);

/// The middle of the places where the EM sensor was while it was recorded.
Eigen::Vector3d EmCentre(const Run& run, const EmStream& em);

/// The largest moment at the gages, about one axis.
double HighestMoment(const Run& run, const StrainStream& strain);

}  // namespace flextip::hidden
