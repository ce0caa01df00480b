// SPDX-License-Identifier: Apache-2.0
// The work of one choice: grasps checked one by one at the places the object is taken from and put
// to.
#pragma once

#include <optional>

#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/choice/hand_at_object.hpp"

namespace handsel::grasp_planner {

/// A ranked and checked feasible grasp.
struct GraspChooser::Found {
  double rank{};
  Grasp grasp;
  std::optional<TransferPose> transfer;
  PuttingDown goal;
};

struct GraspChooser::Search {
  Search(const GraspChooser& chooser, const ChoiceInputs& given);

  /// Sets another place of the robot.
  void stand(const Pose& T_world_base);

  /// Returns the place of the robot.
  Vector3 p_world_robot() const;
  /// Grasps that bear the object, and weaker ones, used when few others are feasible; best first.
  struct Ranked {
    Ranking strong, weak;
  };
  /// Returns the grasps of the list in the order in which they are considered; counts the others.
  Ranked ranked();
  /// Returns the rank of a grasp before the arm is checked.
  double rank(const ListedGrasp& listed, std::size_t index) const;
  bool below_support(const Grasp& g);
  /// Returns where the object, at this tilt [rad], can be handed over in this grasp. The robot may
  /// collide only with the person's arms.
  std::optional<TransferPose> transfer(std::size_t index, const Grasp& g, double tilt);
  /// Checks whether the grasp is feasible; completes `out`, whose rank and transfer are set.
  ChoiceReason consider(const Grasp& listed, Found& out);

  /// The object at rest on a support, with the hand open.
  struct Site {
    Pose T_world_object{Pose::Identity()};
    CollisionWorld world;
  };
  /// The pose of the object at the nominal handover place.
  struct HandoverPlace {
    /// Cosine of how far the hand is behind the object, [0, 1], in the best heading; -1: none is
    /// reachable.
    double behind{-1};
    Pose T_world_object{Pose::Identity()};
  };

  /// Nominal handover place between person and robot, world [m].
  struct HandoverPoint {
    Vector3 place, to_person;  ///< to_person: unit
  };

  const RobotModel& robot() const { return *self.robot_; }
  const settings::GraspPlannerSettings& settings() const { return self.settings_; }
  void plan_handover();
  HandoverPlace handover(const Grasp& g, const Vector& arm_q);
  double visible(const Grasp& g, const Pose& T_world_object);
  Vector whole(const Vector& arm_q, const Vector& hand_q) const;
  std::optional<Vector> reach(const Pose& T_world_hand, const Vector& seed, int restarts);
  std::optional<Vector> inverse(const Pose& T_world_hand, const Vector& seed, int restarts) const;
  bool free(CollisionWorld& world, const Vector& arm_q, const Vector& hand_q);
  bool approach_free(Site& site, const Vector& approach_q, const Vector& grasp_q, const Grasp& g);
  double stand_off() const;  ///< distance of the start of the straight approach from the grasp [m]
  std::optional<Vector> approach(Site& site, const Vector& grasp_q, const Grasp& g);
  ChoiceReason pick_up(Grasp& g);
  bool can_lift(const Pose& T_world_hand, const Vector& grasp_q, const Grasp& g);
  /// Returns how far the hand is on the robot's side of a held object, [0, 1]; the giver is on the
  /// other side.
  double on_our_side(const Grasp& g) const;
  /// Returns whether the robot, hand open, keeps its clearance to the giver's head, torso, upper
  /// arms and legs.
  bool off_giver(const Vector& arm_q, const Grasp& g);
  ChoiceReason put_down(const Grasp& g, PuttingDown& down);

  const GraspChooser& self;
  const ChoiceInputs& inputs;
  HandAtObject hand;
  const Person* person{};
  std::string holder;  // person that holds the object; empty: none
  Scene scene;
  Site start;
  std::optional<Site> goal;
  std::optional<HolderBody> holder_body;   // of the person that holds the object
  std::optional<CollisionWorld> giver;     // the giver without forearms and hands
  std::optional<CollisionWorld> carrying;  // at the goal, with the object held
  // with the object held at the handover, the person's arms excluded
  std::optional<CollisionWorld> held;
  bool goal_is_taken{};
  Pose T_root_world{Pose::Identity()};
  std::optional<Vector3> eye;                   // world: of the person, else of the robot
  std::optional<HandoverPoint> handover_point;  // of the person; empty: not known
  std::optional<TransferPlaces> places;
  std::uint64_t transfer_budget{};  // of transfer_reaches
  std::vector<std::vector<Pose>> T_open;
  Choice out;
};

}  // namespace handsel::grasp_planner
