// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/hand/hands.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/model/manipulator.hpp"

namespace handsel::trajectory_controller {

namespace {

HandAxes axes_of(const RobotModel& robot, const Group* fingers) {
  HandAxes hand;
  if (fingers == nullptr) return hand;
  for (int axis : fingers->axes) {
    const Axis& bounds = robot.axes()[static_cast<std::size_t>(axis)];
    const Joint& joint = robot.joints()[static_cast<std::size_t>(bounds.joint)];
    hand.axes.push_back(axis);
    hand.lower.push_back(bounds.lower);
    hand.upper.push_back(bounds.upper);
    hand.sliding.push_back(joint.kind == JointKind::prismatic);
  }
  return hand;
}

/// Returns the payload of a hand that the servos compensate [kg].
double held_payload(const ServoReference& reference, std::size_t hand) noexcept {
  if (hand == 0) return reference.payload;
  const auto other = static_cast<Eigen::Index>(hand) - 1;
  return other < reference.other_payloads.size() ? reference.other_payloads[other] : 0.0;
}

/// Returns the measured payload of a hand [kg].
double felt_payload(const RobotState& robot, std::size_t hand) noexcept {
  if (hand == 0) return robot.payload;
  return hand <= robot.other_hands.size() ? robot.other_hands[hand - 1].payload : 0.0;
}

/// Returns the measured external wrench on a hand, in its frame; nullptr if not measured.
const Wrench* felt_wrench(const RobotState& robot, std::size_t hand) noexcept {
  if (hand == 0) return &robot.wrist_wrench;
  return hand <= robot.other_hands.size() ? &robot.other_hands[hand - 1].wrist_wrench : nullptr;
}

/// Finds the nearest hand of a person to a hand at `p` (world [m]), or keeps a nearer one of
/// before, and the handover partner as seen from `p`.
void find_people(const ObservedPeople& people, const Vector3& p, HandInputs& in) noexcept {
  double torso = std::numeric_limits<double>::infinity();
  for (const PersonPoints& person : people.points()) {
    const double left = (person.left_hand - p).norm(), right = (person.right_hand - p).norm();
    in.person_distance = std::min({in.person_distance, left, right});
    const Vector3 to_torso = person.torso - p;
    const bool may_take = people.partner().empty() || person.id == people.partner();
    if (may_take && to_torso.norm() < torso && to_torso.norm() > 1e-6) {
      torso = to_torso.norm();
      in.toward = to_torso / torso;
    }
  }
}

/// Returns whether a trajectory moves fingers of a hand. `on_path` has one flag per robot axis.
bool is_on_path(const HandExecutor& hand, const std::vector<char>& on_path) noexcept {
  return std::any_of(hand.axes().begin(), hand.axes().end(),
                     [&on_path](int axis) { return on_path[static_cast<std::size_t>(axis)] != 0; });
}

}  // namespace

Hands::Hands(const HandSettings& settings, const RobotModel& robot, double period)
    : period_(period), effort_(Vector::Zero(robot.dof())) {
  for (const Manipulator& hand : hands_of(robot)) {
    const std::string group = hand.fingers != nullptr ? hand.fingers->name : "hand";
    HandExecutor executor(settings, axes_of(robot, hand.fingers), robot.comfort_limits(),
                          robot.stop_limits());
    hands_.push_back({group, hand.palm, std::move(executor)});
    const std::vector<int>& axes = hands_.back().executor.axes();
    axes_.insert(axes_.end(), axes.begin(), axes.end());
  }
  const auto count = static_cast<Eigen::Index>(hands_.size());
  other_payloads_ = Vector::Zero(count == 0 ? 0 : count - 1);
}

Hands::Hand* Hands::find(const std::string& group) {
  const auto same = [&](const Hand& hand) { return hand.group == group; };
  const auto found = std::find_if(hands_.begin(), hands_.end(), same);
  if (found != hands_.end()) return &*found;
  return group.empty() && !hands_.empty() ? &hands_.front() : nullptr;
}

std::string Hands::why_not_on_path(const std::vector<std::uint32_t>& axes) const {
  for (const Hand& hand : hands_) {
    const std::vector<int>& fingers = hand.executor.axes();
    const bool concerned = std::any_of(axes.begin(), axes.end(), [&](std::uint32_t axis) {
      return std::find(fingers.begin(), fingers.end(), static_cast<int>(axis)) != fingers.end();
    });
    if (concerned && !hand.executor.is_free())
      return "the hand \"" + hand.group + "\" executes a command or holds something";
  }
  return {};
}

std::string Hands::accept(const HandCommand& command, std::string refusal,
                          const std::vector<char>& on_path) {
  last_command_ = command.id;
  Hand* hand = find(command.group);
  if (refusal.empty() && hand != nullptr && is_on_path(hand->executor, on_path))
    refusal = "a trajectory moves the fingers of the hand \"" + hand->group + "\"";
  if (refusal.empty())
    refusal = hand == nullptr ? "there is no hand \"" + command.group + "\""
                              : hand->executor.accept(command);
  if (hand != nullptr) hand->refused = !refusal.empty();
  if (!refusal.empty()) return refusal;
  accepted_ = command.id;
  hand->together = command.both_hands;
  // Watches that begin at the same time decide the same: the hands release together.
  if (command.both_hands && command.action == HandAction::release_on_pull)
    for (Hand& other : hands_) other.restarts_watch = other.together;
  const bool takes_payload = command.payload > 0.0 || hand->payload == 0.0;
  if (command.action == HandAction::grasp && takes_payload) hand->grasped_payload = command.payload;
  return {};
}

void Hands::reset(const Vector& position, const ServoReference* reference) noexcept {
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    Hand& hand = hands_[i];
    hand.executor.reset(position, reference != nullptr ? reference->effort : Vector());
    const double held =
        reference != nullptr ? trajectory_controller::held_payload(*reference, i) : 0.0;
    hand.payload = hand.grasped_payload = held;
    hand.together = false;
  }
}

