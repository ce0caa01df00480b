// Normal < Slow < Hold < Stop < Fault, with named causes and the rules that clear them (architecture: section 1; reliability). Pure.
#pragma once

#include <cstdint>

#include "common/messages/execution.hpp"

namespace handsel::trajectory_controller {

struct TimeoutSettings {
  double robot_state{0.02};  ///< Stop [s]
  double human_state{0.2};   ///< Stop [s]
  double forecast{0.1};      ///< Hold, while a trajectory runs [s]
  double attention{0.3};     ///< fixed low factor [s]
  double supervisor{0.3};    ///< Hold at the end of the trajectory [s]
};

/// What the machine judges in one cycle. Ages in s; negative = never seen.
struct ModeInputs {
  double robot_age{-1}, human_age{-1}, forecast_age{-1}, attention_age{-1}, go_age{-1};
  double running_for{};  ///< since the running trajectory started [s]
  bool running{};        ///< a trajectory is not finished
  bool at_rest{};        ///< no axis moves
  bool drive_enabled{};
  bool set_points_late{};  ///< the robot side stands with its drives enabled because set-points stayed away
  bool tracking_error{}, limit_violation{}, cycle_late{};
  bool forecast_collision_hold{}, forecast_collision_slow{};
  bool separation_slow{}, separation_stop{}, human_unknown{}, wall_slow{}, contact_stop{}, clamped{};
  bool attention_slow{}, cost_slow{}, override_slow{}, stop_unproven{};
  bool blind{}, blind_ahead{};  ///< no live source looks where the arm can be within its stop; nor where its path leads
  std::uint64_t go_epoch{};
  bool go_allowed{}, go_acknowledge{};
  std::uint64_t first_go_epoch{};  ///< of the Go heard first since the start, which permits no motion
  bool awaits_person{};            ///< motion is not permitted until a person resumes
};

struct ModeVerdict {
  Mode mode{Mode::hold};
  std::uint32_t causes{};  ///< bits of Cause that hold now
};

class ModeMachine {
 public:
  explicit ModeMachine(const TimeoutSettings& timeouts) : timeouts_(timeouts) {}
  ModeVerdict update(const ModeInputs& in) noexcept;
  Mode latched() const { return latched_; }

 private:
  TimeoutSettings timeouts_;
  Mode latched_{Mode::hold};  // normal when nothing is latched
  std::uint64_t epoch_{};     // a Go must be newer than this to resume
};

/// The most severe of the causes: what people are told.
Cause gravest(std::uint32_t causes);

}  // namespace handsel::trajectory_controller
