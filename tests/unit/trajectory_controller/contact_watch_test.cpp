// SPDX-License-Identifier: Apache-2.0
// Detection of contact, and that a steady push remains a contact.
#include "components/trajectory_controller/input/contact_watch.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace handsel::trajectory_controller::contact_watch_test {
namespace {

constexpr double kPeriod = 0.002;  // control period [s]

struct Watched {
  ContactSettings settings;
  ContactWatch watch{settings, {0, 1}};
  bool resting{}, in_handover{};
  double time{};

  Contact feel(double torque) {
    time += kPeriod;
    Eigen::VectorXd torques(2);
    torques << 0.0, torque;
    return watch.update(torques, kPeriod, resting, in_handover);
  }
  Contact feel_for(double seconds, double torque) {
    Contact last{};
    for (const double end = time + seconds; time < end;) last = feel(torque);
    return last;
  }
};

TEST(ContactWatch, a_steady_push_stays_a_contact_until_it_ends) {
  Watched w;
  w.feel_for(1.0, 3.0);
  EXPECT_EQ(w.feel_for(0.05, 35.0), Contact::contact);
  EXPECT_EQ(w.feel_for(1.1, 35.0), Contact::clamped);
  EXPECT_EQ(w.feel_for(120.0, 35.0), Contact::clamped);
  w.watch.reset();  // the held object has changed
  EXPECT_EQ(w.feel_for(1.0, 35.0), Contact::clamped);
  EXPECT_EQ(w.feel_for(0.01, 3.0), Contact::none);
  EXPECT_EQ(w.feel_for(0.05, 35.0), Contact::contact) << "and is one again";
}

TEST(ContactWatch, a_push_that_grows_slowly_is_found_at_a_bounded_torque) {
  for (const double rate : {0.1, 1.0, 5.0, 20.0}) {  // [Nm/s]
    Watched w;
    double torque = 0.0;
    w.feel_for(1.0, 0.0);
    while (w.feel(torque) == Contact::none) {
      torque += rate * kPeriod;
      ASSERT_LT(torque, w.settings.max_usual + w.settings.torque + 1.0)
          << "growing by " << rate << " Nm/s";
    }
  }
}

TEST(ContactWatch, errors_of_the_model_that_come_and_go_are_no_contact) {
  Watched w;
  double torque = 0.0;
  for (int k = 0; k < 60; ++k) {
    const double to = k % 2 == 0 ? 12.0 : -12.0;
    for (const double step = (to - torque) / 1500; std::abs(to - torque) > 1e-9; torque += step)
      ASSERT_EQ(w.feel(torque), Contact::none) << "after " << w.time << " s";
  }
}

TEST(ContactWatch, an_exchange_has_a_budget_of_its_own) {
  Watched w;
  w.in_handover = true;
  w.feel_for(1.0, 0.0);
  EXPECT_EQ(w.feel_for(2.0, 40.0), Contact::none) << "a pull that is wanted";
  EXPECT_EQ(w.feel_for(0.05, 60.0), Contact::contact);
  EXPECT_EQ(w.feel_for(2.0, 60.0), Contact::clamped);
}

TEST(ContactWatch, a_load_put_on_the_resting_arm_no_longer_moves_it_and_does_not_hide_a_contact) {
  Watched w;
  w.resting = true;
  w.feel_for(1.0, 0.0);
  w.feel_for(1.0, 20.0);
  EXPECT_NEAR(w.watch.push(1), 20.0, 1e-9);
  EXPECT_EQ(w.feel_for(3.0, 20.0), Contact::none);
  EXPECT_EQ(w.watch.push(1), 0.0);
  EXPECT_EQ(w.feel_for(0.05, 26.0), Contact::contact);
}

TEST(ContactWatch, what_presses_already_at_the_start_is_found) {
  Watched w;
  EXPECT_EQ(w.feel_for(0.05, 45.0), Contact::contact);
}

}  // namespace
}  // namespace handsel::trajectory_controller::contact_watch_test
