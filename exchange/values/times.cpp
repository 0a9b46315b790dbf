#include "exchange/values/times.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/median.h"
#include "recording/streams/series_file.h"
#include "recording/text/bounds.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

constexpr TimeNs kNsPerSecond = 1'000'000'000;
constexpr TimeNs kDay_ns = 24 * 3600 * kNsPerSecond;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

int DigitsOf(const std::string& unit) {
  if (unit == "s") return 9;
  if (unit == "ms") return 6;
  return unit == "us" ? 3 : 0;
}

// Takes digits from the front of `text`.
std::string_view TakeDigits(std::string_view& text) {
  std::size_t n = 0;
  while (n < text.size() && IsDigit(text[n])) ++n;
  const std::string_view digits = text.substr(0, n);
  text.remove_prefix(n);
  return digits;
}

bool Take(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

// `digits` times ten to the `shift`, rounded half up.
std::optional<TimeNs> Shifted(std::string digits, long shift) {
  bool up = false;
  if (shift >= 0) {
    if (shift > 20) return {};
    digits.append(static_cast<std::size_t>(shift), '0');
  } else {
    const auto cut = static_cast<std::size_t>(-shift);
    if (cut > digits.size()) return 0;
    up = digits[digits.size() - cut] >= '5';
    digits.erase(digits.size() - cut);
  }
  digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size()));
  if (digits.empty()) return up ? 1 : 0;
  const auto value = ParseInteger(digits);
  if (!value || *value == std::numeric_limits<TimeNs>::max()) return {};
  return *value + (up ? 1 : 0);
}

// A number of exactly so many digits.
std::optional<int> TakeNumber(std::string_view& text, std::size_t digits) {
  const std::string_view taken = TakeDigits(text);
  if (taken.size() != digits) return {};
  return static_cast<int>(*ParseInteger(taken));
}

// HH:MM:SS[.fraction]
std::optional<TimeNs> TakeTimeOfDay(std::string_view& text) {
  const auto hour = TakeNumber(text, 2);
  if (!hour || *hour > 23 || !Take(text, ":")) return {};
  const auto minute = TakeNumber(text, 2);
  if (!minute || *minute > 59 || !Take(text, ":")) return {};
  const auto second = TakeNumber(text, 2);
  if (!second || *second > 60) return {};
  TimeNs t_ns = (*hour * 3600LL + *minute * 60LL + *second) * kNsPerSecond;
  if (Take(text, ".,")) {
    const std::string_view fraction = TakeDigits(text);
    if (fraction.empty()) return {};
    t_ns += *Shifted(std::string(fraction), 9 - static_cast<long>(fraction.size()));
  }
  return t_ns;
}

// Z or +02:00, +0200, +02: the nanoseconds that the clock is ahead.
std::optional<TimeNs> TakeZone(std::string_view& text) {
  if (Take(text, "Zz")) return 0;
  const TimeNs sign = !text.empty() && text.front() == '-' ? -1 : 1;
  if (!Take(text, "+-")) return {};
  std::string digits(TakeDigits(text));
  if (digits.size() == 2 && Take(text, ":")) {
    const std::string_view minutes = TakeDigits(text);
    if (minutes.size() != 2) return {};
    digits += minutes;
  }
  if (digits.size() == 2) digits += "00";
  if (digits.size() != 4) return {};
  const TimeNs number = *ParseInteger(digits);
  return sign * (number / 100 * 3600 + number % 100 * 60) * kNsPerSecond;
}

// YYYY-MM-DD: nanoseconds since 1970.
std::optional<TimeNs> TakeDate(std::string_view& text) {
  const auto year = TakeNumber(text, 4);
  if (!year || !Take(text, "-/")) return {};
  const auto month = TakeNumber(text, 2);
  if (!month || !Take(text, "-/")) return {};
  const auto day = TakeNumber(text, 2);
  if (!day) return {};
  const std::chrono::year_month_day date{std::chrono::year(*year),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok() || *year < 1900 || *year > 2200) return {};
  return std::chrono::sys_days(date).time_since_epoch().count() * TimeNs{86400} * kNsPerSecond;
}

}  // namespace

