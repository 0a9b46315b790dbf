#include "recording/join.h"

#include "core/check.h"
#include "recording/cut.h"

namespace flextip {
namespace {

// When a stretch goes on: all times are so much later, and from `begin_ns` on there is something.
struct Stretch {
  TimeNs later_ns, begin_ns;
};

template <class Stream, class T>
void Append(const std::optional<Stream>& from, const Stretch& at, Series<T> Stream::*series,
            std::optional<Stream>& to) {
  if (!from) return;
  if (!to) {
    to = from;
    ((*to).*series).clear();
  }
  Series<T>& samples = (*to).*series;
  for (Sample<T> sample : (*from).*series) {
    sample.t_ns += at.later_ns;
    const bool later = samples.empty() || sample.t_ns > samples.back().t_ns;
    if (later && sample.t_ns >= at.begin_ns) samples.push_back(sample);
  }
}

}  // namespace

Recording Join(const std::vector<const Recording*>& stretches, double settle_s) {
  FLEXTIP_CHECK(!stretches.empty() && stretches.front()->wrist0, "stretches have a wrist0");
  Recording joined = *stretches.front();
  DropFrames(joined);
  for (std::size_t i = 1; i < stretches.size(); ++i) {
    const Recording& next = *stretches[i];
    FLEXTIP_CHECK(next.wrist0 && next.wrist0->samples.size() > 1, "stretches have a wrist0");
    FLEXTIP_CHECK(!next.arm, "stretches are of a shaft");
    const Series<WristSample>& wrist = next.wrist0->samples;
    const TimeNs begin_ns = joined.wrist0->samples.back().t_ns + wrist[1].t_ns - wrist.front().t_ns;
    const Stretch at_once{begin_ns - wrist.front().t_ns, begin_ns};
    const Stretch settled{at_once.later_ns, begin_ns + static_cast<TimeNs>(1e9 * settle_s)};
    Append(next.wrist0, at_once, &WristStream::samples, joined.wrist0);
    Append(next.command0, at_once, &CommandStream::p_RW, joined.command0);
    Append(next.load0, at_once, &LoadStream::f_tip_N, joined.load0);
    Append(next.em0, settled, &EmStream::samples, joined.em0);
    Append(next.em1, settled, &EmStream::samples, joined.em1);
    Append(next.strain0, settled, &StrainStream::moments_Nm, joined.strain0);
    Append(next.vision0, settled, &VisionStream::tips, joined.vision0);
  }
  return joined;
}

}  // namespace flextip
