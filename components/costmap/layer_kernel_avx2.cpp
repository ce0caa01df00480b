// SPDX-License-Identifier: Apache-2.0
#define HANDSEL_FILL_ROW fill_row_avx2
#include "components/costmap/layer_kernel_body.hpp"
