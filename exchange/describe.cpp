#include "exchange/describe.h"
#include "exchange/list_text.h"

#include <fmt/format.h>

namespace flextip::exchange {
namespace {

std::string TurnText(const Eigen::Quaterniond& q) {
  return fmt::format(", w x y z {:.6g}, {:.6g}, {:.6g}, {:.6g}", q.w(), q.x(), q.y(), q.z());
}

std::string WristText(const WristSample& s) {
  return VectorText(s.p_RW) + " m" + (s.q_RW ? TurnText(*s.q_RW) : ", orientation not measured");
}

std::string EmText(const EmSample& s) { return VectorText(s.p_RS) + " m" + TurnText(s.q_RS); }

template <class T, class Function>
void Describe(const std::string& name, double rate_hz, const Series<T>& series, Function text,
              std::vector<StreamLine>& lines) {
  if (series.empty()) return;
  lines.push_back({name, series.size(), series.front().t_ns, series.back().t_ns, rate_hz,
                   text(series.front().value)});
}

void DescribeCamera(const std::string& name, const std::optional<CameraStream>& camera,
                    std::vector<StreamLine>& lines) {
  if (!camera) return;
  const double rate_hz = camera->calibration.rate_hz;
  Describe(
      name, rate_hz, camera->frame_numbers,
      [](int frame) { return fmt::format("frame {}", frame); }, lines);
  Describe(
      name, rate_hz, camera->filenames, [](const std::string& file) { return file; }, lines);
}

}  // namespace

std::string VectorText(const Eigen::VectorXd& v) {
  std::string text;
  for (const double value : v) AppendItem(text, fmt::format("{:.6g}", value));
  return text;
}

std::vector<StreamLine> DescribeStreams(const Recording& r) {
  std::vector<StreamLine> lines;
  const auto in = [](const char* unit) {
    return [unit](const auto& v) { return VectorText(v) + unit; };
  };
  if (r.wrist0) Describe("wrist0", r.wrist0->rate_hz, r.wrist0->samples, WristText, lines);
  if (r.command0) Describe("command0", r.command0->rate_hz, r.command0->p_RW, in(" m"), lines);
  if (r.em0) Describe("em0", r.em0->rate_hz, r.em0->samples, EmText, lines);
  if (r.em1) Describe("em1", r.em1->rate_hz, r.em1->samples, EmText, lines);
  if (r.strain0) Describe("strain0", r.strain0->rate_hz, r.strain0->moments_Nm, in(" Nm"), lines);
  if (r.load0) Describe("load0", r.load0->rate_hz, r.load0->f_tip_N, in(" N"), lines);
  DescribeCamera("cam0", r.cam0, lines);
  DescribeCamera("cam1", r.cam1, lines);
  return lines;
}

}  // namespace flextip::exchange
