// SPDX-License-Identifier: Apache-2.0
// What a robot does before a table: the robot, its hands' lists on an object, the scene. For
// commands.
#pragma once

#include <nlohmann/json.hpp>

#include "components/grasp_planner/regrasp/regrasp.hpp"
#include "deploy/handsel/offline/grasp_input.hpp"
#include "deploy/handsel/pictures/png.hpp"

namespace handsel {

inline constexpr double kDegree = 3.14159265358979323846 / 180;

struct StageOptions : ListOptions {
  std::string robot, png;  ///< name or file of the robot description; picture to write, empty: none
  /// Centre x, y, size x, y and height [m], robot base frame.
  std::vector<double> table{0.85, -0.62, 0.7, 0.7, 0.72};
  int size{420};  ///< width and height of one picture [px]
};

/// Adds the list options but --hand and --seed, and --robot, --table, --png, --size.
void add_stage_options(CLI::App& command, StageOptions& options);

/// The robot, its arms and their lists on the object, which is known by the name "object".
struct Stage {
  explicit Stage(const StageOptions& options);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Returns a library that gives the object for every name; it must not outlive the stage.
  ObjectLibrary library() const;
  /// Returns the pose of the upright object, its lowest point on the table; `yaw` [rad].
  Pose standing(double x, double y, double yaw = 0) const;
  /// Returns the poses of the object on the table: upright and in its other stable placements, each
  /// turned in eighths of a turn.
  std::vector<Pose> resting(double x, double y) const;

  std::filesystem::path file;                   ///< robot description
  std::shared_ptr<const RobotModel> robot;      ///< loaded from `file`
  ObjectModel object;                           ///< scaled as the options say
  std::vector<Listed> lists;                    ///< one an arm, in the order of `arms`
  std::vector<grasp_planner::RegraspArm> arms;  ///< each with its hand and its list; at least one
  Scene scene;   ///< the robot at its rest configuration and the table; robot base frame
  double top{};  ///< height of the table [m]
};

/// Called "person", facing the origin.
Person somebody(double x, double y, double stature);

/// Writes a PNG file and its size to stderr; throws ConfigError when the file cannot be written.
void write(const Picture& picture, const std::string& file);
/// Prints to stderr, one line each.
void print_refusals(const Refusals& refusals);
/// Returns {"p": [x, y, z], "q": [x, y, z, w]}, p in [m].
nlohmann::json pose_line(const Pose& T);
/// Returns a list of the values.
nlohmann::json numbers(const Vector& v);
/// Returns `n` as the type that %llu expects.
inline unsigned long long whole(std::uint64_t n) { return n; }

}  // namespace handsel
