#include "recording/cut.h"

#include <algorithm>

namespace flextip {
namespace {

template <class Stream, class T>
void CutStream(std::optional<Stream>& stream, Series<T> Stream::*series, TimeNs from_ns,
               TimeNs to_ns) {
  if (!stream) return;
  std::erase_if((*stream).*series,
                [&](const Sample<T>& s) { return s.t_ns < from_ns || s.t_ns > to_ns; });
  if (((*stream).*series).empty()) stream.reset();
}

}  // namespace

void DropFrames(Recording& recording) {
  for (std::optional<CameraStream>* camera : {&recording.cam0, &recording.cam1}) {
    if (!*camera) continue;
    (*camera)->video.clear();
    (*camera)->filenames.clear();
    (*camera)->frame_numbers.clear();
  }
}

Recording Cut(const Recording& recording, TimeNs from_ns, TimeNs to_ns) {
  Recording cut = recording;
  CutStream(cut.wrist0, &WristStream::samples, from_ns, to_ns);
  CutStream(cut.command0, &CommandStream::p_RW, from_ns, to_ns);
  CutStream(cut.em0, &EmStream::samples, from_ns, to_ns);
  CutStream(cut.em1, &EmStream::samples, from_ns, to_ns);
  CutStream(cut.strain0, &StrainStream::moments_Nm, from_ns, to_ns);
  CutStream(cut.load0, &LoadStream::f_tip_N, from_ns, to_ns);
  CutStream(cut.vision0, &VisionStream::tips, from_ns, to_ns);
  CutStream(cut.joints0, &JointStream::q, from_ns, to_ns);
  CutStream(cut.joints_command0, &JointStream::q, from_ns, to_ns);
  CutStream(cut.joints_seen0, &JointStream::q, from_ns, to_ns);
  CutStream(cut.torque0, &TorqueStream::tau, from_ns, to_ns);
  CutStream(cut.pose0, &PoseStream::samples, from_ns, to_ns);
  DropFrames(cut);
  return cut;
}

}  // namespace flextip
