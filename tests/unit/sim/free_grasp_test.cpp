// SPDX-License-Identifier: Apache-2.0
// Places at which a person can hold an object that a robot holds.
#include <gtest/gtest.h>

#include "common/geometry/segments.hpp"
#include "common/model/human/holding_hand.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/object_surface.hpp"
#include "sim/people/free_grasp.hpp"

namespace handsel::sim::free_grasp_test {
namespace {

constexpr double kStature = 1.75;

double distance(const HandPart& a, const HandPart& b) {
  Vector3 on_a, on_b;
  return std::sqrt(nearest_points(a.a, a.b, b.a, b.b, on_a, on_b)) - a.radius - b.radius;
}

Vector3 level(const Vector3& v) { return {v.x(), v.y(), 0}; }

/// A person at the origin who faces +x, and an object before the right shoulder.
class FreeGraspTest : public testing::Test {
 protected:
  FreeGraspTest() {
    person_.joints = standing_body(Vector3::Zero(), 0, kStature);
    query_.arm = human_arm(person_, Side::right).value();
    query_.wrist = 0.09;
    query_.trunk = 0.45;
    query_.T_world_object.translation() = Vector3(0.5, -0.15, 1.15);
    query_.preferred = -Vector3::UnitX();
    query_.robot = &robot_;
  }

  const ObjectModel& load(const std::string& name) {
    object_ = ObjectModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/objects/" + name + "/" +
                                name + ".txtpb");
    query_.object = &object_;
    return object_;
  }

  /// Returns the parts of the hand in the grasp, world.
  std::vector<HandPart> hand(const FreeGrasp& grasp) const {
    std::vector<HandPart> out;
    const Pose T = query_.T_world_object * grasp.T_object_hand;
    for (const HandPart& part : shape_.parts(grasp.closures))
      out.push_back({T * part.a, T * part.b, part.radius});
    return out;
  }

