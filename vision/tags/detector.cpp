#include "vision/tags/detector.h"

#include <apriltag/apriltag.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "vision/grey.h"
#include "vision/tags/edge_refiner.h"
#include "vision/tags/families.h"

namespace flextip {
namespace {

// The library thresholds tiles of 4x4 pixels and needs a few of them.
constexpr int kMinSide_px = 16;

// The library keeps a table of every code with up to `bits` of its bits wrong, three places of 16
// bytes for each entry: 3 GB and ten seconds for two bits of tagStandard52h13.
constexpr double kMaxTableEntries = 1e7;

int AffordableBits(const apriltag_family_t& family, int bits) {
  const double n = family.nbits, codes = family.ncodes;
  const double entries[] = {codes, codes * (1 + n), codes * (1 + n + n * (n - 1) / 2)};
  while (bits > 0 && entries[bits] > kMaxTableEntries) --bits;
  return bits;
}

void CheckOptions(const TagDetectorOptions& o) {
  const auto check = [](bool good, const char* what, double found) {
    if (!good) throw InputError(fmt::format("tag detector: {}, found {}", what, found));
  };
  check(o.quad_decimate >= 1 && o.quad_decimate <= 8, "quad_decimate must be in 1..8",
        o.quad_decimate);
  check(o.quad_sigma_px >= 0 && o.quad_sigma_px <= 10, "quad_sigma_px must be in 0..10",
        o.quad_sigma_px);
  check(o.decode_sharpening >= 0 && o.decode_sharpening <= 10, "decode_sharpening must be in 0..10",
        o.decode_sharpening);
  check(o.threads >= 1 && o.threads <= 64, "threads must be in 1..64", o.threads);
  check(o.max_hamming >= 0 && o.max_hamming <= 2, "max_hamming must be 0, 1 or 2", o.max_hamming);
}

}  // namespace

Image ToGrey(const Image& image) {
  if (image.Empty() || image.width_px <= 0 || image.height_px <= 0) {
    throw InputError("the image is empty");
  }
  if (image.channels == 1) return image;
  if (image.channels != 3) {
    throw InputError(fmt::format("expected an image of 1 or 3 channels, found {}", image.channels));
  }
  Image grey(image.width_px, image.height_px, 1);
  const std::uint8_t* from = image.data.data();
  for (std::uint8_t& to : grey.data) {
    to = GreyOf(from);
    from += 3;
  }
  return grey;
}

struct TagDetector::Impl {
  TagDetectorOptions options;
  TagFamily family;
  apriltag_detector_t* detector = nullptr;

  explicit Impl(const TagDetectorOptions& o) : options(o), family(MakeTagFamily(o.family)) {
    CheckOptions(o);
    detector = apriltag_detector_create();
    apriltag_detector_add_family_bits(detector, family.get(),
                                      AffordableBits(*family, o.max_hamming));
    detector->quad_decimate = static_cast<float>(o.quad_decimate);
    detector->quad_sigma = static_cast<float>(o.quad_sigma_px);
    detector->refine_edges = o.refine_edges;
    detector->decode_sharpening = o.decode_sharpening;
    detector->nthreads = o.threads;
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { apriltag_detector_destroy(detector); }

  TagDetection Convert(const apriltag_detection_t& d, const Image& grey) const;
};

// The library's corners come in the order this class documents. Its pixel centres are at .5.
TagDetection TagDetector::Impl::Convert(const apriltag_detection_t& d, const Image& grey) const {
  TagDetection tag;
  tag.id = d.id;
  tag.hamming = d.hamming;
  tag.decision_margin = d.decision_margin;
  for (int i = 0; i < 4; ++i) {
    tag.raw_corners_px[i] = {d.p[i][0], d.p[i][1]};
    tag.corners_px[i] = tag.raw_corners_px[i] - Eigen::Vector2d(0.5, 0.5);
  }
  if (options.refine_corners) {
    const RefinedQuad quad = RefineCorners(grey, tag.corners_px, family->width_at_border);
    tag.corners_px = quad.corners_px;
    tag.refined = quad.edges_fitted == 4;
  }
  return tag;
}

TagDetector::TagDetector(const TagDetectorOptions& options)
    : impl_(std::make_unique<Impl>(options)) {}
TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;

std::vector<TagDetection> TagDetector::Detect(const Image& image, double min_decimate) {
  const double decimate = std::max(impl_->options.quad_decimate, min_decimate);
  impl_->detector->quad_decimate = static_cast<float>(decimate);
  Image grey = ToGrey(image);
  const double smaller = std::min(grey.width_px, grey.height_px) / decimate;
  if (smaller < kMinSide_px) return {};
  image_u8_t view = {grey.width_px, grey.height_px, grey.width_px, grey.data.data()};
  zarray_t* found = apriltag_detector_detect(impl_->detector, &view);
  std::vector<TagDetection> tags;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* d = nullptr;
    zarray_get(found, i, static_cast<void*>(&d));
    if (d->hamming > impl_->options.max_hamming) continue;
    if (d->decision_margin < impl_->options.min_decision_margin) continue;
    const TagDetection tag = impl_->Convert(*d, grey);
    const bool finite = std::all_of(tag.corners_px.begin(), tag.corners_px.end(),
                                    [](const Eigen::Vector2d& c) { return c.allFinite(); });
    if (finite) tags.push_back(tag);
  }
  apriltag_detections_destroy(found);
  std::stable_sort(tags.begin(), tags.end(), [](const TagDetection& a, const TagDetection& b) {
    return a.id != b.id ? a.id < b.id : a.decision_margin > b.decision_margin;
  });
  return tags;
}

}  // namespace flextip
