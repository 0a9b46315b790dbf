// The four parts of a stop's picture.
#pragma once

#include <string>
#include <vector>

#include "report/figure.h"
#include "report/stops/table.h"

namespace flextip::report {

/// What the figures mark.
struct StopMarks {
  double at_s = 0.0;      ///< when the hold began
  double fault_s = 0.0;   ///< when it became a fault; 0: it did not
  double end_s = 0.0;     ///< of the last cycle held
  std::string odd = {};   ///< the sensor that does not fit; empty: none
  std::string name = {};  ///< of the figures: "stop1"
};

/// Returns how far the tips are apart over time, the tip's path from above its plane, chi-squared
/// over its limit, and a strip a sensor with one of the robot.
std::vector<Figure> StopFigures(const StopRows& rows, const StopMarks& marks);

}  // namespace flextip::report
