#include "recording/text/bounds.h"

#include <fmt/format.h>

#include <cmath>

namespace flextip {
namespace {

struct Quantity {
  std::string_view ending;
  Bounds bounds;
};

// The longest ending that fits counts. A length of 1e4 is the longest shaft in millimetres, a place
// of 1e5 a hall in millimetres, a noise of 1e3 a bad tracker's in micrometres.
constexpr Quantity kQuantities[] = {
    {"length_m", {1e4, 1e-4, "m"}},
    {"diameter_m", {1e4, 1e-6, "m"}},
    {"noise_m", {1e3, 1e-12, "m"}},
    {"registration_m", {1e3, 1e-12, "m"}},
    {"noise_rad", {1e3, 1e-12, "rad"}},
    {"noise_N", {1e5, 1e-12, "N"}},
    {"noise_Nm", {1e4, 1e-15, "N m"}},
    {"spacing_m", {1e4, 1e-6, "m"}},
    {"speed_m_s", {1e4, 1e-6, "m/s"}},
    {"origin_s", {1e10, 1e-9, "s"}},
    {"offset_s", {1e10, 1e-9, "s"}},
    {"frequency_hz", {1e5, 1e-6, "Hz"}},
    {"_m", {1e5, 1e-9, "m"}},
    {"_mm", {1e8, 1e-6, "mm"}},
    {"_m2", {1e10, 1e-24, "m2"}},
    {"_m_s", {1e4, 1e-9, "m/s"}},
    {"_m_s2", {1e5, 1e-6, "m/s2"}},
    {"_1_m", {1e5, 1e-9, "1/m"}},
    {"_m_N", {1e3, 1e-15, "m/N"}},
    {"_kg_m", {1e4, 1e-9, "kg/m"}},
    {"_kg", {1e5, 1e-9, "kg"}},
    {"_rad", {1e4, 1e-12, "rad"}},
    {"_deg", {1e6, 1e-10, "deg"}},
    {"_s", {1e5, 1e-9, "s"}},
    {"_hz", {1e5, 1e-4, "Hz"}},
    {"_N", {1e6, 1e-12, "N"}},
    {"_Nm", {1e6, 1e-15, "N m"}},
    {"_Nm2", {1e9, 1e-9, "N m2"}},
    {"_Nm_s", {1e6, 1e-15, "N m/s"}},
    {"_Nm_rad", {1e9, 1e-12, "N m/rad"}},
    {"_N_m", {1e9, 1e-9, "N/m"}},
    {"_ns", {4e18, 1.0, "ns"}},
    {"_px", {1e6, 1e-9, "px"}},
    {"sigma_px", {1e3, 1e-9, "px"}},
    {"intrinsics", {1e6, 1e-9, "px"}},
    {"camera_matrix", {1e6, 1e-9, "px"}},
    {"projection_matrix", {1e6, 1e-9, "px"}},
    {"resolution", {1e5, 1.0, "px"}},
    {"image_width", {1e5, 1.0, "px"}},
    {"image_height", {1e5, 1.0, "px"}},
    {"first_frame", {1e8, 1.0, ""}},
    {"last_frame", {1e8, 1.0, ""}},
    {"distortion_coefficients", {1e6, 1e-12, ""}},
    {"distortion_coeffs", {1e6, 1e-12, ""}},
    {"gamma", {1e2, 1e-2, ""}},
    {"taper", {2.0, 1e-12, ""}},
    {"gain", {1e6, 1e-9, ""}},
    {"scale", {1e6, 1e-9, ""}},
    {"exposure", {1e6, 1e-6, ""}},
    {"quad_decimate", {64.0, 1.0, ""}},
};

// Units in a column's brackets that no name ends with.
constexpr Quantity kUnits[] = {
    {"s", {1e10, 1e-9, "s"}},        {"ms", {1e13, 1e-6, "ms"}},    {"us", {1e16, 1e-3, "us"}},
    {"1/m2", {1e10, 1e-12, "1/m2"}}, {"1/s", {1e10, 1e-12, "1/s"}},
};

std::optional<Bounds> OfUnit(std::string_view unit) {
  for (const Quantity& q : kUnits)
    if (q.ending == unit) return q.bounds;
  for (const Quantity& q : kQuantities)
    if (q.ending.substr(0, 1) == "_" && q.ending.substr(1) == unit) return q.bounds;
  return {};
}

std::optional<Bounds> OfPart(std::string_view part) {
  if (part.ends_with(']')) {
    const auto from = part.rfind('[');
    if (from != std::string_view::npos)
      return OfUnit(part.substr(from + 1, part.size() - from - 2));
  }
  const Quantity* best = nullptr;
  for (const Quantity& q : kQuantities) {
    if (part.ends_with(q.ending) && (best == nullptr || q.ending.size() > best->ending.size()))
      best = &q;
  }
  if (best != nullptr) return best->bounds;
  // Poses and places: T_RC, p_WE.
  if (part.starts_with("T_") || part.starts_with("p_")) return Bounds{1e5, 1e-9, "m"};
  return {};
}

std::string Text(double least, const Bounds& b) {
  return fmt::format("{:g} to {:g}{}{}", least, b.most, *b.unit == '\0' ? "" : " ", b.unit);
}

}  // namespace

std::optional<Bounds> KnownBoundsOf(std::string_view name) {
  if (name.ends_with(']')) return OfPart(name);  // a unit may hold a dot
  while (true) {
    const auto dot = name.rfind('.');
    if (const auto bounds = OfPart(dot == std::string_view::npos ? name : name.substr(dot + 1)))
      return bounds;
    if (dot == std::string_view::npos) return {};
    name = name.substr(0, dot);
  }
}

Bounds BoundsOf(std::string_view name) { return KnownBoundsOf(name).value_or(Bounds{}); }

std::string ExpectedWithin(const Bounds& bounds, double value) {
  return std::abs(value) <= bounds.most ? "" : Text(-bounds.most, bounds);
}

std::string ExpectedAbove(const Bounds& bounds, double value, bool zero) {
  if (zero && value == 0.0) return "";
  if (bounds.least <= value && value <= bounds.most) return "";
  return (zero ? "0, or " : "") + Text(bounds.least, bounds);
}

}  // namespace flextip
