#include "components/spark/scene_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/human_body.hpp"

namespace handsel::spark {
namespace {

constexpr double kSameMove = 0.004;      // [m] what is seen this near the estimate is the same place: averaged
constexpr double kSameTurn = 0.06;       // [rad]
constexpr int kAverageOver = 15;         // [samples]
constexpr double kRevisionMove = 0.005;  // [m] an object that moved this far makes a new revision

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
    known.object.id = observed.id;
    known.object.model = observed.model;
    known.object.T_world_object =
        known.looks > 0 ? averaged(known.object.T_world_object, observed.T_world_object, known.looks) : observed.T_world_object;
    known.looks = std::max(known.looks, 1);
    known.seen = seen;
    if (robot_known_) known.T_tool_object = T_world_tool_.inverse() * observed.T_world_object;
  }
}

void SceneModel::update(const RobotState& state) {
  robot_known_ = true;
  position_ = state.position;
  payload_ = state.payload;
  T_world_base_ = state.T_world_base;
}

const SceneBox* SceneModel::support_under(const SceneObject& object) const {
  const ObjectModel* model = library_ ? library_(object.model) : nullptr;
  if (model == nullptr) return nullptr;
  double bottom = std::numeric_limits<double>::max();
  for (const auto& v : model->mesh.vertices) bottom = std::min(bottom, (object.T_world_object * v).z());
  for (const auto& box : boxes_) {
    if (!box.supports) continue;
    const Vector3 p = box.T_world_box.inverse() * object.T_world_object.translation();
    const double top = box.T_world_box.translation().z() + box.size.z() / 2;
    if (std::abs(bottom - top) <= settings_.support_gap() && std::abs(p.x()) <= box.size.x() / 2 && std::abs(p.y()) <= box.size.y() / 2)
      return &box;
  }
  return nullptr;
}

void SceneModel::assign_holder(Known& known, const HumanState& people) const {
  SceneObject& object = known.object;
  if (const SceneBox* box = support_under(object)) {
    object.holder = Holder::surface;
    object.holder_id = box->id;
    return;
  }
  const ObjectModel* model = library_ ? library_(object.model) : nullptr;
  const bool loaded = model != nullptr && payload_ > 0.4 * model->mass;
  const Vector3 where = object.T_world_object.translation();
  if (robot_known_ && loaded && (where - T_world_tool_.translation()).norm() < 0.35) {
    object.holder = Holder::robot;
    object.holder_id.clear();
    return;
  }
  double nearest = settings_.near_distance();
  for (const auto& person : people.people) {
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
    assign_holder(known, people);
    known.object.age = std::max(0.0, to_seconds(now - known.seen));
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
