// SPDX-License-Identifier: Apache-2.0
// Poses of sources and robots in the world (deploy/config/calibration.txtpb). Pure except for
// reading the file.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "common/geometry/pose.hpp"
#include "common/messages/perception.hpp"

namespace handsel::spark {

class Calibration {
 public:
  struct Source {
    bool own_frame{};                       ///< whether observations are in the camera's frame
    Pose T_world_camera{Pose::Identity()};  ///< pose of the camera in the world [m]
    std::optional<Coverage> coverage;       ///< replaces the reported coverage, world [m]
    std::string measured;                   ///< day of measurement YYYY-MM-DD, or empty
  };
  struct Robot {
    Pose T_world_base{Pose::Identity()};  ///< pose of the root link in the world [m]
    std::string measured;                 ///< day of measurement YYYY-MM-DD, or empty
  };

  /// Creates an empty calibration: every source reports in frame world.
  Calibration() = default;
  /// Reads a calibration; a missing file gives an empty one. Throws ConfigError "file:line: what"
  /// for an invalid orientation, an impossible position, a duplicate name or an invalid date.
  explicit Calibration(const std::filesystem::path& file);

  /// Converts the observation of a source to the world frame. A turned coverage becomes the largest
  /// axis-aligned box of the same proportions inside: never more than the source observes.
  void to_world(HumanObservation& observation) const;
  /// Converts objects and grips of a source that reports in its own frame to the world frame.
  void to_world(ObjectObservation& observation) const;

  /// Returns the calibrated sources by name.
  const std::map<std::string, Source>& sources() const { return sources_; }
  /// Returns the measured robots by the name of their description.
  const std::map<std::string, Robot>& robots() const { return robots_; }
  /// Returns the days for which a measurement is valid; 0 without a file.
  double valid_days() const { return valid_days_; }

 private:
  std::map<std::string, Source> sources_;
  std::map<std::string, Robot> robots_;
  double valid_days_{0};
};

/// Returns the max axis-aligned box inside `box`, whose frame is T_world_box, with the same centre
/// and the proportions of the axis-aligned bounding box.
Coverage inscribed(const Coverage& box, const Pose& T_world_box);

/// Returns the days from the first day to the second, both YYYY-MM-DD; nullopt: an invalid date.
std::optional<double> days_between(const std::string& first, const std::string& second);

}  // namespace handsel::spark
