// SPDX-License-Identifier: Apache-2.0
// Grip forces of random grasps against independent oracles: balance, friction cones, force limits,
// the margin by sampled loads, and optimality.
#include "common/grasp/grip_force.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include <Eigen/Dense>

namespace handsel::grip_force_test {
namespace {

using Random = std::mt19937_64;

Vector3 random_unit(Random& random) {
  std::normal_distribution<double> n;
  return Vector3(n(random), n(random), n(random)).normalized();
}

/// Returns contacts on a ball of 4 cm with normals up to 20 degrees from the radial direction.
std::vector<PointContact> random_contacts(Random& random, int count) {
  std::vector<PointContact> contacts;
  for (int i = 0; i < count; ++i) {
    const Vector3 out = random_unit(random);
    contacts.push_back({0.04 * out, -(out + 0.35 * random_unit(random)).normalized(), 0.6});
  }
  return contacts;
}

Eigen::MatrixXd grasp_matrix(const std::vector<PointContact>& contacts, const Vector3& com) {
  Eigen::MatrixXd G(6, 3 * static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const auto column = static_cast<Eigen::Index>(3 * i) + k;
      G.col(column).head<3>() = Vector3::Unit(k);
      G.col(column).tail<3>() = (contacts[i].position - com).cross(Vector3::Unit(k)) / 0.04;
    }
  }
  return G;
}

/// Returns the min remaining friction force of the contacts over the sampled loads [N].
double sampled_margin(const std::vector<PointContact>& contacts, const Vector3& com,
                      const Eigen::VectorXd& squeeze, double load, double share,
                      const std::vector<Vector3>& ways) {
  const Eigen::MatrixXd bear =
      -grasp_matrix(contacts, com).completeOrthogonalDecomposition().pseudoInverse().leftCols(3);
  double least = 1e9;
  for (const Vector3& way : ways) {
    const Eigen::VectorXd f = squeeze + load * bear * way;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Vector3 force = f.segment<3>(static_cast<Eigen::Index>(3 * i));
      const double normal = force.dot(contacts[i].inward_normal);
      const double sideways = (force - normal * contacts[i].inward_normal).norm();
      least = std::min(least, share * contacts[i].friction * normal - sideways);
    }
  }
  return least;
}

class GripForce : public testing::TestWithParam<int> {
 protected:
  Random random_{static_cast<std::uint64_t>(GetParam())};
};

TEST_P(GripForce, is_balanced_within_its_cap_and_no_other_squeeze_bears_more) {
  const GripForceSettings settings;
  const double mass = 0.3, load = mass * settings.acceleration,
               polygon = 1 / std::cos(M_PI / settings.edges);
  std::vector<Vector3> ways;
  for (int k = 0; k < 400; ++k) ways.push_back(random_unit(random_));
  int held = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const auto contacts = random_contacts(random_, 3 + trial % 3);
    const Vector3 com = 0.01 * random_unit(random_);
    const GripForces grip = grip_forces(contacts, com, mass, settings);
    ASSERT_EQ(grip.forces.size(), contacts.size());
    Eigen::VectorXd f(3 * static_cast<Eigen::Index>(contacts.size()));
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      f.segment<3>(static_cast<Eigen::Index>(3 * i)) = grip.forces[i];
      EXPECT_LE(grip.forces[i].dot(contacts[i].inward_normal), settings.max_normal + 1e-6);
    }
    const Eigen::MatrixXd G = grasp_matrix(contacts, com);
    EXPECT_LT((G * f).norm(), 1e-6 * std::max(1.0, f.norm()))
        << "seed " << GetParam() << " trial " << trial;
    // The linearised cone encloses the friction cone: the true margin is smaller by at most the
    // difference of the two.
    const double true_margin =
        sampled_margin(contacts, com, f, load, settings.friction_fraction, ways);
    const double rough =
        (polygon - 1) * settings.friction_fraction * 0.6 * settings.max_normal + 0.05 * load;
    EXPECT_GT(true_margin, grip.margin - rough - 0.05 * std::abs(grip.margin))
        << "seed " << GetParam() << " trial " << trial;
    EXPECT_LT(grip.margin, true_margin + rough + 0.05 * std::abs(grip.margin));
    held += grip.margin > 0;
    // Other grip forces: the margin is concave, so a better solution would exist nearby.
    const Eigen::MatrixXd free = Eigen::FullPivLU<Eigen::MatrixXd>(G).kernel();
    for (int k = 0; k < 200; ++k) {
      const Eigen::VectorXd step = free * Eigen::VectorXd::NullaryExpr(free.cols(), [&] {
                                     return std::normal_distribution<double>()(random_);
                                   });
      const Eigen::VectorXd other = f + (0.02 + 0.2 * (k % 5)) * step / step.norm();
      bool allowed = true;
      for (std::size_t i = 0; i < contacts.size(); ++i)
        allowed =
            allowed &&
            other.segment<3>(static_cast<Eigen::Index>(3 * i)).dot(contacts[i].inward_normal) <=
                settings.max_normal;
      if (allowed) {
        EXPECT_LT(sampled_margin(contacts, com, other, load, settings.friction_fraction, ways),
                  grip.margin + rough);
      }
    }
  }
  std::printf("seed %d: %d of 60 random grasps bear %.1f N in any direction\n", GetParam(), held,
              load);
}

