// SPDX-License-Identifier: Apache-2.0
// The newest sample of people: as capsules for the guard, as points for the hands, with the partner
// of a handover, whose forearms and hands are exempt from separation. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/messages/task.hpp"
#include "components/trajectory_controller/input/person_capsules.hpp"
#include "components/trajectory_controller/input/sample_time.hpp"

namespace handsel::trajectory_controller {

/// Where the torso and the hands of a person are.
struct PersonPoints {
  std::string id;                        ///< as in HumanState
  Vector3 torso, left_hand, right_hand;  ///< world [m]
};

class ObservedPeople {
 public:
  /// `unknown_after`: a person not seen for longer has no known velocity [s].
  explicit ObservedPeople(double unknown_after) : unknown_after_(unknown_after) {}

  /// Replaces people and views.
  void set(const HumanState& people, TimePoint sampled);
  /// Takes the partner of an engaged handover: the person named, or the only one there is.
  void set(const ActionStatus& action);
  /// Ends the exemption of the partner, unless the handover is still engaged. Allocates nothing.
  void end_exemption() noexcept;

  /// Newest sample.
  const HumanState& state() const noexcept { return people_; }
  /// Bodies of all people; forearms and hands of the partner are exempt.
  const PersonCapsules& capsules() const noexcept { return capsules_; }
  /// People whose whole body was measured.
  const std::vector<PersonPoints>& points() const noexcept { return points_; }
  /// Person exempt from separation, until clear of the robot; empty: none.
  const std::string& partner() const noexcept { return partner_; }
  /// Returns whether a sample was received.
  bool received() const noexcept { return time_.received(); }
  /// Returns whether people are reported, but not all of the robot's reach is observed.
  bool uncovered() const noexcept { return received() && !capsules_.covered; }
  /// Returns the age of the newest sample; -1 before any [s].
  double age(TimePoint now) const noexcept { return time_.age(now); }
  /// Returns the age as one of data: 0 before any sample [s].
  double data_age(TimePoint now) const noexcept { return std::max(0.0, time_.age(now)); }

 private:
  void refresh();

  double unknown_after_;
  HumanState people_;
  SampleTime time_;
  PersonCapsules capsules_;
  std::vector<PersonPoints> points_;
  std::string partner_;
  bool engaged_{};
};

}  // namespace handsel::trajectory_controller
