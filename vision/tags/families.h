// The tag families of the AprilTag library by name, for the sources of vision/.
#pragma once

#include <memory>
#include <string>

struct apriltag_family;  // the library's

namespace flextip {

using TagFamily = std::unique_ptr<apriltag_family, void (*)(apriltag_family*)>;

/// Returns the AprilTag library's family of that name. Throws InputError where there is none.
TagFamily MakeTagFamily(const std::string& name);

}  // namespace flextip
