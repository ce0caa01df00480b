// SPDX-License-Identifier: Apache-2.0
// The newest sample of an input with the time it was taken. Pure.
#pragma once

#include "components/trajectory_controller/input/sample_time.hpp"

namespace handsel::trajectory_controller {

template <class T>
struct Sample {
  T value{};        ///< newest
  SampleTime time;  ///< when it was taken; time.received() is false before the first set()

  /// Replaces the sample.
  void set(const T& sample, TimePoint at) {
    value = sample;
    time.mark(at);
  }
};

}  // namespace handsel::trajectory_controller
