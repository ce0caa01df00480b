// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/input/observed_people.hpp"

#include "common/model/human/body_index.hpp"

namespace handsel::trajectory_controller {

void ObservedPeople::set(const HumanState& people, TimePoint sampled) {
  people_ = people;
  time_.mark(sampled);
  points_.clear();
  for (const Person& p : people.people) {
    if (p.joints.size() != kBodyJoints.size()) continue;
    points_.push_back({p.id, p.joints[body::torso].position, p.joints[body::l_hand].position,
                       p.joints[body::r_hand].position});
  }
  refresh();
}

void ObservedPeople::set(const ActionStatus& action) {
  engaged_ = action.exchange_engaged;
  if (!engaged_) return;
  std::string person = action.human;
  if (person.empty() && people_.people.size() == 1) person = people_.people.front().id;
  if (person == partner_) return;
  partner_ = person;
  refresh();
}

void ObservedPeople::end_exemption() noexcept {
  if (engaged_ || partner_.empty()) return;
  partner_.clear();
  for (PersonCapsule& capsule : capsules_.capsules) capsule.excepted = false;
}

void ObservedPeople::refresh() {
  SeparationExemption exemption;
  exemption.person = partner_;
  prepare(people_, exemption, unknown_after_, capsules_);
}

}  // namespace handsel::trajectory_controller
