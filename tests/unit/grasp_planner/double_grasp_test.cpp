// SPDX-License-Identifier: Apache-2.0
// Pairs of grasps, checked on the hands' link shapes by forward kinematics and FCL, independent of
// the tests of the pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "common/collision/collision_world.hpp"
#include "components/grasp_planner/choice/grasp_answer.hpp"
#include "components/grasp_planner/pair/double_grasp.hpp"
#include "tests/support/grasp_lists.hpp"

namespace handsel::grasp_planner::double_grasp_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double hands_distance(const HandGeometry& a, const Pose& T_object_a, const Vector& qa,
                      const HandGeometry& b, const Pose& T_object_b, const Vector& qb) {
  std::vector<Pose> Ta, Tb;
  a.hand.model().forward(qa, Ta);
  b.hand.model().forward(qb, Tb);
  double least = 1;
  for (std::size_t i = 0; i < Ta.size(); ++i) {
    for (const PlacedShape& s : a.hand.model().links()[i].collision) {
      for (std::size_t k = 0; k < Tb.size(); ++k) {
        for (const PlacedShape& t : b.hand.model().links()[k].collision) {
          least = std::min(least, shape_distance(s.shape, T_object_a * Ta[i] * s.T_parent_shape,
                                                 t.shape, T_object_b * Tb[k] * t.T_parent_shape)
                                      .distance);
        }
      }
    }
  }
  return least;
}

HandSide side_of(const HandOnObject& h) { return {h.hand_geometry.get(), &h.list, {}}; }

TEST(LeftHand, the_left_hand_is_the_mirror_image_of_the_right) {
  for (const auto& [right, left] :
       {std::pair("sah", "sah_left"), std::pair("human_right", "human_left")}) {
    const HandModel &r = hand_kit(right)->hand, &l = hand_kit(left)->hand;
    ASSERT_EQ(r.model().dof(), l.model().dof());
    for (const double share : {0.0, 0.3, 0.8}) {
      Vector q(r.model().dof());
      for (int i = 0; i < q.size(); ++i) {
        const Axis& axis = r.model().axes()[static_cast<std::size_t>(i)];
        q[i] = axis.lower + share * (1 + 0.1 * (i % 3)) / 1.2 * (axis.upper - axis.lower);
      }
      for (std::size_t f = 0; f < r.fingers().size(); ++f) {
        const Vector3 p =
            r.model().link_pose(q, r.model().link_index(r.fingers()[f].tip_link)).translation();
        const Vector3 m =
            l.model().link_pose(q, l.model().link_index(l.fingers()[f].tip_link)).translation();
        EXPECT_LT((m - Vector3(p.x(), -p.y(), p.z())).norm(), 1e-8) << left << ", finger " << f;
      }
    }
  }
  // Wrist crease to the tip of the middle finger of an adult: 0.17 to 0.21 m.
  const HandModel& human = hand_kit("human_right")->hand;
  const int tip = human.model().link_index("middle_tip");
  const double length =
      human.model().link_pose(Vector::Zero(human.model().dof()), tip).translation().z() +
      human.fingers()[2].tip_radius;
  EXPECT_GT(length, 0.17);
  EXPECT_LT(length, 0.21);
}

