// SPDX-License-Identifier: Apache-2.0
// How a RobotModel is put together: URDF tree, SRDF, axes and limits. Used by the loaders of this
// folder only.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/config/described.hpp"
#include "common/config/resources.hpp"
#include "common/config/schema/robot.pb.h"
#include "common/model/robot_model.hpp"

namespace handsel {

/// What a description says about reading its URDF.
struct UrdfOptions {
  std::vector<std::filesystem::path> packages;  ///< folders that hold what package:// names
  std::vector<std::string> without;             ///< links left out, with all they carry
};

class RobotModelBuilder {
 public:
  /// Reads links and joints; no axes yet. Throws ConfigError / MissingError with file and line.
  RobotModelBuilder(const std::filesystem::path& urdf, Meshes meshes,
                    const UrdfOptions& options = {});

  /// Joins another tree to a link, rigidly; before the axes are set. Throws ConfigError when a name
  /// is in both.
  void mount(RobotModelBuilder other, const config::HandMount& at,
             const std::filesystem::path& source);

  /// Actuated joints in document order.
  std::vector<std::string> actuated() const;
  /// Makes these joints the axes. The other actuated joints are held at `held` (0 if not named).
  /// `source` is the file the names stand in.
  void set_axes(const std::vector<std::string>& joints, const std::map<std::string, double>& held,
                const std::filesystem::path& source);
  /// Adds a group of axes; `joints` must be axes, an empty `tip` is none. Throws ConfigError when
  /// the name is taken or the tip is no link.
  void add_group(const std::string& name, const std::vector<std::string>& joints,
                 const std::string& tip, const std::filesystem::path& source);
  /// Groups (when wanted) and disabled pairs. Unknown names are errors when strict, else passed
  /// over; pairs with a link that is left out are passed over.
  void read_srdf(const std::filesystem::path& srdf, bool groups, bool strict);
  /// Takes name, axes, groups, SRDF, roles and limits from the description, which stands in `file`.
  /// Throws ConfigError naming file and field, also when comfort exceeds guard / 1.1 or stop
  /// exceeds guard.
  void apply(const config::RobotDescription& description, const std::filesystem::path& file);
  /// Sets guard and stop from the URDF: velocity v (1 where none is given), acceleration 2 v, jerk
  /// 6 v; comfort = guard / 1.1.
  void default_limits();
  /// Every body that moves needs a mass. Throws ConfigError.
  void require_masses() const;
  /// Disables the pairs of links that are adjacent or rigidly joined, and gives the model away: to
  /// be called last.
  RobotModel finish();

  /// on_platform of common/model/platform.hpp.
  static RobotModel on_platform(const RobotModel& robot, double speed, double turn_speed);

 private:
  friend class SrdfReader;
  int joint_index(const std::string& name) const;
  int axis_of(const std::string& joint) const;
  int require_link(const std::string& name, const std::string& field,
                   const std::filesystem::path& source) const;
  KinematicLimits limits(const google::protobuf::RepeatedPtrField<config::AxisLimits>& entries,
                         const std::string& field, const std::filesystem::path& source) const;
  void disable(int a, int b);

  std::filesystem::path urdf_;
  RobotModel model_;
  std::vector<int> document_order_;  // joints as they stand in the URDF
  std::set<std::string> left_out_;   // links of the URDF that are left out
};

/// The builder of the URDF that a description of a robot or hand names.
template <class Description>
RobotModelBuilder described_urdf(const std::filesystem::path& file, const Description& text,
                                 const google::protobuf::RepeatedPtrField<std::string>& without) {
  if (text.urdf().empty()) throw ConfigError(file.string() + ": urdf is missing");
  const std::filesystem::path urdf = described_path(file, text.urdf());
  if (!std::filesystem::exists(urdf))
    throw MissingError(locate(file, text.urdf()) + ": no file " + urdf.string());
  UrdfOptions options;
  for (const std::string& folder : text.packages())
    options.packages.push_back(described_path(file, folder));
  options.without.assign(without.begin(), without.end());
  return {urdf, Meshes::load, options};
}

}  // namespace handsel
