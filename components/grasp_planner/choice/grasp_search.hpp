// The work of one choice: grasps checked one by one at the places the object is taken from and put
// to.
#pragma once

#include <optional>

#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/choice/hand_at_object.hpp"

namespace handsel::grasp_planner {

/// Weighed and checked: a grasp that serves.
struct GraspChooser::Found {
  double rank{};
  Grasp grasp;
  std::optional<TransferPose> transfer;
  PuttingDown goal;
};

struct GraspChooser::Search {
  Search(const GraspChooser& chooser, const ChoiceInputs& given);

  /// The robot stands elsewhere from now on.
  void stand(const Pose& T_world_base);

  /// Where the robot stands.
  Vector3 p_world_robot() const;
  /// Ranks of grasps and their places in the list, best first.
  using Ranking = std::vector<std::pair<double, std::size_t>>;
  /// Grasps by which one hand holds the object, and weaker ones, used where few others serve.
  struct Ranked {
    Ranking strong, weak;
  };
  /// Returns the grasps of the list in the order in which they are considered; counts the others.
  Ranked ranked();
  /// What can be said of a grasp before the arm is checked.
  double rank(const ListedGrasp& listed, std::size_t index) const;
  bool below_support(const Grasp& g);
  /// Where and how the object, tilted by that much, can be handed over in this grasp, the robot
  /// free of everything but the person's arms.
  std::optional<TransferPose> transfer(std::size_t index, const Grasp& g, double tilt);
  /// Whether the grasp serves; writes the rest of `out`, whose rank and transfer are set.
  ChoiceReason consider(const Grasp& listed, Found& out);

  /// The object standing somewhere, the hand not closed on it.
  struct Site {
    Pose T_world_object{Pose::Identity()};
    CollisionWorld world;
  };
  /// The middle place for the exchange, and how the object is held there.
  struct HandoverPlace {
    /// How well the hand stays behind the object, [0, 1], in the best heading; -1: the arm gets to
    /// none.
    double behind{-1};
    Pose T_world_object{Pose::Identity()};
  };

  /// Where the person and the robot can hold the object, in the middle between them.
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
  double stand_off() const;  ///< before the object, where the straight approach begins [m]
  std::optional<Vector> approach(Site& site, const Vector& grasp_q, const Grasp& g);
  ChoiceReason pick_up(Grasp& g);
  bool can_lift(const Pose& T_world_hand, const Vector& grasp_q, const Grasp& g);
  /// How far on the robot's side of the object the hand is, [0, 1]: the person with the object in
  /// the hand is on the other.
  double on_our_side(const Grasp& g) const;
  /// Far enough from head, torso, upper arms and legs of the person that holds it, the hand open.
  bool off_giver(const Vector& arm_q, const Grasp& g);
  ChoiceReason put_down(const Grasp& g, PuttingDown& down);

  const GraspChooser& self;
  const ChoiceInputs& inputs;
  HandAtObject hand;
  const Person* person{};
  std::string holder;  // person in whose hand it is; empty: nobody
  Scene scene;
  Site start;
  std::optional<Site> goal;
  std::optional<HandShape::PlacedHand> holder_body;  // frame of the object
  std::optional<CollisionWorld> giver;     // the person that holds it, but for forearms and hands
  std::optional<CollisionWorld> carrying;  // about the goal, with the object in the hand
  // with the object in the hand, at the handover: the person's arms are no obstacle
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
