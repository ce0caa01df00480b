// SPDX-License-Identifier: Apache-2.0
// HANDSEL_LANES=avx512|avx2|base selects the SIMD width of the linked tests. A width that the
// processor lacks is skipped by exit code 77.
#include <cstdio>
#include <cstdlib>

#include "common/trajectory/batch/kernels.hpp"

namespace {

const bool kChosen = [] {
  const char* wanted = std::getenv("HANDSEL_LANES");
  if (wanted && !handsel::detail::choose_batch_kernels(wanted)) {
    std::printf("this processor has no lanes called %s\n", wanted);
    std::exit(77);
  }
  return true;
}();

}  // namespace
