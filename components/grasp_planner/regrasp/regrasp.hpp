// SPDX-License-Identifier: Apache-2.0
// From one grasp of an object to another, or from one place to another that one grasp does not
// serve: picking up, passing from hand to hand and putting down, as few times as can be (chapter
// section 3.2.10).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/grasp/grip_force.hpp"
#include "common/model/manipulator.hpp"
#include "components/grasp_planner/file_defaults.hpp"
#include "components/grasp_planner/pair/double_grasp.hpp"
#include "components/grasp_planner/pair/load_share.hpp"
#include "components/grasp_planner/regrasp/step_graph.hpp"

namespace handsel::grasp_planner {

/// An arm with the grasps of its hand on the object.
struct RegraspArm {
  Manipulator arm;  ///< groups of arm and hand in the robot model
  const HandGeometry*
      hand_geometry{};      ///< geometry of the hand of this arm; must outlive this struct
  const GraspList* list{};  ///< grasps of that hand on the object; must outlive this struct
};

/// The object held by one hand, or at rest on a support.
struct ObjectState {
  int arm{-1};                       ///< index of the arm; -1: on a support
  std::optional<std::size_t> grasp;  ///< index into the arm's list; as a goal it may be left open
  Pose T_world_object{Pose::Identity()};  ///< pose on the support
};

struct RegraspTask {
  ObjectState start, goal;        ///< where the object is, and where it is to be
  std::vector<Pose> other_goals;  ///< T_world_object: alternatives to the goal
  std::vector<Pose> placements;   ///< T_world_object: intermediate placements
};

enum class RegraspStepKind { pick, pass, place, join };

/// An object that both hands take where it stands and carry together.
struct TwoHandTask {
  Pose T_world_start{Pose::Identity()};  ///< where the object stands
  Pose T_world_goal{Pose::Identity()};   ///< where both hands release the object
  bool in_air{};  ///< a person takes the object at the goal; else the object is put down there
};

/// One change of hands. The whole robot's axes [rad].
struct RegraspStep {
  RegraspStepKind kind{};  ///< kind of the transfer
  int from{-1}, to{-1};    ///< indices of the arm that releases and the arm that takes; -1: none
  std::size_t grasp_from{}, grasp_to{};   ///< indices into the lists of these arms
  Pose T_world_object{Pose::Identity()};  ///< where the object is during the step
  Vector q;                               ///< all hands that touch the object closed on it
  Vector before;  ///< pick, pass, join: the taking hand, opened, at its stand-off
  /// Pass, place: the releasing hand, opened, at its stand-off; both if two put the object down.
  Vector after;
};

struct RegraspSettings {
  /// Grasps of each list that are considered, spread over all orientations.
  std::size_t max_of_each{file_defaults().regrasp_grasps};
  double clearance{file_defaults().regrasp_clearance};  ///< between the hands [m]
  /// Max error of a held object's position when the other hand takes it [m].
  double slack{file_defaults().regrasp_slack};
  /// Distance of a hand before its approach and after its retreat [m].
  double stand_off{file_defaults().stand_off};
  /// Straight vertical motion after a pick and before a place [m].
  double lift{file_defaults().lift};
  /// Max motion of an arm axis on a straight path [rad].
  double max_turn{file_defaults().max_approach_turn};
  /// Places and turns of the object tried to pass it in one double grasp.
  int handover_tries{static_cast<int>(file_defaults().regrasp_poses)};
  /// The search ends when so many picks, passes and places were checked.
  std::uint64_t max_steps_tried{file_defaults().regrasp_steps};
  StepCosts costs;  ///< of the steps
  /// Fraction of the length of an arm up to which its hand is away without strain.
  double comfortable{file_defaults().regrasp_comfortable};
  /// Between an opened hand and the object on a straight path [m].
  double hand_clearance{file_defaults().regrasp_hand_clearance};
  GripForceSettings grip;  ///< of hands that bear a load together
  /// Of the palms of two hands that carry together [m].
  double min_apart{file_defaults().both_apart};
  std::size_t max_pairs_tried{file_defaults().both_pairs};  ///< of two hands at once
  std::size_t motions_tried{file_defaults().both_motions};  ///< of each arm for one pair
};

struct RegraspPlan {
  std::vector<RegraspStep> steps;  ///< empty when nothing has to change, or when there is none
  bool solved{};                   ///< the object gets to the goal; also when nothing has to change
  std::string reason;              ///< why not, one sentence
  Refusals rejected;               ///< steps that were checked and why they cannot be made
  /// Steps checked in detail; pairs of grasps of two hands that do not collide.
  std::uint64_t checked{}, double_grasps{};
  std::vector<LoadShare> load_shares;  ///< of two hands at once, one an arm: grip of each
};

/// Keeps what it found about an object on a robot in a scene: later tasks with the same object are
/// answered faster. For one thread.
class RegraspPlanner {
 public:
  /// `arms`: one or two. The scene's boxes are obstacles; its objects are too, but the one with the
  /// id `object_id`.
  RegraspPlanner(const RobotModel& robot, std::vector<RegraspArm> arms, const Graspable& object,
                 ObjectLibrary library, const Scene& scene, const std::string& object_id);
  ~RegraspPlanner();

  /// Replaces the settings, which are the defaults before, and forgets what was found.
  void set_settings(const RegraspSettings& settings);

  /// The sequence with the fewest steps; among those of equal length about the one of the best
  /// grasps. ConfigError when start or goal name an arm or a grasp that is not there.
  RegraspPlan plan(const RegraspTask& task, const std::function<bool()>& cancelled = {});

  /// Two hands that take it at once where it stands, up by `lift`, straight over and down, or after
  /// the lift straight to a goal in the air: pick, join, place. All along the path both arms keep
  /// the angles of their elbows, stay inside their limits and touch nothing, and the fingers of
  /// both bear the load. ConfigError when there is one arm.
  RegraspPlan plan_together(const TwoHandTask& task, const std::function<bool()>& cancelled = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns a word for reports: "pick", "pass", "place" or "join".
const char* name(RegraspStepKind);

}  // namespace handsel::grasp_planner
