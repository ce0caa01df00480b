// A recorded person: the taker of a folder in the format of the KTH handover set (CSV, 120 Hz, one file a body frame).
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "common/geometry/pose.hpp"
#include "common/messages/world.hpp"
#include "common/model/human_body.hpp"

namespace handsel::sim {

using BodyPoints = std::array<Vector3, kBodyJoints.size()>;  ///< in the order of kBodyJoints

struct Recording {
  double rate{120};                ///< [Hz]
  std::vector<BodyPoints> frames;  ///< own frame: the first frame's waist on the floor at the origin, facing +x [m]
  Side taking{Side::right};        ///< the hand that reaches farther
  double contact{};                ///< time of its farthest reach [s]

  double duration() const { return static_cast<double>(frames.size() - 1) / rate; }
  /// Linear between frames, clamped to the ends.
  void sample(double t, BodyPoints& out) const;
};

/// Reads <folder>/taker_*_pose_saved.csv, columns x y z q0 q1 q2 q3 with the quaternion as x y z w. Legs, which were not recorded, are
/// put under the recorded waist. Throws MissingError naming the file, ConfigError "file:line: what".
Recording load_recording(const std::filesystem::path& folder);

}  // namespace handsel::sim