TEST_P(GripForce, presses_no_harder_than_enough) {
  const GripForceSettings hard;
  GripForceSettings gentle;
  gentle.enough = 1.0;
  const auto pressure = [](const std::vector<PointContact>& contacts, const GripForces& grip) {
    double sum = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i)
      sum += grip.forces[i].dot(contacts[i].inward_normal);
    return sum;
  };
  int limited = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const auto contacts = random_contacts(random_, 3 + trial % 3);
    const GripForces full = grip_forces(contacts, Vector3::Zero(), 0.3, hard);
    const GripForces less = grip_forces(contacts, Vector3::Zero(), 0.3, gentle);
    EXPECT_NEAR(less.margin, std::min(full.margin, gentle.enough), 1e-6)
        << "seed " << GetParam() << " trial " << trial;
    if (full.margin < 1.1 * gentle.enough) continue;
    ++limited;
    EXPECT_LT(pressure(contacts, less), pressure(contacts, full));
  }
  EXPECT_GT(limited, 0);
}

TEST_P(GripForce, without_load_there_is_a_squeeze_exactly_when_the_grasp_is_force_closed) {
  const GripForceSettings settings;
  int closed = 0, open = 0;
  for (int trial = 0; trial < 200; ++trial) {
    auto contacts = random_contacts(random_, 3 + trial % 3);
    const bool squeezes = grip_forces(contacts, Vector3::Zero(), 0.0, settings).margin > 1e-6;
    for (PointContact& c : contacts) c.friction *= 0.98 * settings.friction_fraction;
    const bool inside =
        force_closure(contact_wrenches(contacts, settings.edges, Vector3::Zero(), 25));
    for (PointContact& c : contacts) c.friction /= 0.98 * std::cos(M_PI / settings.edges);
    const bool outside =
        force_closure(contact_wrenches(contacts, 2 * settings.edges, Vector3::Zero(), 25));
    if (inside) {
      EXPECT_TRUE(squeezes) << "seed " << GetParam() << " trial " << trial;
    }
    if (!outside) {
      EXPECT_FALSE(squeezes) << "seed " << GetParam() << " trial " << trial;
    }
    (squeezes ? closed : open)++;
  }
  EXPECT_GT(closed, 5);
  EXPECT_GT(open, 5);
}

INSTANTIATE_TEST_SUITE_P(Seeds, GripForce, testing::Values(1, 2, 3));

TEST(GripForces, opposed_pads_press_with_all_they_may_and_what_cannot_be_held_says_so) {
  const auto at = [](double angle) {
    const Vector3 out(std::cos(angle), std::sin(angle), 0);
    return PointContact{0.04 * out, -out, 0.6};
  };
  GripForceSettings settings;
  const GripForces grip =
      grip_forces({at(0), at(2 * M_PI / 3), at(4 * M_PI / 3)}, Vector3::Zero(), 0.1, settings);
  ASSERT_EQ(grip.forces.size(), 3U);
  for (const Vector3& f : grip.forces)
    EXPECT_NEAR(f.norm(), settings.max_normal, 0.02) << "three equal pads share the load equally";
  // Vertically each pad bears a third; horizontally the equal springs of opposed pads allow no
  // larger margin.
  EXPECT_GT(grip.margin, 0.8 * 0.6 * settings.max_normal - 0.1 * settings.acceleration);
  EXPECT_LT(grip.margin, 0.8 * 0.6 * settings.max_normal);
  EXPECT_LT(grip_forces({at(0), at(0.3), at(-0.3)}, Vector3::Zero(), 0.1, settings).margin, 0.0)
      << "all from one side";
  EXPECT_TRUE(grip_forces({at(0), at(M_PI)}, Vector3::Zero(), 0.1, settings).forces.empty())
      << "two points";
}

TEST(SharedGripForces, one_hand_without_a_known_weight_is_the_single_grip) {
  Random random(5);
  for (int trial = 0; trial < 40; ++trial) {
    const auto contacts = random_contacts(random, 3 + trial % 3);
    const GripForces alone = grip_forces(contacts, Vector3::Zero(), 0.3),
                     shared = shared_grip_forces(
                                  {contacts}, Vector3::Zero(),
                                  {Vector3::Zero(), 0.3 * GripForceSettings{}.acceleration})
                                  .front();
    EXPECT_NEAR(shared.margin, alone.margin, 1e-6) << "trial " << trial;
  }
}

