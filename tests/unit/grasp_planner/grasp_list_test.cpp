// SPDX-License-Identifier: Apache-2.0
// Grasp lists of the Schunk hand on the project's objects: every property of a listed grasp,
// checked independently.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "components/grasp_planner/list/epsilon.hpp"
#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel::grasp_planner::grasp_list_test {
namespace {

const std::filesystem::path kDeploy = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";

std::shared_ptr<const HandGeometry> sah() {
  static const auto hand_geometry =
      std::make_shared<const HandGeometry>(HandModel::load(kDeploy / "hands/sah/sah.txtpb"));
  return hand_geometry;
}

std::shared_ptr<const FingerWorkspaces> workspaces() {
  static const auto made = std::make_shared<const FingerWorkspaces>(make_workspaces(*sah()));
  return made;
}

ObjectModel object(const std::string& name) {
  return ObjectModel::load(kDeploy / "objects" / name / (name + ".txtpb"));
}

GraspList list_of(const std::string& name, std::uint32_t positions = 24,
                  std::uint32_t orientations = 48, GraspListSettings settings = {}) {
  settings.positions = positions;
  settings.orientations = orientations;
  return list_grasps(sah(), workspaces(),
                     std::make_shared<const Graspable>(object(name), sah()->tip_radius(),
                                                       settings.step_fraction, 1),
                     settings);
}

// Returns the depth of a point inside a shape [m], negative outside.
double depth(const Shape& shape, const Vector3& p) {
  if (const auto* s = std::get_if<Sphere>(&shape)) return s->radius - p.norm();
  if (const auto* b = std::get_if<Box>(&shape)) return (0.5 * b->size - p.cwiseAbs()).minCoeff();
  if (const auto* c = std::get_if<Cylinder>(&shape))
    return std::min(c->radius - p.head<2>().norm(), 0.5 * c->length - std::abs(p.z()));
  ADD_FAILURE() << "shape not known to this test";
  return 0;
}

// Checks virtual work by the hand's kinematics: for a small motion the work of the axes equals the
// work of the forces at the contact points.
void expect_efforts_do_the_work_of_the_squeeze(const ObjectModel& o,
                                               const std::vector<PointContact>& contacts,
                                               const Grasp& g) {
  const GripForces grip = grip_forces(contacts, o.com, o.mass, limits_of(sah()->hand, {}));
  EXPECT_NEAR(grip.margin, g.margin, 1e-9);
  ASSERT_EQ(g.hand_effort.size(), g.hand_joints.size());
  const HandModel& hand = sah()->hand;
  const auto contact_at = [&](std::size_t k, const Vector& q) {
    const int tip = hand.model().link_index(hand.fingers()[g.contacts[k].finger].tip_link);
    const Pose T_tip_object =
        (g.T_object_hand * hand.model().link_pose(g.hand_joints, tip)).inverse();
    return Vector3(g.T_object_hand * hand.model().link_pose(q, tip) * T_tip_object *
                   g.contacts[k].position);
  };
  for (Eigen::Index a = 0; a < g.hand_joints.size(); ++a) {
    constexpr double kStep = 1e-6;
    const Vector ahead = g.hand_joints + kStep * Vector::Unit(g.hand_joints.size(), a);
    double work = 0;
    for (std::size_t k = 0; k < g.contacts.size(); ++k) {
      work += grip.forces[k].dot(contact_at(k, ahead) - contact_at(k, g.hand_joints)) / kStep;
    }
    EXPECT_NEAR(work, g.hand_effort[a], 1e-4) << "axis " << a;
  }
}

class ListedGrasps : public testing::TestWithParam<const char*> {};

TEST_P(ListedGrasps, keep_their_promises) {
  const ObjectModel o = object(GetParam());
  const GraspList list = list_of(GetParam());
  const RobotModel& model = sah()->hand.model();
  ASSERT_GE(list.grasps.size(), 20U);
  SurfaceSettings dense;
  dense.step = 0.003;
  dense.max_points = 40000;
  const auto surface = sample_surface(o.mesh, dense);
  std::uint64_t counted = 0;
  for (const std::uint64_t r : list.reasons) counted += r;
  EXPECT_EQ(counted, list.frames);
  EXPECT_EQ(list.reasons[0], list.grasps.size());
  std::vector<Pose> T_hand_link, T_open;
  double last = 1;
  for (const ListedGrasp& g : list.grasps) {
    EXPECT_LE(g.grasp.quality, last);
    last = g.grasp.quality;
    EXPECT_GE(g.grasp.quality, 0);
    ASSERT_GE(g.grasp.contacts.size(), 3U);
    EXPECT_EQ(g.grasp.contacts.front().finger, 0U) << "no grasp without the thumb";
    model.forward(g.grasp.hand_joints, T_hand_link);
    model.forward(g.grasp.pregrasp_joints, T_open);
    std::vector<PointContact> contacts;
    for (const Contact& c : g.grasp.contacts) {
      const auto& t = o.mesh.triangles[c.triangle];
      Vector3 on = Vector3::Zero();
      for (int k = 0; k < 3; ++k)
        on += c.barycentric[k] *
              o.mesh.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
      EXPECT_LT((on - c.position).norm(), 1e-9);
      const Finger& finger = sah()->hand.fingers()[c.finger];
      const Vector3 tip =
          g.grasp.T_object_hand *
          T_hand_link[static_cast<std::size_t>(model.link_index(finger.tip_link))].translation();
      EXPECT_LT((tip - c.position - finger.tip_radius * c.normal).norm(), 2e-4);
      const Vector3 open =
          g.grasp.T_object_hand *
          T_open[static_cast<std::size_t>(model.link_index(finger.tip_link))].translation();
      EXPECT_GT((open - tip).dot(c.normal), 0.008) << "the opened finger is off the surface";
      for (const int a : finger.axes) {
        EXPECT_GE(g.grasp.hand_joints[a], sah()->hand.lower_contact()[a] - 1e-9);
        EXPECT_LE(g.grasp.hand_joints[a], sah()->hand.upper_contact()[a] + 1e-9);
      }
      contacts.push_back({c.position, -c.normal, c.friction});
    }
    double radius = 0;
    for (const Vector3& v : o.mesh.vertices) radius = std::max(radius, (v - o.com).norm());
    EXPECT_NEAR(epsilon(contact_wrenches(contacts, 8, o.com, 1 / radius)), g.grasp.epsilon, 1e-9);
    EXPECT_GT(g.grasp.epsilon, 0);
    expect_efforts_do_the_work_of_the_squeeze(o, contacts, g.grasp);
    double deepest = -1, deepest_open = -1;
    for (std::size_t l = 0; l < model.links().size(); ++l) {
      for (const PlacedShape& shape : model.links()[l].collision) {
        const Pose T_shape_object =
            (g.grasp.T_object_hand * T_hand_link[l] * shape.T_parent_shape).inverse();
        const Pose T_shape_open =
            (g.grasp.T_object_hand * T_open[l] * shape.T_parent_shape).inverse();
        for (const SurfacePoint& p : surface) {
          deepest = std::max(deepest, depth(shape.shape, T_shape_object * p.position));
          deepest_open = std::max(deepest_open, depth(shape.shape, T_shape_open * p.position));
        }
      }
    }
    EXPECT_LT(deepest, 0.001) << "grasp " << g.grasp.id;
    EXPECT_LT(deepest_open, 0) << "grasp " << g.grasp.id;
  }
}

INSTANTIATE_TEST_SUITE_P(Objects, ListedGrasps, testing::Values("mug", "bottle", "box"));

TEST(GraspList, is_the_same_every_time_and_longer_lists_contain_shorter_ones) {
  const GraspList a = list_of("box", 12, 24), b = list_of("box", 12, 24),
                  longer = list_of("box", 12, 40);
  ASSERT_EQ(a.grasps.size(), b.grasps.size());
  for (std::size_t i = 0; i < a.grasps.size(); ++i) {
    EXPECT_EQ(a.grasps[i].grasp.id, b.grasps[i].grasp.id);
    EXPECT_EQ(a.grasps[i].grasp.hand_joints, b.grasps[i].grasp.hand_joints);
    EXPECT_EQ(a.grasps[i].grasp.T_object_hand.matrix(), b.grasps[i].grasp.T_object_hand.matrix());
    EXPECT_EQ(a.grasps[i].grasp.quality, b.grasps[i].grasp.quality);
    const auto same = std::find_if(longer.grasps.begin(), longer.grasps.end(), [&](const auto& g) {
      return g.grasp.id == a.grasps[i].grasp.id;
    });
    ASSERT_NE(same, longer.grasps.end());
    EXPECT_EQ(same->grasp.hand_joints, a.grasps[i].grasp.hand_joints);
    EXPECT_EQ(same->grasp.hand_effort, a.grasps[i].grasp.hand_effort);
    EXPECT_EQ(same->grasp.margin, a.grasps[i].grasp.margin);
  }
  EXPECT_GT(longer.grasps.size(), a.grasps.size());
}

const ListedGrasp* with_id(const GraspList& list, std::uint64_t id) {
  const auto found = std::find_if(list.grasps.begin(), list.grasps.end(),
                                  [id](const ListedGrasp& g) { return g.grasp.id == id; });
  return found != list.grasps.end() ? &*found : nullptr;
}

TEST(GraspList, takes_the_firmer_contacts_of_a_frame_where_the_grip_has_a_weight) {
  GraspListSettings settings;
  settings.weight_grip = 1;
  const GraspList plain = list_of("box"), firm = list_of("box", 24, 48, settings);
  ASSERT_EQ(plain.grasps.size(), firm.grasps.size());
  const auto value = [&](const ListedGrasp& g) {
    return g.grasp.quality + std::clamp(g.grasp.margin / settings.sturdy_margin, -2.0, 1.0);
  };
  int firmer = 0;
  for (const ListedGrasp& g : plain.grasps) {
    const ListedGrasp* other = with_id(firm, g.grasp.id);
    ASSERT_NE(other, nullptr);
    EXPECT_GE(value(*other), value(g) - 1e-9) << "frame " << g.grasp.id;
    firmer += other->grasp.margin > g.grasp.margin + 0.1;
  }
  EXPECT_GE(firmer, 5);
}

TEST(GraspList, grasps_that_bear_the_object_come_first) {
  GraspListSettings settings;
  settings.min_margin = 0;
  const GraspList list = list_of("mug", 24, 48, settings);
  std::size_t bearing = 0;
  while (bearing < list.grasps.size() && list.bears(list.grasps[bearing].grasp)) ++bearing;
  EXPECT_GT(bearing, 0U);
  EXPECT_LT(bearing, list.grasps.size());
  for (std::size_t i = bearing; i < list.grasps.size(); ++i)
    EXPECT_LT(list.grasps[i].grasp.margin, 0);
}

TEST(GraspList, a_creeping_fingertip_costs_margin_where_the_surface_is_curved_only) {
  GraspListSettings settings;
  settings.creep = 0.003;
  const GraspList steady = list_of("mug"), creeping = list_of("mug", 24, 48, settings);
  ASSERT_EQ(steady.grasps.size(), creeping.grasps.size());
  int curved = 0;
  for (const ListedGrasp& g : steady.grasps) {
    const ListedGrasp* other = with_id(creeping, g.grasp.id);
    ASSERT_NE(other, nullptr);
    bool is_flat = true;
    for (const Contact& c : g.grasp.contacts) is_flat = is_flat && c.curvature < 1e-6;
    if (is_flat) {
      EXPECT_NEAR(other->grasp.margin, g.grasp.margin, 1e-9);
    } else if (g.grasp.margin > 0) {
      EXPECT_LT(other->grasp.margin, g.grasp.margin + 1e-9);
    }
    curved += other->grasp.margin < g.grasp.margin - 0.05;
  }
  EXPECT_GE(curved, 20);
}

TEST(GraspList, says_why_a_frame_gives_none) {
  const GraspList list = list_of("mug", 12, 24);
  std::uint64_t refused = 0;
  for (const Refusal& r : list.refusals()) {
    EXPECT_FALSE(r.reason.empty());
    refused += std::stoull(r.what);
  }
  EXPECT_EQ(refused + list.grasps.size(), list.frames);
}

TEST(GraspList, sheets_and_needles_get_no_more_positions_than_other_things) {
  for (const Vector3& size :
       {Vector3(0.1, 0.1, 0.1), Vector3(0.2, 0.3, 1e-4), Vector3(0.3, 0.001, 0.001),
        Vector3(0.05, 0.08, 0.0), Vector3(0.2, 0.0, 0.0), Vector3(0.04, 0.2, 0.011)}) {
    const auto positions = uniform_positions({Vector3::Zero(), size}, 60);
    EXPECT_GE(positions.size(), 40U) << size.transpose();
    EXPECT_LE(positions.size(), 90U) << size.transpose();
  }
}

TEST(GraspList, positions_in_a_large_box_are_as_near_each_other_as_in_a_small_one) {
  GraspListSettings settings;
  EXPECT_EQ(position_count({Vector3::Zero(), Vector3(0.1, 0.1, 0.1)}, settings),
            settings.positions);
  const Eigen::AlignedBox3d tray(Vector3::Zero(), Vector3(0.56, 0.22, 0.135));
  const auto positions = uniform_positions(tray, position_count(tray, settings));
  double farthest = 0;
  for (const Vector3& p : positions) {
    double nearest = 1;
    for (const Vector3& q : positions)
      if (&p != &q) nearest = std::min(nearest, (p - q).norm());
    farthest = std::max(farthest, nearest);
  }
  EXPECT_LT(farthest, 1.2 * settings.spacing);
  settings.spacing = 0;
  EXPECT_EQ(position_count(tray, settings), settings.positions);
}

TEST(GraspList, an_object_of_the_wrong_size_is_refused_with_a_sentence) {
  ObjectModel o = object("box");
  for (Vector3& v : o.mesh.vertices) v *= 1000;
  try {
    const Graspable g(o, 0.013, 0.6, 1);
    FAIL() << "a box of 130 m";
  } catch (const ConfigError& e) {
    EXPECT_NE(std::string(e.what()).find("scale"), std::string::npos) << e.what();
  }
}

TEST(FingerWorkspace, spheres_are_inside_and_the_finger_gets_everywhere_in_them) {
  for (std::size_t f = 0; f < sah()->chains.size(); ++f) {
    const FingerWorkspace& w = (*workspaces())[f];
    EXPECT_TRUE(w.has_volume());
    ASSERT_GE(w.spheres().size(), 5U);
    int reached = 0, asked = 0;
    double last = 1;
    for (const WorkspaceSphere& s : w.spheres()) {
      EXPECT_LE(s.radius, last + 1e-12);
      last = s.radius;
      for (const Vector3& d :
           {Vector3(1, 0, 0), Vector3(0, -1, 0), Vector3(0, 0, 1), Vector3(-0.6, 0.6, -0.5)}) {
        const Vector3 p = s.centre + 0.9 * s.radius * d;
        ++asked;
        for (const auto& seed : w.seeds(p)) {
          Vector q = sah()->hand.pregrasp();
          for (std::size_t k = 0; k < sah()->chains[f].axes().size(); ++k)
            q[sah()->chains[f].axes()[k]] = seed.q[static_cast<Eigen::Index>(k)];
          if (!sah()->chains[f].inverse(p, sah()->hand.lower_contact(), sah()->hand.upper_contact(),
                                        q))
            continue;
          EXPECT_LT((sah()->chains[f].tip(q) - p).norm(), 1.1e-4);
          ++reached;
          break;
        }
      }
    }
    EXPECT_GE(reached, 0.98 * asked) << "finger " << f;
  }
}

}  // namespace
}  // namespace handsel::grasp_planner::grasp_list_test
