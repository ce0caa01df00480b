#include "components/spark/scene_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "common/model/human/human_body.hpp"
#include "common/model/manipulator.hpp"
#include "common/model/object_extent.hpp"
#include "components/spark/directed.hpp"

namespace handsel::spark {
namespace {

constexpr double kSameMove = 0.004;       // [m] what is seen this near the estimate is the same place: averaged
constexpr double kSameTurn = 0.06;        // [rad]
constexpr int kAverageOver = 15;          // [samples]
constexpr double kVelocityMemory = 0.06;  // [s]
constexpr double kMissed = 0.1;           // [s] what is held and unseen for longer moves with the hand
constexpr double kVelocityGap = 0.3;      // [s] longer unseen: nothing is known of its velocity
constexpr double kClearOfSupport = 0.01;  // [m] what a loaded hand has lifted so far stands there no longer
constexpr double kRevisionMove = 0.005;   // [m] an object that moved this far makes a new revision
constexpr double kRevisionDoubt = 0.02;   // [m] so does one whose place is more or less sure by this
constexpr double kFastest = 2.5;          // [m/s] of what somebody carries
constexpr double kLeap = 0.1;             // [m] beyond that a thing has jumped
constexpr double kTrust = 0.2;            // [s] a source that says nothing for longer is not believed any more
constexpr double kAgree = 0.01;           // [m] two sources may differ by this
constexpr double kTold = 5;               // [s] a refusal is told for so long

double arm_length(const RobotModel& robot) {
  double length = 0;
  for (int link = robot.tool_link(); link > 0;) {
    const Joint& joint = robot.joints()[static_cast<std::size_t>(robot.links()[static_cast<std::size_t>(link)].parent_joint)];
    if (joint.kind != JointKind::fixed || length == 0) length += joint.T_parent_joint.translation().norm();
    link = joint.parent;
  }
  return std::max(length, 0.5);
}

Coverage around(const Vector3& centre, double arm) {
  const double r = arm + 0.3;
  return {{centre.x() - r, centre.y() - r, 0.1}, {centre.x() + r, centre.y() + r, 1.9}};
}

bool differs(const Scene& a, const Scene& b) {
  if (a.objects.size() != b.objects.size() || a.boxes.size() != b.boxes.size() || a.robot_known != b.robot_known) return true;
  for (std::size_t i = 0; i < a.boxes.size(); ++i)
    if (a.boxes[i].id != b.boxes[i].id) return true;
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    const auto &x = a.objects[i], &y = b.objects[i];
    if (x.id != y.id || x.model != y.model || x.holder != y.holder || x.holder_id != y.holder_id) return true;
    if (x.primitive.kind != y.primitive.kind || x.primitive.size != y.primitive.size) return true;
    if (std::abs(x.uncertainty - y.uncertainty) > kRevisionDoubt) return true;
    const bool carried = x.holder == Holder::robot;  // it moves with the hand that everybody knows
    if (!carried && (x.T_world_object.translation() - y.T_world_object.translation()).norm() > kRevisionMove) return true;
  }
  return false;
}

// The place of what stands still is known better than one noisy look at it; what moves is taken as seen.
Pose averaged(const Pose& estimate, const Pose& seen, int& looks) {
  const Eigen::AngleAxisd turn(estimate.linear().transpose() * seen.linear());
  if ((seen.translation() - estimate.translation()).norm() > kSameMove || std::abs(turn.angle()) > kSameTurn) {
    looks = 1;
    return seen;
  }
  looks = std::min(looks + 1, kAverageOver);
  Pose out = estimate;
  out.translation() += (seen.translation() - estimate.translation()) / looks;
  out.linear() = estimate.linear() * Eigen::AngleAxisd(turn.angle() / looks, turn.axis()).toRotationMatrix();
  return out;
}

}  // namespace

SceneModel::SceneModel(const config::SparkSettings& settings, std::shared_ptr<const RobotModel> robot, ObjectLibrary objects,
                       std::vector<SceneBox> boxes)
    : settings_(settings), robot_(std::move(robot)), library_(std::move(objects)), boxes_(std::move(boxes)) {
  arm_length_ = arm_length(*robot_);
  for (const Manipulator& hand : hands_of(*robot_))
    hands_.push_back({hands_.empty() || hand.fingers == nullptr ? "" : hand.fingers->name, hand.palm});
  if (hands_.empty()) hands_.emplace_back();
}

