// Which party carries the object, and whether a handover has happened. Own method: no standard
// defines when a handover is complete.
#pragma once

#include "common/messages/system.hpp"

namespace handsel::sim {

/// The watched object at one physics step.
struct ObjectSituation {
  double height{};  ///< of its centre of mass, world [m]
  /// Held by the robot, touched by it; held by a person, touched or held by a person; in contact
  /// with a box that supports objects; on the floor.
  bool robot_grips{}, robot_touches{}, human_grips{}, human_touches{}, on_surface{}, on_floor{};
};

class HandoverOracle {
 public:
  /// `from_person`: a person has the object at the start; the handover is then the robot's taking
  /// of it.
  HandoverOracle(double start_height, bool from_person)
      : with_person_(from_person), start_height_(start_height) {}

  /// Takes in one physics step of length dt [s].
  void observe(const ObjectSituation&, double dt);
  /// Writes carrier, lifted, max_lifted, human_contact_before_release, human_alone, dropped,
  /// handover_done, handovers.
  void write(GroundTruth&) const;
  /// Whether the object has changed hands without a fall to the floor before; stays true.
  bool done() const { return handovers_ > 0; }
  /// Whether both have had a hand on the object since the last handover: the giver still held it
  /// while the receiver touched it.
  bool shared() const { return shared_ > 0; }

 private:
  void count_handover();

  bool with_person_;  // a person was the last to have the object alone, or at the start
  std::uint64_t handovers_{0};
  double start_height_, height_{0}, max_lifted_{0}, contact_{0}, contact_before_release_{0},
      alone_{0}, robot_alone_{0};
  double lifted_{0}, shared_{0}, held_by_both_{0};  // since the last handover
  bool dropped_{false};
  ObjectSituation last_;
};

}  // namespace handsel::sim
