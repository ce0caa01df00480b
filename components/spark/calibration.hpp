// Where sources and robots stand in the world (deploy/config/calibration.txtpb). Pure but for
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
    bool own_frame{};                       ///< what it reports is in its camera's frame
    Pose T_world_camera{Pose::Identity()};  ///< pose of its camera in the world [m]
    std::optional<Coverage> coverage;       ///< world, instead of the one it reports
    std::string measured;                   ///< YYYY-MM-DD, or empty
  };
  struct Robot {
    Pose T_world_base{Pose::Identity()};  ///< pose of its root link in the world [m]
    std::string measured;                 ///< YYYY-MM-DD, or empty
  };

  /// Nothing is calibrated: every source speaks in frame world.
  Calibration() = default;
  /// A file that is not there calibrates nothing. Throws ConfigError "file:line: what": an
  /// orientation that is no rotation, a place that cannot be, something named twice, a date that is
  /// none.
  explicit Calibration(const std::filesystem::path& file);

  /// Brings what a source reports to the world. Of a turned coverage the largest upright box of the
  /// same proportions inside it counts: never more than the source observes.
  void to_world(HumanObservation& observation) const;
  /// Brings the objects and grips of a source that reports in its own frame to the world.
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

/// The upright box inside `box`, whose frame is T_world_box, with the same middle and the
/// proportions of what stands around it.
Coverage inscribed(const Coverage& box, const Pose& T_world_box);

/// Days from the first day to the second, both YYYY-MM-DD; nullopt: one of them is no date.
std::optional<double> days_between(const std::string& first, const std::string& second);

}  // namespace handsel::spark
