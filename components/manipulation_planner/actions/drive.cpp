// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/cost/person_frame.hpp"
#include "common/messages/names.hpp"
#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/driving/handover_place.hpp"
#include "components/manipulation_planner/driving/standing_search.hpp"
#include "components/manipulation_planner/handover/otp_choice.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"
#include "components/manipulation_planner/parts.hpp"
#include "components/manipulation_planner/placing/top_grid.hpp"

namespace handsel::manipulation_planner {
namespace {

/// Places to drive to, the best first, or why there are none.
struct DrivePlaces {
  Outcome outcome;
  std::vector<Vector3> places;  // x, y [m], heading [rad] in the root frame
};

Vector3 in_root_frame(const Parts& parts, const Pose& T_world_platform) {
  const Pose T = parts.now.T_world_base().inverse() * T_world_platform;
  return {T.translation().x(), T.translation().y(), std::atan2(T.linear()(1, 0), T.linear()(0, 0))};
}

/// Places from which a grasp of the object serves; none where it is within reach already.
Routine<DrivePlaces> places_for_object(Parts& parts, const std::string& object) {
  DrivePlaces found;
  if (parts.now.object(object) == nullptr) {
    found.outcome =
        Outcome::failure("object " + object + " is not in the scene", ActionFailure::not_visible);
    co_return found;
  }
  GraspList list = co_await ask_grasps_anywhere(parts, object);
  found.outcome = list.outcome;
  for (const Grasp& grasp : list.grasps) {
    if (!grasp.has_platform) break;
    const Pose T =
        make_pose({grasp.platform.x(), grasp.platform.y(), 0},
                  Eigen::Quaterniond(Eigen::AngleAxisd(grasp.platform.z(), Vector3::UnitZ())));
    found.places.push_back(in_root_frame(parts, T));
  }
  co_return found;
}

/// Where something could be put down on a surface.
StandingTarget target_on(const Parts& parts, const SceneBox& box) {
  const settings::ManipulationPlannerSettings& settings = parts.settings;
  StandingTarget target;
  const std::vector<SceneObject>& objects = parts.now.scene().objects;
  for (const Vector3& p : top_grid(box, settings.surface_edge, settings.surface_spacing)) {
    const bool taken = std::any_of(objects.begin(), objects.end(), [&](const SceneObject& o) {
      return o.id != parts.held.id() &&
             (o.T_world_object.translation() - p).norm() < settings.surface_clearance;
    });
    if (!taken) target.points.push_back(p);
  }
  return target;
}

/// Where a person comfortably takes and offers things.
StandingTarget target_before(const Person& person) {
  StandingTarget target;
  for (const Side side : {Side::right, Side::left})
    target.points.push_back(comfortable_reach(person, side));
  const Vector3 front = torso_axes(person).col(0).cwiseProduct(Vector3(1, 1, 0));
  target.front = front.stableNormalized();
  return target;
}

/// What a search of places works with, copied for a job.
struct SearchJob {
  std::shared_ptr<const RobotModel> robot;
  Group arm;
  ObjectLibrary objects;
  Scene scene;
  HumanState people;
  Attachment attachment;
  Vector q;
  CostSettings cost;
  settings::ManipulationPlannerSettings settings;
  StandingTarget target;
  std::optional<HandoverNeeds> handover;  ///< nullopt: nothing is handed over there
  StandingSearch result;

