// SPDX-License-Identifier: Apache-2.0
#include "common/model/robot_capsules.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>

#include "common/config/resources.hpp"
#include "common/geometry/segments.hpp"

namespace handsel::robot_capsules_test {
namespace {

double depth(const LinkCapsule& c, const Vector3& p) {
  const Vector3 d = c.b - c.a;
  const double t =
      d.squaredNorm() > 0 ? std::clamp((p - c.a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - c.a - t * d).norm() - c.radius;
}

std::vector<Vector3> surface_points(const Shape& shape) {
  std::vector<Vector3> out;
  if (const auto* box = std::get_if<Box>(&shape)) {
    for (int i = 0; i < 125; ++i)
      out.push_back(Vector3(i % 5, (i / 5) % 5, i / 25)
                        .cwiseQuotient(Vector3::Constant(4))
                        .cwiseProduct(box->size) -
                    box->size / 2);
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    for (int i = 0; i < 64; ++i)
      for (double z : {-0.5, 0.0, 0.5})
        out.emplace_back(cylinder->radius * std::cos(i * M_PI / 32),
                         cylinder->radius * std::sin(i * M_PI / 32), z * cylinder->length);
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    for (int axis = 0; axis < 3; ++axis) out.push_back(sphere->radius * Vector3::Unit(axis));
  } else if (const auto* mesh = std::get_if<MeshPtr>(&shape)) {
    out = (*mesh)->vertices;
  }
  return out;
}

TEST(RobotCapsules, contain_every_point_of_the_shapes) {
  const auto robot = RobotModel::load(robot_description("jido"));
  const auto capsules = robot_capsules(robot);
  for (std::size_t link = 0; link < robot.links().size(); ++link)
    for (const auto& placed : robot.links()[link].collision)
      for (const auto& p : surface_points(placed.shape)) {
        double least = 1;
        for (const auto& c : capsules)
          if (c.link == static_cast<int>(link))
            least = std::min(least, depth(c, placed.T_parent_shape * p));
        EXPECT_LE(least, 1e-6) << robot.links()[link].name;
      }
}

struct Setting {
  RobotModel robot = RobotModel::load(robot_description("jido"));
  std::vector<LinkCapsule> capsules = robot_capsules(robot);
  std::vector<Pose> T;
  Pose T_world_base =
      make_pose({0.1, 0.2, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vector3::UnitZ())));
  HumanState people;
  Setting() {
    robot.forward(robot.rest_configuration(), T);
    Person person;
    person.id = "anna";
    person.joints = standing_body({1.6, 0.4, 0}, M_PI, 1.75);
    people.people.push_back(person);
  }
  Separation find(const SeparationExemption& exception = {}) const {
    return separation(capsules, T, T_world_base, people, exception);
  }
};

TEST(Separation, is_the_least_over_all_pairs) {
  const Setting s;
  double least = std::numeric_limits<double>::infinity();
  Vector3 p, q;
  for (const auto& body : body_capsules(s.people.people[0]))
    for (const auto& c : s.capsules) {
      const Pose T = s.T_world_base * s.T[c.link];
      least = std::min(least, std::sqrt(nearest_points(T * c.a, T * c.b, body.a, body.b, p, q)) -
                                  c.radius - body.radius);
    }
  const auto found = s.find();
  EXPECT_NEAR(found.distance, least, 1e-12);
  EXPECT_NEAR((found.on_robot - found.on_person).norm(), least, 1e-9);
  EXPECT_EQ(found.person, "anna");
}

TEST(Separation, nobody_is_infinitely_far) {
  Setting s;
  s.people.people.clear();
  EXPECT_EQ(s.find().distance, std::numeric_limits<double>::infinity());
  EXPECT_EQ(s.find().link, -1);
}

TEST(Separation, shrinks_by_the_inflation) {
  Setting s;
  const double before = s.find().distance;
  s.people.people[0].inflation = 0.2;
  EXPECT_NEAR(s.find().distance, before - 0.2, 1e-9);
}

TEST(Separation, is_negative_inside_the_person) {
  Setting s;
  for (auto& joint : s.people.people[0].joints)
    joint.position = s.T_world_base * s.T[s.robot.tool_link()].translation();
  EXPECT_LT(s.find().distance, 0);
}

TEST(Separation, excepts_the_exchanging_forearm_and_hand_only) {
  Setting s;
  auto& joints = s.people.people[0].joints;
  const Vector3 palm = s.T_world_base * s.T[s.robot.tool_link()].translation();
  joints[body_joint_index("r_hand")].position = palm;
  joints[body_joint_index("r_wrist")].position = palm + Vector3(0.1, 0, 0);
  EXPECT_LT(s.find().distance, 0);
  EXPECT_LT(s.find({"anna", Side::left, false}).distance, 0);
  EXPECT_LT(s.find({"bert", Side::right, true}).distance, 0);
  const auto free = s.find({"anna", Side::right, false});
  EXPECT_TRUE(free.part != BodyPart::hand_right && free.part != BodyPart::forearm_right);
  EXPECT_GT(free.distance, s.find().distance);
}

TEST(Separation, incomplete_bodies_still_count) {
  Setting s;
  auto& joints = s.people.people[0].joints;
  joints.resize(4);
  EXPECT_LT(s.find().distance, 2.0);
}

}  // namespace
}  // namespace handsel::robot_capsules_test
