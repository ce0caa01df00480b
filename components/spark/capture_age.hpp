// SPDX-License-Identifier: Apache-2.0
// Computes the age of a sample from its capture stamp and the system clock. Pure.
#pragma once

#include <optional>
#include <string>

#include "common/base/time.hpp"
#include "common/config/settings/spark.hpp"

namespace handsel::spark {

/// The clock that stamps the samples of a source.
struct SourceClock {
  double error{};  ///< bound of its offset from the local system clock [s]
  /// Latency of samples without a stamp [s]; nullopt: their age is unknown.
  std::optional<double> assumed_latency;
};
/// Returns the settings of the source's clock, with the general settings as default.
SourceClock clock_of(const settings::SparkSettings& settings, const std::string& source);

struct CaptureAge {
  double age{};         ///< upper bound of the time from capture to arrival [s]
  std::string unknown;  ///< why the age is unknown, one sentence; empty: known
};

/// Returns the age of a sample at its arrival. `stamp`: of the capture; 0: none. `arrival`: system
/// clock. `relative`: delay beyond the fastest sample of the source [s], independent of constant
/// delays and of changes of the system clock. `min_latency`: min latency of any tracker [s]; its
/// sum with `relative` is a lower bound of the age.
CaptureAge capture_age(Stamp stamp, Stamp arrival, double relative, double min_latency,
                       const SourceClock& clock);

/// Returns the age of a transient local sample, at least the age `of_receipt`. A clock offset can
/// only increase the result. `stamp`: 0: none.
Duration age_of(Stamp stamp, Stamp now, Duration of_receipt);

}  // namespace handsel::spark
