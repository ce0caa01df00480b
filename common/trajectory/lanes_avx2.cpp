#include "common/trajectory/lanes_body.hpp"

namespace handsel::detail {
const LaneKernels kLaneKernelsAvx2{"avx2", prepare, finish, evaluate};
}  // namespace handsel::detail
