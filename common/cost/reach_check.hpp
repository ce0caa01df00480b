// SPDX-License-Identifier: Apache-2.0
// Where furniture keeps a person's hands from: the comfort of the arm is validated against the
// environment (chapter section 4.1.2). Own method: the tests, which the chapter leaves open. Pure.
#pragma once

#include <string>
#include <vector>

#include "common/messages/world.hpp"

namespace handsel {

/// A hand that takes something needs this much room around it [m].
inline constexpr double kHandClearance = 0.04;

class ReachCheck {
 public:
  /// Of the person's present shoulders. Places nearer than `clearance` [m] to a box are none. A
  /// person without shoulders is kept from nothing but the boxes themselves.
  ReachCheck(const Person& person, const std::vector<SceneBox>& boxes,
             double clearance = kHandClearance);

  /// Id of a box that p (world) is in, near, under while the shoulders are above it, or behind as
  /// seen from both shoulders; nullptr: none.
  const std::string* blocked_by(const Vector3& p_world) const;

 private:
  struct Obstacle {
    std::size_t id;  // in ids_
    Pose T_box_world;
    Vector3 half, near;
    Vector3 left, right;  // shoulders, box frame
    bool upright, shadows;
    bool blocks(const Vector3& p_world) const;
  };
  std::vector<std::string> ids_;
  std::vector<Obstacle> obstacles_;
};

}  // namespace handsel
