// The page's own files, put into the program by the build (live/page/web/).
#pragma once

#include <vector>

#include "live/page/server.h"

namespace flextip::live {

std::vector<ServedFile> WebFiles();

}  // namespace flextip::live
