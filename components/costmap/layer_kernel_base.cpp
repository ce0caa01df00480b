#define HANDSEL_FILL_ROW fill_row_base
#include "components/costmap/layer_kernel_body.hpp"
