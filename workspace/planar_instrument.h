// The robot of the thesis's 2.3.1: a planar two-link arm that holds a straight shaft through a
// port.
#pragma once

#include "workspace/port_instrument.h"

namespace flextip {

using PlanarInstrument = PortInstrument<2>;  ///< positions are (z, y) in A

}  // namespace flextip
