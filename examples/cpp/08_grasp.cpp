// SPDX-License-Identifier: Apache-2.0
// Tests contacts for force closure and finds the grip forces with the largest margin.
#include <cmath>
#include <cstdio>
#include <numbers>

#include <handsel/grasp.hpp>

int main() {
  std::vector<handsel::PointContact> contacts;
  for (int k = 0; k < 3; ++k) {  // on a cylinder of 3 cm radius
    const double angle = 2 * std::numbers::pi * k / 3;
    const handsel::Vector3 out(std::cos(angle), std::sin(angle), 0);
    contacts.push_back({0.03 * out, -out, 0.6});
  }
  const handsel::Vector3 centre = handsel::Vector3::Zero();
  const std::vector<handsel::PointContact> two(contacts.begin(), contacts.begin() + 2);
  std::printf("two fingers: %d\n",
              handsel::force_closure(handsel::contact_wrenches(two, 8, centre, 1 / 0.03)));
  std::printf("three fingers: %d\n",
              handsel::force_closure(handsel::contact_wrenches(contacts, 8, centre, 1 / 0.03)));
  const handsel::GripForces grip = handsel::grip_forces(contacts, centre, 0.3);
  for (const handsel::Vector3& force : grip.forces) std::printf("%.2f N\n", force.norm());
  std::printf("margin %.2f N\n", grip.margin);
  return 0;
}
