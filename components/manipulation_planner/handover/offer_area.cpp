// Room before people: where the hand waits so that somebody can hold something out to it (ours).
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/human/human_body.hpp"
#include "components/manipulation_planner/planner.hpp"

namespace handsel::manipulation_planner {

namespace {
// [m] The waiting hand keeps so far, level, from where a person would hold something out comfortably: nobody puts it into a hand that is
// there already; the arm keeps the second. Less room by more than the third makes it draw back.
constexpr double kRoom = 0.55, kArmRoom = 0.35, kCrowded = 0.05;
constexpr std::size_t kPostures = 6;  // to wait in that are looked for

Vector3 level(const Vector3& v) { return {v.x(), v.y(), 0}; }
}  // namespace

double ManipulationPlanner::room_before(const Person& who, const Vector& posture) const {
  double room = std::numeric_limits<double>::infinity();
  const Vector3 p_hand = snapshot_.T_world_base() * robot_->link_pose(posture, palm_).translation();
  for (const Side side : {Side::left, Side::right}) {
    const Vector3 p_offer = comfortable_reach(who, side);
    room =
        std::min({room, level(p_hand - p_offer).norm() - kRoom, way_out_.distance(posture, snapshot_.T_world_base(), p_offer) - kArmRoom});
  }
  return room;
}

bool ManipulationPlanner::crowds(const std::string& id) const {
  const Person* who = snapshot_.person(id);
  return who != nullptr && room_before(*who, posture()) < -kCrowded;
}

bool ManipulationPlanner::room_is_made(const Motion& motion) const {
  const std::string& who = motion.makes_room_for;
  return !who.empty() && offered(goal_.object, who) && (motion.any_offer || !crowds(who));
}

std::vector<Vector> ManipulationPlanner::postures_before(const Person& who) const {
  struct Place {
    Vector joints;
    double room, from_rest;
  };
  const Pose T_rest = snapshot_.T_world_base() * robot_->link_pose(robot_->rest_posture(), palm_);
  const Vector3 away =
      level(snapshot_.T_world_base().translation() - who.joints[static_cast<std::size_t>(body_joint_index("torso"))].position)
          .stableNormalized();
  const Vector3 aside = Vector3::UnitZ().cross(away);
  std::vector<Place> places;
  IkOptions options;
  options.restarts = 0;
  for (const double back : {0.0, 0.1, 0.2, 0.3}) {
    for (const double beside : {0.0, 0.15, -0.15, 0.3, -0.3, 0.45, -0.45}) {
      Pose T = T_rest;
      T.translation() += back * away + beside * aside;
      const auto joints = robot_->inverse(arm_, snapshot_.T_world_base().inverse() * T, robot_->rest_posture(), options);
      if (joints) places.push_back({*joints, room_before(who, RobotModel::with(posture(), arm_, *joints)), std::hypot(back, beside)});
    }
  }
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    const bool enough = a.room >= 0;
    if (enough != (b.room >= 0)) return enough;
    return enough ? a.from_rest < b.from_rest : a.room > b.room;
  });
  if (places.size() > kPostures) places.resize(kPostures);
  std::vector<Vector> out;
  for (Place& place : places) out.push_back(std::move(place.joints));
  return out;
}

Routine<Outcome> ManipulationPlanner::go_to_rest() {
  Motion motion;
  motion.phase = ActionPhase::to_rest;
  motion.speed = attachment_.object.empty() ? 1.0 : settings_.carry_speed();
  const Vector rest = RobotModel::with(posture(), arm_, RobotModel::part(robot_->rest_posture(), arm_));
  const Person* who = snapshot_.person("");
  if (who != nullptr && room_before(*who, rest) < -kCrowded) motion.goals = postures_before(*who);
  if (motion.goals.empty()) motion.goals = {RobotModel::part(robot_->rest_posture(), arm_)};
  Outcome outcome = co_await move(motion);
  co_return outcome;
}

Routine<Outcome> ManipulationPlanner::make_room(const std::string& giver, bool for_offer) {
  const Person* who = snapshot_.person(giver);
  if (who == nullptr) co_return Outcome::failure("nobody is in sight");
  Motion back;
  back.phase = ActionPhase::making_room;
  back.goals = postures_before(*who);
  back.makes_room_for = giver;
  back.any_offer = for_offer;
  if (back.goals.empty()) co_return Outcome::failure("no posture of the arm lies farther back");
  Outcome made = co_await move(back);
  co_return made;
}

}  // namespace handsel::manipulation_planner
