// A recorded person, whatever it was recorded in: a folder of the KTH handover set, a CSV of body
// points, or BVH.
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
  /// Own frame: the first frame's waist on the floor at the origin, facing +x [m].
  std::vector<BodyPoints> frames;
  double stature{1.75};      ///< of the recorded body: the one whose trunk and legs fit best [m]
  Side taking{Side::right};  ///< the hand that reaches farther
  double contact{};          ///< time of its farthest reach [s]

  /// Returns the time from the first frame to the last [s]; there must be a frame.
  double duration() const { return static_cast<double>(frames.size() - 1) / rate; }
  /// Linear between frames, clamped to the ends.
  void sample(double t, BodyPoints& out) const;
};

/// The taker of a folder <path>/taker_*_pose_saved.csv (columns x y z q0 q1 q2 q3 with the
/// quaternion as x y z w, 120 Hz) or of the folder a file of that name stands in; a .bvh file; or
/// any other .csv as of parse_body_csv. Legs that were not recorded are put under the recorded
/// waist. A body that walks through the room (more than 0.5 m) walks on the spot. Throws
/// MissingError naming the file, ConfigError "file:line: what".
Recording load_recording(const std::filesystem::path& path);

/// A relative path is below `data_root`. Throws MissingError when it is relative and there is no
/// such folder.
std::filesystem::path resolve_recording(const std::filesystem::path& recording,
                                        const std::filesystem::path& data_root);

/// The unit in which this is a person's stature: its factor to metres and its name; a factor of 0
/// when there is none.
std::pair<double, const char*> unit_of(double stature);

/// Body points over time: the first line names the columns, `time` [s] and <joint>.x <joint>.y
/// <joint>.z [m], z up, for REP-155 joints: at least head, waist, both shoulders and one elbow and
/// wrist. Throws ConfigError "name:line: what".
Recording parse_body_csv(std::string_view text, const std::string& name);

/// BVH with the joint names in use (CMU, Mixamo, Vicon, ...). BVH has no unit: metres, centimetres,
/// millimetres and inches are distinguished by the body's size; any other skeleton is made 1.75 m
/// tall. Throws ConfigError "name:line: what".
Recording parse_bvh_recording(std::string_view text, const std::string& name);

/// The same motion by another body. Bones keep their directions and take the lengths of
/// standing_body(stature); the feet keep their height over the floor and paths on it grow with the
/// legs; each hand keeps its direction from the shoulder and its fraction of the arm's whole reach,
/// the elbow the plane it bends in. Own method: keeps what a hand reaches for within the new body's
/// reach.
Recording retarget(const Recording&, double stature);

}  // namespace handsel::sim
