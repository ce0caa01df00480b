// SPDX-License-Identifier: Apache-2.0
#include "components/spark/left_out_report.hpp"

#include <cstdio>

namespace handsel::spark {

void LeftOutReport::count_new(const std::string& what, std::uint64_t so_far,
                              std::uint64_t& counted) {
  count_(what, so_far - counted);
  counted = so_far;
}

void LeftOutReport::add_bodies(std::uint32_t count, TimePoint arrival) {
  bodies_.add(count, arrival);
  count_("bodies of an observation: farther than the nearest " + std::to_string(quotas_.bodies),
         count);
}

void LeftOutReport::add_tracks(const LeftOut& tracks, const PeopleTracker& tracker) {
  count_("people remembered: farther than the nearest " + std::to_string(quotas_.tracks),
         tracks.count);
  count_new("observations of people: more than " + std::to_string(quotas_.sources) + " sources",
            tracker.refused_observations(), observations_counted_);
}

void LeftOutReport::add_people(const LeftOut& people, TimePoint now, HumanState& state) {
  people_ = people;
  state.left_out += bodies_.get(now);
  count_("people: farther than the nearest " + std::to_string(quotas_.people), state.left_out);
}

void LeftOutReport::add_scene(const SceneModel& scene) {
  count_("objects: less relevant than " + std::to_string(quotas_.objects) + " others",
         scene.objects_left_out());
  count_("boxes: farther than the nearest " + std::to_string(quotas_.boxes),
         scene.boxes_left_out());
  count_new(
      "objects remembered: less relevant than " + std::to_string(quotas_.known_objects) + " others",
      scene.forgotten(), objects_counted_);
}

void LeftOutReport::add_facts(const Facts& facts) {
  count_("facts: less relevant than " + std::to_string(quotas_.facts) + " others", facts.left_out);
}

std::string LeftOutReport::people_in_reach(const Coverage& reach) const {
  if (people_.count == 0 || people_.nearest > arm_radius(reach)) return "";
  char text[160];
  std::snprintf(text, sizeof text,
                "%u people are left out, the nearest %.2f m from the robot and within reach of the "
                "arm",
                people_.count, people_.nearest);
  return text;
}

}  // namespace handsel::spark
