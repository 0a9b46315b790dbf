#include "exchange/formats/side_car.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "exchange/values/times.h"
#include "recording/text/bounds.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

using Json = nlohmann::json;

// Seconds as nanoseconds: a whole number of `per_second` is kept exactly.
TimeNs ToNs(const Json& number, TimeNs ns_per_unit) {
  const double t_ns = number.get<double>() * static_cast<double>(ns_per_unit);
  const std::string expected = ExpectedWithin(BoundsOf("_ns"), t_ns);
  if (!expected.empty()) {
    throw InputError(fmt::format("found the time {:.6g} ns, expected {}", t_ns, expected));
  }
  if (number.is_number_integer()) return number.get<TimeNs>() * ns_per_unit;
  return std::llround(number.get<double>() * static_cast<double>(ns_per_unit));
}

std::vector<TimeNs> ListedTimes(const Json& json) {
  struct Key {
    const char* name;
    TimeNs ns_per_unit;
  };
  for (const Key& key : {Key{"timestamps_ns", 1}, Key{"timestamps_ms", 1'000'000},
                         Key{"timestamps", 1'000'000'000}}) {
    if (!json.contains(key.name)) continue;
    std::vector<TimeNs> times;
    for (const Json& t : json.at(key.name)) times.push_back(ToNs(t, key.ns_per_unit));
    return times;
  }
  std::vector<TimeNs> times;
  for (const Json& frame : json.at("frames")) {
    times.push_back(ToNs(frame.at(frame.contains("cpu_ns") ? "cpu_ns" : "cpu_ts"), 1));
  }
  return times;
}

TimeNs StatedLatency(const Json& json) {
  if (json.contains("estimated_latency_ms")) {
    return ToNs(json.at("estimated_latency_ms"), 1'000'000);
  }
  return json.contains("estimated_latency") ? ToNs(json.at("estimated_latency"), 1'000'000'000) : 0;
}

}  // namespace

bool IsSideCar(const std::filesystem::path& file) { return file.extension() == ".json"; }

SideCar ReadSideCar(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& what) -> InputError {
    return InputError::At(file.string(), 0, what);
  };
  SideCar side_car;
  try {
    const Json json = Json::parse(ReadTextFile(file));
    side_car.t_ns = ListedTimes(json);
    side_car.latency_ns = StatedLatency(json);
    side_car.side_by_side = json.value("side_by_side", "");
  } catch (const Json::exception&) {
    throw refuse(
        "is no side-car of a video, expected JSON with timestamps_ns, or frames with "
        "cpu_ts");
  } catch (const InputError& error) {
    throw refuse(error.what());
  }
  if (side_car.side_by_side == "undefined") side_car.side_by_side.clear();
  if (side_car.t_ns.empty()) throw refuse("holds no times of frames");
  for (std::size_t i = 0; i < side_car.t_ns.size(); ++i) {
    const auto t_ns = WithOffset(side_car.t_ns[i], -side_car.latency_ns);
    if (!t_ns)
      throw refuse(fmt::format("the time of frame {} is beyond what a recording holds", i));
    side_car.t_ns[i] = *t_ns;
    if (i > 0 && side_car.t_ns[i] <= side_car.t_ns[i - 1]) {
      throw refuse(fmt::format("the times of frames {} and {} do not increase", i - 1, i));
    }
  }
  return side_car;
}

}  // namespace flextip::exchange
