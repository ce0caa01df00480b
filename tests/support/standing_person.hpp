// SPDX-License-Identifier: Apache-2.0
// A person who stands at rest.
#pragma once

#include <numbers>

#include "common/model/human/human_body.hpp"

namespace handsel::test {

/// Returns anna alone, 1.75 m, facing -x, her feet at `feet`, world [m].
inline HumanState person_at(const Vector3& feet) {
  HumanState state;
  Person person;
  person.id = "anna";
  person.joints = standing_body(feet, std::numbers::pi, 1.75);
  state.people.push_back(person);
  return state;
}

}  // namespace handsel::test
