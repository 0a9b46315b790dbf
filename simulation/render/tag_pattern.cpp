#include "simulation/render/tag_pattern.h"

#include <fmt/format.h>

#include <cstdlib>
#include <memory>

#include "core/error.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>
}

namespace flextip::simulation {
namespace {

using Family = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

Family MakeFamily(const std::string& name) {
  if (name == "tag36h11") return {tag36h11_create(), tag36h11_destroy};
  if (name == "tag25h9") return {tag25h9_create(), tag25h9_destroy};
  if (name == "tag16h5") return {tag16h5_create(), tag16h5_destroy};
  if (name == "tagCircle21h7") return {tagCircle21h7_create(), tagCircle21h7_destroy};
  if (name == "tagStandard41h12") return {tagStandard41h12_create(), tagStandard41h12_destroy};
  if (name == "tagStandard52h13") return {tagStandard52h13_create(), tagStandard52h13_destroy};
  throw InputError(
      fmt::format("tag family: found {}, expected one the renderer knows, such as "
                  "tag36h11, tag25h9, tag16h5 or tagStandard41h12",
                  name));
}

// As image_u8_destroy does, which Debian keeps in a library of its own.
void FreeImage(image_u8_t* image) {
  std::free(image->buf);
  std::free(image);
}

}  // namespace

TagPattern MakeTagPattern(const std::string& family_name, int id) {
  const Family family = MakeFamily(family_name);
  if (id < 0 || id >= static_cast<int>(family->ncodes)) {
    throw InputError(fmt::format("tag id: found {}, expected 0 to {} in {}", id, family->ncodes - 1,
                                 family_name));
  }
  const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> image(
      apriltag_to_image(family.get(), id), FreeImage);
  TagPattern pattern;
  pattern.cells = family->total_width;
  pattern.border_cells = family->width_at_border;
  pattern.white.resize(static_cast<std::size_t>(pattern.cells) * pattern.cells);
  for (int y = 0; y < pattern.cells; ++y) {
    for (int x = 0; x < pattern.cells; ++x) {
      pattern.white[static_cast<std::size_t>(y) * pattern.cells + x] =
          image->buf[y * image->stride + x] > 127;
    }
  }
  return pattern;
}

}  // namespace flextip::simulation
