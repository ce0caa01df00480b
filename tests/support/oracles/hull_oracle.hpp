// SPDX-License-Identifier: Apache-2.0
// Convex hull of a set of wrenches by Qhull: an oracle for epsilon and the peer of its benchmark.
#pragma once

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "common/grasp/force_closure.hpp"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace handsel::test {

/// Signed distance of the origin to the hull: positive inside; NaN when Qhull finds the set flat.
/// "Qt" exact, "QJ" joggled.
inline double hull_oracle(const WrenchMatrix& w, const char* options = "Qt") {
  std::vector<double> points(w.data(), w.data() + w.size());
  qhT qh_storage;
  qhT* qh = &qh_storage;
  QHULL_LIB_CHECK
  qh_zero(qh, nullptr);
  std::string command = std::string("qhull ") + options;
  static FILE* silent = std::fopen("/dev/null", "w");
  const int failed = qh_new_qhull(qh, static_cast<int>(w.rows()), static_cast<int>(w.cols()),
                                  points.data(), 0, command.data(), silent, silent);
  double least = std::numeric_limits<double>::quiet_NaN();
  if (!failed) {
    least = std::numeric_limits<double>::infinity();
    facetT* facet = nullptr;
    FORALLfacets { least = std::min(least, -facet->offset); }
  }
  qh_freeqhull(qh, qh_ALL);
  int current = 0, total = 0;
  qh_memfreeshort(qh, &current, &total);
  return least;
}

}  // namespace handsel::test
