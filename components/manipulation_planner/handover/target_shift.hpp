// SPDX-License-Identifier: Apache-2.0
// The shift of the exchange point that attention asks for, within bounds. Own method: attention
// asks relative to the point that it has seen, so a changed point rests before the next shift.
// Pure.
#pragma once

#include <optional>

#include "common/base/advised_value.hpp"
#include "common/config/settings/manipulation_planner.hpp"
#include "common/messages/attention.hpp"

namespace handsel::manipulation_planner {

class TargetShift {
 public:
  explicit TargetShift(const settings::ManipulationPlannerSettings& settings)
      : max_shift_(settings.max_shift),
        min_shift_(settings.min_shift),
        reached_(settings.shift_reached),
        pause_(from_seconds(settings.shift_pause)) {}

  /// Takes the newest advice; it expires as AdvisedValue does.
  void advise(const AttentionAdvice& advice, TimePoint now);
  /// Notes that the search has chosen a point, world [m]: shifts are bounded around this point.
  void note_choice(const Vector3& p_chosen, TimePoint now);
  /// Notes that the exchange point has been shifted to a point, world [m].
  void note_change(const Vector3& p_shifted, TimePoint now) {
    p_shifted_ = p_shifted;
    changed_at_ = now;
  }
  /// Notes that a shifted point, world [m], is refused: points within min_shift of it are not
  /// wanted until the next refusal or choice.
  void note_refusal(const Vector3& p_refused) { p_refused_ = p_refused; }

  /// Returns whether a point, world [m], is within shift_reached of the one last passed to
  /// note_change() since the choice.
  bool has_led_to(const Vector3& p) const;
  /// Returns whether a point, world [m], is too far from the chosen one for a shift of it.
  bool is_another_choice(const Vector3& p) const {
    return !p_chosen_ || (p - *p_chosen_).norm() > max_shift_;
  }
  /// Returns where the exchange point is wanted, world [m]: shifted from `p_present`, at most
  /// max_shift from where it was chosen. nullopt: there is no advice now, the shift is below
  /// min_shift, the point was refused, or the last change is less than shift_pause ago.
  std::optional<Vector3> wanted(const Vector3& p_present, TimePoint now) const;
  /// The same around another point than the chosen one, `p_center`, world [m].
  std::optional<Vector3> wanted_around(const Vector3& p_center, const Vector3& p_present,
                                       TimePoint now) const;

 private:
  double max_shift_, min_shift_, reached_;  // [m]
  Duration pause_;
  AdvisedValue<std::optional<Vector3>> shift_;
  std::optional<Vector3> p_chosen_, p_shifted_, p_refused_;
  TimePoint changed_at_{};
};

}  // namespace handsel::manipulation_planner
