// A component's time when the simulator gives the pace. Pure.
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/time.hpp"

namespace handsel {

/// How far components may let their time advance.
struct TimeGrant {
  std::uint64_t incarnation{};  ///< of the simulator
  TimePoint until{};            ///< no component's time passes this instant
  Duration waited{};            ///< for how long time has stood still since the simulator started
};

/// The machine's monotonic clock ("wall") less the time for which time has stood still. It stands still where no more is granted, goes back
/// at no other time than at the first grant, and is the machine's clock until then. A grant that ended more than 50 ms ago lets time
/// advance no further: a process that has been stopped meanwhile first hears whether the simulator has waited for it. When the simulator
/// has been silent for a second in which this component could have heard it, time continues from where it stands.
class PacedClock {
 public:
  /// Returns false when the grant is of another simulator than the one heard within the last second, and was ignored.
  bool grant(const TimeGrant& grant, TimePoint wall);
  /// The time now.
  TimePoint at(TimePoint wall);
  /// Returns the time at a `wall` since the grant before the last one, at most the last at().
  TimePoint past(TimePoint wall) const;
  /// Returns whether the newest grant is so old that how far time has advanced is not known.
  bool stale(TimePoint wall) const;
  /// When to look at the clock again for `instant`: when it will be there, or earlier as long as that is not granted.
  TimePoint look_at(TimePoint instant, TimePoint wall) const;
  bool paced() const { return paced_; }

 private:
  TimePoint unbounded(TimePoint wall) const { return wall - waited_; }

  bool paced_{false}, ever_paced_{false};
  std::uint64_t incarnation_{};
  TimePoint until_{}, last_{};
  Duration waited_{};
  TimePoint until_before_{TimePoint::min()};  // of the grant before
  Duration waited_before_{};
  Duration silence_{};  // of the simulator, while this component listened
  TimePoint listened_{};
};

}  // namespace handsel
