// SPDX-License-Identifier: Apache-2.0
// A robot: its tree of links from a URDF, groups and disabled pairs from an SRDF, limits and roles
// from its description.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.hpp"
#include "common/geometry/shape.hpp"
#include "common/trajectory/trajectory.hpp"

namespace handsel {

struct Link {
  std::string name;                                  ///< as in the URDF
  int parent_joint{-1};                              ///< index into joints(); -1 for the root
  std::vector<PlacedShape> collision;                ///< link frame
  double mass{};                                     ///< [kg]
  Vector3 com{Vector3::Zero()};                      ///< link frame [m]
  Eigen::Matrix3d inertia{Eigen::Matrix3d::Zero()};  ///< about the com, link axes
};

enum class JointKind { fixed, revolute, continuous, prismatic };

struct Joint {
  std::string name;                       ///< as in the URDF
  JointKind kind{JointKind::fixed};       ///< planar and floating joints of the URDF are fixed ones
  int parent{}, child{};                  ///< link indices
  Pose T_parent_joint{Pose::Identity()};  ///< joint frame in the parent link's
  Vector3 axis{Vector3::UnitZ()};         ///< joint frame, unit
  int dof{-1};  ///< axis that drives it, own or mimicked; -1: fixed, or held at mimic_offset
  double mimic_factor{1.0}, mimic_offset{0.0};  ///< value = factor * q[dof] + offset
  bool is_mimic{false};                         ///< follows the axis of another joint
  double lower{}, upper{};                      ///< [rad] or [m]
  double max_velocity{}, max_effort{};          ///< from the URDF
};

/// An axis of the robot: an actuated joint in the order of the description.
struct Axis {
  std::string name;         ///< of its joint
  int joint{};              ///< index into joints()
  double lower{}, upper{};  ///< position limits [rad] or [m]
  double max_effort{};      ///< [Nm] or [N]; 0: not given
};

/// Axes that move together, with the link they carry.
struct Group {
  std::string name;       ///< "arm", "hand", "head"
  std::vector<int> axes;  ///< robot axis indices
  int tip{-1};            ///< link index of the tool frame (arm) or of the last link; -1 if none
};

/// Options of the numeric inverse kinematics.
struct IkOptions {
  int max_iterations{200};          ///< from each start
  int restarts{8};                  ///< after q_seed failed: from rest, then random configurations
  double position_tolerance{1e-5};  ///< [m]
  double angle_tolerance{1e-4};     ///< [rad]
  std::uint64_t random_seed{1};     ///< of those random configurations
};

/// Whether a URDF's collision meshes are read too (kinematics alone does not need them).
enum class Meshes { load, skip };

class RobotModel {
 public:
  /// Loads a robot description (Protobuf text, see common/config/schema/robot.proto) with its URDF,
  /// SRDF and meshes. Throws ConfigError / MissingError naming the file and what is wrong.
  static RobotModel load(const std::filesystem::path& description);
  /// Loads a bare URDF: every movable non-mimic joint is an axis, in document order; group "all"
  /// and those of the SRDF. Position and velocity limits from the URDF, acceleration 2 v and jerk 6
  /// v (the chapter's planning ratio), comfort = guard / 1.1. Continuous joints get two turns;
  /// planar and floating joints are held. package:// is searched for in the URDF's folder and the
  /// folders above it.
  static RobotModel load_urdf(const std::filesystem::path& urdf,
                              const std::filesystem::path& srdf = {}, Meshes meshes = Meshes::load);

  /// As in the description; of a bare URDF the robot's name in it.
  const std::string& name() const { return name_; }
  /// Parents before children; links()[0] is the root.
  const std::vector<Link>& links() const { return links_; }
  const std::vector<Joint>& joints() const { return joints_; }  ///< parents before children
  const std::vector<Axis>& axes() const { return axes_; }       ///< in the order of q
  int dof() const { return static_cast<int>(axes_.size()); }    ///< number of axes
  int link_index(const std::string& name) const;                ///< -1 if there is none
  const Group* group(const std::string& name) const;            ///< nullptr if there is none
  const Group& require_group(const std::string& name) const;    ///< throws ConfigError
  const std::vector<Group>& groups() const { return groups_; }  ///< in the order of the description
  /// Pairs of links that are never tested against each other: SRDF disable_collisions, adjacent
  /// links (looking through links without shapes), links rigidly joined.
  bool pair_disabled(int link_a, int link_b) const;

  const KinematicLimits& comfort_limits() const { return comfort_; }  ///< planning
  /// No set-point ever exceeds these.
  const KinematicLimits& guard_limits() const { return guard_; }
  /// The maker's, for stopping and recoil; <= guard.
  const KinematicLimits& stop_limits() const { return stop_; }
  const Vector& rest_configuration() const { return rest_; }  ///< all axes
  int tool_link() const { return tool_; }                     ///< hand frame; -1 if none
  int redundancy_axis() const { return redundancy_; }         ///< -1 if none
  const std::string& hand() const { return hand_; }  ///< name of the hand description, may be empty
  int gaze_link() const { return gaze_; }            ///< camera link, x forward; -1 if none

  /// Poses of all links in the root frame for the positions of all axes. `T_root_link` is resized
  /// once, then reused.
  void forward(const Vector& q, std::vector<Pose>& T_root_link) const;
  Pose link_pose(const Vector& q, int link) const;  ///< convenience
  /// 6 x group.axes.size(): linear then angular velocity of the group's tip origin, root axes.
  Eigen::MatrixXd jacobian(const Vector& q, const Group& group) const;
  /// Group axes such that the group's tip is at T_root_tip; the other axes as in q_seed. Inside
  /// position limits, near q_seed first, null-space pull toward the rest configuration. nullopt
  /// when none is found.
  std::optional<Vector> inverse(const Group& group, const Pose& T_root_tip, const Vector& q_seed,
                                const IkOptions& = {}) const;

  /// Returns q with the group's entries replaced by group_q.
  static Vector with(const Vector& q, const Group& group, const Vector& group_q);
  /// Returns the group's entries of q, in the order of the group's axes.
  static Vector part(const Vector& q, const Group& group);

 private:
  friend class RobotModelBuilder;
  std::string name_, hand_;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
  std::vector<Axis> axes_;
  std::vector<Group> groups_;
  std::vector<bool> disabled_pairs_;  // links x links
  KinematicLimits comfort_, guard_, stop_;
  Vector rest_;
  int tool_{-1}, redundancy_{-1}, gaze_{-1};
};

}  // namespace handsel
