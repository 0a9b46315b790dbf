// A collar's tags as the photometric fit takes them.
#pragma once

#include <vector>

#include "core/tag_collar.h"
#include "vision/photometric/face.h"

namespace flextip {

/// Returns the faces of a collar, in the order of its tags. Each side's white reaches as far as the
/// planes of its neighbours allow. Throws InputError where a tag does not exist.
std::vector<PhotometricFace> MakeFaces(const TagCollar& collar);

}  // namespace flextip
