#include "live/serve/shift_times.h"

namespace flextip::live {
namespace {

template <class T>
void Shift(TimeNs offset_ns, Series<T>& series) {
  for (auto& sample : series) sample.t_ns += offset_ns;
}

}  // namespace

void ShiftTimes(TimeNs offset_ns, Recording& recording, Series<TruthSample>& truth) {
  if (recording.wrist0) Shift(offset_ns, recording.wrist0->samples);
  if (recording.command0) Shift(offset_ns, recording.command0->p_RW);
  if (recording.em0) Shift(offset_ns, recording.em0->samples);
  if (recording.em1) Shift(offset_ns, recording.em1->samples);
  if (recording.strain0) Shift(offset_ns, recording.strain0->moments_Nm);
  if (recording.load0) Shift(offset_ns, recording.load0->f_tip_N);
  if (recording.vision0) Shift(offset_ns, recording.vision0->tips);
  Shift(offset_ns, truth);
}

}  // namespace flextip::live
