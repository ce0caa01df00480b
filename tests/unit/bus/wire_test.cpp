// SPDX-License-Identifier: Apache-2.0
// The message validation layer: every message converted in both directions, every field damaged,
// every IDL field documented.
#include <gtest/gtest.h>

#include <cfloat>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/task.hpp"
#include "common/wire/message_type.hpp"
#include "tests/support/oracles/cdr_size.hpp"
#include "tests/support/oracles/wire_leaves.hpp"

namespace handsel::wire_test {
namespace {

class EveryMessage : public testing::TestWithParam<std::size_t> {
 protected:
  const MessageType& type = message_type(GetParam());
  std::shared_ptr<void> sample(bool full = false) const {
    auto wire = type.new_wire();
    type.fill(wire.get(), full);
    return wire;
  }
  std::vector<NamedLeaf> leaves(void* wire) const { return leaves_of(type, wire); }
  /// Accepted? The sentence of a rejection goes to `why`.
  bool accepts(void* wire, std::string& why) const {
    why.clear();
    return type.from_wire(wire, type.new_message().get(), why);
  }
  /// Within an observation only the element goes: idl/README.md.
  bool leaves_out_singly(const NamedLeaf& leaf) const {
    return std::string(type.row().type).ends_with("Observation") &&
           leaf.name.find('[') != std::string::npos;
  }
  void expect_rejected(void* wire, const NamedLeaf& leaf, const std::string& with) const {
    std::string why;
    if (leaves_out_singly(leaf)) {
      LeftOutElements left_out;
      EXPECT_TRUE(type.from_wire(wire, type.new_message().get(), why, left_out)) << why;
      EXPECT_EQ(left_out.count, 1u) << type.row().type << '.' << leaf.name << " with " << with;
      why = left_out.why;
    } else {
      EXPECT_FALSE(accepts(wire, why)) << type.row().type << '.' << leaf.name << " with " << with;
    }
    EXPECT_EQ(why.rfind(type.row().type, 0), 0u) << why;
    const std::string field = leaf.name.substr(0, leaf.name.find_first_of(".["));
    EXPECT_NE(why.find(field), std::string::npos) << why << " should name " << leaf.name;
  }
};

TEST_P(EveryMessage, goes_there_and_back_without_loss) {
  for (const bool full : {false, true}) {
    auto first = sample(full);
    auto message = type.new_message();
    std::string why;
    if (full && std::string(type.row().type) == "Costmap")
      continue;  // its three counts cannot represent full lists
    ASSERT_TRUE(type.from_wire(first.get(), message.get(), why)) << why;
    auto second = type.new_wire();
    ASSERT_TRUE(type.to_wire(message.get(), 5, second.get(), why)) << why;
    const auto a = leaves(first.get()), b = leaves(second.get());
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      const bool text = a[i].kind == WireLeaf::Kind::text;
      EXPECT_TRUE(
          text ? std::strcmp(static_cast<char*>(a[i].value), static_cast<char*>(b[i].value)) == 0
               : std::memcmp(a[i].value, b[i].value, a[i].size) == 0)
          << type.row().type << a[i].name;
    }
  }
}

TEST_P(EveryMessage, prints_as_json) {
  auto message = type.new_message();
  std::string why;
  auto wire = sample();
  ASSERT_TRUE(type.from_wire(wire.get(), message.get(), why)) << why;
  const auto json = nlohmann::json::parse(type.to_json(message.get()), nullptr, false);
  ASSERT_FALSE(json.is_discarded()) << type.to_json(message.get());
  EXPECT_EQ(json.at("stamp"), 1);
  EXPECT_FALSE(
      nlohmann::json::parse(type.to_json(type.new_message().get()), nullptr, false).is_discarded());
}

TEST_P(EveryMessage, rejects_every_number_that_is_none) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  auto wire = sample();
  for (const NamedLeaf& leaf : leaves(wire.get())) {
    if (leaf.kind != WireLeaf::Kind::number) continue;
    double& value = *static_cast<double*>(leaf.value);
    const double good = value;
    for (const double bad :
         {std::nan(""), -std::nan(""), std::numeric_limits<double>::signaling_NaN(), kInf, -kInf,
          1e308, -1e308, DBL_MAX, -DBL_MAX, 1e18, -1e18}) {
      value = bad;
      expect_rejected(wire.get(), leaf, std::to_string(bad));
    }
    // Denormals and negative zero are valid where zero is in range.
    value = 0.0;
    std::string why;
    const bool zero = accepts(wire.get(), why);
    for (const double legal : {5e-324, -0.0}) {
      value = legal;
      const bool accepted = accepts(wire.get(), why);
      if (legal == 0.0) {
        EXPECT_EQ(accepted, zero) << leaf.name;
      } else if (zero) {
        EXPECT_TRUE(accepted) << why;
      }
    }
    value = good;
  }
  std::string why;
  EXPECT_TRUE(accepts(wire.get(), why)) << why;
}

