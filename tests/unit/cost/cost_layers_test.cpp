// SPDX-License-Identifier: Apache-2.0
#include "common/cost/cost_layers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace handsel::cost_layers_test {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

constexpr TimePoint kStart{std::chrono::seconds(100)};

Costmap layer(const std::string& name, std::uint8_t value = 100) {
  Costmap map;
  map.layer = name;
  map.resolution = 1;
  map.nx = map.ny = map.nz = 2;
  map.values.assign(8, value);
  map.weight = 2;
  return map;
}

TEST(CostLayers, keeps_arm_comfort_and_what_others_add) {
  CostLayers layers;
  for (const char* name : {"total", "safety", "visibility", "noise", "crowd"})
    layers.put(layer(name), kStart, kStart);
  Costmap comfort = layer("arm_comfort");
  comfort.person = "anna";
  layers.put(comfort, kStart, kStart);
  const LayersNow now = layers.at(kStart);
  ASSERT_EQ(now.outside.size(), 2u);
  EXPECT_EQ(now.outside[0]->layer(), "crowd");
  EXPECT_EQ(now.outside[1]->layer(), "noise");
  EXPECT_NE(now.comfort_of("anna"), nullptr);
  EXPECT_EQ(now.comfort_of("ben"), nullptr);
  EXPECT_EQ(layers.left_out(), 0u);
  EXPECT_EQ(layers.complaint(kStart), "");
}

TEST(CostLayers, a_place_costs_the_weighted_sum_and_says_who_forbids_it) {
  CostLayers layers;
  layers.put(layer("crowd", 127), kStart, kStart);
  layers.put(layer("noise", 255), kStart, kStart);
  const LayersNow now = layers.at(kStart);
  const OutsideCost cost = now.outside_cost({0.5, 0.5, 0.5});
  EXPECT_NEAR(cost.cost, 2 * 0.5 + 2 * 1, 1e-12);
  ASSERT_NE(cost.forbidden_by, nullptr);
  EXPECT_EQ(cost.forbidden_by->layer(), "noise");
  EXPECT_EQ(now.outside_cost({3, 0, 0}).cost, 0);
}

TEST(CostLayers, what_has_a_fault_is_left_out_counted_and_named) {
  CostLayers layers;
  Costmap short_one = layer("short"), flat = layer("flat"), fine = layer("fine"),
          endless = layer("endless");
  short_one.values.pop_back();
  flat.nz = 1;
  flat.values.resize(4);
  fine.resolution = 0;
  endless.origin.x() = std::numeric_limits<double>::infinity();
  std::uint64_t count = 0;
  for (const auto& [bad, why] : {std::pair{short_one, "7 values for 8 points"},
                                 {flat, "at least two points"},
                                 {fine, "resolution"},
                                 {endless, "origin"}}) {
    layers.put(bad, kStart, kStart);
    EXPECT_EQ(layers.left_out(), ++count);
    EXPECT_THAT(layers.complaint(kStart), HasSubstr("\"" + bad.layer + "\""));
    EXPECT_THAT(layers.complaint(kStart), HasSubstr(why));
  }
  EXPECT_TRUE(layers.at(kStart).outside.empty());
}

TEST(CostLayers, one_older_than_a_second_counts_no_more_until_it_comes_again) {
  CostLayers layers;
  layers.put(layer("crowd"), kStart, kStart);
  EXPECT_EQ(layers.at(kStart + milliseconds(999)).outside.size(), 1u);
  EXPECT_TRUE(layers.at(kStart + milliseconds(1001)).outside.empty());
  EXPECT_EQ(layers.left_out(), 1u);
  EXPECT_THAT(layers.complaint(kStart + milliseconds(1001)), HasSubstr("crowd"));
  layers.put(layer("crowd"), kStart, kStart + milliseconds(1500));
  EXPECT_TRUE(layers.at(kStart + milliseconds(1500)).outside.empty())
      << "sent too long ago when it came";
  EXPECT_EQ(layers.left_out(), 2u);
  layers.put(layer("crowd"), kStart + milliseconds(1600), kStart + milliseconds(1600));
  EXPECT_EQ(layers.at(kStart + milliseconds(1600)).outside.size(), 1u);
  EXPECT_EQ(layers.complaint(kStart + milliseconds(1600)), "");
}

TEST(CostLayers, a_silent_layer_is_named_for_ten_seconds_and_our_own_is_not) {
  CostLayers layers;
  layers.put(layer("arm_comfort"), kStart, kStart);
  EXPECT_EQ(layers.at(kStart + milliseconds(1500)).comfort, nullptr);
  EXPECT_EQ(layers.complaint(kStart + milliseconds(1500)), "") << "nobody is there any more";
  layers.put(layer("crowd"), kStart, kStart);
  EXPECT_NE(layers.complaint(kStart + milliseconds(9000)), "");
  EXPECT_EQ(layers.complaint(kStart + milliseconds(19500)), "");
}

TEST(CostLayers, there_is_an_end_to_what_it_keeps) {
  CostLayers layers;
  for (int i = 0; i < 40; ++i) layers.put(layer("layer" + std::to_string(i)), kStart, kStart);
  EXPECT_EQ(layers.at(kStart).outside.size(), 16u);
  EXPECT_EQ(layers.left_out(), 24u);
}

}  // namespace
}  // namespace handsel::cost_layers_test