void SceneModel::locate_hands() {
  if (!robot_known_) return;
  robot_->forward(position_, links_);
  for (Hand& hand : hands_)
    if (hand.palm >= 0) hand.T_world_palm = T_world_base_ * links_[static_cast<std::size_t>(hand.palm)];
}

/// A described model counts more than a primitive.
bool SceneModel::known_shape(ObservedObject& observed) const {
  const bool described = !observed.model.empty() && (!library_ || library_(observed.model) != nullptr);
  if (described) {
    observed.primitive = {};
    return true;
  }
  if (!primitive_shape(observed.primitive)) return false;
  observed.model.clear();
  return true;
}

void SceneModel::unswap(std::vector<ObservedObject>& seen, TimePoint at) const {
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t k = i + 1; k < seen.size(); ++k) {
      const auto a = objects_.find(seen[i].id), b = objects_.find(seen[k].id);
      if (a == objects_.end() || b == objects_.end() || seen[i].model != seen[k].model) continue;
      if (seen[i].primitive.kind != seen[k].primitive.kind || !seen[i].primitive.size.isApprox(seen[k].primitive.size, 0.1)) continue;
      const auto apart = [&](const ObservedObject& look, const Known& known) {
        return (look.T_world_object.translation() - known.last_seen_at).norm();
      };
      const double possible = kLeap + kFastest * to_seconds(at - std::min(a->second.seen, b->second.seen));
      const bool leapt = apart(seen[i], a->second) > possible && apart(seen[k], b->second) > possible;
      if (leapt && apart(seen[i], b->second) < possible && apart(seen[k], a->second) < possible) std::swap(seen[i].id, seen[k].id);
    }
  }
}

/// One source at a time, so that what stands still does not move to and fro between two that differ.
bool SceneModel::believes(Known& known, const ObservedObject& observed, const std::string& source, TimePoint seen) const {
  if (known.looks == 0 || known.source == source || to_seconds(seen - known.seen) > kTrust) {
    known.source = source;
    return true;
  }
  const double between = std::abs(to_seconds(seen - known.seen)) * known.object.velocity.norm();
  const double apart = (observed.T_world_object.translation() - known.last_seen_at).norm() - between;
  const bool wider = apart > known.spread || seen > known.spread_until;
  if (apart > kAgree && wider) known.spread = apart;
  if (apart > kAgree) known.spread_until = seen + from_seconds(settings_.doubt_time());
  return false;
}

void SceneModel::observe(const ObjectObservation& observation, TimePoint seen) {
  locate_hands();
  std::vector<ObservedObject> looks;
  for (ObservedObject observed : observation.objects) {
    if (known_shape(observed)) {
      looks.push_back(std::move(observed));
      continue;
    }
    ++refused_;
    refused_at_ = seen;
    refusal_ = "object " + observed.id + " of source " + observation.source +
               (observed.model.empty() ? " has neither a model nor a primitive"
                                       : " is of model " + observed.model + ", which is not described, and has no primitive") +
               " with a size above 0";
  }
  shorten(looks);
  unswap(looks, seen);
  for (const ObservedObject& observed : looks) {
    Known& known = objects_[observed.id];
    if (seen < known.seen || !believes(known, observed, observation.source, seen)) continue;
    const double leap = (observed.T_world_object.translation() - known.last_seen_at).norm();
    if (known.looks > 0 && leap > kLeap + kFastest * to_seconds(seen - known.seen)) {
      known.jump = leap;
      known.jump_until = seen + from_seconds(settings_.doubt_time());
    }
    follow(known, observed, seen);
    known.object.id = observed.id;
    known.object.model = observed.model;
    known.object.primitive = observed.primitive;
    known.object.T_world_object =
        known.looks > 0 ? averaged(known.object.T_world_object, observed.T_world_object, known.looks) : observed.T_world_object;
    known.looks = std::max(known.looks, 1);
    known.seen = seen;
    known.wandered = 0;
    if (robot_known_) known.T_palm_object = hands_[known.by].T_world_palm.inverse() * observed.T_world_object;
  }
  forget_least_relevant();
}

void SceneModel::want(const std::string& object) {
  constexpr std::size_t kMaxWanted = 8;
  if (object.empty() || std::find(wanted_.begin(), wanted_.end(), object) != wanted_.end()) return;
  wanted_.push_back(object);
  if (wanted_.size() > kMaxWanted) wanted_.pop_front();
}

Rank SceneModel::rank(const SceneObject& object) const {
  return rank_of(object, std::find(wanted_.begin(), wanted_.end(), object.id) != wanted_.end(), reach());
}

