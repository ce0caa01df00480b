#include "common/trajectory/lanes_body.hpp"

namespace handsel::detail {
const LaneKernels kLaneKernelsAvx512{"avx512", prepare, finish, evaluate};
}  // namespace handsel::detail
