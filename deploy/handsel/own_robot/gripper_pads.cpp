// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/gripper_pads.hpp"

#include <algorithm>
#include <numbers>

#include "common/base/errors.hpp"

namespace handsel {
namespace {

struct CornerFinder {
  std::vector<Vector3>& out;
  void ring(double radius, double z) const {
    constexpr int kPoints = 16;
    for (int k = 0; k < kPoints; ++k) {
      const double a = 2 * std::numbers::pi * k / kPoints;
      out.emplace_back(radius * std::cos(a), radius * std::sin(a), z);
    }
  }
  void operator()(const Sphere& s) const {
    for (int k = -4; k <= 4; ++k) {
      const double a = std::numbers::pi / 8 * k;
      ring(s.radius * std::cos(a), s.radius * std::sin(a));
    }
  }
  void operator()(const Box& b) const {
    for (int c = 0; c < 8; ++c)
      out.emplace_back((c & 1 ? 0.5 : -0.5) * b.size.x(), (c & 2 ? 0.5 : -0.5) * b.size.y(),
                       (c & 4 ? 0.5 : -0.5) * b.size.z());
  }
  void operator()(const Cylinder& c) const {
    for (const double z : {-c.length / 2, c.length / 2}) ring(c.radius, z);
  }
  void operator()(const Capsule& c) const {
    for (const double z : {-c.length / 2, c.length / 2}) ring(c.radius, z);
  }
  void operator()(const MeshPtr& m) const {
    out.insert(out.end(), m->vertices.begin(), m->vertices.end());
  }
};

/// Links that move as one.
struct Body {
  int branch{};  ///< the first moving joint below the palm
  std::vector<std::size_t> links;
  std::vector<Vector3> points;        ///< palm frame, at the middle configuration [m]
  std::vector<std::size_t> point_of;  ///< link of each point
  Vector3 middle{Vector3::Zero()};    ///< of the points
  double reach{};                     ///< max along the direction of reach [m]
};

class PadFinder {
 public:
  PadFinder(const RobotModel& robot, const RobotParts& parts, const PadSettings& settings)
      : robot_(robot), settings_(settings), palm_(static_cast<std::size_t>(parts.flange)) {
    for (const std::string& name : parts.hand)
      for (int i = 0; i < robot.dof(); ++i)
        if (robot.axes()[static_cast<std::size_t>(i)].name == name) axes_.push_back(i);
    middle_ = robot.rest_configuration();
    for (const int i : axes_)
      middle_[i] = (robot.axes()[static_cast<std::size_t>(i)].lower +
                    robot.axes()[static_cast<std::size_t>(i)].upper) /
                   2;
  }

  Gripper find() {
    collect_bodies();
    const auto [a, b] = fingers();
    Vector3 closing = b.middle - a.middle;
    closing -= closing.dot(reach_) * reach_;
    if (closing.norm() < 1e-4)
      throw ConfigError("the fingers of links " + name(a) + " and " + name(b) +
                        " are not beside each other: describe the hand yourself and name the "
                        "description with --hand");
    closing = near_axis(closing.normalized());
    Gripper gripper;
    gripper.fingers = {finger(a, closing), finger(b, -closing)};
    set_range(gripper);
    const Pose T_palm = poses_[palm_];
    Vector3 between = Vector3::Zero();
    for (const GripperFinger& f : gripper.fingers)
      between += 0.5 * (T_palm.inverse() * poses_[index(f.link)] * f.T_link_pad).translation();
    gripper.T_palm_grasp = make_pose(between);
    gripper.reach = reach_;
    return gripper;
  }

 private:
  std::size_t index(const std::string& link) const {
    return static_cast<std::size_t>(robot_.link_index(link));
  }
  std::string name(const Body& body) const { return robot_.links()[body.links.front()].name; }