  void run() {
    PlatformFloor floor(*robot, objects, scene, people,
                        {settings.standing_room, settings.furniture_room});
    floor.carry(attachment);
    NavigationCost navigation(*robot, cost);
    navigation.set_people(people, scene.T_world_base);
    const StandingQuery query{*robot, arm, q, scene.T_world_base, navigation};
    const ServesFrom serves = [this](const StandingPlace& place) {
      return can_hand_over_from(place.place, *handover, *robot, arm, scene, settings);
    };
    result = find_standing_places(query, target, floor, settings, handover ? serves : nullptr);
  }
};

/// What the held object needs to be handed to a person; nullopt: no grasp holds an object.
std::optional<HandoverNeeds> handover_to(Parts& parts, const Person& person) {
  const auto& grasp = parts.held.grasp();
  if (!grasp) return std::nullopt;
  return HandoverNeeds{person,
                       parts.arm.configuration(),
                       parts.now.layers(),
                       parts.arm.palm(),
                       parts.held.attachment().T_tool_object,
                       barred_directions(*grasp),
                       grasp->partners,
                       parts.arm.direction_back(*grasp)};
}

Routine<DrivePlaces> places_for(Parts& parts, StandingTarget target,
                                std::optional<HandoverNeeds> handover) {
  auto work = std::make_shared<SearchJob>(SearchJob{parts.arm.shared_robot(),
                                                    parts.arm.group(),
                                                    parts.now.objects(),
                                                    parts.now.scene(),
                                                    parts.now.people(),
                                                    parts.held.attachment(),
                                                    parts.arm.configuration(),
                                                    parts.cost,
                                                    parts.settings,
                                                    std::move(target),
                                                    std::move(handover),
                                                    {}});
  const std::function<void()> job = [work] { work->run(); };
  DrivePlaces found;
  found.outcome = co_await parts.worker.run(job);
  for (const auto& refusal : work->result.refusals) parts.refuse(refusal.what, refusal.reason);
  for (const StandingPlace& place : work->result.places) found.places.push_back(place.place);
  if (found.outcome.good && found.places.empty())
    found.outcome = Outcome::failure("the platform finds no place to stand: " +
                                     work->result.refusals.front().reason);
  co_return found;
}

Routine<DrivePlaces> find_places_for(Parts& parts, const ActionGoal& goal) {
  DrivePlaces found;
  if (goal.has_goal) {
    found.places = {in_root_frame(parts, goal.T_world_goal)};
  } else if (!goal.object.empty()) {
    found = co_await places_for_object(parts, goal.object);
  } else if (!goal.human.empty()) {
    const Person* person = parts.now.person(goal.human);
    if (person == nullptr)
      found.outcome = Outcome::out_of_sight("person " + goal.human);
    else
      found = co_await places_for(parts, target_before(*person), handover_to(parts, *person));
  } else {
    const SceneBox* box = parts.now.surface(goal.surface);
    if (box == nullptr)
      found.outcome = Outcome::failure("there is no surface " + goal.surface);
    else
      found = co_await places_for(parts, target_on(parts, *box), std::nullopt);
  }
  co_return found;
}

/// Chooses places as the world is now, and drives to one of them until the scene shows the platform
/// there.
Routine<Outcome> drive_once(Parts& parts, const ActionGoal& goal) {
  parts.action.phase = ActionPhase::choosing_platform_place;
  const DrivePlaces found = co_await find_places_for(parts, goal);
  if (!found.outcome.good || found.places.empty()) co_return found.outcome;
  MotionSpec motion;
  motion.phase = ActionPhase::moving_platform;
  motion.is_of_platform = true;
  motion.speed = parts.held.is_holding() ? parts.settings.carry_speed : 1.0;
  motion.goals.assign(found.places.begin(), found.places.end());
  motion.T_world_root = parts.now.T_world_base();
  Outcome driven = co_await move(parts, motion);
  if (!driven.good) co_return driven;
  const RobotModel& robot = parts.arm.robot();
  const auto has_arrived = [&] {
    const Vector& seen = parts.now.scene().robot_position;
    return (platform_place(robot, seen) - platform_place(robot, parts.now.set_point())).norm() <
           parts.settings.drive_arrived;
  };
  co_await parts.waiting.until(has_arrived, parts.settings.arrival_timeout);
  co_return driven;
}

/// Returns whether the kind of a failure excludes that somebody stands in the way.
bool names_cause(ActionFailure kind) {
  return kind != ActionFailure::none && kind != ActionFailure::other;
}

/// Returns whether anybody else than `served` is known: they may stand where the robot could.
bool others_than(const Parts& parts, const std::string& served) {
  const auto& people = parts.now.people().people;
  return std::any_of(people.begin(), people.end(),
                     [&](const Person& person) { return person.id != served; });
}

/// Drives, again where the platform is found elsewhere than its wheels have measured, and for a
/// while where others may stand in the way.
Routine<Outcome> drive_patiently(Parts& parts, const ActionGoal& goal) {
  Outcome driven;
  const TimePoint begin = parts.now.time();
  for (std::uint32_t displacements = 0; displacements < parts.settings.drive_attempts;) {
    driven = co_await drive_once(parts, goal);
    const bool is_displaced = driven.end == MotionEnd::displaced;
    const bool is_in_the_way = !driven.good && driven.end == MotionEnd::failed &&
                               !names_cause(driven.kind) && others_than(parts, goal.human) &&
                               to_seconds(parts.now.time() - begin) < parts.settings.drive_patience;
    if (!is_displaced && !is_in_the_way) break;
    parts.refuse(text_of(ActionPhase::moving_platform), driven.reason);
    displacements += is_displaced;
    if (is_in_the_way) co_await parts.waiting.pause(parts.settings.drive_pause);
  }
  co_return driven;
}

}  // namespace

Routine<Outcome> drive(Parts& parts, const ActionGoal& goal) {
  const RobotModel& robot = parts.arm.robot();
  if (!drives(robot))
    co_return Outcome::failure("robot " + robot.name() + " has no platform that drives");
  Outcome driven = co_await rest_all(parts);
  if (driven.good) driven = co_await drive_patiently(parts, goal);
  // The platform stops a little beside its place: the grasps may be out of reach from there. Where
  // one is within reach, there is nothing left to drive.
  const std::uint32_t corrections = goal.object.empty() ? 0 : parts.settings.drive_corrections;
  for (std::uint32_t i = 0; driven.good && i < corrections; ++i)
    driven = co_await drive_patiently(parts, goal);
  co_return driven;
}

}  // namespace handsel::manipulation_planner
