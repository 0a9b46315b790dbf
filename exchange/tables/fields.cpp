#include "exchange/tables/fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "exchange/values/times.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

constexpr double kLargestValue = 1e20;  // NDI's trackers write -3.697314e28 for a lost tool

bool IsNumberOfAnySign(std::string_view field) {
  return ParseNumber(WithPoint(field, '.')) || ParseNumber(WithPoint(field, ','));
}

bool IsValue(std::string_view field) { return IsNumberOfAnySign(field) || ParseClock(field); }

}  // namespace

bool IsComment(std::string_view line) {
  line = Trim(line);
  return !line.empty() && (line.front() == '#' || line.front() == '%');
}

std::string WithPoint(std::string_view field, char decimal) {
  std::string text(Trim(field));
  if (decimal == ',') std::replace(text.begin(), text.end(), ',', '.');
  if (!text.empty() && text.front() == '+') text.erase(0, 1);
  return text;
}

bool HasDecimal(std::string_view field, char sign) {
  const auto digit = [&](std::size_t i) {
    return i < field.size() && field[i] >= '0' && field[i] <= '9';
  };
  const auto at = field.find(sign);
  return at != std::string_view::npos && at > 0 && digit(at - 1) && digit(at + 1) &&
         ParseNumber(WithPoint(field, sign));
}

bool HoldsSeveralNumbers(std::string_view field) {
  field = Trim(field);
  if (ParseClock(field)) return false;
  const auto blank = field.find_first_of(" \t;");
  if (blank == std::string_view::npos) return false;
  std::string_view rest = Trim(field.substr(blank + 1));
  rest = rest.substr(0, rest.find_first_of(" \t;"));
  return IsNumberOfAnySign(field.substr(0, blank)) && (rest.empty() || IsNumberOfAnySign(rest));
}

bool NamesColumns(const std::vector<std::string_view>& fields) {
  bool any = false;
  for (const auto field : fields) {
    if (IsValue(field)) return false;
    any = any || !Trim(field).empty();
  }
  return any;
}

std::optional<double> NumberOrMissing(const std::string& text) {
  static const std::set<std::string> kMissing{"",    "NA",   "N/A",  "#N/A", "NaN",     "NAN",
                                              "nan", "null", "NULL", "None", "MISSING", "-"};
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (kMissing.contains(text)) return kNaN;
  const auto number = ParseNumber(text);
  if (number && std::isfinite(*number) && std::abs(*number) > kLargestValue) return kNaN;
  return number;
}

}  // namespace flextip::exchange