  void collect_bodies() {
    robot_.forward(middle_, poses_);
    const auto below = descends_from(robot_, static_cast<int>(palm_));
    std::vector<int> body_of(robot_.links().size(), -1);
    for (std::size_t l = 0; l < robot_.links().size(); ++l) {
      const int j = robot_.links()[l].parent_joint;
      if (!below[l] || l == palm_ || j < 0) continue;
      const Joint& joint = robot_.joints()[static_cast<std::size_t>(j)];
      const int parent = body_of[static_cast<std::size_t>(joint.parent)];
      if (joint.kind == JointKind::fixed) {
        body_of[l] = parent;
      } else {
        body_of[l] = static_cast<int>(bodies_.size());
        Body body;
        body.branch = parent >= 0 ? bodies_[static_cast<std::size_t>(parent)].branch : j;
        bodies_.push_back(body);
      }
      if (body_of[l] >= 0) add_link(bodies_[static_cast<std::size_t>(body_of[l])], l);
    }
    std::erase_if(bodies_, [](const Body& body) { return body.points.empty(); });
    Vector3 sum = Vector3::Zero();
    for (Body& body : bodies_) {
      for (const Vector3& p : body.points)
        body.middle += p / static_cast<double>(body.points.size());
      sum += body.middle / static_cast<double>(bodies_.size());
    }
    const Vector3 from = palm_middle();
    if ((sum - from).norm() > 1e-4) reach_ = near_axis((sum - from).normalized());
    for (Body& body : bodies_)
      for (const Vector3& p : body.points)
        body.reach = std::max(body.reach, (p - from).dot(reach_));
    for (Body& body : bodies_) body.reach += from.dot(reach_);
    start_ = from.dot(reach_);
  }

  /// Returns the middle of the shapes of the palm, palm frame [m]; its origin without shapes.
  Vector3 palm_middle() const {
    Eigen::AlignedBox3d box;
    for (const PlacedShape& placed : robot_.links()[palm_].collision)
      for (const Vector3& p : corners_of(placed.shape)) box.extend(placed.T_parent_shape * p);
    return box.isEmpty() ? Vector3(Vector3::Zero()) : Vector3(box.center());
  }

  void add_link(Body& body, std::size_t link) const {
    body.links.push_back(link);
    for (const PlacedShape& placed : robot_.links()[link].collision)
      for (const Vector3& p : corners_of(placed.shape)) {
        body.points.push_back(poses_[palm_].inverse() * poses_[link] * placed.T_parent_shape * p);
        body.point_of.push_back(link);
      }
  }

  /// Returns an axis of the palm near a direction, else the direction.
  static Vector3 near_axis(const Vector3& direction) {
    constexpr double kNear = 0.94;  // cosine of 20 degrees
    for (int i = 0; i < 3; ++i)
      if (std::abs(direction[i]) > kNear)
        return Vector3(Vector3::Unit(i) * (direction[i] > 0 ? 1.0 : -1.0));
    return direction;
  }

  /// Returns the two bodies that reach farthest, of different branches.
  std::pair<Body, Body> fingers() const {
    std::vector<Body> far;  // the farthest of each branch
    for (const Body& body : bodies_) {
      const auto same = std::find_if(far.begin(), far.end(),
                                     [&](const Body& f) { return f.branch == body.branch; });
      if (same == far.end())
        far.push_back(body);
      else if (body.reach >= same->reach)
        *same = body;
    }
    std::stable_sort(far.begin(), far.end(),
                     [](const Body& x, const Body& y) { return x.reach > y.reach; });
    const auto is_finger = [&](const Body& body) {
      return body.reach - start_ > settings_.finger_reach * (far.front().reach - start_);
    };
    const auto count = std::count_if(far.begin(), far.end(), is_finger);
    if (count != 2)
      throw ConfigError("the hand below link " + robot_.links()[palm_].name + " has " +
                        std::to_string(count) + " finger" + (count == 1 ? "" : "s") +
                        ", and only grippers of two fingers are described automatically; describe "
                        "the hand (docs/own_robot.md, section 2) and name the description with "
                        "--hand");
    return {far[0], far[1]};
  }

