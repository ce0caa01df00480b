// SPDX-License-Identifier: Apache-2.0
// Variants of a scenario are drawn by the seed, equally in every process; an error in any variant
// is refused with its line.
#include "common/config/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "common/base/errors.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::scenario_test {
namespace {

using test::message_of;
using test::TemporaryFolder;
using testing::HasSubstr;

const std::string kPlace =
    "name: \"s\"\n"
    "robot: \"jido\"\n"
    "start { key: \"arm_a1\" value: 0.5 }\n"
    "boxes { id: \"table\" pose { xyz { x: 0.8 z: 0.36 } } size { x: 1 y: 1 z: 0.72 } }\n"
    "objects { id: \"thing\" model: \"mug\" on: \"table\" pose { xyz { x: 0.7 } } jitter: 0.05 }\n";

config::Scenario one_variant(const std::string& with) {
  const TemporaryFolder folder;
  return read_scenario(
      folder.write("s.txtpb", kPlace + "draws { name: \"d\" variants { name: \"v\" with { " + with +
                                  " } } }\n"),
      1);
}

std::string refusal(const std::string& more) {
  const TemporaryFolder folder;
  const auto file = folder.write("s.txtpb", kPlace + more);
  const std::string said = message_of<ConfigError>([&] { draw_scenario(file, 1); });
  const std::size_t at = said.find("s.txtpb");
  return at == std::string::npos ? said : said.substr(at);
}

TEST(Draws, a_variant_goes_over_the_entry_of_the_same_id_and_adds_the_others) {
  const config::Scenario drawn = one_variant(
      "robot: \"panda\" base { xyz { z: 0.7 } } start { key: \"panda_joint1\" value: 0.1 } "
      "objects { id: \"thing\" model: \"can\" jitter: 0 } boxes { id: \"stand\" } "
      "human_sensors { source: \"k\" rate: 30 }");
  EXPECT_EQ(drawn.robot(), "panda");
  EXPECT_EQ(drawn.base().xyz().z(), 0.7);
  EXPECT_EQ(drawn.start().size(), 2u);
  ASSERT_EQ(drawn.objects_size(), 1);
  EXPECT_EQ(drawn.objects(0).model(), "can");
  EXPECT_EQ(drawn.objects(0).on(), "table") << "what the variant does not write stays";
  EXPECT_EQ(drawn.objects(0).jitter(), 0) << "a 0 that is written replaces";
  ASSERT_EQ(drawn.boxes_size(), 2);
  EXPECT_EQ(drawn.boxes(1).id(), "stand");
  EXPECT_EQ(drawn.human_sensors_size(), 1);
  EXPECT_EQ(drawn.draws_size(), 0);
}

TEST(Draws, a_seed_always_draws_the_same_and_weights_are_kept_over_many_seeds) {
  const TemporaryFolder folder;
  const std::string objects =
      "draws { name: \"object\"\n variants { name: \"can\" weight: 3 with { objects { id: "
      "\"thing\" model: \"can\" } } }\n"
      " variants { name: \"box\" with { objects { id: \"thing\" model: \"box\" } } }\n"
      " variants { name: \"never\" weight: 0 } }\n";
  const auto file = folder.write("s.txtpb", kPlace + objects);
  const auto other =
      folder.write("o.txtpb", kPlace +
                                  "draws { name: \"robot\" variants { name: \"jido\" } "
                                  "variants { name: \"duo\" with { robot: \"duo\" } } }\n" +
                                  objects);
  std::map<std::string, int> count;
  std::set<std::string> pairs;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    const DrawnScenario drawn = draw_scenario(file, seed);
    const std::string object = drawn.variants.at("object");
    ASSERT_EQ(drawn.scenario.objects(0).model(), object);
    ++count[object];
    if (seed > 100) continue;
    ASSERT_EQ(draw_scenario(file, seed).scenario.SerializeAsString(),
              drawn.scenario.SerializeAsString());
    const DrawnScenario more = draw_scenario(other, seed);
    ASSERT_EQ(more.variants.at("object"), object) << "a draw more changed another draw";
    pairs.insert(object + more.variants.at("robot"));
    EXPECT_EQ(scenario_robot(other, seed), more.variants.at("robot"));
  }
  EXPECT_EQ(count.size(), 2u) << "a weight of 0 is never drawn";
  EXPECT_NEAR(count["can"], 1500, 4 * std::sqrt(2000 * 0.75 * 0.25));
  EXPECT_EQ(pairs.size(), 4u) << "draws are independent of each other";
}

TEST(Draws, the_top_of_a_box_moves_and_its_bottom_stays) {
  const TemporaryFolder folder;
  const auto file = folder.write("s.txtpb", kPlace +
                                                "boxes { id: \"low\" pose { xyz { z: 0.3 } } "
                                                "size { x: 1 y: 1 z: 0.6 } top_jitter: 0.1 }");
  double lowest = 1, highest = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const DrawnScenario drawn = draw_scenario(file, seed);
    const config::BoxDescription& box = drawn.scenario.boxes(1);
    ASSERT_NEAR(box.pose().xyz().z() - box.size().z() / 2, 0, 1e-12);
    const double top = box.pose().xyz().z() + box.size().z() / 2;
    ASSERT_NEAR(drawn.tops.at("low"), top, 1e-12);
    lowest = std::min(lowest, top), highest = std::max(highest, top);
    ASSERT_EQ(drawn.scenario.boxes(0).size().z(), 0.72);
  }
  EXPECT_GE(lowest, 0.5);
  EXPECT_LE(highest, 0.7);
  EXPECT_LT(lowest, 0.505);
  EXPECT_GT(highest, 0.695);
}

