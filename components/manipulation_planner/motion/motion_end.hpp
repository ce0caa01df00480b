// SPDX-License-Identifier: Apache-2.0
// How motions and other parts of an action end.
#pragma once

#include <cstdint>
#include <string>

#include "common/messages/task.hpp"

namespace handsel::manipulation_planner {

/// How a motion of the arm ended.
enum class MotionEnd : std::uint8_t {
  reached,           ///< its goal
  failed,            ///< for a reason of its own
  person_too_near,   ///< a person is so near that the controller lets the arm go no further
  target_moved,      ///< what it aimed at was moved
  giver_approached,  ///< what it aimed at was moved by a step of the giver toward the hand
  late,              ///< it took longer than it may
  taken,             ///< the receiver takes hold of the object already
  displaced,         ///< the platform is found elsewhere than its wheels have measured
};

/// Outcome of a part of an action.
struct Outcome {
  bool good{true};                          ///< the part has succeeded
  std::string reason;                       ///< why not, one sentence
  MotionEnd end{MotionEnd::reached};        ///< failed also where no motion was part of it
  ActionFailure kind{ActionFailure::none};  ///< of a failure: recovery is chosen by it
  /// Returns whether the target of the motion is no longer where it was.
  bool target_moved() const {
    return end == MotionEnd::target_moved || end == MotionEnd::giver_approached;
  }
  /// Returns whether another attempt at the same motion is of no use.
  bool is_final() const {
    return target_moved() || end == MotionEnd::taken || end == MotionEnd::late ||
           end == MotionEnd::displaced;
  }
  /// Makes a failure for a reason of its own; `why`: one sentence.
  static Outcome failure(std::string why, ActionFailure of_kind = ActionFailure::other) {
    return {false, std::move(why), MotionEnd::failed, of_kind};
  }
  /// Returns this failure with the part of the action in front of its reason.
  Outcome of(const std::string& part) const { return {good, part + ": " + reason, end, kind}; }
  /// Makes the failure that a planner, e.g. "path", has not replied in time.
  static Outcome no_answer(const std::string& planner) {
    return failure("the " + planner + " planner does not answer", ActionFailure::no_answer);
  }
  /// Makes the failure that an object or a person is not seen any more.
  static Outcome out_of_sight(const std::string& what) {
    return failure(what + " is out of sight", ActionFailure::not_visible);
  }
};

}  // namespace handsel::manipulation_planner
