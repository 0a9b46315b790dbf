// Which recordings the diagnosis's matrix is made of.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "testdata/hidden/recording.h"

namespace flextip::bench {

/// One recording and one diagnosis of it.
struct MatrixCase {
  std::string part;                  ///< one of MatrixParts()
  std::vector<std::string> effects;  ///< by name; empty: none, or `drawn`
  int drawn = 0;                     ///< effects drawn by the recording's seed
  std::string size = "any";          ///< subtle, plain, strong; any: without meaning
  bool load = true;                  ///< load0 is recorded
  std::string left_out;              ///< a sensor
  std::string without;               ///< an effect the diagnosis does not know
  std::string family = "tuning";     ///< family of motions
  double duration_s = 20.0;
  double noise_correlation = 0.0;  ///< AR(1) coefficient of the sensors' noise
  int index = 0;                   ///< within the cell
  std::uint64_t seed = 0;          ///< seed of the recording

  /// Everything above in one line: what resuming recognises a case by.
  std::string Key() const;
};

/// singles, healthy, pairs, triples, unknown, leave_sensor, leave_effect.
const std::vector<std::string>& MatrixParts();

struct MatrixPlan {
  std::vector<std::string> parts = {"singles", "healthy", "pairs", "unknown"};
  std::vector<std::string> sizes = {"plain"};
  std::vector<std::string> loads = {"known", "unknown"};
  std::vector<std::string> effects;  ///< for singles and leave-outs; empty: the whole catalogue
  int seeds_per_cell = 1;            ///< a cell: part, effect or form, size, load, left-out part
  int healthy = 10;                  ///< for each load
  int pairs = 5, triples = 5;        ///< for each load and size
  std::uint64_t first_seed = 1;
  std::string family = "tuning";
  double duration_s = 20.0;
  double noise_correlation = 0.0;  ///< AR(1) coefficient of the sensors' noise
};

/// Every case of the plan. A recording's seed follows from the first seed and the case's own key
/// without `without`, so that a part's cases do not depend on which other parts are asked for.
std::vector<MatrixCase> PlanMatrix(const MatrixPlan& plan);

/// What makes the recording.
hidden::HiddenOptions HiddenOptionsOf(const MatrixCase& one);

/// The call of flextip_make_hidden that makes the same recording.
std::string MakeHiddenCall(const MatrixCase& one);

}  // namespace flextip::bench
