// SPDX-License-Identifier: Apache-2.0
// Solves many problems of seven axes in one call, side by side in SIMD registers.
#include <cmath>
#include <cstdio>

#include <handsel/trajectory.hpp>

int main() {
  constexpr int kProblems = 1000, kAxes = 7, kAll = kProblems * kAxes;
  std::vector<double> from(kAll, 0.0), to(kAll), rest(kAll, 0.0), v(kAll, 1.0), a(kAll, 2.0),
      j(kAll, 10.0);
  for (int i = 0; i < kAll; ++i) to[i] = std::sin(i);
  handsel::SynchronisedBatch batch(kAxes, kProblems);  // allocates here only
  const int solved = batch.solve({from.data(), rest.data(), rest.data(), to.data(), rest.data(),
                                  rest.data(), v.data(), a.data(), j.data()},
                                 kProblems);
  double longest = 0;
  for (int p = 0; p < kProblems; ++p) longest = std::max(longest, batch.duration(p));
  std::printf("%d of %d solved, longest %.3f s\n", solved, kProblems, longest);
  return solved == kProblems ? 0 : 1;
}
