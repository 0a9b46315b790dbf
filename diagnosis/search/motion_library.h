// Motions that a user could make to tell effects apart: imagined recordings with the sensors of a
// real one.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "diagnosis/samples/sample_set.h"

namespace flextip::diagnosis {

struct LibraryMotion {
  std::string text;                       ///< what to do, for a person
  SampleSet samples;                      ///< imagined (planning/imagined_samples.h)
  std::vector<Eigen::Vector3d> places_m;  ///< of the straight shaft's tip in R, ten a second
  double load_N = 0.0;                    ///< hung from the tip
};

/// Some thirty motions about the port of `recorded`, 20 s each: insertions, sweeps, circles, slow
/// and fast, with and without a mass hung from the tip or a roll of the instrument.
std::vector<LibraryMotion> MotionLibrary(const SampleSet& recorded);

}  // namespace flextip::diagnosis
