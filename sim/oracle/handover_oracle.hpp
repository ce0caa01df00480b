// SPDX-License-Identifier: Apache-2.0
// Decides which party carries the object and whether a handover has happened. Own method: no
// standard defines when a handover is complete.
#pragma once

#include "common/messages/system.hpp"

namespace handsel::sim {

/// The watched object at one physics step.
struct ObjectSituation {
  double height{};       ///< height of the centre of mass, world [m]
  bool robot_grips{};    ///< the robot holds the object
  bool robot_touches{};  ///< the robot touches the object
  bool human_grips{};    ///< a person holds the object
  bool human_touches{};  ///< a person touches or holds the object
  bool on_surface{};     ///< the object touches a box that supports objects
  bool on_floor{};       ///< the object lies on the floor
};

class HandoverOracle {
 public:
  /// `from_person`: a person holds the object at the start, and the robot is the receiver.
  HandoverOracle(double start_height, bool from_person)
      : with_person_(from_person), start_height_(start_height) {}

  /// Evaluates one physics step of length dt [s].
  void observe(const ObjectSituation&, double dt);
  /// Writes carrier, lifted, max_lifted, human_contact_before_release, human_alone, dropped,
  /// handover_done, handovers.
  void write(GroundTruth&) const;
  /// Returns whether the object has changed hands without a preceding fall to the floor; then
  /// remains true.
  bool done() const { return handovers_ > 0; }
  /// Returns whether the receiver has touched the object while the giver held it since the last
  /// handover.
  bool shared() const { return shared_ > 0; }

 private:
  void count_handover();

  bool with_person_;  // whether a person was the last sole holder
  std::uint64_t handovers_{0};
  double start_height_, height_{0}, max_lifted_{0}, contact_{0}, contact_before_release_{0},
      alone_{0}, robot_alone_{0};
  double lifted_{0}, shared_{0}, held_by_both_{0};  // since the last handover
  bool dropped_{false};
  ObjectSituation last_;
};

}  // namespace handsel::sim
