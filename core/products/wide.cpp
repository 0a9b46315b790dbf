// Compiled with AVX2 and FMA (core/CMakeLists.txt) and only called where the processor has them.
// The namespace has a name of its own here: the linker must not take these instantiations of
// Eigen's templates for those of the rest of the program.
#define Eigen EigenWide
#include "core/products/eigen_kernels.h"
#undef Eigen

namespace flextip::products {

Kernels Wide() { return kKernels; }

}  // namespace flextip::products