/// Of an observation as many as are remembered.
void SceneModel::shorten(std::vector<ObservedObject>& seen) {
  const LeftOut left_out = keep_lowest(seen, quotas_of(settings_).known_objects, [&](const ObservedObject& observed) {
    SceneObject object;
    if (const auto known = objects_.find(observed.id); known != objects_.end()) object.holder = known->second.object.holder;
    object.id = observed.id;
    object.T_world_object = observed.T_world_object;
    return rank(object);
  });
  forgotten_ += left_out.count;
}

void SceneModel::forget_least_relevant() {
  const std::size_t max = quotas_of(settings_).known_objects;
  if (objects_.size() <= max) return;
  std::vector<std::pair<Rank, std::string>> ranked;
  for (const auto& [id, known] : objects_) ranked.emplace_back(rank(known.object), id);
  std::sort(ranked.begin(), ranked.end());
  for (std::size_t i = max; i < ranked.size(); ++i) objects_.erase(ranked[i].second);
  forgotten_ += ranked.size() - max;
}

std::string SceneModel::left_out_in_reach() const {
  std::string out;
  for (const auto& [left_out, what] : {std::pair{&objects_left_out_, "objects"}, std::pair{&boxes_left_out_, "boxes"}}) {
    if (left_out->count == 0 || left_out->nearest > arm_radius(reach())) continue;
    char text[160];
    std::snprintf(text, sizeof text, "%u %s are left out of the scene, the nearest %.2f m from the robot and within its reach",
                  left_out->count, what, left_out->nearest);
    out += (out.empty() ? "" : "; ") + std::string(text);
  }
  return out;
}

std::string SceneModel::trouble(TimePoint now) const {
  const std::string crowded = left_out_in_reach();
  if (refused_ == 0 || to_seconds(now - refused_at_) > kTold) return crowded;
  return refusal_ + ": refused, " + std::to_string(refused_) + " so far" + (crowded.empty() ? "" : "; ") + crowded;
}

// Velocity by a first-order filter over what was seen; steps of the averaged place would look like jerks.
void SceneModel::follow(Known& known, const ObservedObject& observed, TimePoint seen) const {
  const Vector3 at = observed.T_world_object.translation();
  const double dt = to_seconds(seen - known.seen);
  if (known.looks == 0 || dt > kVelocityGap) {
    known.object.velocity.setZero();
  } else if (dt > 0) {
    known.object.velocity += -std::expm1(-dt / kVelocityMemory) * ((at - known.last_seen_at) / dt - known.object.velocity);
  }
  known.last_seen_at = at;
  known.grips = observed.grips;
}

void SceneModel::update(const RobotState& state) {
  robot_known_ = true;
  position_ = state.position;
  hands_.front().payload = state.payload;
  for (std::size_t i = 1; i < hands_.size(); ++i) hands_[i].payload = i <= state.other_hands.size() ? state.other_hands[i - 1].payload : 0;
  T_world_base_ = state.T_world_base;
}

