// SPDX-License-Identifier: Apache-2.0
// Reads recorded motions of a person: a folder of the KTH handover set, a CSV file of body points,
// or a BVH file.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/geometry/pose.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::sim {

using BodyPoints = std::array<Vector3, kBodyJoints.size()>;  ///< in the order of kBodyJoints

struct Recording {
  double rate{120};  ///< [Hz]
  /// Body points per frame [m]; in the first, the waist is above the origin and the body faces +x.
  std::vector<BodyPoints> frames;
  double stature{1.75};      ///< of the body whose trunk and legs fit the recording best [m]
  Side taking{Side::right};  ///< side of the hand that reaches farther
  double contact{};          ///< time of that hand's max reach [s]

  /// Returns the time from the first frame to the last [s]; there must be a frame.
  double duration() const { return static_cast<double>(frames.size() - 1) / rate; }
  /// Writes the body points at time t [s]: linear between frames, clamped to the ends.
  void sample(double t, BodyPoints& out) const;
};

/// Reads a recording. A folder, or a file in it, has the KTH set's taker_*_pose_saved.csv: columns
/// x y z q0 q1 q2 q3, quaternion as x y z w, 120 Hz. Any other file is a .bvh file or a .csv file
/// of parse_body_csv(). Unrecorded legs are placed below the recorded waist. A body that walks more
/// than 0.5 m walks on the spot instead. Throws MissingError naming the file, ConfigError
/// "file:line: what".
Recording load_recording(const std::filesystem::path& path);

/// Returns the path of a recording; a relative path is below `data_root`. Throws MissingError if
/// the path is relative and `data_root` is empty.
std::filesystem::path resolve_recording(const std::filesystem::path& recording,
                                        const std::filesystem::path& data_root);

/// Returns the unit in which `stature` is a person's body height: factor to metres and name; factor
/// 0 if no unit fits.
std::pair<double, const char*> unit_of(double stature);

/// Reads body points over time. The first line names the columns, `time` [s] and <joint>.x
/// <joint>.y <joint>.z [m], z up, for REP-155 joints: at least head, waist, both shoulders and one
/// elbow and wrist. Throws ConfigError "name:line: what".
Recording parse_body_csv(std::string_view text, const std::string& name);

/// Reads BVH with the usual joint names (CMU, Mixamo, Vicon, ...). BVH has no unit: the size of the
/// body distinguishes metres, centimetres, millimetres and inches; any other skeleton is scaled to
/// 1.75 m. Throws ConfigError "name:line: what".
Recording parse_bvh_recording(std::string_view text, const std::string& name);

/// Returns the same motion for a body of another stature [m]. Bones keep their directions and have
/// the lengths of standing_body(stature). Heights of the feet are unchanged; paths on the floor
/// scale with the stature. Each hand keeps its direction from the shoulder and its fraction of the
/// arm's max reach, and the elbow keeps its plane. Own method: the hand's targets stay within
/// reach.
Recording retarget(const Recording&, double stature);

}  // namespace handsel::sim
