// Who carries the object, and whether a handover has happened (ours).
#pragma once

#include "common/messages/system.hpp"

namespace handsel::sim {

/// The watched object at one physics step.
struct ObjectSituation {
  double height{};  ///< of its centre of mass, world [m]
  bool robot_grips{}, robot_touches{}, human_grips{}, human_touches{}, on_surface{}, on_floor{};
};

class HandoverOracle {
 public:
  /// `from_person`: who has it at the start; the handover is then the robot's taking it.
  HandoverOracle(double start_height, bool from_person) : from_person_(from_person), start_height_(start_height) {}

  void observe(const ObjectSituation&, double dt);
  /// Writes carrier, lifted, max_lifted, human_contact_before_release, human_alone, dropped, handover_done.
  void write(GroundTruth&) const;
  bool done() const { return done_; }
  /// Both have had a hand on it: who gives still holds it, who takes touches it.
  bool shared() const { return shared_ > 0; }

 private:
  bool from_person_;
  double start_height_, height_{0}, max_lifted_{0}, contact_{0}, contact_before_release_{0}, alone_{0}, shared_{0}, held_by_both_{0},
      robot_alone_{0};
  bool dropped_{false}, done_{false};
  ObjectSituation last_;
};

}  // namespace handsel::sim
