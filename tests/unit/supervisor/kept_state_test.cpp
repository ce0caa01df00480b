// SPDX-License-Identifier: Apache-2.0
// Stored state of a system: none after an orderly end, its latches after a kill.
#include "deploy/handsel/system/kept_state.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::kept_state_test {
namespace {

using supervisor::SafetyLatches;
using supervisor::StateStore;
using testing::HasSubstr;

supervisor::DurableState latched() {
  SafetyLatches latches(supervisor::fresh_state(5, 1.0));
  latches.pause();
  latches.set_override(0.1);
  Person anna;
  anna.id = "anna";
  latches.set_lost({anna}, 1);
  return latches.state();
}

class Kept : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
  const StateStore store_{folder_.path()};
};

TEST_F(Kept, says_what_stands_and_how_a_person_releases_it) {
  EXPECT_EQ(standing(supervisor::fresh_state(1, 1.0)), "");
  const std::string text = standing(latched());
  EXPECT_THAT(text, HasSubstr("paused by a person (`handsel task resume`)"));
  EXPECT_THAT(text, HasSubstr("speed override 10 % (`handsel speed 100`)"));
  EXPECT_THAT(text, HasSubstr("`handsel task clear-person anna`"));
  SafetyLatches latches(latched());
  ExecutionStatus fault;
  fault.mode = Mode::fault;
  latches.on(fault, 0);
  EXPECT_THAT(standing(latches.state()),
              HasSubstr("`handsel task acknowledge`, then `handsel task resume`"));
}

TEST_F(Kept, a_killed_system_leaves_its_latches_and_the_next_one_says_so) {
  ASSERT_EQ(store_.save(latched(), 1), "");
  testing::internal::CaptureStderr();
  std::optional<KeptState> kept(std::in_place, folder_.path());
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("did not end in order; still in force: paused by a person"));
  EXPECT_TRUE(store_.read(1, 1)->safety.paused) << "the supervisor finds them";
  kept.reset();
  EXPECT_FALSE(store_.read(1, 1).has_value()) << "that one has ended in order";
  testing::internal::CaptureStderr();
  kept.emplace(folder_.path());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Kept, a_damaged_file_is_named_at_the_start) {
  folder_.write("safety_state", "something else");
  testing::internal::CaptureStderr();
  const KeptState kept(folder_.path());
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("safety_state is damaged"));
}

TEST_F(Kept, a_part_without_a_supervisor_keeps_and_forgets_nothing) {
  ASSERT_EQ(store_.save(latched(), 1), "");
  { const KeptState kept{std::filesystem::path()}; }
  EXPECT_TRUE(store_.read(1, 1).has_value());
}

}  // namespace
}  // namespace handsel::kept_state_test
