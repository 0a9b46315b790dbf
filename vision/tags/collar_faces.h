// A collar's tags as the photometric fit takes them.
#pragma once

#include <vector>

#include "core/tag_collar.h"
#include "vision/photometric/face.h"

namespace flextip {

/// The faces of a collar; how far each side's white reaches follows from its neighbours' planes.
/// Throws InputError where a tag does not exist.
std::vector<PhotometricFace> MakeFaces(const TagCollar& collar);

}  // namespace flextip