TEST(DoubleGrasps, hands_stay_apart_and_the_order_is_that_of_the_score) {
  const HandOnObject &right = hand_on_object("sah", "bottle"),
                     &left = hand_on_object("sah_left", "bottle");
  DoubleSettings settings;
  settings.max_of_each = 60;
  settings.clearance = 0.004;
  const DoubleList doubles = list_double_grasps(side_of(right), side_of(left), settings);
  EXPECT_EQ(doubles.grasps.size() + doubles.colliding, doubles.pairs);
  ASSERT_GT(doubles.grasps.size(), 10U);
  EXPECT_GT(doubles.colliding, 10U);
  std::set<std::pair<std::size_t, std::size_t>> listed;
  double last = 3;
  for (std::size_t n = 0; n < doubles.grasps.size(); ++n) {
    const DoubleGrasp& d = doubles.grasps[n];
    EXPECT_TRUE(listed.insert({d.first, d.second}).second);
    EXPECT_LE(d.score, last);
    last = d.score;
    const Grasp &a = right.list.grasps[d.first].grasp, &b = left.list.grasps[d.second].grasp;
    EXPECT_DOUBLE_EQ(d.quality, std::min(a.quality, b.quality));
    if (n % 4 != 0) continue;
    EXPECT_GT(hands_distance(*right.hand_geometry, a.T_object_hand, a.hand_joints,
                             *left.hand_geometry, b.T_object_hand, b.hand_joints),
              0.0039);
  }
  // Pairs that are not listed collide.
  int tested = 0;
  for (std::size_t i = 0; i < 60; i += 7) {
    for (std::size_t k = 0; k < 60; k += 5) {
      if (listed.contains({i, k})) continue;
      const Grasp &a = right.list.grasps[i].grasp, &b = left.list.grasps[k].grasp;
      EXPECT_LT(hands_distance(*right.hand_geometry, a.T_object_hand, a.hand_joints,
                               *left.hand_geometry, b.T_object_hand, b.hand_joints),
                0.0041);
      ++tested;
    }
  }
  EXPECT_GT(tested, 30);
}

TEST(DoubleGrasps, of_passing_either_hand_gets_out_past_object_and_other_hand) {
  const HandOnObject &right = hand_on_object("sah", "bottle"),
                     &human = hand_on_object("human_right", "bottle");
  DoubleSettings settings;
  settings.max_of_each = 120;
  settings.clearance = 0.01;
  settings.min_opposition = 120 * kDegree;
  settings.passed = right.object.get();
  const DoubleList doubles = list_double_grasps(side_of(right), side_of(human), settings);
  EXPECT_EQ(doubles.grasps.size() + doubles.colliding + doubles.not_opposed + doubles.no_retreat,
            doubles.pairs);
  ASSERT_GT(doubles.grasps.size(), 20U);
  EXPECT_GT(doubles.not_opposed, 0U);
  std::vector<Pose> T_open;
  for (std::size_t n = 0; n < doubles.grasps.size();
       n += std::max<std::size_t>(1, doubles.grasps.size() / 3)) {
    const DoubleGrasp& d = doubles.grasps[n];
    const Grasp &a = right.list.grasps[d.first].grasp, &b = human.list.grasps[d.second].grasp;
    EXPECT_GT(hands_distance(*right.hand_geometry, a.T_object_hand, a.hand_joints,
                             *human.hand_geometry, b.T_object_hand, b.hand_joints),
              0.0099);
    const double angle = std::acos((a.T_object_hand.linear() * Vector3::UnitZ())
                                       .dot(b.T_object_hand.linear() * Vector3::UnitZ()));
    EXPECT_GT(angle, 120 * kDegree - 1e-9);
    EXPECT_NEAR(angle, d.opposition, 1e-6);
    EXPECT_NEAR(d.retreat_first.norm(), 1, 1e-9);
    for (const double s : {0.016, 0.08}) {
      const auto off = [s](const Grasp& g, const Vector3& way) {
        return g.T_object_hand * Eigen::Translation3d(s * way);
      };
      EXPECT_GT(hands_distance(*right.hand_geometry, off(a, d.retreat_first), a.pregrasp_joints,
                               *human.hand_geometry, b.T_object_hand, b.hand_joints),
                0);
      EXPECT_GT(hands_distance(*right.hand_geometry, a.T_object_hand, a.hand_joints,
                               *human.hand_geometry, off(b, d.retreat_second), b.pregrasp_joints),
                0);
      for (const auto& [hand_geometry, g, way] :
           {std::tuple(right.hand_geometry, &a, d.retreat_first),
            std::tuple(human.hand_geometry, &b, d.retreat_second)}) {
        hand_geometry->hand.model().forward(g->pregrasp_joints, T_open);
        for (std::size_t l = 0; l < T_open.size(); ++l) {
          for (const PlacedShape& shape : hand_geometry->hand.model().links()[l].collision) {
            const Pose T_object_shape = off(*g, way) * T_open[l] * shape.T_parent_shape;
            EXPECT_FALSE(shape_distance(shape.shape, T_object_shape,
                                        Shape(std::make_shared<TriangleMesh>(right.object->mesh())),
                                        Pose::Identity())
                             .collide);
          }
        }
      }
    }
  }
}

