// Putting down: a place is chosen before the object is picked, so that the grasp serves there too (chapter section 3.2.9; places: ours).
#include <algorithm>
#include <numbers>

#include "components/manipulation_planner/placing/place_search.hpp"
#include "components/manipulation_planner/planner.hpp"

namespace handsel::manipulation_planner {

namespace {
constexpr std::size_t kPlaces = 24;   // on a surface that are looked at
constexpr std::size_t kPostures = 6;  // that motions are planned to
constexpr double kPatience = 3.0;     // [s] with a person at the hand
}  // namespace

Routine<ManipulationPlanner::Serving> ManipulationPlanner::serving(const std::string& object_id, const std::string& onto,
                                                                   const std::vector<Grasp>& grasps, std::size_t most, std::size_t places) {
  auto found = std::make_shared<Serving>();
  const SceneObject* thing = snapshot_.object(object_id);
  std::vector<SceneBox> surfaces;
  for (const SceneBox& box : snapshot_.scene().boxes)
    if (box.supports && (onto.empty() || box.id == onto)) surfaces.push_back(box);
  if (thing == nullptr || surfaces.empty()) co_return *found;
  const std::function<void()> job = [this, found, world = worker_.world(*robot_, snapshot_.objects()), scene = snapshot_.scene(),
                                     people = snapshot_.people(), surfaces, object_id, grasps, most, places, q = posture(),
                                     T_now = thing->T_world_object] {
    place_world(*world, scene, people);
    PlacingSettings placing;
    placing.reach = arm_reach(*robot_, &arm_, palm_);
    for (const SceneBox& box : surfaces) {
      Putting putting(*world, *robot_, arm_, scene.T_world_base,
                      free_places(*robot_, scene, people, snapshot_.objects(), object_id, box, T_now, places, placing),
                      settings_.lift_height());
      for (std::size_t i = 0; i < grasps.size() && found->at.size() < most; ++i) {
        if (found->at.count(i) > 0) continue;
        const Vector closed = RobotModel::with(RobotModel::with(q, arm_, grasps[i].arm_joints), fingers_, grasps[i].hand_joints);
        const Vector opened = RobotModel::with(closed, fingers_, grasps[i].pregrasp_joints);
        const auto posture = putting.anywhere(closed, opened, {object_id, grasps[i].T_object_hand.inverse()}, 1);
        if (!posture.empty()) found->at[i] = {grasps[i].id, object_id, box.id, posture.front().T_world_object};
      }
      found->objections = putting.objections();
    }
  };
  found->outcome = co_await worker_.run(job);
  co_return *found;
}

Routine<ManipulationPlanner::GraspList> ManipulationPlanner::ask_grasps_onto(const std::string& object_id, const std::string& onto) {
  destinations_.clear();
  GraspList list = co_await ask_grasps(object_id, "", settings_.max_grasps_onto());
  if (!list.outcome.good || snapshot_.surface(onto) == nullptr || snapshot_.object(object_id) == nullptr) co_return list;
  status_.phase = ActionPhase::choosing_place;
  const Serving found = co_await serving(object_id, onto, list.grasps, settings_.max_grasps(), kPlaces);
  if (!found.outcome.good || found.at.empty()) {
    refuse("place",
           found.outcome.good ? "no grasp of " + object_id + " serves on " + onto + " too: " + found.objections : found.outcome.reason);
    co_return list;
  }
  GraspList serving;
  for (const auto& [grasp, destination] : found.at) {
    serving.grasps.push_back(list.grasps[grasp]);
    destinations_.push_back(destination);
  }
  co_return serving;
}

/// Somebody is about to be at the palm. Fingers that open move toward them, and no guard slows fingers.
bool ManipulationPlanner::comes_to_hand() const {
  constexpr double kRoom = 0.30, kSoon = 0.8;  // [m], [s]
  const Vector3 p = T_world_tool().translation();
  return std::any_of(snapshot_.people().people.begin(), snapshot_.people().people.end(), [&](const Person& person) {
    return std::any_of(person.joints.begin(), person.joints.end(), [&](const BodyJoint& joint) {
      const Vector3 way = p - joint.position;
      const double left = way.norm() - kRoom, closing = joint.velocity.dot(way.normalized());
      return left < 0 || (closing > 0 && left < kSoon * closing);
    });
  });
}

void ManipulationPlanner::place_world(CollisionWorld& world, const Scene& scene, const HumanState& people) {
  world.set_scene(scene);
  world.set_people(people);
  world.set_moving_axes({});
}

Routine<Outcome> ManipulationPlanner::lower(const PuttingPosture& posture) {
  Motion above;
  above.phase = ActionPhase::carry;
  above.goals = {posture.arm_above};
  above.speed = settings_.carry_speed();
  Outcome last = co_await move(above);
  if (!last.good) co_return last;
  Motion down = above;
  down.phase = ActionPhase::put_down;
  down.goals = {posture.arm_at};
  down.straight = true;
  down.speed = settings_.approach_speed();
  last = co_await move(down);
  co_return last;
}

Routine<Outcome> ManipulationPlanner::place(const std::string& object_id, const std::string& onto) {
  if (!status_.holding || attachment_.object != object_id) co_return Outcome::failure("the hand does not hold " + object_id);
  const SceneBox* box = snapshot_.surface(onto);
  if (box == nullptr) co_return Outcome::failure("there is no surface called " + onto);
  if (snapshot_.model_of(object_id) == nullptr) co_return Outcome::failure("object " + object_id + " has no model");
  status_.phase = ActionPhase::choosing_place;
  const auto chosen = std::find_if(destinations_.begin(), destinations_.end(), [&](const Destination& d) {
    return grasp_ && d.grasp == grasp_->id && d.object == object_id && d.surface == onto;
  });
  const std::optional<Pose> T_chosen = chosen == destinations_.end() ? std::nullopt : std::optional<Pose>(chosen->T_world_object);

  struct Found {
    std::vector<PuttingPosture> postures;
    std::string objections;
  };
  auto found = std::make_shared<Found>();
  const Vector opening = grasp_ ? grasp_->pregrasp_joints : RobotModel::part(robot_->rest_posture(), fingers_);
  const std::function<void()> job = [this, found, T_chosen, opening, world = worker_.world(*robot_, snapshot_.objects()),
                                     scene = snapshot_.scene(), people = snapshot_.people(), box = *box, held = attachment_, q = posture(),
                                     T_now = T_world_tool() * attachment_.T_tool_object] {
    place_world(*world, scene, people);
    PlacingSettings placing;
    placing.reach = arm_reach(*robot_, &arm_, palm_);
    std::vector<Pose> places = free_places(*robot_, scene, people, snapshot_.objects(), held.object, box, T_now, kPlaces, placing);
    if (T_chosen) places.insert(places.begin(), *T_chosen);
    Putting putting(*world, *robot_, arm_, scene.T_world_base, std::move(places), settings_.lift_height());
    found->postures = putting.anywhere(q, RobotModel::with(q, fingers_, opening), held, kPostures);
    found->objections = putting.objections();
  };
  Outcome last = co_await worker_.run(job);
  if (!last.good) co_return last;
  if (found->postures.empty()) co_return Outcome::failure("no free place on " + onto + " within the arm's reach: " + found->objections);
  for (const PuttingPosture& posture : found->postures) {
    last = co_await lower(posture);
    if (!last.good) continue;
    destinations_.clear();
    co_await waiting_.until([this] { return !comes_to_hand(); }, kPatience);
    HandResult released = co_await hand(HandAction::release, opening, settings_.hand_timeout());
    if (!released.outcome.good) co_return released.outcome;
    release_object();
    const std::string nobody;
    Outcome back = co_await retreat(nobody, object_id);
    if (!back.good) refuse("retreat", back.reason);
    co_return Outcome{};
  }
  co_return last;
}

}  // namespace handsel::manipulation_planner