TEST(SharedGripForces, each_hand_balances_itself_and_the_margin_is_that_of_the_sampled_loads) {
  Random random(7);
  const GripForceSettings settings;
  const GripLoad load{Vector3(0, 0, -5), 1.0};
  int held = 0;
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<std::vector<PointContact>> hands{random_contacts(random, 3 + trial % 2),
                                                 random_contacts(random, 4)};
    std::vector<PointContact> all;
    for (std::size_t h = 0; h < 2; ++h)
      for (PointContact& c : hands[h]) {
        c.position.x() += h == 0 ? -0.2 : 0.2;
        all.push_back(c);
      }
    const Vector3 com = 0.02 * random_unit(random);
    const std::vector<GripForces> grips = shared_grip_forces(hands, com, load, settings);
    const Eigen::MatrixXd bear =
        -grasp_matrix(all, com).completeOrthogonalDecomposition().pseudoInverse().leftCols(3);
    Eigen::Index row = 0;
    for (std::size_t h = 0; h < 2; ++h) {
      const auto m = static_cast<Eigen::Index>(hands[h].size());
      ASSERT_EQ(grips[h].forces.size(), hands[h].size());
      Eigen::VectorXd f(3 * m);
      for (Eigen::Index i = 0; i < m; ++i)
        f.segment<3>(3 * i) = grips[h].forces[static_cast<std::size_t>(i)];
      EXPECT_LT((grasp_matrix(hands[h], com) * f).norm(), 1e-6 * std::max(1.0, f.norm()))
          << "trial " << trial;
      double least = 1e9;
      for (int k = 0; k < 400; ++k) {
        const Eigen::VectorXd total =
            f + bear.middleRows(row, 3 * m) * (load.weight + load.shake * random_unit(random));
        for (Eigen::Index i = 0; i < m; ++i) {
          const PointContact& c = hands[h][static_cast<std::size_t>(i)];
          const Vector3 force = total.segment<3>(3 * i);
          const double normal = force.dot(c.inward_normal);
          least = std::min(least, settings.friction_fraction * c.friction * normal -
                                      (force - normal * c.inward_normal).norm());
        }
      }
      // The linearised cone encloses the friction cone.
      const double rough = (1 / std::cos(M_PI / settings.edges) - 1) * settings.friction_fraction *
                               0.6 * (settings.max_normal + 6) +
                           0.1;
      EXPECT_NEAR(grips[h].margin, least, rough + 0.05 * std::abs(least)) << "trial " << trial;
      held += grips[h].margin > 0;
      row += 3 * m;
    }
  }
  EXPECT_GT(held, 5);
}

TEST(SharedGripForces, two_hands_bear_what_turns_out_of_one) {
  const auto ring = [](double x) {
    std::vector<PointContact> contacts;
    for (int k = 0; k < 4; ++k) {
      const Vector3 out(std::cos(k * M_PI / 2), std::sin(k * M_PI / 2), 0);
      contacts.push_back({Vector3(x, 0, 0) + 0.03 * out, -out, 0.6});
    }
    return contacts;
  };
  const GripLoad load{Vector3(0, 0, -12), 1};
  EXPECT_LT(shared_grip_forces({ring(0.25)}, Vector3::Zero(), load).front().margin, 0)
      << "at its end alone";
  for (const GripForces& g : shared_grip_forces({ring(-0.25), ring(0.25)}, Vector3::Zero(), load))
    EXPECT_GT(g.margin, 0);
  for (const GripForces& g :
       shared_grip_forces({ring(-0.25), ring(0.25)}, Vector3::Zero(), {Vector3(0, 0, -60), 1}))
    EXPECT_LT(g.margin, 0);
}

TEST(Maximise, corners_of_small_problems) {
  Eigen::MatrixXd A(3, 2);
  A << 1, 1, 1, 0, 0, 1;
  const Eigen::Vector3d b(4, 3, 2);
  const Eigen::VectorXd x = maximise(Eigen::Vector2d(1, 2), A, b);
  EXPECT_NEAR(x[0], 2, 1e-12);
  EXPECT_NEAR(x[1], 2, 1e-12);
  A << -1, 0, 1, 1, 0, -1;
  const Eigen::VectorXd low = maximise(Eigen::Vector2d(-1, -2), A, Eigen::Vector3d(5, 1, 7));
  EXPECT_NEAR(low[0], -5, 1e-12);
  EXPECT_NEAR(low[1], -7, 1e-12);
}

}  // namespace
}  // namespace handsel::grip_force_test