/// Returns the distance of a fingertip from the surface of the object [m].
double tip_distance(const HandGeometry& hand, std::uint32_t finger, const Pose& T_object_hand,
                    const Vector& q, const Graspable& object) {
  const RobotModel& model = hand.hand.model();
  const auto& tip = hand.hand.fingers()[finger];
  return shape_distance(Shape(Sphere{tip.tip_radius}),
                        T_object_hand * model.link_pose(q, model.link_index(tip.tip_link)),
                        Shape(std::make_shared<TriangleMesh>(object.mesh())), Pose::Identity())
      .distance;
}

TEST(DoubleGrasps, a_reply_pairs_either_hand_of_the_person_each_touching_the_object_and_not_ours) {
  const HandOnObject& robot = hand_on_object("sah", "mug");
  const std::map<Side, const HandOnObject*> human{
      {Side::right, &hand_on_object("human_right", "mug")},
      {Side::left, &hand_on_object("human_left", "mug")}};
  GraspReply reply;
  for (const ListedGrasp& listed : robot.list.grasps) reply.grasps.push_back(listed.grasp);
  for (const Side side : {Side::right, Side::left})
    add_partners(robot.list, TransferTable(side_of(robot), side_of(*human.at(side)), *robot.object),
                 side, reply);
  std::map<Side, int> checked;
  for (const Grasp& ours : reply.grasps) {
    std::map<Side, std::size_t> count;
    for (const PartnerGrasp& partner : ours.partners) {
      EXPECT_LE(++count[partner.side], 4U);
      if (checked[partner.side] >= 60) continue;
      const HandOnObject& hand = *human.at(partner.side);
      const auto theirs = std::find_if(hand.list.grasps.begin(), hand.list.grasps.end(),
                                       [&](const auto& g) { return g.grasp.id == partner.id; });
      ASSERT_NE(theirs, hand.list.grasps.end());
      const Vector& q = theirs->grasp.hand_joints;
      EXPECT_GT(hands_distance(*robot.hand_geometry, ours.T_object_hand, ours.hand_joints,
                               *hand.hand_geometry, partner.T_object_wrist, q),
                0.0039);
      // The fingers of a hand of the other side would not reach their contacts.
      for (const Contact& contact : theirs->grasp.contacts)
        EXPECT_LT(std::abs(tip_distance(*hand.hand_geometry, contact.finger, partner.T_object_wrist,
                                        q, *robot.object)),
                  0.004);
      ++checked[partner.side];
    }
  }
  EXPECT_GE(checked[Side::right], 30);
  EXPECT_GE(checked[Side::left], 30);
}

TEST(DoubleGrasps, the_less_natural_arm_counts_and_grasps_out_of_reach_are_left_out) {
  const HandOnObject &right = hand_on_object("sah", "bottle"),
                     &left = hand_on_object("sah_left", "bottle");
  HandSide a = side_of(right), b = side_of(left);
  for (std::size_t i = 0; i < right.list.grasps.size(); ++i)
    a.rest_score.push_back(i % 3 == 0 ? -1.0 : 0.5 + 0.001 * static_cast<double>(i));
  b.rest_score.assign(left.list.grasps.size(), 0.52);
  DoubleSettings settings;
  settings.max_of_each = 60;
  const DoubleList doubles = list_double_grasps(a, b, settings);
  EXPECT_EQ(doubles.out_of_reach, 20U * 60U);
  double low_q = 1, high_q = 0, low_p = 1, high_p = 0;
  for (const DoubleGrasp& d : doubles.grasps) {
    EXPECT_NE(d.first % 3, 0U);
    EXPECT_DOUBLE_EQ(d.rest_score, std::min(a.rest_score[d.first], 0.52));
    low_q = std::min(low_q, d.quality);
    high_q = std::max(high_q, d.quality);
    low_p = std::min(low_p, d.rest_score);
    high_p = std::max(high_p, d.rest_score);
  }
  for (const DoubleGrasp& d : doubles.grasps)
    EXPECT_NEAR(d.score,
                (d.quality - low_q) / (high_q - low_q) + (d.rest_score - low_p) / (high_p - low_p),
                1e-9);
}

}  // namespace
}  // namespace handsel::grasp_planner::double_grasp_test