TEST_P(EveryMessage, rejects_unknown_choices_broken_texts_flags_and_stamps) {
  auto wire = sample();
  for (const NamedLeaf& leaf : leaves(wire.get())) {
    std::vector<char> good(static_cast<char*>(leaf.value),
                           static_cast<char*>(leaf.value) + leaf.size);
    if (leaf.kind == WireLeaf::Kind::choice) {
      for (const std::uint32_t bad : {100u, 0x7fffffffu, 0xffffffffu}) {
        std::memcpy(leaf.value, &bad, sizeof bad);
        expect_rejected(wire.get(), leaf, std::to_string(bad));
      }
    } else if (leaf.kind == WireLeaf::Kind::text) {
      char* text = static_cast<char*>(leaf.value);
      std::memset(text, 'x', leaf.size);
      expect_rejected(wire.get(), leaf, "no terminator");
      std::memcpy(text, "\xc3(", 3);
      expect_rejected(wire.get(), leaf, "broken UTF-8");
      std::memcpy(text, "a\x01", 3);
      expect_rejected(wire.get(), leaf, "a control character");
    } else if (leaf.kind == WireLeaf::Kind::flag) {
      *static_cast<unsigned char*>(leaf.value) = 2;
      expect_rejected(wire.get(), leaf, "2");
    } else if (leaf.name == "stamp") {
      *static_cast<std::int64_t*>(leaf.value) = -1;
      expect_rejected(wire.get(), leaf, "-1");
    }
    std::memcpy(leaf.value, good.data(), good.size());
  }
}

TEST_P(EveryMessage, fullest_sample_fits_its_row_of_the_table) {
  const std::size_t size = test::cdr_size(type, sample(true).get());
  EXPECT_LE(size, type.row().largest) << type.row().type;
  EXPECT_GE(size * 2, type.row().largest) << type.row().type << " is far below its row: " << size;
  EXPECT_LT(size, 8u << 20);
}

INSTANTIATE_TEST_SUITE_P(Table, EveryMessage, testing::Range<std::size_t>(0, std::size(kTopics)),
                         [](const auto& instance) {
                           return std::string(kTopics[instance.param].type);
                         });

std::string refusal_of(const auto& message) {
  using M = std::remove_cvref_t<decltype(message)>;
  std::string why;
  auto wire = message_type<M>().new_wire();
  EXPECT_FALSE(message_type<M>().to_wire(&message, 1, wire.get(), why));
  return why;
}

RobotState good_state() {
  RobotState state;
  state.robot = "jido";
  state.position = state.velocity = Vector::Zero(22);
  return state;
}

TEST(Wire, says_what_is_wrong_in_one_sentence) {
  RobotState state = good_state();
  state.velocity = Vector::Zero(21);
  EXPECT_EQ(refusal_of(state), "RobotState.velocity has not as many values as position");
  state = good_state();
  state.position = state.velocity = Vector::Zero(65);
  EXPECT_EQ(refusal_of(state), "RobotState.position has 65 elements, at most 64 are allowed");
  state = good_state();
  state.T_world_base.linear() *= 2;
  EXPECT_EQ(refusal_of(state), "RobotState.T_world_base.orientation is not a rotation");
  state = good_state();
  state.robot.clear();
  EXPECT_EQ(refusal_of(state), "RobotState.robot is empty, a name is needed");
  state.robot = std::string(65, 'j');
  EXPECT_EQ(refusal_of(state), "RobotState.robot is longer than 64 bytes");
  TrajectoryCommand command;
  command.robot = "jido";
  command.axes = {0, 1};
  command.trajectory.axes.resize(2);
  command.trajectory.axes[1].segments.push_back({0.5, 1.0});
  EXPECT_EQ(refusal_of(command), "TrajectoryCommand.trajectory.axes do not last equally long");
  command.trajectory.axes[0].segments.push_back({0.5, std::nan("")});
  EXPECT_EQ(refusal_of(command),
            "TrajectoryCommand.trajectory.axes[0].segments[0].jerk is nan, must be a number from "
            "-1e+09 to 1e+09");
  TaskGoal goal;
  goal.kind = static_cast<TaskKind>(99);
  EXPECT_EQ(refusal_of(goal),
            "TaskGoal.kind is the unknown choice 99, the last known one is 15 (drive)");
}

TEST(Wire, normalises_nearly_unit_quaternions_and_rejects_zero_ones) {
  const MessageType& type = message_type<RobotState>();
  auto wire = type.new_wire();
  type.fill(wire.get(), false);
  RobotState out;
  std::string why;
  const auto set_w = [&](double w) {
    type.leaves(wire.get(), [&](const WireLeaf& leaf) {
      if (leaf.path() == "T_world_base.orientation.w") *static_cast<double*>(leaf.value) = w;
    });
  };
  set_w(1.0005);
  ASSERT_TRUE(type.from_wire(wire.get(), &out, why)) << why;
  EXPECT_NEAR(out.T_world_base.linear().determinant(), 1.0, 1e-12);
  set_w(0.0);
  EXPECT_FALSE(type.from_wire(wire.get(), &out, why));
  EXPECT_EQ(why, "RobotState.T_world_base.orientation has norm 0, must be a unit quaternion");
}

