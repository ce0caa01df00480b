// SPDX-License-Identifier: Apache-2.0
// A small world for tests: Jido at rest, a mug on a column between its fingers, and optionally a
// person in front.
#pragma once

#include <cstdlib>
#include <memory>
#include <string>

#include "common/model/hand_model.hpp"
#include "sim/world.hpp"

namespace handsel::sim::test {

inline std::filesystem::path deploy() {
  return std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";
}

inline const RobotModel& jido() {
  static const RobotModel model = RobotModel::load(deploy() / "robots/jido/jido.txtpb");
  return model;
}
inline const HandModel& sah() {
  static const HandModel model = HandModel::load(deploy() / "hands/sah/sah.txtpb");
  return model;
}
inline const ObjectLibrary& library() {
  static const ObjectModel mug = ObjectModel::load(deploy() / "objects/mug/mug.txtpb");
  static const ObjectLibrary objects = [](const std::string& name) {
    return name == "mug" ? &mug : nullptr;
  };
  return objects;
}

/// Returns the mug's centre between the fingers in the rest configuration, world [m].
inline Vector3 in_hand() {
  return jido().link_pose(jido().rest_configuration(), jido().tool_link()) *
         Vector3(0.055, 0.0, 0.19);
}

inline config::Scenario mug_in_hand() {
  config::Scenario scenario;
  scenario.set_name("mug_in_hand");
  const Vector3 mug = in_hand();
  auto* column = scenario.add_boxes();
  column->set_id("column");
  column->set_supports(true);
  const double top = mug.z() - library()("mug")->height_above_support;
  column->mutable_pose()->mutable_xyz()->set_x(mug.x());
  column->mutable_pose()->mutable_xyz()->set_y(mug.y());
  column->mutable_pose()->mutable_xyz()->set_z(top - 0.05);
  column->mutable_size()->set_x(0.05);
  column->mutable_size()->set_y(0.05);
  column->mutable_size()->set_z(0.1);
  auto* object = scenario.add_objects();
  object->set_id("mug");
  object->set_model("mug");
  object->set_on("column");
  object->mutable_pose()->mutable_xyz()->set_x(mug.x());
  object->mutable_pose()->mutable_xyz()->set_y(mug.y());
  return scenario;
}

/// Someone 0.55 m beyond the mug, facing the robot.
inline config::PersonDescription* add_person(config::Scenario& scenario,
                                             config::PersonBehaviour behaviour) {
  auto* person = scenario.add_people();
  person->set_id("anna");
  person->set_x(in_hand().x() + 0.55);
  person->set_y(in_hand().y());
  person->set_yaw(M_PI);
  person->set_behaviour(behaviour);
  return person;
}

/// Sends set-points as a controller would and steps the world.
class Driver {
 public:
  Driver(SimWorld& world, const Vector& start) : world_(world), q_(start) {}

  const Vector& q() const { return q_; }
  /// All axes to `to` by a fifth-order polynomial, `seconds` long; `each` is called after every
  /// step.
  template <class F>
  void move(const Vector& to, double seconds, F&& each) {
    const Vector from = q_;
    const int n = static_cast<int>(std::lround(seconds / 0.001));
    for (int i = 1; i <= n; ++i) {
      const double x = static_cast<double>(i) / n;
      JointCommand c;
      c.robot = "jido";
      c.sequence = ++sequence_;
      c.position = from + x * x * x * (10 + x * (-15 + 6 * x)) * (to - from);
      c.velocity = x * x * (30 + x * (-60 + 30 * x)) / seconds * (to - from);
      c.acceleration = x * (60 + x * (-180 + 120 * x)) / (seconds * seconds) * (to - from);
      world_.command(c);
      world_.step();
      q_ = c.position;
      each();
    }
  }
  void move(const Vector& to, double seconds) {
    move(to, seconds, [] {});
  }
  void hold(double seconds) { move(q_, seconds); }
  std::uint64_t sequence() const { return sequence_; }

 private:
  SimWorld& world_;
  Vector q_;
  std::uint64_t sequence_{0};
};

inline Vector hand_at(Vector q, const Vector& hand) {
  return RobotModel::with(q, jido().require_group("hand"), hand);
}
/// Every finger well beyond the mug's surface, so that it squeezes.
inline Vector closed(const Vector& q) {
  Vector hand = sah().pregrasp();
  for (int i = 0; i < hand.size(); ++i) {
    const std::string& joint = sah().model().axes()[i].name;
    if (joint.ends_with("_proximal")) hand[i] = 0.9;
    if (joint.ends_with("_middle")) hand[i] = 0.8;
  }
  return hand_at(q, hand);
}
inline Vector opened(const Vector& q) {
  Vector hand = sah().pregrasp();
  for (int i = 0; i < hand.size(); ++i) {
    if (sah().model().axes()[i].name != "thumb_rotation") hand[i] = 0;
  }
  return hand_at(q, hand);
}
/// The arm raised by 0.15 m at the same orientation.
inline Vector raised(const Vector& q) {
  const Group& arm = jido().require_group("arm");
  Pose T = jido().link_pose(q, arm.tip);
  T.translation().z() += 0.15;
  const auto found = jido().inverse(arm, T, q);
  return found ? RobotModel::with(q, arm, *found) : q;
}

inline GroundTruth truth_of(const SimWorld& world) {
  GroundTruth ground_truth;
  world.ground_truth(ground_truth);
  return ground_truth;
}

}  // namespace handsel::sim::test
