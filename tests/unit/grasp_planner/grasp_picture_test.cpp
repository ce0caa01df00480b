// SPDX-License-Identifier: Apache-2.0
// Pictures of grasps: near parts hide far ones, transparent parts do not, and a figure shows its
// subject.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "deploy/handsel/pictures/grasp_picture.hpp"

namespace handsel::grasp_picture_test {
namespace {

using namespace grasp_planner;

constexpr Colour kRed = {200, 0, 0}, kBlue = {0, 0, 200};

Canvas from_above() {
  return Canvas(40, 40, {Vector3::Zero(), Vector3::UnitZ(), Vector3::UnitY(), 0.4});
}

TEST(Canvas, what_is_nearer_hides_what_is_behind_in_whatever_order_they_are_drawn) {
  for (const bool near_first : {true, false}) {
    Canvas canvas = from_above();
    for (const bool near : {near_first, !near_first})
      canvas.shape(Box{{0.1, 0.1, 0.02}}, make_pose(Vector3(0, 0, near ? 0.1 : 0)),
                   near ? kRed : kBlue);
    const Colour c = canvas.picture().at(20, 20);
    EXPECT_GT(c[0], 80) << near_first;
    EXPECT_EQ(c[2], 0) << near_first;
  }
}

TEST(Canvas, x_is_right_y_is_up_and_the_scale_is_that_of_the_eye) {
  Canvas canvas = from_above();
  canvas.ball({0.1, 0.05, 0}, 0.02, kRed);
  const Picture p = canvas.picture();
  EXPECT_LT(p.at(30, 15)[1], 100);
  EXPECT_EQ(p.at(30, 25), (Colour{255, 255, 255}));
  EXPECT_EQ(p.at(33, 15), (Colour{255, 255, 255}));
}

TEST(Canvas, what_lets_light_through_shows_what_is_behind_it_and_nothing_before_it) {
  Canvas canvas = from_above();
  canvas.shape(Box{{0.2, 0.2, 0.02}}, make_pose(Vector3(0, 0, 0.1)), kRed, 0.5);
  canvas.ball({0, 0, 0}, 0.04, kBlue);
  canvas.ball({0.08, 0, 0.2}, 0.02, kBlue);
  const Picture p = canvas.picture();
  EXPECT_GT(p.at(20, 20)[0], 40);
  EXPECT_GT(p.at(20, 20)[2], 15) << "two faces of the pane halve it twice";
  EXPECT_EQ(p.at(28, 20)[0], 0) << "a red pane behind the ball";
}

class Figures : public testing::Test {
 protected:
  static std::set<Colour> colours(const Picture& p) {
    std::set<Colour> out;
    for (int y = 0; y < p.height(); ++y)
      for (int x = 0; x < p.width(); ++x) out.insert(p.at(x, y));
    return out;
  }
  /// Returns the number of pixels in the hue of a finger, independent of brightness.
  static int of_finger(const Picture& p, std::size_t finger) {
    const Colour c = finger_colour(finger);
    int count = 0;
    for (int y = 0; y < p.height(); ++y) {
      for (int x = 0; x < p.width(); ++x) {
        const Colour s = p.at(x, y);
        const double light = (s[0] + s[1] + s[2]) / static_cast<double>(c[0] + c[1] + c[2]);
        bool same = light > 0.3 && light <= 1.01;
        for (std::size_t k = 0; k < 3; ++k) same = same && std::abs(s[k] - light * c[k]) < 3;
        count += same;
      }
    }
    return count;
  }

  const std::filesystem::path deploy_ = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";
  HandGeometry hand_geometry_{HandModel::load(deploy_ / "hands/sah/sah.txtpb")};
  Graspable object_{ObjectModel::load(deploy_ / "objects/box/box.txtpb"),
                    hand_geometry_.tip_radius(), 0.6, 1};
};

TEST_F(Figures, a_grasp_shows_the_contacts_of_its_fingers_and_of_no_other) {
  Grasp g;
  g.hand_joints = hand_geometry_.hand.pregrasp();
  for (const std::uint32_t finger : {0U, 2U}) {
    Contact c;
    c.finger = finger;
    c.position = object_.points()[40 * (finger + 1)].position;
    c.normal = object_.points()[40 * (finger + 1)].normal;
    c.friction = 0.5;
    g.contacts.push_back(c);
  }
  std::array<int, 4> seen{};
  for (const Vector3& side : {Vector3(1, 1, 1), Vector3(-1, -1, -1)}) {
    Canvas canvas(200, 200, eye_on(object_.box(), side));
    draw_contacts(canvas, g);
    for (std::size_t f = 0; f < 4; ++f) seen[f] += of_finger(canvas.picture(), f);
  }
  EXPECT_GT(seen[0], 10);
  EXPECT_GT(seen[2], 10);
  EXPECT_EQ(seen[1] + seen[3], 0);
}

TEST_F(Figures, flat_is_red_and_the_edges_of_a_box_are_blue) {
  Canvas canvas(200, 200, eye_on(object_.box(), Vector3::UnitX()));
  draw_curvature(canvas, object_, 0.013);
  const Picture p = canvas.picture();
  const Colour middle = p.at(100, 100);
  EXPECT_GT(middle[0], 90);
  EXPECT_EQ(middle[2], 0);
  int y = 100;
  while (p.at(100, y) != Colour{255, 255, 255}) --y;
  EXPECT_GT(p.at(100, y + 2)[2], 60);
  EXPECT_LT(p.at(100, y + 2)[0], 30);
}

TEST_F(Figures, candidates_are_coloured_by_the_fingers_that_reach_them) {
  const FingerWorkspaces workspaces = make_workspaces(hand_geometry_);
  const Pose T_object_hand =
      make_pose(object_.box().center()) * hand_geometry_.hand.T_hand_grasp().inverse();
  std::array<int, 4> seen{};
  for (const Vector3& side : {Vector3(1, 1, 1), Vector3(-1, -1, -1)}) {
    Canvas canvas(200, 200, eye_on(object_.box(), side));
    draw_candidates(canvas, hand_geometry_, workspaces, object_, T_object_hand);
    for (std::size_t f = 0; f < 4; ++f) seen[f] += of_finger(canvas.picture(), f);
  }
  for (std::size_t f = 0; f < 4; ++f) EXPECT_GT(seen[f], 20) << f;
}

TEST_F(Figures, the_boxes_of_the_tree_hold_all_points_at_every_depth) {
  std::vector<Vector3> positions;
  for (const SurfacePoint& p : object_.points()) positions.push_back(p.position);
  const PointTree tree(positions);
  for (int depth = 0; depth < 6; ++depth) {
    const auto boxes = tree.boxes(depth);
    EXPECT_LE(boxes.size(), std::size_t{1} << depth);
    EXPECT_GT(boxes.size(), (std::size_t{1} << depth) / 2);
    for (const Vector3& p : positions)
      EXPECT_TRUE(
          std::any_of(boxes.begin(), boxes.end(), [&](const auto& b) { return b.contains(p); }));
  }
}

}  // namespace
}  // namespace handsel::grasp_picture_test
