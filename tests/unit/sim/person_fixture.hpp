// SPDX-License-Identifier: Apache-2.0
// People without the emulated world: an offered object and the passing of time.
#pragma once

#include "tests/unit/sim/sim_fixture.hpp"

namespace handsel::sim::test {

inline std::filesystem::path recording_folder() {
  const char* data = std::getenv("HANDSEL_DATA");
  return data == nullptr ? std::filesystem::path()
                         : std::filesystem::path(data) / "motion/kth_handover/handover_sample";
}

inline PersonView offer(const Vector3& where) {
  PersonView view;
  view.object = library()("mug");
  view.T_world_object = make_pose(where);
  view.robot_hand = where + Vector3(-0.2, 0, 0);
  view.held_by_robot = true;
  return view;
}

inline int joint(const char* name) { return body_joint_index(name); }

/// Steps a person until the phase is reached, at most `max_time` [s].
inline void step_until(PersonModel& person, const PersonView& view, PersonPhase phase,
                       double max_time) {
  for (int i = 0; i < 1000 * max_time && person.phase() != phase; ++i) person.step(0.001, view);
}

/// Lets a person live for a while [s].
inline void step_for(PersonModel& person, const PersonView& view, double time) {
  for (int i = 0; i < 1000 * time; ++i) person.step(0.001, view);
}

/// Returns a person in front of the object of offer().
inline PersonSettings taker() {
  PersonSettings settings;
  settings.feet = Vector3(1.5, 0, 0);
  settings.yaw = M_PI;
  return settings;
}

}  // namespace handsel::sim::test
