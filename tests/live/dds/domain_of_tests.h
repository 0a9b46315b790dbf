// A domain of DDS for this process, so that tests that run at once do not meet.
#pragma once

#include <unistd.h>

namespace flextip::live {

/// Returns a domain from 1 to 100: ports of later ones are those that the system gives to others.
inline int DomainOfTests() { return 1 + static_cast<int>(getpid() % 100); }

}  // namespace flextip::live