  Person person_;
  ObjectModel object_;
  std::vector<HandPart> robot_;
  FreeGraspQuery query_;
  HumanHand shape_{Side::right, kStature, 0.09};
};

TEST_F(FreeGraspTest, every_object_of_the_library_can_be_held) {
  for (const char* name : {"mug", "bottle", "can", "box", "torch", "tube", "ball", "tray"}) {
    load(name);
    const auto grasp = find_free_grasp(query_, shape_);
    ASSERT_TRUE(grasp) << name;
    EXPECT_GE(grasp->digits_in_contact, 3) << name;
    EXPECT_LE(grasp->strain, 1.0) << name;
    for (const HandPart& part : hand(*grasp)) {
      const Pose T_object_world = query_.T_world_object.inverse();
      EXPECT_GT(surface_distance(object_, T_object_world * part.b), part.radius - 0.006) << name;
    }
  }
}

TEST_F(FreeGraspTest, the_hand_keeps_off_the_robot) {
  load("bottle");
  const auto alone = find_free_grasp(query_, shape_);
  ASSERT_TRUE(alone);
  const Vector3 p = query_.T_world_object * alone->T_object_hand.translation();
  robot_ = {{p, p + Vector3(0, 0, 0.01), 0.02}};  // at the hand's place
  const auto beside = find_free_grasp(query_, shape_);
  ASSERT_TRUE(beside);
  for (const HandPart& part : hand(*beside)) EXPECT_GE(distance(part, robot_[0]), 0.0029);
}

TEST_F(FreeGraspTest, there_is_none_on_an_object_that_the_robot_covers) {
  load("can");
  const Vector3 p = query_.T_world_object * object_.com;
  robot_ = {{p - Vector3(0, 0, 0.1), p + Vector3(0, 0, 0.1), 0.06}};
  EXPECT_FALSE(find_free_grasp(query_, shape_));
}

TEST_F(FreeGraspTest, a_hand_that_gives_leaves_the_upper_end_free) {
  query_.preferred = Vector3(-0.6, -0.8, 0);
  for (const char* name : {"mug", "bottle", "can", "box", "torch", "tube"}) {
    load(name);
    double top = -1, bottom = 1;
    for (const Vector3& vertex : object_.mesh.vertices) {
      top = std::max(top, vertex.z());
      bottom = std::min(bottom, vertex.z());
    }
    query_.p_left = query_.T_world_object * Vector3(0, 0, top);
    const auto grasp = find_free_grasp(query_, shape_);
    ASSERT_TRUE(grasp) << name;
    EXPECT_LT(grasp->T_object_hand.translation().z(), (top + bottom) / 2 - 0.02) << name;
    EXPECT_LT(grasp->strain, 0.65) << name;
  }
}

/// In a precision grip the hand is near less of the surface than with the palm on the object.
TEST_F(FreeGraspTest, a_hand_that_gives_may_hold_by_the_digits_alone) {
  query_.preferred = Vector3(-0.6, -0.8, 0);
  load("mug");
  query_.p_left = query_.T_world_object * Vector3(0, 0, 0.1);
  const auto free_fraction = [&](const FreeGrasp& grasp) {
    const std::vector<HandPart> parts = hand(grasp);
    double free = 0, all = 0;
    for (const auto& t : object_.mesh.triangles) {
      const Vector3 &a = object_.mesh.vertices[t[0]], &b = object_.mesh.vertices[t[1]],
                    &c = object_.mesh.vertices[t[2]];
      const double area = (b - a).cross(c - a).norm();
      const Vector3 p = query_.T_world_object * ((a + b + c) / 3);
      const bool is_free = std::none_of(parts.begin(), parts.end(), [&p](const HandPart& part) {
        return distance({p, p, 0}, part) < 0.03;
      });
      all += area;
      free += is_free ? area : 0;
    }
    return free / all;
  };
  FreeGraspSettings palm_on_object;
  palm_on_object.giving_palm_gap = 0;
  const auto with_palm = find_free_grasp(query_, shape_, palm_on_object);
  const auto by_digits = find_free_grasp(query_, shape_);
  ASSERT_TRUE(with_palm && by_digits);
  EXPECT_GE(by_digits->digits_in_contact, 3);
  // The tip of the thumb is on the other side of the object's axis than that of a finger.
  const auto tip = [&](int digit) {
    const auto parts = shape_.digit(digit, by_digits->closures[static_cast<std::size_t>(digit)]);
    return Vector3(by_digits->T_object_hand * std::prev(parts.end())->b);
  };
  bool is_opposed = false;
  for (int d = 1; d < kDigits; ++d) is_opposed = is_opposed || level(tip(0)).dot(level(tip(d))) < 0;
  EXPECT_TRUE(is_opposed);
  EXPECT_GT(surface_distance(object_, by_digits->T_object_hand.translation()),
            kPalmDistance + 0.01);
  std::printf("free of the hand: %.2f by the digits, %.2f with the palm\n",
              free_fraction(*by_digits), free_fraction(*with_palm));
  EXPECT_GT(free_fraction(*by_digits), free_fraction(*with_palm) + 0.05);
}

/// A planner's assumption of a giver's digits, of whom only wrist and hand are observed.
TEST_F(FreeGraspTest, assumed_digits_are_near_those_of_a_hand_that_gives) {
  query_.preferred = Vector3(-0.6, -0.8, 0);
  for (const char* name : {"mug", "bottle", "can", "box", "torch", "tube"}) {
    load(name);
    query_.p_left = query_.T_world_object * Vector3(0, 0, 0.1);
    const auto grasp = find_free_grasp(query_, shape_);
    ASSERT_TRUE(grasp) << name;
    const Pose T = query_.T_world_object * grasp->T_object_hand;
    Person seen = person_;
    seen.stature = kStature;
    const auto at = [&](const char* joint) -> Vector3& {
      return seen.joints[static_cast<std::size_t>(body_joint_index(joint))].position;
    };
    at("r_hand") = T.translation();
    at("r_wrist") = T * Vector3(0, 0, -query_.wrist);
    const auto max_distance = [&] {
      const std::vector<HandPart> digits = assumed_digits(seen, object_, query_.T_world_object);
      EXPECT_EQ(digits.size(), static_cast<std::size_t>(kDigits * kDigitSegments)) << name;
      double max = 0;
      for (int d = 0; d < kDigits; ++d) {
        for (const HandPart& part : shape_.digit(d, grasp->closures[d])) {
          const Vector3 p = grasp->T_object_hand * part.b;
          double nearest = std::numeric_limits<double>::infinity();
          for (const HandPart& assumed : digits)
            nearest = std::min(nearest, distance({p, p, part.radius}, assumed) + part.radius * 2);
          max = std::max(max, nearest);
        }
      }
      return max;
    };
    // An unobserved turn of the palm: a digit is up to 5 cm from where it is assumed.
    const double unobserved = max_distance();
    seen.palms.push_back({"r_hand", T.linear() * Vector3::UnitX()});
    const double observed = max_distance();
    std::printf(
        "%s: max distance of a digit from the assumed digits: %.1f mm, %.1f mm with the "
        "palm observed\n",
        name, 1e3 * unobserved, 1e3 * observed);
    EXPECT_LT(unobserved, 0.05) << name;
    EXPECT_LT(observed, 0.01) << name;
  }
}

TEST_F(FreeGraspTest, there_is_none_out_of_reach) {
  load("mug");
  query_.T_world_object.translation().x() = 1.4;
  EXPECT_FALSE(find_free_grasp(query_, shape_));
}

TEST(HumanHand, a_left_hand_mirrors_a_right_hand) {
  const HumanHand right(Side::right, kStature, 0.09), left(Side::left, kStature, 0.09);
  const Closures half{0.5, 0.5, 0.5, 0.5, 0.5};
  const auto a = right.parts(half), b = left.parts(half);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR((a[i].b.cwiseProduct(Vector3(1, -1, 1)) - b[i].b).norm(), 0, 1e-12);
    EXPECT_EQ(a[i].radius, b[i].radius);
  }
}

TEST(HumanHand, a_closing_digit_is_continuous_and_keeps_its_length) {
  const HumanHand hand(Side::right, kStature, 0.09);
  for (int d = 0; d < kDigits; ++d) {
    auto before = hand.digit(d, 0);
    for (double c = 0.01; c <= 1.0; c += 0.01) {
      const auto now = hand.digit(d, c);
      for (int s = 0; s < kDigitSegments; ++s) {
        EXPECT_LT((now[s].b - before[s].b).norm(), 0.005) << d << " " << s << " at " << c;
        EXPECT_NEAR((now[s].b - now[s].a).norm(), (before[s].b - before[s].a).norm(), 1e-12);
      }
      before = now;
    }
  }
}

}  // namespace
}  // namespace handsel::sim::free_grasp_test
