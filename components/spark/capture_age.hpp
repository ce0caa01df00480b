// How old a picture is: its capture stamp against the system clock. Pure.
#pragma once

#include <optional>
#include <string>

#include "common/base/time.hpp"
#include "common/config/settings/spark.hpp"

namespace handsel::spark {

/// The clock that stamps a source's pictures.
struct SourceClock {
  double error{};  ///< bound of its offset from the system clock here [s]
  /// Of pictures without a stamp [s]; none: their age is unknown.
  std::optional<double> assumed_latency;
};
/// Returns the settings of the source's clock; those it does not have are the general ones.
SourceClock clock_of(const settings::SparkSettings& settings, const std::string& source);

struct CaptureAge {
  double age{};         ///< since the capture, at arrival: never less than it is [s]
  std::string unknown;  ///< why the age is not known, one sentence; empty: it is
};

/// Returns the age of a picture at its arrival. `stamp`: of its capture, 0: none. `arrival`: the
/// system clock then. `relative`: by how much it took longer than the fastest one of its source
/// [s]: of a delay that is always there this shows nothing, of a system clock that was set nothing
/// either. The fourth argument: the smallest latency of any tracker [s], added to `relative` as a
/// lower bound of the age.
CaptureAge capture_age(Stamp stamp, Stamp arrival, double relative, double min_latency,
                       const SourceClock& clock);

/// Returns the age of a transient local sample, which may be larger than the age that its receipt
/// states. A clock that differs only makes the sample older. `stamp`: 0 for none.
Duration age_of(Stamp stamp, Stamp now, Duration of_receipt);

}  // namespace handsel::spark