bool Hands::step(const HandsInputs& in, TimePoint now, MotionState3& next) noexcept {
  bool changed = false;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    Hand& hand = hands_[i];
    const HandState before = hand.executor.state();
    if (is_on_path(hand.executor, in.on_path))
      hand.executor.reset(next.position);
    else if (hand.executor.size() > 0)
      step(i, in, now, next);
    const HandState state = hand.executor.state();
    if (state == HandState::grasped) hand.payload = hand.grasped_payload;
    if (state == HandState::empty || state == HandState::released) hand.payload = 0.0;
    changed = changed || state != before;
    if (i > 0) other_payloads_[static_cast<Eigen::Index>(i) - 1] = hand.payload;
  }
  return changed;
}

void Hands::feel(std::size_t index, const HandsInputs& all, HandInputs& in) const noexcept {
  const bool together = hands_[index].together;
  Vector3 p_sum = Vector3::Zero();
  int count = 0;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    const Hand& hand = hands_[i];
    if (hand.palm < 0 || (i != index && !(together && hand.together))) continue;
    const Pose T_world_tool =
        all.robot.T_world_base * all.T_root_link[static_cast<std::size_t>(hand.palm)];
    const Wrench* felt = felt_wrench(all.robot, i);
    if (felt != nullptr) in.force += T_world_tool.linear() * felt->force;
    find_people(all.people, T_world_tool.translation(), in);
    p_sum += T_world_tool.translation();
    ++count;
  }
  if (count > 1) find_people(all.people, p_sum / count, in);
}

void Hands::step(std::size_t index, const HandsInputs& all, TimePoint now,
                 MotionState3& next) noexcept {
  Hand& hand = hands_[index];
  HandInputs in;
  in.robot = &all.robot;
  in.new_state = all.new_state;
  in.may_move = all.mode < Mode::hold;
  in.stop = all.mode >= Mode::stop;
  in.too_near = too_near_;
  in.person_distance = std::numeric_limits<double>::infinity();
  in.clamped = all.clamped && !all.people.partner().empty();
  in.payload = felt_payload(all.robot, index);
  in.restarts_watch = std::exchange(hand.restarts_watch, false);
  if (in.new_state) feel(index, all, in);
  hand.executor.step(in, period_, now, next);
  for (int i = 0; i < hand.executor.size(); ++i) {
    const int axis = hand.executor.axes()[static_cast<std::size_t>(i)];
    effort_[axis] = hand.executor.effort(i);
  }
}

void Hands::limit(const FingerBounds& bounds) noexcept {
  too_near_ = bounds.too_near;
  for (Hand& hand : hands_) hand.executor.limit_speed(bounds.speed);
}

void Hands::stop_from(const MotionState3& sent, MotionState3& next) noexcept {
  for (Hand& hand : hands_) {
    hand.executor.stop_from(sent);
    hand.executor.advance(period_, next);
  }
}

void Hands::follow(const Vector& position, double dead_band) noexcept {
  for (Hand& hand : hands_) hand.executor.follow(position, dead_band);
}

double Hands::held_payload() const noexcept {
  double mass = 0.0;
  for (const Hand& hand : hands_) mass += hand.payload;
  return mass;
}

bool Hands::any_moving() const noexcept {
  return std::any_of(hands_.begin(), hands_.end(),
                     [](const Hand& hand) { return hand.executor.state() == HandState::moving; });
}

bool Hands::has_released(const std::string& group) const noexcept {
  const auto same = [&](const Hand& hand) { return hand.group == group; };
  const auto found = std::find_if(hands_.begin(), hands_.end(), same);
  if (hands_.empty()) return false;
  const Hand& hand = found != hands_.end() ? *found : hands_.front();
  return hand.executor.state() == HandState::released;
}

std::uint64_t Hands::key() const noexcept {
  std::uint64_t key = 0;
  for (const Hand& hand : hands_) key = key << 8 | static_cast<std::uint64_t>(hand.reported());
  return key;
}

void Hands::report(ExecutionStatus& status) const {
  status.hand_command = last_command_;
  if (hands_.empty()) return;
  status.hand = hands_.front().reported();
  status.pull = hands_.front().executor.pull();
  for (std::size_t i = 1; i < hands_.size(); ++i)
    status.other_hands.push_back({hands_[i].group, hands_[i].reported()});
}

}  // namespace handsel::trajectory_controller
