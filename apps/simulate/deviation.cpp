#include "apps/simulate/deviation.h"

#include "recording/text/csv.h"
#include "recording/text/text.h"

namespace flextip {

void WriteDeviation(const std::filesystem::path& file, const simulation::LoopResult& result) {
  CsvWriter csv({"timestamp [ns]", "p_desired_x [m]", "p_desired_y [m]", "p_desired_z [m]",
                 "p_RE_x [m]", "p_RE_y [m]", "p_RE_z [m]", "deviation [m]"});
  for (const simulation::LoopUpdate& update : result.updates) {
    csv.Add(update.t_ns);
    for (int i = 0; i < 3; ++i) csv.Add(update.p_RE_desired[i]);
    for (int i = 0; i < 3; ++i) csv.Add(update.p_RE[i]);
    csv.Add(update.deviation_m);
    csv.EndRow();
  }
  WriteTextFile(file, csv.text());
}

}  // namespace flextip
