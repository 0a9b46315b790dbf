// The tag families of the AprilTag library by name. For the sources of vision/ only: the library's
// types show here.
#pragma once

#include <apriltag/apriltag.h>

#include <memory>
#include <string>

namespace flextip {

using TagFamily = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

/// Throws InputError where there is no family of that name.
TagFamily MakeTagFamily(const std::string& name);

}  // namespace flextip
