#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/task.hpp"

namespace handsel {

const char* name(Behaviour value) {
  switch (value) {
    case Behaviour::search:
      return "search";
    case Behaviour::track:
      return "track";
    case Behaviour::avoid:
      return "avoid";
    case Behaviour::pick:
      return "pick";
    case Behaviour::place:
      return "place";
    case Behaviour::give:
      return "give";
    case Behaviour::receive:
      return "receive";
  }
  return "unknown";
}

const char* name(Cause value) {
  switch (value) {
    case Cause::none:
      return "none";
    case Cause::no_go:
      return "no_go";
    case Cause::supervisor_silent:
      return "supervisor_silent";
    case Cause::forecast_silent:
      return "forecast_silent";
    case Cause::forecast_collision:
      return "forecast_collision";
    case Cause::attention_silent:
      return "attention_silent";
    case Cause::attention_slow:
      return "attention_slow";
    case Cause::separation:
      return "separation";
    case Cause::robot_state_silent:
      return "robot_state_silent";
    case Cause::human_state_silent:
      return "human_state_silent";
    case Cause::human_unknown:
      return "human_unknown";
    case Cause::drive_not_enabled:
      return "drive_not_enabled";
    case Cause::tracking_error:
      return "tracking_error";
    case Cause::limit_violation:
      return "limit_violation";
    case Cause::cycle_late:
      return "cycle_late";
    case Cause::override_slow:
      return "override_slow";
  }
  return "unknown";
}

const char* name(Mode value) {
  switch (value) {
    case Mode::normal:
      return "normal";
    case Mode::slow:
      return "slow";
    case Mode::hold:
      return "hold";
    case Mode::stop:
      return "stop";
    case Mode::fault:
      return "fault";
  }
  return "unknown";
}

const char* name(TaskKind value) {
  switch (value) {
    case TaskKind::give:
      return "give";
    case TaskKind::receive:
      return "receive";
    case TaskKind::pick:
      return "pick";
    case TaskKind::place:
      return "place";
    case TaskKind::clear:
      return "clear";
    case TaskKind::tidy:
      return "tidy";
    case TaskKind::regrasp:
      return "regrasp";
    case TaskKind::lift:
      return "lift";
    case TaskKind::go_to:
      return "go_to";
    case TaskKind::pause:
      return "pause";
    case TaskKind::resume:
      return "resume";
    case TaskKind::cancel:
      return "cancel";
    case TaskKind::acknowledge:
      return "acknowledge";
    case TaskKind::speed:
      return "speed";
  }
  return "unknown";
}

const char* name(TaskState value) {
  switch (value) {
    case TaskState::accepted:
      return "accepted";
    case TaskState::running:
      return "running";
    case TaskState::paused:
      return "paused";
    case TaskState::succeeded:
      return "succeeded";
    case TaskState::failed:
      return "failed";
    case TaskState::cancelled:
      return "cancelled";
    case TaskState::refused:
      return "refused";
  }
  return "unknown";
}

const char* name(ActionKind value) {
  switch (value) {
    case ActionKind::pick:
      return "pick";
    case ActionKind::place:
      return "place";
    case ActionKind::give:
      return "give";
    case ActionKind::receive:
      return "receive";
    case ActionKind::go_to:
      return "go_to";
  }
  return "unknown";
}

}  // namespace handsel
