// What a robot does before a table: the robot, its hands' lists on an object, the scene. For commands.
#pragma once

#include <nlohmann/json.hpp>

#include "components/grasp_planner/regrasp/regrasp.hpp"
#include "deploy/handsel/offline/grasp_input.hpp"
#include "deploy/handsel/pictures/png.hpp"

namespace handsel {

inline constexpr double kDegree = 3.14159265358979323846 / 180;

struct StageOptions : ListOptions {
  std::string robot, png;
  std::vector<double> table{0.85, -0.62, 0.7, 0.7, 0.72};  // middle x y, size x y, height
  int size{420};
};

void add_stage_options(CLI::App& command, StageOptions& options);

/// The robot, its arms and their lists on the object, which is known by the name "object".
struct Stage {
  explicit Stage(const StageOptions& options);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  ObjectLibrary library() const;
  /// The object on the table, its lowest point there.
  Pose standing(double x, double y, double yaw = 0) const;
  /// On the table any way it stands by itself, upright or not, turned in eighths.
  std::vector<Pose> resting(double x, double y) const;

  std::filesystem::path file;
  std::shared_ptr<const RobotModel> robot;
  ObjectModel object;
  std::vector<Listed> lists;
  std::vector<grasp_planner::RegraspArm> arms;
  Scene scene;
  double top{};
};

/// Called "person", facing the origin.
Person somebody(double x, double y, double stature);

void write(const Picture& picture, const std::string& file);
void print_refusals(const Refusals& refusals);
nlohmann::json pose_line(const Pose& T);
nlohmann::json numbers(const Vector& v);
inline unsigned long long whole(std::uint64_t n) { return n; }

}  // namespace handsel
