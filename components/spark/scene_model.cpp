#include "components/spark/scene_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/human_body.hpp"

namespace handsel::spark {
namespace {

constexpr double kSameMove = 0.004;       // [m] what is seen this near the estimate is the same place: averaged
constexpr double kSameTurn = 0.06;        // [rad]
constexpr int kAverageOver = 15;          // [samples]
constexpr double kVelocityMemory = 0.06;  // [s]
constexpr double kVelocityGap = 0.3;      // [s] longer unseen: nothing is known of its velocity
constexpr double kClearOfSupport = 0.01;  // [m] what a loaded hand has lifted so far stands there no longer
constexpr double kRevisionMove = 0.005;   // [m] an object that moved this far makes a new revision

double arm_length(const RobotModel& robot) {
  double length = 0;
  for (int link = robot.tool_link(); link > 0;) {
    const Joint& joint = robot.joints()[static_cast<std::size_t>(robot.links()[static_cast<std::size_t>(link)].parent_joint)];
    if (joint.kind != JointKind::fixed || length == 0) length += joint.T_parent_joint.translation().norm();
    link = joint.parent;
  }
  return std::max(length, 0.5);
}

bool differs(const Scene& a, const Scene& b) {
  if (a.objects.size() != b.objects.size() || a.boxes.size() != b.boxes.size() || a.robot_known != b.robot_known) return true;
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    const auto &x = a.objects[i], &y = b.objects[i];
    if (x.id != y.id || x.holder != y.holder || x.holder_id != y.holder_id) return true;
    if ((x.T_world_object.translation() - y.T_world_object.translation()).norm() > kRevisionMove) return true;
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
}

void SceneModel::locate_tool() {
  if (!robot_known_ || robot_->tool_link() < 0) return;
  robot_->forward(position_, links_);
  T_world_tool_ = T_world_base_ * links_[static_cast<std::size_t>(robot_->tool_link())];
}

void SceneModel::observe(const ObjectObservation& observation, TimePoint seen) {
  locate_tool();
  for (const auto& observed : observation.objects) {
    Known& known = objects_[observed.id];
    if (seen < known.seen) continue;
    follow(known, observed, seen);
    known.object.id = observed.id;
    known.object.model = observed.model;
    known.object.T_world_object =
        known.looks > 0 ? averaged(known.object.T_world_object, observed.T_world_object, known.looks) : observed.T_world_object;
    known.looks = std::max(known.looks, 1);
    known.seen = seen;
    if (robot_known_) known.T_tool_object = T_world_tool_.inverse() * observed.T_world_object;
  }
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
  payload_ = state.payload;
  T_world_base_ = state.T_world_base;
}

const SceneBox* SceneModel::support_under(const SceneObject& object, double gap) const {
  const ObjectModel* model = library_ ? library_(object.model) : nullptr;
  if (model == nullptr) return nullptr;
  double bottom = std::numeric_limits<double>::max();
  for (const auto& v : model->mesh.vertices) bottom = std::min(bottom, (object.T_world_object * v).z());
  for (const auto& box : boxes_) {
    if (!box.supports) continue;
    const Vector3 p = box.T_world_box.inverse() * object.T_world_object.translation();
    const double top = box.T_world_box.translation().z() + box.size.z() / 2;
    if (std::abs(bottom - top) <= gap && std::abs(p.x()) <= box.size.x() / 2 && std::abs(p.y()) <= box.size.y() / 2) return &box;
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
    if (robot_known_) claim(kRobotName, T_world_tool_.translation());
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

void SceneModel::assign_holder(Known& known, const HumanState& people) const {
  SceneObject& object = known.object;
  if (keep_gripped(object)) return;
  const ObjectModel* model = library_ ? library_(object.model) : nullptr;
  const bool loaded = model != nullptr && payload_ > 0.4 * model->mass;
  const Vector3 where = object.T_world_object.translation();
  const bool robot_may = robot_known_ && loaded && (where - T_world_tool_.translation()).norm() < 0.35;
  if (const SceneBox* box = support_under(object, robot_may ? kClearOfSupport : settings_.support_gap())) {
    object.holder = Holder::surface;
    object.holder_id = box->id;
    return;
  }
  if (robot_may) {
    object.holder = Holder::robot;
    object.holder_id.clear();
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

Scene SceneModel::scene(TimePoint now, const HumanState& people) {
  locate_tool();
  Scene out;
  out.robot_known = robot_known_;
  out.T_world_base = T_world_base_;
  out.robot_position = position_;
  out.boxes = boxes_;
  for (auto& [id, known] : objects_) {
    attribute_grips(known, people);
    assign_holder(known, people);
    known.object.age = std::max(0.0, to_seconds(now - known.seen));
    if (known.object.age > kVelocityGap) known.object.velocity.setZero();
    SceneObject object = known.object;
    if (object.holder == Holder::robot && object.age > 0.1) object.T_world_object = T_world_tool_ * known.T_tool_object;
    out.objects.push_back(std::move(object));
  }
  if (revision_ == 0 || differs(out, last_)) {
    ++revision_;
    last_ = out;
  }
  out.revision = revision_;
  return out;
}

Coverage SceneModel::reach() const {
  const Vector3 centre = T_world_base_.translation();
  const double r = arm_length_ + 0.3;
  Coverage box;
  box.low = Vector3(centre.x() - r, centre.y() - r, 0.1);
  box.high = Vector3(centre.x() + r, centre.y() + r, 1.9);
  return box;
}

const Obstacles& SceneModel::obstacles() {
  locate_tool();
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
