// HANDSEL_LANES=avx512|avx2|base runs the tests this is linked into with registers of that width.
// What this processor does not have is skipped: ctest counts exit code 77 so.
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
