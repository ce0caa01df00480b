// SPDX-License-Identifier: Apache-2.0
// For the sources of Recording: joints of the legs, and functions common to the readers of all
// formats.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/recordings/body_joints.hpp"
#include "sim/recordings/recording.hpp"

namespace handsel::sim::recording_detail {

inline constexpr std::size_t kMaxRows = 200000;  ///< max rows of a CSV file
/// Distance from waist to head, divided by the stature, as in standing_body().
inline constexpr double kTrunk = 0.37;
inline constexpr double kAnkleUp = 0.039;  ///< height of an ankle, divided by the stature

inline const int kHip[2] = {body_joint_index("l_hip"), body_joint_index("r_hip")};
inline const int kKnee[2] = {body_joint_index("l_knee"), body_joint_index("r_knee")};
inline const int kAnkle[2] = {body_joint_index("l_ankle"), body_joint_index("r_ankle")};

/// Throws ConfigError "name:line: what".
[[noreturn]] void fail_at(const std::string& name, std::size_t line, const std::string& what);

/// Calls `act` with every line, without its line end, and the line's number from 1.
void for_each_line(std::string_view text,
                   const std::function<void(std::string_view, std::size_t)>& act);

/// Splits a line at its commas; removes the blanks around each cell.
std::vector<std::string_view> cells(std::string_view line);

/// Returns the number in a cell; NaN if the cell is not a finite number.
double number_in(std::string_view cell);

/// Returns the stature of a person with this distance from waist to head [m].
double trunk_stature(const BodyPoints& p);

/// Throws ConfigError unless the first frame, read from `line`, is a person in metres, z up.
void check_body(const BodyPoints& p, const std::string& name, std::size_t line);

/// Converts world points to the recording's frame and finds the max reach.
Recording finish(std::vector<BodyPoints> frames, double rate, bool lower_body_recorded);

/// Returns the positions of all joints of a body.
BodyPoints points_of(const std::vector<BodyJoint>& joints);

}  // namespace handsel::sim::recording_detail