std::optional<TimeNs> DecimalTime(std::string_view text, const std::string& unit) {
  text = Trim(text);
  const bool negative = !text.empty() && text.front() == '-';
  (void)Take(text, "+-");
  std::string digits(TakeDigits(text));
  long fraction = 0;
  if (Take(text, ".")) {
    const std::string_view more = TakeDigits(text);
    digits += more;
    fraction = static_cast<long>(more.size());
  }
  if (digits.empty()) return {};
  long exponent = 0;
  if (Take(text, "eE")) {
    (void)(!text.empty() && text.front() == '+' && Take(text, "+"));
    const auto value = ParseInteger(text);
    if (!value || std::abs(*value) > 100) return {};
    exponent = static_cast<long>(*value);
    text = {};
  }
  if (!text.empty()) return {};
  const auto t_ns = Shifted(std::move(digits), DigitsOf(unit) - fraction + exponent);
  if (!t_ns) return {};
  return negative ? -*t_ns : *t_ns;
}

std::optional<ClockTime> ParseClock(std::string_view text) {
  text = Trim(text);
  ClockTime time;
  if (text.size() > 4 && !IsDigit(text[4]) && text[2] != ':') {
    const auto date = TakeDate(text);
    if (!date || !Take(text, "Tt ")) return {};
    time.t_ns = *date;
    time.has_date = true;
  }
  const auto of_day = TakeTimeOfDay(text);
  if (!of_day) return {};
  time.t_ns += *of_day;
  text = Trim(text);
  if (text.empty()) return time;
  const auto ahead = TakeZone(text);
  if (!ahead || !text.empty()) return {};
  time.t_ns -= *ahead;
  time.has_zone = true;
  return time;
}

std::optional<TimeNs> ParseTime(std::string_view text, const std::string& unit) {
  if (unit != "clock") return DecimalTime(text, unit);
  const auto time = ParseClock(text);
  if (!time) return {};
  return time->t_ns;
}

std::optional<TimeNs> WithOffset(TimeNs t_ns, TimeNs offset_ns) {
  TimeNs sum = 0;
  if (__builtin_add_overflow(t_ns, offset_ns, &sum)) return {};
  if (!ExpectedWithin(BoundsOf("_ns"), static_cast<double>(sum)).empty()) return {};
  return sum;
}

void RefuseLeaps(const std::string& whose, const std::vector<TimeNs>& times) {
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] - times[i - 1] <= kLongestGap_ns) continue;
    throw InputError(
        fmt::format("{} {} and {} are {:.3g} days apart, expected at most {}", whose, i, i + 1,
                    static_cast<double>(times[i] - times[i - 1]) / static_cast<double>(kDay_ns),
                    kLongestGap_ns / kDay_ns));
  }
}

std::string SecondsText(TimeNs t_ns) {
  const bool negative = t_ns < 0;
  const auto size =
      negative ? 0ULL - static_cast<std::uint64_t>(t_ns) : static_cast<std::uint64_t>(t_ns);
  std::string text = fmt::format("{}.{:09}", size / 1'000'000'000ULL, size % 1'000'000'000ULL);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  if (negative) text.insert(text.begin(), '-');
  return text;
}

TimeUnitGuess GuessTimeUnit(const std::vector<std::string>& times) {
  if (times.empty()) return {};
  if (ParseClock(times.front())) return {"clock", "clock texts"};
  std::vector<double> steps;
  std::optional<double> last;
  for (const std::string& text : times) {
    const auto t = ParseNumber(text);
    if (t && last && *t != *last) steps.push_back(std::abs(*t - *last));
    if (t) last = t;
  }
  const auto first = ParseNumber(times.front());
  if (!first) return {};
  const double size = std::abs(*first);
  const auto since_1970 = [&](const char* unit) {
    return TimeUnitGuess{unit, fmt::format("{} as a time since 1970", times.front())};
  };
  if (size >= 5e8 && size < 5e9) return since_1970("s");
  if (size >= 5e11 && size < 5e12) return since_1970("ms");
  if (size >= 5e14 && size < 5e15) return since_1970("us");
  if (size >= 5e17 && size < 5e18) return since_1970("ns");
  if (steps.empty()) return {};
  const double step = Median(steps);
  // Steps of 1 ms to 1 s, the rates of laboratories; steps of 1 could be either, or row numbers.
  for (const double either : {1.0, 1e3, 1e6}) {
    if (std::abs(step / either - 1.0) < 0.05) return {};
  }
  const char* unit = step < 1.0 ? "s" : step < 1e3 ? "ms" : step < 1e6 ? "us" : "ns";
  return {unit, fmt::format("steps of {:.6g} between times", step)};
}

}  // namespace flextip::exchange
