#include "recording/truth.h"

#include "recording/streams/sensor_head.h"
#include "recording/streams/series_file.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

const std::vector<std::string> kColumns = {"p_RE_x [m]", "p_RE_y [m]", "p_RE_z [m]", "q_RE_w []",
                                           "q_RE_x []",  "q_RE_y []",  "q_RE_z []",  "p_RW_x [m]",
                                           "p_RW_y [m]", "p_RW_z [m]"};

}  // namespace

std::optional<Series<TruthSample>> ReadTruth(const std::filesystem::path& recording) {
  const auto folder = recording / "truth0";
  if (!std::filesystem::exists(folder)) return {};
  ReadLog log;
  return ReadSeries<TruthSample>(folder / "data.csv", kColumns, log, [](const CsvReader& csv) {
    return TruthSample{ReadVector3(csv, 1), ReadQuaternion(csv, 4), ReadVector3(csv, 8)};
  });
}

void WriteTruth(const std::filesystem::path& recording, const Series<TruthSample>& truth) {
  const auto folder = recording / "truth0";
  WriteSeries(folder / "data.csv", kColumns, truth, [](CsvWriter& csv, const TruthSample& sample) {
    AddVector3(csv, sample.p_RE);
    AddQuaternion(csv, sample.q_RE);
    AddVector3(csv, sample.p_RW);
  });
  const double span_s =
      truth.size() > 1 ? 1e-9 * static_cast<double>(truth.back().t_ns - truth.front().t_ns) : 1.0;
  const double rate_hz = truth.size() > 1 ? static_cast<double>(truth.size() - 1) / span_s : 1.0;
  WriteTextFile(folder / "sensor.yaml",
                HeadText("truth", "the simulation's truth, for scoring only", rate_hz));
}

}  // namespace flextip
