// From one grasp of an object to another, or from one place to another that one grasp does not serve: picking up, passing from hand to hand
// and putting down, as few times as can be (chapter section 3.2.10).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/grasp/grip_force.hpp"
#include "common/model/manipulator.hpp"
#include "components/grasp_planner/pair/double_grasp.hpp"
#include "components/grasp_planner/pair/load_share.hpp"

namespace handsel::grasp_planner {

/// An arm with the grasps of its hand on the object.
struct RegraspArm {
  Manipulator arm;
  const HandKit* kit{};
  const GraspList* list{};
};

/// One hand holds the object, or it stands somewhere.
struct ObjectState {
  int arm{-1};                            ///< index of the arm; -1: it stands
  std::optional<std::size_t> grasp;       ///< index into the arm's list; as a goal it may be left open
  Pose T_world_object{Pose::Identity()};  ///< where it stands
};

struct RegraspTask {
  ObjectState start, goal;
  std::vector<Pose> placements;  ///< T_world_object: where else it can be put down
};

enum class RegraspStepKind { pick, pass, place, join };

/// One change of hands. The whole robot's axes [rad].
struct RegraspStep {
  RegraspStepKind kind{};
  int from{-1}, to{-1};  ///< arms: who lets go, who takes
  std::size_t grasp_from{}, grasp_to{};
  Pose T_world_object{Pose::Identity()};
  Vector q;       ///< all hands that touch the object closed on it
  Vector before;  ///< pick, pass, join: the hand that comes, opened, off the object
  Vector after;   ///< pass, place: the hand that went, opened, off the object; both when two put it down
};

struct RegraspSettings {
  std::size_t most_of_each{200};         ///< grasps of each list that are considered, spread over all orientations
  double clearance{0.004};               ///< between the hands [m]
  double slack{0.005};                   ///< what is held may lie this far from where it was planned to, when the other hand comes [m]
  double stand_off{0.09};                ///< of a hand before it comes and after it went [m]
  double lift{0.08};                     ///< what is picked up or put down must be able to go this far straight up [m]
  int exchange_tries{200};               ///< places and turns of the object tried to pass it in one double grasp
  std::uint64_t most_steps_tried{3000};  ///< the search ends when so many picks, passes and places were judged
  GripForceSettings grip;                ///< of hands that share a load
  double least_apart{0.25};              ///< of the palms of two hands that carry together [m]
  std::size_t most_pairs_tried{400};     ///< of two hands at once
};

struct RegraspPlan {
  std::vector<RegraspStep> steps;  ///< empty when nothing has to change, or when there is none
  bool solved{};
  std::string reason;  ///< why not, one sentence
  Refusals rejected;   ///< steps that were judged and why they cannot be made
  std::uint64_t judged{}, double_grasps{};
  std::vector<LoadShare> shares;  ///< of two hands at once, one an arm: how each squeezes
};

/// Keeps what it found about an object on a robot in a scene: later tasks with the same object are answered faster. For one thread.
class RegraspPlanner {
 public:
  /// `arms`: one or two. The scene's boxes are obstacles; its objects are too, but the one with the id `object_id`.
  RegraspPlanner(const RobotModel& robot, std::vector<RegraspArm> arms, const Graspable& object, ObjectLibrary library, const Scene& scene,
                 const std::string& object_id, const RegraspSettings& settings = {});
  ~RegraspPlanner();

  /// The sequence with the fewest steps; among those of equal length about the one of the best grasps. ConfigError when start or goal name
  /// an arm or a grasp that is not there.
  RegraspPlan plan(const RegraspTask& task, const std::function<bool()>& cancelled = {});

  /// Two hands that take it at once where it stands, up by `lift`, straight over and down: pick, join, place. On the whole way both arms
  /// keep the angles of their elbows, stay inside their limits and touch nothing, and the fingers of both bear the load. ConfigError when
  /// there is one arm.
  RegraspPlan plan_together(const Pose& T_world_start, const Pose& T_world_goal, const std::function<bool()>& cancelled = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

const char* name(RegraspStepKind);

}  // namespace handsel::grasp_planner
