#include "simulation/render/film.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace flextip::simulation::render {
namespace {

constexpr int kCodes = 65536;
constexpr int kQuantileBits = 12, kQuantiles = 1 << kQuantileBits;

// Steele, Lea and Flood's SplitMix64.
std::uint64_t NextRandom(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

double NormalCdf(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

// The normal's quantiles at (i + 1/2) / n, scaled to unit variance: drawing an entry at random is a
// normal deviate cut off at 3.7 standard deviations.
std::vector<float> NormalQuantiles() {
  std::vector<double> quantiles(kQuantiles);
  double squares = 0;
  for (int i = 0; i < kQuantiles; ++i) {
    const double p = (i + 0.5) / kQuantiles;
    double low = -6, high = 6;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (NormalCdf(middle) < p ? low : high) = middle;
    }
    quantiles[i] = low;
    squares += low * low;
  }
  const double scale = std::sqrt(kQuantiles / squares);
  std::vector<float> scaled(kQuantiles);
  std::transform(quantiles.begin(), quantiles.end(), scaled.begin(),
                 [&](double q) { return static_cast<float>(q * scale); });
  return scaled;
}

}  // namespace

Film::Film(const LaparoscopeOptions& options, double gamma)
    : electrons_(options.full_well_electrons),
      read_electrons_(options.read_noise_electrons),
      seed_(options.seed),
      code_(kCodes) {
  for (int i = 0; i < kCodes; ++i) {
    code_[i] =
        static_cast<std::uint8_t>(std::lround(255.0 * std::pow(i / (kCodes - 1.0), 2.0 / gamma)));
  }
  if (electrons_ > 0) normal_ = NormalQuantiles();
}

Image Film::Develop(const LinearImage& light, int frame_number) const {
  const int row_values = light.width_px * light.channels;
  Image image(light.width_px, light.height_px, light.channels);
  std::uint64_t frame_state = seed_;
  NextRandom(frame_state);
  frame_state ^= 0xd1342543de82ef95ull * (static_cast<std::uint64_t>(frame_number) + 1);
  tbb::parallel_for(0, light.height_px, [&](int y) {
    std::uint64_t row_state =
        frame_state ^ (0xa0761d6478bd642full * static_cast<std::uint64_t>(y + 1));
    row_state = NextRandom(row_state);
    DevelopRow(light.At(0, y), image.Row(y), row_values, row_state);
  });
  return image;
}

void Film::DevelopRow(const float* light, std::uint8_t* out, int count, std::uint64_t state) const {
  const auto encode = [&](float signal) {
    // Never negative, so that cutting rounds; lround would cost a call a pixel.
    // NOLINTNEXTLINE(bugprone-incorrect-roundings)
    return code_[static_cast<std::size_t>(std::sqrt(std::clamp(signal, 0.0f, 1.0f)) * (kCodes - 1) +
                                          0.5f)];
  };
  if (electrons_ <= 0) {
    std::transform(light, light + count, out, encode);
    return;
  }
  // In electrons: variance = mean (shot) + read noise squared.
  const auto per_electron = static_cast<float>(1.0 / electrons_);
  const auto read_variance = static_cast<float>(std::pow(read_electrons_ / electrons_, 2));
  std::uint64_t bits = 0;
  for (int i = 0; i < count; ++i) {
    if (i % 5 == 0) bits = NextRandom(state);
    const float deviate = normal_[bits & (kQuantiles - 1)];
    bits >>= kQuantileBits;
    const float mean = std::max(light[i], 0.0f);
    out[i] = encode(mean + deviate * std::sqrt(mean * per_electron + read_variance));
  }
}

}  // namespace flextip::simulation::render
