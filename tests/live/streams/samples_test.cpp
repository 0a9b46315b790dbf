// Messages that are sound on the wire and still no samples of their stream.
#include <gmock/gmock.h>

#include <limits>

#include "live/streams/streams.h"
#include "tests/live/session/sample_session.h"

namespace flextip::live {
namespace {

using testing::HasSubstr;

constexpr TimeNs kNow_ns = 1'700'000'000'000'000'000;
constexpr TimeNs kDay_ns = TimeNs{86'400} * 1'000'000'000;

std::string WhyNot(StreamName stream, decltype(WireMessage::body) body) {
  std::string why;
  EXPECT_FALSE(SampleIn(stream, {"d", kNow_ns, std::move(body)}, why));
  EXPECT_NE(why, "");
  return why;
}

WireTransform At(const Eigen::Vector3d& p) { return {{Eigen::Matrix3d::Identity(), p}}; }

WireNumbers Tip() { return {{100, 0, 200, 0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01, 1, 0, 0, 0.01}}; }

TEST(Samples, OfAnotherUnitAreRefusedWithTheirValues) {
  EXPECT_THAT(WhyNot(StreamName::kWrist, At({600, 0, 0})),
              HasSubstr("found a position of 600 m, expected at most 10 m"));
  EXPECT_THAT(WhyNot(StreamName::kEm0, At({0, 0, -245.7})), HasSubstr("245.7 m"));
  WireNumbers tip = Tip();
  tip.values[0] = 1e5;  // mm
  EXPECT_THAT(WhyNot(StreamName::kTip, tip), HasSubstr("found a position of 100"));
  EXPECT_THAT(WhyNot(StreamName::kStrain, WireNumbers{{800, 0, 0, 0}}), HasSubstr("800 N m"));
  EXPECT_THAT(WhyNot(StreamName::kLoad, WireNumbers{{0, 0, 5000}}), HasSubstr("5000 N"));
}

TEST(Samples, OfAnotherSizeOrKindAreRefused) {
  EXPECT_THAT(WhyNot(StreamName::kStrain, WireNumbers{{1, 2, 3}}),
              HasSubstr("found 3 numbers, expected 4"));
  EXPECT_THAT(WhyNot(StreamName::kTip, WireNumbers{{1, 2, 3}}), HasSubstr("expected 16"));
  EXPECT_THAT(WhyNot(StreamName::kWrist, WireNumbers{{1, 2, 3}}), HasSubstr("expected a pose"));
  EXPECT_THAT(WhyNot(StreamName::kLoad, At({0, 0, 0})), HasSubstr("expected numbers"));
  EXPECT_THAT(WhyNot(StreamName::kWrist, WireText{"x"}), HasSubstr("expected a pose"));
  WireTransform position = At({0, 0, 0});
  position.has_orientation = false;
  EXPECT_THAT(WhyNot(StreamName::kEm0, position), HasSubstr("no orientation"));
}

TEST(Samples, OfImpossibleNumbersAreRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(WhyNot(StreamName::kStrain, WireNumbers{{1, kNan, 3, 4}}), HasSubstr("found nan"));
  EXPECT_THAT(WhyNot(StreamName::kWrist, At({kNan, 0, 0})), HasSubstr("not finite"));
  WireTransform stretched = At({0, 0, 0});
  stretched.T_RD.R *= 1.1;
  EXPECT_THAT(WhyNot(StreamName::kWrist, stretched), HasSubstr("off a rotation by 0.21"));
  WireNumbers tip = Tip();
  tip.values[3] = -0.01;
  EXPECT_THAT(WhyNot(StreamName::kTip, tip), HasSubstr("eigenvalue -1e-08 m2"));
  tip = Tip();
  tip.values[12] = 2;
  EXPECT_THAT(WhyNot(StreamName::kTip, tip), HasSubstr("direction of length 2"));
}

TEST(Samples, OfAnotherDayAreNotTakenAndShutNobodyOut) {
  const Session session = ReadSession(WriteSession(SessionText()));
  Streams streams(session);
  const auto take = [&](TimeNs t_ns) {
    return streams.Take(StreamName::kWrist, {"PSM1/measured_cp", t_ns, At({0, 0, 0.3})}, kNow_ns);
  };
  EXPECT_THAT(take(kNow_ns - kDay_ns), HasSubstr("86400 s before this machine's"));
  EXPECT_THAT(take(kNow_ns + kDay_ns), HasSubstr("86400 s after this machine's"));
  EXPECT_FALSE(streams.Look().wrist.has_value());
  EXPECT_EQ(take(kNow_ns), "");
  EXPECT_TRUE(streams.Look().wrist.has_value());
  EXPECT_EQ(streams.Counts(StreamName::kWrist).unusable, 2);
}

}  // namespace
}  // namespace flextip::live
