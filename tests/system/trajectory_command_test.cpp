// SPDX-License-Identifier: Apache-2.0
// `handsel trajectory solve | smooth | sample` from the user's side: real process, exit codes,
// exact sentences.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/support/processes/shell.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::test::trajectory_command_test {
namespace {

using nlohmann::json;

const std::string kHandsel = HANDSEL_COMMAND;

struct Answers {
  int exit_code{};
  std::vector<json> lines;
  std::string err;
};

Answers ask(const std::string& arguments, const std::string& input) {
  const Outcome outcome =
      shell("printf '%s' '" + input + "' | " + kHandsel + " trajectory " + arguments);
  Answers out{outcome.exit_code, {}, outcome.err};
  std::istringstream lines(outcome.out);
  for (std::string line; std::getline(lines, line);)
    out.lines.push_back(json::parse(line, nullptr, false));
  return out;
}

/// Two axes at rest, one of them with something else in it.
std::string problem(const std::string& replaced = "", const std::string& by = "") {
  json line = json::parse(
      R"({"p0":[0,0],"v0":[0,0],"a0":[0,0],"pf":[1,2],"vf":[0,0],"af":[0,0],"vmax":[1,1],)"
      R"("amax":[1,1],"jmax":[1,1]})");
  std::string text = line.dump();
  if (replaced.empty()) return text;
  const std::string now = "\"" + replaced + "\":" + line[replaced].dump();
  return text.replace(text.find(now), now.size(), "\"" + replaced + "\":" + by);
}

void expect_refusal(const std::string& command, const std::string& line,
                    const std::string& sentence) {
  SCOPED_TRACE(line);
  const Answers a = ask(command, line);
  EXPECT_EQ(a.exit_code, 2);
  ASSERT_EQ(a.lines.size(), 1u);
  EXPECT_EQ(a.lines[0], (json{{"line", 1}, {"error", sentence}}));
  EXPECT_EQ(a.err, "");
}

TEST(TrajectoryCommand, solves_and_samples_what_it_solved) {
  const Answers solved = ask("solve", problem());
  EXPECT_EQ(solved.exit_code, 0);
  ASSERT_EQ(solved.lines.size(), 1u);
  const json& s = solved.lines[0];
  // V = A = J = 1: 4 s of jerk phases, 2 m need d1 = 2 m.
  EXPECT_NEAR(s.at("min_durations")[1].get<double>(), 4, 1e-12);
  EXPECT_NEAR(s.at("duration").get<double>(), 4, 1e-12);
  EXPECT_NEAR(s.at("min_durations")[0].get<double>(), 4 * std::cbrt(0.5), 1e-12);
  ASSERT_EQ(s.at("axes").size(), 2u);
  const Answers sampled = ask("sample --period 0.5", s.dump());
  EXPECT_EQ(sampled.exit_code, 0);
  const json& t = sampled.lines.at(0);
  ASSERT_EQ(t.at("t").size(), 9u);
  EXPECT_NEAR(t.at("p")[8][1].get<double>(), 2, 1e-12);
  EXPECT_NEAR(t.at("p")[4][1].get<double>(), 1, 1e-12);
  EXPECT_NEAR(t.at("v")[4][1].get<double>(), 1, 1e-12);
}

TEST(TrajectoryCommand, each_axis_for_itself_and_imposed_durations) {
  const std::string open = problem().substr(0, problem().size() - 1);
  const Answers none = ask("solve", open + R"(,"sync":"none"})");
  EXPECT_EQ(none.exit_code, 0);
  // The first axis arrives before the second and waits.
  const json& segments = none.lines.at(0).at("axes")[0].at("segments");
  EXPECT_EQ(segments.back()[1], 0);
  EXPECT_NEAR(segments.back()[0].get<double>(), 4 - 4 * std::cbrt(0.5), 1e-12);
  const Answers imposed = ask("solve", open + R"(,"impose":true,"duration":6})");
  EXPECT_EQ(imposed.exit_code, 0);
  EXPECT_NEAR(imposed.lines.at(0).at("duration").get<double>(), 6, 1e-12);
  EXPECT_EQ(imposed.lines[0].at("excess"), 0);
  expect_refusal("solve", open + R"(,"impose":true,"duration":3.5})",
                 "axis 1: needs 4.000000 s, imposed are 3.500000 s");
  expect_refusal("solve", open + R"(,"impose":true,"duration":-1})",
                 "the imposed duration must be finite and not negative");
  expect_refusal("solve", open + R"(,"impose":true})", "the field \"duration\" is missing");
  expect_refusal("solve", open + R"(,"sync":"late"})", "\"sync\" must be \"time\" or \"none\"");
}

TEST(TrajectoryCommand, every_fault_has_its_sentence) {
  expect_refusal("solve", problem("p0", "[0,NaN]"), "this is not JSON");
  expect_refusal("solve", problem("p0", "[0,Infinity]"), "this is not JSON");
  expect_refusal("solve", problem("p0", "[0,null]"), "\"p0\" must be a finite number");
  expect_refusal("solve", problem("a0", "[0,1e999]"), "this is not JSON");
  expect_refusal(
      "solve", problem("v0", "[0]"),
      "the start state has 2 positions, 1 velocities and 2 accelerations, wanted 2 of each");
  expect_refusal(
      "solve", problem("pf", "[1,2,3]"),
      "the end state has 3 positions, 2 velocities and 2 accelerations, wanted 2 of each");
  expect_refusal("solve", problem("vmax", "[1]"), "limits do not have 2 axes");
  expect_refusal("solve", problem("vmax", "[1,0]"), "axis 1: a limit is not positive");
  expect_refusal("solve", problem("jmax", "[-1,1]"), "axis 0: a limit is not positive");
  expect_refusal("solve", problem("vf", "[0,3]"),
                 "axis 1: the end state cannot be reached inside the limits");
  expect_refusal("solve", "{", "this is not JSON");
  expect_refusal("solve", "[]", "expected an object with the field \"p0\"");
  const std::string smooth = R"("vmax":[1,1],"amax":[1,1],"jmax":[1,1])";
  expect_refusal("smooth", "{\"nodes\":[]," + smooth + "}", "there are no nodes");
  expect_refusal("smooth", "{\"nodes\":[[0,0],[1]]," + smooth + "}", "node 1 has 1 axes, node 0 2");
  expect_refusal("smooth", "{\"nodes\":[[0,0],[1,1]],\"tau\":-1," + smooth + "}",
                 "tau must be a number that is not negative");
  expect_refusal("smooth", R"({"nodes":[[0,0],[1,1]],"vmax":[1,1],"amax":[1,0],"jmax":[1,1]})",
                 "axis 1: limits must be positive and finite");
  expect_refusal("sample",
                 R"({"axes":[{"p0":0,"v0":0,"a0":0,"segments":[[1,1]]},{"p0":0,"v0":0,"a0":0,)"
                 R"("segments":[]}]})",
                 "the axes do not last equally long");
  expect_refusal("sample", R"({"axes":[{"p0":0,"v0":0,"a0":0,"segments":[[-1,1]]}]})",
                 "a segment must be [duration, jerk], the duration not negative");
}

TEST(TrajectoryCommand, starts_beyond_the_limits_come_back_inside) {
  const Answers a = ask("solve", problem("v0", "[1.5,0]"));
  EXPECT_EQ(a.exit_code, 0);
  const Answers samples = ask("sample --period 0.01", a.lines.at(0).dump());
  double last = 1.5;
  bool inside = false;
  for (const json& v : samples.lines.at(0).at("v")) {
    const double speed = std::abs(v[0].get<double>());
    inside = inside || speed <= 1;
    EXPECT_LE(speed, inside ? 1 + 1e-9 : last + 1e-12);
    last = speed;
  }
  EXPECT_TRUE(inside);
}

TEST(TrajectoryCommand, smooths_a_node_and_says_how) {
  const std::string line =
      R"({"nodes":[[0,0],[0.5,0],[0.8,0.4]],"vmax":[0.1,0.1],"amax":[0.3,0.3],"jmax":[0.9,0.9])";
  const Answers soft = ask("smooth", line + "}"), stop = ask("smooth", line + ",\"tau\":0}");
  EXPECT_EQ(soft.exit_code, 0);
  ASSERT_EQ(soft.lines.at(0).at("corners").size(), 1u);
  const json& corner = soft.lines[0]["corners"][0];
  EXPECT_EQ(corner.at("node"), 1);
  EXPECT_NE(corner.at("method"), "stop");
  EXPECT_NEAR(soft.lines[0].at("duration").get<double>() + corner.at("saved_s").get<double>(),
              soft.lines[0].at("duration_ptp").get<double>(), 1e-9);
  EXPECT_EQ(stop.lines.at(0).at("corners")[0].at("method"), "stop");
  EXPECT_EQ(stop.lines[0].at("corners")[0].at("reason"), "tau leaves no room");
}

TEST(TrajectoryCommand, a_bad_line_does_not_stop_the_others) {
  const Answers a =
      ask("solve", problem() + "\n" + problem("vmax", "[0,1]") + "\n\n" + problem() + "\n");
  EXPECT_EQ(a.exit_code, 2);
  ASSERT_EQ(a.lines.size(), 3u);
  EXPECT_EQ(a.lines[1], (json{{"line", 2}, {"error", "axis 0: a limit is not positive"}}));
  EXPECT_EQ(a.lines[2], a.lines[0]);
}

TEST(TrajectoryCommand, bad_usage_is_one_sentence) {
  const auto refused = [](const std::string& arguments, const std::string& says) {
    const Outcome outcome = shell(kHandsel + " " + arguments + " < /dev/null");
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  };
  refused("trajectory solve", "nothing came on standard input");
  refused("trajectory fly", "there is no command \"fly\" here");
  refused("trajectory sample --period 0", "--period");
  refused("trajectory sample --period soon", "--period");
  refused("trajectory", "subcommand");
}

/// Answers to a file of the examples, each line changed before.
Answers ask_example(const std::string& arguments, const std::string& file,
                    const std::function<void(json&)>& change = {}) {
  std::ifstream in(std::string(HANDSEL_SOURCE_DIR) + "/examples/" + file);
  std::string input;
  for (std::string text; std::getline(in, text);) {
    json line = json::parse(text);
    if (change) change(line);
    input += line.dump() + "\n";
  }
  return ask(arguments, input);
}

TEST(TrajectoryCommand, on_the_way_to_the_cassette_the_corner_over_the_lid_keeps_its_stop) {
  const Answers with = ask_example("cartesian --robot jido", "cassette/cassette.jsonl");
  EXPECT_EQ(with.exit_code, 0) << with.err;
  ASSERT_EQ(with.lines.size(), 1u);
  const json& answer = with.lines[0];
  ASSERT_TRUE(answer.at("solved").get<bool>()) << answer;
  ASSERT_EQ(answer.at("corners").size(), 2u);
  EXPECT_EQ(answer.at("corners")[0].at("method"), "stop");
  EXPECT_NE(answer.at("corners")[0].at("reason").get<std::string>().find("collides"),
            std::string::npos);
  EXPECT_NE(answer.at("corners")[1].at("method"), "stop");
  const double saved = answer.at("saved_s").get<double>();
  EXPECT_GT(saved, 0.3);
  EXPECT_NEAR(answer.at("duration").get<double>(), answer.at("duration_ptp").get<double>() - saved,
              1e-9);
  const Answers without =
      ask_example("cartesian --robot jido", "cassette/cassette.jsonl", [](json& line) {
        auto& things = line.at("obstacles");
        things.erase(std::find_if(things.begin(), things.end(),
                                  [](const json& thing) { return thing.at("id") == "lid"; }));
      });
  ASSERT_EQ(without.lines.size(), 1u);
  EXPECT_NE(without.lines[0].at("corners")[0].at("method"), "stop");
  EXPECT_LT(without.lines[0].at("duration").get<double>(),
            answer.at("duration").get<double>() - 0.3);
}

TEST(TrajectoryCommand, what_the_tool_cannot_do_is_said_and_the_way_before_it_is_there) {
  const auto expect = [](const char* what, std::size_t reached,
                         const std::function<void(json&)>& change) {
    const Answers a =
        ask_example("cartesian --robot jido", "cassette/cassette.jsonl", [&](json& line) {
          line.erase("obstacles");
          line.at("nodes").erase(2);
          change(line.at("nodes"));
        });
    ASSERT_EQ(a.lines.size(), 1u) << what;
    const json& answer = a.lines[0];
    ASSERT_TRUE(answer.contains("solved")) << answer;
    EXPECT_EQ(a.exit_code, 1) << what;
    EXPECT_NE(answer.at("reason").get<std::string>().find(what), std::string::npos)
        << answer.at("reason");
    EXPECT_EQ(answer.at("reached"), reached) << what;
    EXPECT_EQ(answer.at("duration").get<double>() > 0.5, reached > 0) << what;
  };
  expect("out of reach", 1, [](json& nodes) { nodes[1]["p"][0] = 4; });
  expect("half a turn", 1, [](json& nodes) {
    const json q = nodes[0]["q"];  // turned by pi about its own z axis
    nodes[1]["q"] = {q[1], -q[0].get<double>(), q[3], -q[2].get<double>()};
  });
  // Behind the shoulder: reachable only through the stretched arm or on another branch.
  expect("node 2", 1, [](json& nodes) {
    nodes[1]["p"][0] = -nodes[0]["p"][0].get<double>();
    nodes[1]["p"][1] = -0.6;
  });
  // Equal waypoints, and a waypoint at the tool, give no motion.
  const Answers same =
      ask_example("cartesian --robot jido", "cassette/cassette.jsonl", [](json& line) {
        line.erase("obstacles");
        json& nodes = line.at("nodes");
        nodes = {nodes[0], nodes[0], nodes[1], nodes[1]};
      });
  ASSERT_EQ(same.lines.size(), 1u);
  EXPECT_TRUE(same.lines[0].at("solved").get<bool>());
  EXPECT_EQ(same.lines[0].at("reached"), 4);
  EXPECT_EQ(same.lines[0].at("corners").size(), 1u);
}

TEST(TrajectoryCommand, the_platform_drives_beneath_the_tool) {
  const auto drive = [](json& line) {
    line.erase("obstacles");
    json& nodes = line.at("nodes");
    nodes.erase(nodes.begin() + 1, nodes.end());
    nodes[0]["p"][0] = nodes[0]["p"][0].get<double>() + 0.8;  // beyond reach without driving
    nodes[0]["also"] = {{"platform_x", 0.8}, {"platform_y", 0.05}, {"platform_heading", 0.1}};
  };
  const Answers a =
      ask_example("cartesian --robot jido --platform", "cassette/cassette.jsonl", drive);
  ASSERT_EQ(a.lines.size(), 1u);
  EXPECT_EQ(a.exit_code, 0) << a.lines[0];
  EXPECT_EQ(a.lines[0].at("joint_names").size(), 10u);
  EXPECT_EQ(ask_example("cartesian --robot jido", "cassette/cassette.jsonl", drive).exit_code, 2);
}

TEST(TrajectoryCommand, beside_people_the_speed_follows_the_cost_of_the_way) {
  const TemporaryFolder folder;
  const std::string svg = (folder.path() / "sweep.svg").string();
  const Answers a = ask_example("timed --robot jido --svg " + svg, "beside_people/sweep.jsonl");
  EXPECT_EQ(a.exit_code, 0) << a.err;
  ASSERT_EQ(a.lines.size(), 3u);
  std::vector<double> slowest;  // middle of the slowest zone
  for (const json& answer : a.lines) {
    EXPECT_TRUE(answer.at("solved").get<bool>());
    double begin = 0, least = 2, middle = 0;
    for (const json& zone : answer.at("speeds")[0]) {
      if (zone[1].get<double>() < least) {
        least = zone[1].get<double>();
        middle = 0.5 * (begin + zone[0].get<double>());
      }
      begin = zone[0].get<double>();
    }
    EXPECT_LT(least, 0.9);
    slowest.push_back(middle);
  }
  EXPECT_LT(slowest[0], slowest[2] - 0.3);
  std::ifstream drawn(svg), kept(HANDSEL_SOURCE_DIR "/docs/figures/speed_beside_people.svg");
  const std::string text((std::istreambuf_iterator<char>(drawn)), {}),
      shipped((std::istreambuf_iterator<char>(kept)), {});
  EXPECT_EQ(text, shipped)
      << "docs/figures/speed_beside_people.svg is not what examples/beside_people draws";
  EXPECT_EQ(ask("timed --robot jido", R"({"nodes": [{"nose": 1}]})").exit_code, 2);
}

}  // namespace
}  // namespace handsel::test::trajectory_command_test