const SceneBox* SceneModel::support_under(const SceneObject& object, double gap) const {
  const ObjectModel* model = library_ ? library_(object.model) : nullptr;
  const Eigen::AlignedBox3d box = object_extent(nullptr, object.primitive);
  if (model == nullptr && box.isEmpty()) return nullptr;
  double bottom = std::numeric_limits<double>::max();
  const auto reach = [&](const Vector3& v) { bottom = std::min(bottom, (object.T_world_object * v).z()); };
  if (model != nullptr)
    for (const auto& v : model->mesh.vertices) reach(v);
  else
    for (int i = 0; i < 8; ++i) reach(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  for (const auto& support : boxes_) {
    if (!support.supports) continue;
    const Vector3 p = support.T_world_box.inverse() * object.T_world_object.translation();
    const double top = support.T_world_box.translation().z() + support.size.z() / 2;
    if (std::abs(bottom - top) <= gap && std::abs(p.x()) <= support.size.x() / 2 && std::abs(p.y()) <= support.size.y() / 2)
      return &support;
  }
  return nullptr;
}

// A sensor feels the hand that is nearest to it.
void SceneModel::attribute_grips(Known& known, const HumanState& people) const {
  known.object.grips.clear();
  for (const ObservedGrip& felt : known.grips) {
    ObjectGrip grip{"", felt.force};
    double nearest = settings_.grip_distance();
    const auto claim = [&](const std::string& who, const Vector3& hand) {
      const double distance = (hand - felt.position).norm();
      if (distance >= nearest) return;
      nearest = distance;
      grip.person = who;
    };
    for (const Person& person : people.people)
      for (const char* hand : {"l_hand", "r_hand"})
        claim(person.id, person.joints[static_cast<std::size_t>(body_joint_index(hand))].position);
    for (const Hand& hand : hands_)
      if (robot_known_) claim(kRobotName, hand.T_world_palm.translation());
    known.object.grips.push_back(std::move(grip));
  }
}

/// An object with force sensors tells itself who has it: whoever had it keeps it until their grip is lost, then the strongest.
bool SceneModel::keep_gripped(SceneObject& object) const {
  const ObjectGrip* strongest = nullptr;
  const std::string now = object.holder == Holder::robot ? kRobotName : object.holder_id;
  for (const ObjectGrip& grip : object.grips) {
    if (grip.person.empty()) continue;
    const bool keeps = object.holder >= Holder::robot && grip.person == now && grip.force > settings_.grip_lost();
    if (keeps) return true;
    if (grip.force > settings_.grip_force() && (strongest == nullptr || grip.force > strongest->force)) strongest = &grip;
  }
  if (strongest == nullptr) return false;
  object.holder = strongest->person == kRobotName ? Holder::robot : Holder::human;
  object.holder_id = strongest->person == kRobotName ? "" : strongest->person;
  return true;
}

std::optional<std::size_t> SceneModel::loaded_hand(const Known& known) const {
  constexpr double kReach = 0.35;  // [m] from the palm
  constexpr double kTaken = 0.30;  // [m] and so near to come to be held: what only leans on the fingertips is not in the hand
  constexpr double kShare = 0.4;   // of its weight that is felt when it is held
  constexpr double kSome = 0.2;    // and that whoever had it feels at least
  const ObjectModel* model = library_ ? library_(known.object.model) : nullptr;
  if (model == nullptr || !robot_known_) return std::nullopt;
  std::optional<std::size_t> most;
  double together = 0;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    const Hand& hand = hands_[i];
    const double reach = known.object.holder == Holder::robot ? kReach : kTaken;
    if (!((known.object.T_world_object.translation() - hand.T_world_palm.translation()).norm() < reach)) continue;
    together += hand.payload;
    if (!most || hand.payload > hands_[*most].payload) most = i;
  }
  if (!most || !(together > kShare * model->mass)) return std::nullopt;
  const Hand& before = hands_[known.by];
  const bool kept = known.object.holder == Holder::robot && before.payload > kSome * model->mass;
  return kept ? known.by : *most;
}

void SceneModel::assign_holder(Known& known, const HumanState& people) const {
  SceneObject& object = known.object;
  if (keep_gripped(object)) return;
  const Vector3 where = object.T_world_object.translation();
  const std::optional<std::size_t> by = loaded_hand(known);
  const bool robot_may = by.has_value();
  if (robot_may && *by != known.by) {
    known.by = *by;
    known.T_palm_object = hands_[*by].T_world_palm.inverse() * object.T_world_object;
  }
  if (const SceneBox* box = support_under(object, robot_may ? kClearOfSupport : settings_.support_gap())) {
    object.holder = Holder::surface;
    object.holder_id = box->id;
    return;
  }
  if (robot_may) {
    object.holder = Holder::robot;
    object.holder_id = hands_[*by].name;
    return;
  }
  double nearest = settings_.near_distance();
  for (const auto& person : people.people) {
    if (!object.grips.empty()) break;  // nobody grips it
    for (const char* hand : {"l_hand", "r_hand"}) {
      const double distance = (person.joints[static_cast<std::size_t>(body_joint_index(hand))].position - where).norm();
      if (distance > nearest) continue;
      nearest = distance;
      object.holder = Holder::human;
      object.holder_id = person.id;
    }
  }
  const bool human_went = object.holder == Holder::human && nearest >= settings_.near_distance();
  const bool robot_went = object.holder == Holder::robot || object.holder == Holder::surface;
  if (nearest >= settings_.near_distance() && (human_went || robot_went)) {
    object.holder = Holder::nobody;
    object.holder_id.clear();
  }
}

