#include "pipeline/guard/still_pictures.h"

#include <algorithm>
#include <cstring>

namespace flextip {
namespace {

constexpr double kMoved_m = 2e-4, kNoises = 10.0;

/// Mixes eight bytes at a time: a picture takes a tenth of a millisecond.
std::uint64_t HashOf(const std::vector<const Image*>& images) {
  constexpr std::uint64_t kPrime = 0x9E3779B97F4A7C15ULL;
  std::uint64_t hash = 1;
  const auto mix = [&](std::uint64_t word) {
    hash = (hash ^ word) * kPrime;
    hash ^= hash >> 32;
  };
  for (const Image* image : images) {
    mix(image == nullptr ? 0 : 1);
    if (image == nullptr) continue;
    const auto bytes = static_cast<std::size_t>(image->width_px) * image->channels;
    for (int y = 0; y < image->height_px; ++y) {
      const std::uint8_t* row = image->Row(y);
      for (std::size_t i = 0; i < bytes; i += sizeof(std::uint64_t)) {
        std::uint64_t word = 0;
        std::memcpy(&word, row + i, std::min(sizeof word, bytes - i));
        mix(word);
      }
    }
  }
  return hash == 0 ? 1 : hash;
}

}  // namespace

bool StillPictures::Look(const std::vector<const Image*>& images,
                         const std::optional<Measurements>& measured) {
  const bool none = std::all_of(images.begin(), images.end(),
                                [](const Image* image) { return image == nullptr; });
  if (none) return false;
  const auto pixels = static_cast<std::int64_t>(HashOf(images));
  if (pixels != pixels_) {
    pixels_ = pixels;
    first_p_RW_.reset();
    if (measured) first_p_RW_ = measured->p_RW;
    return false;
  }
  if (!measured || !first_p_RW_) return false;
  const double moved_m = (measured->p_RW - *first_p_RW_).norm();
  return moved_m > std::max(kMoved_m, kNoises * measured->wrist_position_noise_m);
}

void StillPictures::VisitState(StateText& state) {
  state(pixels_);
  state(first_p_RW_);
}

}  // namespace flextip