TEST(Draws, clutter_has_a_drawn_number_of_objects_of_drawn_models) {
  const TemporaryFolder folder;
  const auto file = folder.write("s.txtpb", kPlace +
                                                "clutter { on: \"table\" models: \"can\" "
                                                "models: \"box\" min_count: 1 max_count: 3 }");
  std::set<std::string> numbers, models;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const DrawnScenario drawn = draw_scenario(file, seed);
    const int count = drawn.scenario.objects_size() - 1;
    ASSERT_EQ(drawn.variants.at("clutter"), std::to_string(count));
    numbers.insert(drawn.variants.at("clutter"));
    for (int i = 1; i <= count; ++i) {
      EXPECT_TRUE(drawn.scenario.objects(i).free_place());
      EXPECT_EQ(drawn.scenario.objects(i).id(), "table_" + std::to_string(i));
      models.insert(drawn.scenario.objects(i).model());
    }
  }
  EXPECT_EQ(numbers, (std::set<std::string>{"1", "2", "3"}));
  EXPECT_EQ(models, (std::set<std::string>{"can", "box"}));
}

TEST(Draws, what_is_wrong_is_refused_with_line_and_key_whatever_the_seed_draws) {
  const std::string good = "draws { name: \"a\" variants { name: \"v\" } }\n";
  EXPECT_THAT(refusal("draws { variants { name: \"v\" } }\n"), HasSubstr("s.txtpb:6:draws: "));
  EXPECT_THAT(refusal(good + good), HasSubstr("s.txtpb:7:name: \"a\" is there twice"));
  EXPECT_THAT(refusal("draws {\n  name: \"a\"\n}\n"), HasSubstr("s.txtpb:7:name: "));
  EXPECT_THAT(refusal("draws { name: \"clutter\" variants { name: \"v\" } }"),
              HasSubstr("s.txtpb:6:name: is \"clutter\""));
  EXPECT_THAT(refusal("draws { name: \"a\"\n variants { weight: 1 }\n}\n"),
              HasSubstr("s.txtpb:7:variants: a variant needs a name"));
  EXPECT_THAT(refusal("draws { name: \"a\" variants { name: \"v\" }\n variants { name: \"v\" } }"),
              HasSubstr("s.txtpb:7:name: \"v\" is there twice"));
  EXPECT_THAT(refusal("draws { name: \"a\" variants { name: \"v\" weight: 0 } }"),
              HasSubstr("the weights of the variants are all 0"));
  EXPECT_THAT(refusal("draws { name: \"a\" variants { name: \"v\"\n weight: -1 } }"),
              HasSubstr("s.txtpb:7:weight: is -1"));
  EXPECT_THAT(refusal("draws { name: \"a\" variants { name: \"v\" with {\n draws { } } } }"),
              HasSubstr("s.txtpb:7:draws: a variant cannot hold draws"));
  EXPECT_THAT(refusal("draws { name: \"a\" variants { name: \"v\" with {\n boxes { } } } }"),
              HasSubstr("s.txtpb:7:boxes: an entry has no id"));
  EXPECT_THAT(refusal("draws { name: \"a\" variants { name: \"v\" }\n variants { name: \"w\" "
                      "weight: 0 with {\n objects { id: \"thing\"\n jitter: 9 } } } }"),
              HasSubstr("s.txtpb:9:jitter: is 9"));
  EXPECT_THAT(refusal("clutter { on: \"table\" models: \"can\" min_count: 3\n max_count: 2 }"),
              HasSubstr("s.txtpb:7:max_count: is 2, must be at least min_count, 3"));
  EXPECT_THAT(refusal("clutter { models: \"can\" max_count: 2 }"),
              HasSubstr("s.txtpb:6:clutter: "));
  EXPECT_THAT(refusal("clutter { on: \"table\" max_count: 2 }"),
              HasSubstr("s.txtpb:6:on: the clutter has no models"));
}

TEST(Draws, a_robot_or_object_that_is_not_there_is_missing_also_where_another_is_drawn) {
  const TemporaryFolder folder;
  const auto said = [&](const std::string& with) {
    const auto file = folder.write(
        "s.txtpb", kPlace +
                       "draws { name: \"a\" variants { name: \"v\" }\n variants { name: "
                       "\"w\" weight: 0 with {\n " +
                       with + " } } }");
    return message_of<MissingError>([&] { draw_scenario(file, 1); });
  };
  EXPECT_THAT(said("robot: \"r2d2\""), HasSubstr("s.txtpb:8:robot: no robot \"r2d2\""));
  EXPECT_THAT(said("objects { id: \"thing\" model: \"anvil\" }"),
              HasSubstr("s.txtpb:8:model: no object \"anvil\""));
  EXPECT_THAT(said("clutter { on: \"table\" models: \"anvil\" max_count: 1 }"),
              HasSubstr("s.txtpb:8:models: no object \"anvil\""));
}

}  // namespace
}  // namespace handsel::scenario_test