  /// Returns the finger with the pad on the side of `pressing` (palm frame).
  GripperFinger finger(const Body& body, const Vector3& pressing) const {
    const Vector3 across = reach_.cross(pressing);
    double low = 1e9;
    for (const Vector3& p : body.points) low = std::min(low, p.dot(reach_));
    const double distal = (low + body.reach) / 2;
    double front = -1e9;
    for (const Vector3& p : body.points)
      if (p.dot(reach_) >= distal) front = std::max(front, p.dot(pressing));
    Eigen::AlignedBox3d face;
    std::size_t link = body.links.front();
    double nearest = 1e9;
    for (double depth = settings_.face_depth;; depth *= 2) {
      for (std::size_t i = 0; i < body.points.size(); ++i) {
        const Vector3& p = body.points[i];
        const double behind = front - p.dot(pressing);
        if (behind < -settings_.face_depth || behind > depth) continue;
        face.extend(Vector3(p.dot(across), p.dot(reach_), p.dot(pressing)));
        if (behind < nearest) nearest = behind, link = body.point_of[i];
      }
      constexpr double kMaxDepth = 0.02;  // [m]
      if (face.sizes().head<2>().minCoeff() >= settings_.min_side || depth > kMaxDepth) break;
    }
    GripperFinger out;
    out.link = robot_.links()[link].name;
    const auto side = [&](int i) {
      return std::clamp(settings_.fill * face.sizes()[i], settings_.min_side, settings_.max_side);
    };
    out.width = side(0);
    out.height = side(1);
    Vector3 middle = face.center();
    // Of a long face the far end touches.
    if (settings_.fill * face.sizes().y() > settings_.max_side)
      middle.y() = face.max().y() - settings_.max_side / 2;
    Pose T_palm_pad = Pose::Identity();
    T_palm_pad.linear() << across, reach_, pressing;
    T_palm_pad.translation() = middle.x() * across + middle.y() * reach_ + front * pressing;
    out.T_link_pad = poses_[link].inverse() * poses_[palm_] * T_palm_pad;
    out.joints = drivers(link);
    return out;
  }

  /// Actuated joints that move a link in the palm frame, from the palm outward.
  std::vector<std::string> drivers(std::size_t link) const {
    std::vector<std::string> out;
    while (link != palm_) {
      const Joint& joint =
          robot_.joints()[static_cast<std::size_t>(robot_.links()[link].parent_joint)];
      if (joint.kind != JointKind::fixed && joint.dof >= 0) {
        const std::string& axis = robot_.axes()[static_cast<std::size_t>(joint.dof)].name;
        std::erase(out, axis);
        out.insert(out.begin(), axis);
      }
      link = static_cast<std::size_t>(joint.parent);
    }
    return out;
  }

  double gap(const Gripper& gripper, const Vector& q) const {
    std::vector<Pose> T;
    robot_.forward(q, T);
    const auto pad = [&](const GripperFinger& f) { return T[index(f.link)] * f.T_link_pad; };
    const Pose first = pad(gripper.fingers[0]), second = pad(gripper.fingers[1]);
    return (second.translation() - first.translation()).dot(first.linear().col(2));
  }

  void set_range(Gripper& gripper) const {
    constexpr double kMinStroke = 0.003;  // [m]
    Vector open = middle_, closed = middle_;
    for (const int i : axes_) {
      const Axis& axis = robot_.axes()[static_cast<std::size_t>(i)];
      Vector low = middle_, high = middle_;
      low[i] = axis.lower;
      high[i] = axis.upper;
      const bool opens_high = gap(gripper, high) >= gap(gripper, low);
      open[i] = opens_high ? axis.upper : axis.lower;
      closed[i] = opens_high ? axis.lower : axis.upper;
      gripper.open[axis.name] = open[i];
      gripper.closed[axis.name] = closed[i];
    }
    gripper.max_gap = gap(gripper, open);
    if (gripper.max_gap - gap(gripper, closed) < kMinStroke)
      throw ConfigError("the fingers of links " + gripper.fingers[0].link + " and " +
                        gripper.fingers[1].link +
                        " do not approach each other: check axes and the multipliers of mimic, or "
                        "describe the hand yourself and name the description with --hand");
  }

  const RobotModel& robot_;
  const PadSettings& settings_;
  std::size_t palm_;
  std::vector<int> axes_;
  Vector middle_;
  std::vector<Pose> poses_;  // root frame, at the middle configuration
  std::vector<Body> bodies_;
  Vector3 reach_{Vector3::UnitZ()};  // palm frame
  double start_{};                   // of the middle of the palm along reach_ [m]
};

}  // namespace

std::vector<Vector3> corners_of(const Shape& shape) {
  std::vector<Vector3> out;
  std::visit(CornerFinder{out}, shape);
  return out;
}

Gripper find_gripper(const RobotModel& robot, const RobotParts& parts,
                     const PadSettings& settings) {
  return PadFinder(robot, parts, settings).find();
}

}  // namespace handsel
