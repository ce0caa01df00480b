// SPDX-License-Identifier: Apache-2.0
#include "components/spark/capture_age.hpp"

#include <algorithm>
#include <cstdio>

namespace handsel::spark {

SourceClock clock_of(const settings::SparkSettings& settings, const std::string& source) {
  SourceClock clock{settings.clock_error, std::nullopt};
  for (const settings::SourceClock& one : settings.clocks) {
    if (one.source != source) continue;
    if (one.clock_error) clock.error = *one.clock_error;
    if (one.assumed_latency) clock.assumed_latency = one.assumed_latency;
  }
  return clock;
}

CaptureAge capture_age(Stamp stamp, Stamp arrival, double relative, double min_latency,
                       const SourceClock& clock) {
  const double at_least = std::max(0.0, relative) + min_latency;
  if (stamp == 0) {
    if (!clock.assumed_latency)
      return {at_least,
              "gives no capture stamps, and no assumed_latency is set for it in spark.txtpb"};
    return {std::max(at_least, *clock.assumed_latency), ""};
  }
  const double since = to_seconds(Duration(arrival - stamp));
  if (since < -clock.error) {
    char text[96];
    std::snprintf(text, sizeof text,
                  "stamps its pictures %.3f s in the future; its clock may be off by %.3f s",
                  -since, clock.error);
    return {at_least, text};
  }
  return {std::max(at_least, since + clock.error), ""};
}

Duration age_of(Stamp stamp, Stamp now, Duration of_receipt) {
  return stamp > 0 ? std::max(of_receipt, Duration(now - stamp)) : of_receipt;
}

}  // namespace handsel::spark
