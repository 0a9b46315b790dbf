// Times as whole nanoseconds.
#include "exchange/values/times.h"

#include <gmock/gmock.h>

#include "exchange/values/units.h"

namespace flextip::exchange {
namespace {

using testing::Eq;
using testing::Optional;

TEST(DecimalTime, IsExactWhereADoubleIsNot) {
  EXPECT_THAT(DecimalTime("1700000000.123456789", "s"), Optional(Eq(1700000000123456789)));
  EXPECT_THAT(DecimalTime("1700000000123.456789", "ms"), Optional(Eq(1700000000123456789)));
  EXPECT_THAT(DecimalTime("1700000000123456.789", "us"), Optional(Eq(1700000000123456789)));
  EXPECT_THAT(DecimalTime("1700000000123456789", "ns"), Optional(Eq(1700000000123456789)));
  EXPECT_THAT(DecimalTime("1.700000000123456789e9", "s"), Optional(Eq(1700000000123456789)));
  EXPECT_THAT(DecimalTime("1.7E+18", "ns"), Optional(Eq(1700000000000000000)));
}

TEST(DecimalTime, IsRoundedToTheNearest) {
  EXPECT_THAT(DecimalTime("0.0000000014", "s"), Optional(Eq(1)));
  EXPECT_THAT(DecimalTime("0.0000000015", "s"), Optional(Eq(2)));
  EXPECT_THAT(DecimalTime("-0.0000000016", "s"), Optional(Eq(-2)));
  EXPECT_THAT(DecimalTime("0.9999999999", "s"), Optional(Eq(1'000'000'000)));
  EXPECT_THAT(DecimalTime("1e-12", "s"), Optional(Eq(0)));
  EXPECT_THAT(DecimalTime("+.5", "s"), Optional(Eq(500'000'000)));
}

TEST(DecimalTime, RefusesWhatIsNone) {
  for (const char* text : {"", "-", "1.2.3", "1 2", "abc", "1e", "99999999999999999999", "nan"}) {
    EXPECT_EQ(DecimalTime(text, "s"), std::nullopt) << text;
  }
}

TEST(Clock, TakesIso8601) {
  const TimeNs noon = 1'714'564'800'000'000'000;  // 2024-05-01T12:00:00Z
  for (const char* text :
       {"2024-05-01T12:00:00Z", "2024-05-01 12:00:00", "2024/05/01 12:00:00.000",
        "2024-05-01T14:00:00+02:00", "2024-05-01T07:30:00-0430", "2024-05-01T12:00:00,0Z"}) {
    const auto time = ParseClock(text);
    ASSERT_TRUE(time) << text;
    EXPECT_EQ(time->t_ns, noon) << text;
    EXPECT_TRUE(time->has_date) << text;
  }
  EXPECT_EQ(ParseClock("2024-05-01T12:00:00.123")->t_ns, noon + 123'000'000);
  EXPECT_EQ(ParseClock("2024-05-01T12:00:00.123456789")->t_ns, noon + 123'456'789);
  EXPECT_EQ(ParseClock("00:00:01.5")->t_ns, 1'500'000'000);
  EXPECT_FALSE(ParseClock("00:00:01.5")->has_date);
}

TEST(Clock, RefusesWhatIsNone) {
  for (const char* text :
       {"2024-13-01T12:00:00", "2024-02-30T12:00:00", "2024-05-01", "2024-05-01T25:00:00",
        "12:61:00", "1700000000", "12:00", "0.5", "2024-05-01T12:00:00 noon"}) {
    EXPECT_FALSE(ParseClock(text)) << text;
  }
}

TEST(SecondsText, IsExact) {
  for (const TimeNs t :
       {TimeNs{0}, TimeNs{12'300'000'000}, TimeNs{-1}, TimeNs{1'700'000'000'123'456'789}}) {
    EXPECT_THAT(DecimalTime(SecondsText(t), "s"), Optional(Eq(t)));
  }
  EXPECT_EQ(SecondsText(12'300'000'000), "12.3");
  EXPECT_EQ(SecondsText(-500'000'000), "-0.5");
}

TEST(TimeUnit, IsGuessedByEpochAndSteps) {
  EXPECT_EQ(GuessTimeUnit({"1700000000.1", "1700000000.12"}).unit, "s");
  EXPECT_EQ(GuessTimeUnit({"1700000000100", "1700000000120"}).unit, "ms");
  EXPECT_EQ(GuessTimeUnit({"1700000000100000", "1700000000120000"}).unit, "us");
  EXPECT_EQ(GuessTimeUnit({"1700000000100000000", "1700000000120000000"}).unit, "ns");
  EXPECT_EQ(GuessTimeUnit({"0", "0.02", "0.04"}).unit, "s");
  EXPECT_EQ(GuessTimeUnit({"0", "20", "40.1"}).unit, "ms");
  EXPECT_EQ(GuessTimeUnit({"0", "20000", "40000"}).unit, "us");
  EXPECT_EQ(GuessTimeUnit({"0", "20000000", "40000000"}).unit, "ns");
  EXPECT_EQ(GuessTimeUnit({"2024-05-01T12:00:00"}).unit, "clock");
  EXPECT_EQ(GuessTimeUnit({"1", "2", "3", "4"}).unit, "");  // rows, seconds or milliseconds
  EXPECT_EQ(GuessTimeUnit({"5"}).unit, "");
}

TEST(Units, AreOfAKind) {
  EXPECT_EQ(ParseUnit("mm")->ToSi(1234.5), 1.2345);
  EXPECT_EQ(ParseUnit("Nm", "moment")->ToSi(2.0), 2.0);
  EXPECT_EQ(ParseUnit("Ncm", "moment")->ToSi(200.0), 2.0);
  EXPECT_EQ(ParseUnit("mN")->ToSi(3.0), 0.003);
  EXPECT_NEAR(ParseUnit("deg")->ToSi(180.0), 3.14159265358979, 1e-14);
  EXPECT_FALSE(ParseUnit("mm", "angle"));
  EXPECT_FALSE(ParseUnit("furlong"));
}

}  // namespace
}  // namespace flextip::exchange
