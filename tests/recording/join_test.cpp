// Stretches of one session as one recording.
#include "recording/join.h"

#include <gtest/gtest.h>

namespace flextip {
namespace {

constexpr TimeNs kPeriod_ns = 10'000'000;

// A wrist from `first` on, as places along x (mm), and an EM sensor that begins half a period
// before it.
Recording Stretch(TimeNs start_ns, int first, int count) {
  Recording recording;
  recording.wrist0.emplace();
  recording.em0.emplace();
  recording.em0->distance_from_tip_m = 0.02;
  for (int i = 0; i < count; ++i) {
    const TimeNs t_ns = start_ns + i * kPeriod_ns;
    recording.wrist0->samples.push_back({t_ns, {Eigen::Vector3d(1e-3 * (first + i), 0, 0), {}}});
    EmSample em;
    em.p_RS.x() = first + i;
    recording.em0->samples.push_back({t_ns - kPeriod_ns / 2, em});
  }
  recording.cam0.emplace().filenames.push_back({start_ns, "a.png"});
  return recording;
}

TEST(Join, GoesOnAfterAPeriod) {
  const Recording a = Stretch(1'000, 0, 50), b = Stretch(7'000'000'000, 50, 60);
  const Recording joined = Join({&a, &b}, 0.1);
  const auto& wrist = joined.wrist0->samples;
  ASSERT_EQ(wrist.size(), 110u);
  for (std::size_t i = 0; i < wrist.size(); ++i) {
    EXPECT_EQ(wrist[i].t_ns, 1'000 + TimeNs(i) * kPeriod_ns);
    EXPECT_DOUBLE_EQ(wrist[i].value.p_RW.x(), 1e-3 * double(i));
  }
  EXPECT_TRUE(joined.cam0.has_value());
  EXPECT_TRUE(joined.cam0->filenames.empty());
}

TEST(Join, LeavesOutWhatMayBeOfTheTimeBefore) {
  const Recording a = Stretch(0, 0, 50), b = Stretch(0, 50, 60);
  const Recording joined = Join({&a, &b}, 0.1);
  // Half a period before the wrist: its eleventh sample is the first that is 0.1 s after the end.
  const auto& em = joined.em0->samples;
  ASSERT_EQ(em.size(), 50u + 60u - 11u);
  EXPECT_EQ(em[49].value.p_RS.x(), 49);
  EXPECT_EQ(em[50].value.p_RS.x(), 61);
  EXPECT_EQ(em[50].t_ns, 61 * kPeriod_ns - kPeriod_ns / 2);
  EXPECT_EQ(joined.em0->distance_from_tip_m, 0.02);
}

TEST(Join, TakesUpASensorThatBeginsLater) {
  Recording a = Stretch(0, 0, 50);
  const Recording b = Stretch(0, 50, 60);
  a.em0.reset();
  const Recording joined = Join({&a, &b}, 0.0);
  ASSERT_TRUE(joined.em0.has_value());
  EXPECT_EQ(joined.em0->samples.size(), 59u);  // one lies before the stretch
}

TEST(Join, OfOneIsThatOne) {
  const Recording a = Stretch(0, 0, 50);
  const Recording joined = Join({&a});
  EXPECT_EQ(joined.wrist0->samples.size(), 50u);
  EXPECT_EQ(joined.em0->samples.size(), 50u);
}

}  // namespace
}  // namespace flextip
