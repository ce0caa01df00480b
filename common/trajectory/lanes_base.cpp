#include "common/trajectory/lanes_body.hpp"

namespace handsel::detail {
const LaneKernels kLaneKernelsBase{"base", prepare, finish, evaluate};
}  // namespace handsel::detail