/// How far it may have gone since it was seen: with the hand that has it no farther than the person may have gone.
void SceneModel::mislay(Known& known, const HumanState& people, TimePoint now) const {
  const double unseen = to_seconds(now - known.seen) - settings_.unseen_after();
  const double since = std::clamp(to_seconds(now - known.judged), 0.0, std::max(0.0, unseen));
  known.judged = now;
  SceneObject& object = known.object;
  if (object.holder == Holder::robot) known.wandered = 0;
  double speed = object.holder == Holder::robot ? 0 : settings_.unseen_drift(), with = 0;
  for (const Person& person : people.people) {
    if (object.holder == Holder::human && object.holder_id == person.id) with = person.inflation;
    for (const char* hand : {"l_hand", "r_hand"})
      if ((joint_of(person, hand).position - object.T_world_object.translation()).norm() <
              2 * settings_.near_distance() + person.inflation &&
          object.holder != Holder::robot)
        speed = settings_.touched_drift();
  }
  known.wandered = std::min(known.wandered + since * speed, settings_.unseen_most());
  object.uncertainty = known.wandered + with;
  if (now < known.spread_until) object.uncertainty += known.spread;
  if (now < known.jump_until) object.uncertainty = std::max(object.uncertainty, known.jump);
}

bool SceneModel::carry(Known& known, const HumanState& people) const {
  SceneObject& object = known.object;
  if (object.holder != Holder::human) return false;
  const auto who = std::find_if(people.people.begin(), people.people.end(), [&](const Person& p) { return p.id == object.holder_id; });
  if (who == people.people.end()) return false;
  if (known.object.age <= kMissed) {
    if (known.gripped == known.seen) return false;
    known.gripped = known.seen;
    double nearest = std::numeric_limits<double>::infinity();
    for (const char* hand : {"l_hand", "r_hand"}) {
      const Vector3 p = object.T_world_object.translation() - joint_of(*who, hand).position;
      if (p.norm() >= nearest) continue;
      nearest = p.norm();
      known.hand = body_joint_index(hand);
      known.p_hand_object = p;
    }
    return false;
  }
  object.T_world_object.translation() = who->joints[static_cast<std::size_t>(known.hand)].position + known.p_hand_object;
  object.velocity = who->joints[static_cast<std::size_t>(known.hand)].velocity;
  return true;
}

Scene SceneModel::scene(TimePoint now, const HumanState& people) {
  locate_hands();
  std::erase_if(objects_, [&](const auto& entry) {
    const Known& known = entry.second;
    return known.looks > 0 && known.object.holder == Holder::human && to_seconds(now - known.seen) > settings_.unseen_after() &&
           std::none_of(people.people.begin(), people.people.end(), [&](const Person& p) { return p.id == known.object.holder_id; });
  });
  Scene out;
  out.robot_known = robot_known_;
  out.T_world_base = T_world_base_;
  out.robot_position = position_;
  out.boxes = boxes_;
  for (auto& [id, known] : objects_) {
    known.object.age = std::max(0.0, to_seconds(now - known.seen));
    attribute_grips(known, people);
    if (known.object.age > kVelocityGap) known.object.velocity.setZero();
    if (!carry(known, people)) assign_holder(known, people);
    mislay(known, people, now);
    SceneObject object = known.object;
    if (object.holder == Holder::robot && object.age > kMissed) object.T_world_object = hands_[known.by].T_world_palm * known.T_palm_object;
    out.objects.push_back(std::move(object));
  }
  const Quotas quotas = quotas_of(settings_);
  objects_left_out_ = keep_lowest(out.objects, quotas.objects, [&](const SceneObject& object) { return rank(object); });
  boxes_left_out_ = keep_lowest(out.boxes, quotas.boxes, [&](const SceneBox& box) { return Rank{0, distance_to_arm(box, reach())}; });
  out.left_out = objects_left_out_.count + boxes_left_out_.count;
  if (revision_ == 0 || differs(out, last_)) {
    ++revision_;
    last_ = out;
  }
  out.revision = revision_;
  return out;
}

Coverage SceneModel::reach() const { return around(T_world_base_.translation(), arm_length_); }

Coverage reach_of(const RobotModel& robot, const Vector3& base) { return around(base, arm_length(robot)); }

const Obstacles& SceneModel::obstacles() {
  locate_hands();
  if (capsules_.empty()) {
    capsules_ = robot_capsules(*robot_);
    for (const SceneBox& box : boxes_) obstacles_.boxes.push_back({box.T_world_box, box.size});
  }
  obstacles_.robot.clear();
  for (const LinkCapsule& c : capsules_) {
    if (links_.empty()) break;
    const Pose T = T_world_base_ * links_[static_cast<std::size_t>(c.link)];
    obstacles_.robot.push_back({T * c.a, T * c.b, c.radius});
  }
  return obstacles_;
}

}  // namespace handsel::spark
