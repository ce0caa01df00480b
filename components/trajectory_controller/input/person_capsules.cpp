// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/input/person_capsules.hpp"

#include <algorithm>

#include "common/model/human/body_motion.hpp"

namespace handsel::trajectory_controller {

void prepare(const HumanState& people, const SeparationExemption& exception, double unknown_after,
             PersonCapsules& out) {
  out.capsules.clear();
  out.covered = people.covered;
  ++out.revision;
  for (const Person& person : people.people) {
    const bool in_handover = !exception.person.empty() && person.id == exception.person;
    const bool known = person.age <= unknown_after && person.joints.size() == kBodyJoints.size();
    const BodyCapsule* before = nullptr;
    const std::vector<BodyCapsule> body_parts = body_capsules(person);
    for (const BodyCapsule& body : body_parts) {
      PersonCapsule c;
      c.a = body.a;
      c.b = body.b;
      c.radius = body.radius;
      c.age = person.inflation > 0 ? 0.0 : std::max(0.0, person.age);
      c.centre = 0.5 * (body.a + body.b);
      c.reach = 0.5 * (body.b - body.a).norm() + body.radius;
      c.region = region_of(body.part);
      const bool first = before == nullptr || before->part != body.part;
      if (c.region == BodyRegion::lower_leg && first)
        c.region = BodyRegion::thigh;  // the first limb of a leg is the thigh
      before = &body;
      c.measured = known;
      if (known)
        for (int j : joints_of(body.part)) {
          const BodyJoint& joint = person.joints[static_cast<std::size_t>(j)];
          const Vector3& velocity = joint.velocity;
          c.measured = c.measured && joint.age <= unknown_after;
          c.velocities[static_cast<std::size_t>(c.joints++)] = velocity;
          c.fastest = std::max(c.fastest, velocity.norm());
        }
      const bool left = body.part == BodyPart::forearm_left || body.part == BodyPart::hand_left;
      const bool right = body.part == BodyPart::forearm_right || body.part == BodyPart::hand_right;
      c.excepted =
          in_handover && ((left && (exception.both_sides || exception.side == Side::left)) ||
                          (right && (exception.both_sides || exception.side == Side::right)));
      out.capsules.push_back(c);
    }
  }
}

}  // namespace handsel::trajectory_controller