TEST(Wire, cuts_long_sentences_and_long_lists_of_refusals_instead_of_losing_the_message) {
  TaskStatus status;
  status.reason = std::string(255, 'a') + "\xc3\xa9";  // the bound falls into the last character
  status.refusals.assign(300, Refusal{"grasp", "no"});
  const MessageType& type = message_type<TaskStatus>();
  auto wire = type.new_wire();
  std::string why;
  ASSERT_TRUE(type.to_wire(&status, 1, wire.get(), why)) << why;
  TaskStatus out;
  ASSERT_TRUE(type.from_wire(wire.get(), &out, why)) << why;
  EXPECT_EQ(out.reason, std::string(255, 'a'));
  EXPECT_EQ(out.refusals.size(), 256u);
}

TEST(Wire, infinity_travels_as_the_horizon) {
  TrajectoryForecast forecast;
  forecast.time_to_collision = forecast.clearance = std::numeric_limits<double>::infinity();
  const MessageType& type = message_type<TrajectoryForecast>();
  auto wire = type.new_wire();
  std::string why;
  ASSERT_TRUE(type.to_wire(&forecast, 1, wire.get(), why)) << why;
  TrajectoryForecast out;
  ASSERT_TRUE(type.from_wire(wire.get(), &out, why)) << why;
  EXPECT_EQ(out.time_to_collision, std::numeric_limits<double>::infinity());
  EXPECT_EQ(out.clearance, std::numeric_limits<double>::infinity());
}

TEST(Topics, table_names_what_exists_once) {
  const std::set<std::string> components{"supervisor",
                                         "spark",
                                         "costmap",
                                         "collision_checker",
                                         "path_planner",
                                         "grasp_planner",
                                         "trajectory_planner",
                                         "manipulation_planner",
                                         "attention",
                                         "trajectory_controller",
                                         "bridge",
                                         "sim",
                                         "driver",
                                         "ros2_lane",
                                         "handsel"};
  std::set<std::string> seen;
  for (const TopicRow& row : topics()) {
    EXPECT_TRUE(seen.insert(row.topic).second) << row.topic;
    EXPECT_EQ(std::string(row.topic).rfind("handsel/", 0), 0u);
    for (const char* list : {row.writers, row.readers}) {
      std::istringstream words(list);
      std::string word;
      int count = 0;
      while (words >> word) {
        ++count;
        EXPECT_TRUE(components.contains(word)) << row.topic << ": " << word;
      }
      EXPECT_GT(count, 0) << row.topic;
    }
    if (row.deadline > 0) {
      EXPECT_GE(row.deadline * row.rate, 2.0)
          << row.topic << ": a deadline is at least two periods";
    }
    EXPECT_EQ(find_topic(row.type), &row);
    EXPECT_EQ(find_topic(row.topic), &row);
  }
}

TEST(Idl, every_field_and_enumerator_is_documented) {
  int fields = 0;
  for (const auto& entry : std::filesystem::directory_iterator(HANDSEL_SOURCE_DIR "/idl")) {
    if (entry.path().extension() != ".idl") continue;
    std::ifstream file(entry.path());
    std::string line;
    bool inside = false;
    for (int number = 1; std::getline(file, line); ++number) {
      const std::string where =
          entry.path().filename().string() + ':' + std::to_string(number) + ": " + line;
      const std::size_t comment = line.find("//");
      const std::string code = line.substr(0, comment),
                        text = comment == std::string::npos ? "" : line.substr(comment + 2);
      if (code.find("struct ") != std::string::npos || code.rfind("enum ", 0) == 0) inside = true;
      if (code.rfind("};", 0) == 0) inside = false;
      EXPECT_EQ(code.find("@optional"), std::string::npos) << where;
      EXPECT_EQ(code.find("union"), std::string::npos) << where;
      EXPECT_EQ(code.find("wchar"), std::string::npos) << where;
      EXPECT_TRUE(code.find("struct ") == std::string::npos ||
                  code.find("@final") != std::string::npos)
          << where;
      const bool member = inside && code.rfind("  ", 0) == 0;
      if (!member) continue;
      ++fields;
      EXPECT_GT(text.size(), 3u) << where;
      const bool numeric =
          code.find("double") != std::string::npos || code.find(" long ") != std::string::npos ||
          code.find("octet") != std::string::npos || code.find("Vector3 ") != std::string::npos;
      if (numeric) {
        EXPECT_NE(text.find('['), std::string::npos) << where << " has no unit";
      }
      if (code.find("double") != std::string::npos) {
        EXPECT_NE(text.find(" .. "), std::string::npos) << where << " has no range";
      }
      if (code.find("sequence<") != std::string::npos) {
        EXPECT_NE(code.find(", "), std::string::npos) << where << " has no bound";
      }
      if (code.find("string") != std::string::npos) {
        EXPECT_NE(code.find("string<"), std::string::npos) << where << " has no bound";
      }
    }
  }
  EXPECT_GT(fields, 250);
}

}  // namespace
}  // namespace handsel::wire_test
