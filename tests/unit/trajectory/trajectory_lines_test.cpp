// SPDX-License-Identifier: Apache-2.0
// Answers of `handsel trajectory` to valid and invalid lines; trajectories as JSON and on the wire.
#include "deploy/handsel/offline/trajectory_lines.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "common/messages/execution.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/path/smooth.hpp"
#include "common/wire/message_type.hpp"

namespace handsel::trajectory_lines_test {
namespace {

using namespace command;
using Eigen::VectorXd;
using nlohmann::json;

json answer_to(const std::string& kind, const json& line) {
  if (kind == "solve") return solve_line(line);
  if (kind == "smooth") return smooth_line(line);
  return sample_line(line, 0.01);
}

struct Answers {
  std::vector<json> answers;
  int exit_code{};
};

Answers run(const std::string& kind, const std::string& text) {
  std::istringstream in(text);
  std::ostringstream out;
  Answers result;
  result.exit_code =
      for_each_line(in, out, [&](const json& line) { return answer_to(kind, line); });
  std::istringstream lines(out.str());
  for (std::string line; std::getline(lines, line);) result.answers.push_back(json::parse(line));
  return result;
}

std::string with(const std::string& field, const std::string& value) {
  json line = json::parse(
      R"({"p0":[0,0],"v0":[0,0],"a0":[0,0],"pf":[1,2],"vf":[0,0],"af":[0,0],"vmax":[1,1],)"
      R"("amax":[1,1],"jmax":[1,1]})");
  line[field] = json::parse(value);
  return line.dump() + "\n";
}

std::string error_of(const std::string& kind, const std::string& text) {
  const Answers r = run(kind, text);
  if (r.exit_code != 2 || r.answers.size() != 1 || !r.answers[0].contains("error"))
    return "no error: " + r.answers.at(0).dump();
  return r.answers[0]["error"];
}

TEST(TrajectoryLines, every_fault_has_its_own_sentence) {
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(error_of("solve", with("p0", "[0,null]")), "\"p0\" must be a finite number");
  has(error_of("solve", with("v0", "[0]")), "velocities");
  has(error_of("solve", with("pf", "[1]")), "end state");
  has(error_of("solve", with("vmax", "[1,0]")), "axis 1: a limit is not positive");
  has(error_of("solve", with("jmax", "[-1,1]")), "axis 0: a limit is not positive");
  has(error_of("solve", with("amax", "[1]")), "limits");
  has(error_of("solve", with("vf", "[0,3]")), "axis 1: the end state");
  has(error_of("solve", with("sync", "\"late\"")), "\"sync\"");
  has(error_of("solve", with("impose", "true")), "\"duration\" is missing");
  json line = json::parse(with("impose", "true"));
  line["duration"] = 0.5;
  has(error_of("solve", line.dump()), "needs");
  line["duration"] = -1;
  has(error_of("solve", line.dump()), "duration");
  has(error_of("smooth", R"({"nodes":[[0],[1]],"vmax":[1],"amax":[1],"jmax":[1],"tau":-1})"),
      "tau");
  has(error_of("smooth", R"({"nodes":[[0],[1,2]],"vmax":[1],"amax":[1],"jmax":[1]})"), "node 1");
  has(error_of("sample",
               R"({"axes":[{"p0":0,"v0":0,"a0":0,"segments":[[1,1]]},{"p0":0,"v0":0,"a0":0,)"
               R"("segments":[]}]})"),
      "equally long");
  has(error_of("sample", "{"), "not JSON");
}

TEST(TrajectoryLines, a_line_too_deep_or_too_long_is_refused_and_the_next_one_answered) {
  const std::string good = with("p0", "[0,0]");
  for (const std::string& bad : {std::string(200000, '['), std::string(17u << 20, ' ') + "1"}) {
    const Answers r = run("solve", bad + "\n" + good);
    ASSERT_EQ(r.answers.size(), 2u);
    EXPECT_TRUE(r.answers[0].contains("error"));
    EXPECT_TRUE(r.answers[1].contains("duration"));
    EXPECT_EQ(r.exit_code, 2);
  }
}

TEST(TrajectoryLines, starts_beyond_the_limits_come_back_inside) {
  const Answers r = run("solve", with("v0", "[1.5,0]"));
  ASSERT_EQ(r.exit_code, 0);
  const Trajectory t = trajectory_in(r.answers[0]);
  EXPECT_NEAR(t.at(0).velocity[0], 1.5, 1e-12);
  EXPECT_NEAR(final_state(t).position[0], 1, 1e-9);
}

TEST(TrajectoryLines, answers_have_what_the_contract_names) {
  json imposed = json::parse(with("impose", "true"));
  imposed["duration"] = 12.5;
  const Answers solved = run(
      "solve", with("sync", "\"time\"") + with("sync", "\"none\"") + "\n" + imposed.dump() + "\n");
  ASSERT_EQ(solved.exit_code, 0);
  ASSERT_EQ(solved.answers.size(), 3u);
  for (const json& a : solved.answers) {
    EXPECT_EQ(a["axes"].size(), 2u);
    EXPECT_EQ(a["min_durations"].size(), 2u);
  }
  EXPECT_NEAR(solved.answers[2]["duration"].get<double>(), 12.5, 1e-9);
  EXPECT_EQ(solved.answers[2]["excess"], 0);
  const Answers smoothed = run(
      "smooth", R"({"nodes":[[0,0],[1,0],[1,1],[0,1]],"vmax":[1,1],"amax":[1,1],"jmax":[2,2]})");
  ASSERT_EQ(smoothed.exit_code, 0);
  const json& a = smoothed.answers[0];
  ASSERT_EQ(a["corners"].size(), 2u);
  double saved = 0;
  for (const json& c : a["corners"]) {
    EXPECT_TRUE(c.contains("node") && c.contains("method") && c.contains("excess"));
    saved += c["saved_s"].get<double>();
  }
  EXPECT_NEAR(a["duration_ptp"].get<double>() - a["duration"].get<double>(), saved, 1e-9);
  const Answers sampled = run("sample", a.dump());
  ASSERT_EQ(sampled.exit_code, 0);
  const json& s = sampled.answers[0];
  EXPECT_EQ(s["t"].size(), s["p"].size());
  EXPECT_NEAR(s["p"].back()[1].get<double>(), 1, 1e-9);
}

TEST(TrajectoryLines, a_bad_line_is_answered_and_the_rest_still_runs) {
  const Answers r = run("solve", with("p0", "[0,0]") + "{\n" + with("p0", "[0,0]"));
  EXPECT_EQ(r.exit_code, 2);
  ASSERT_EQ(r.answers.size(), 3u);
  EXPECT_EQ(r.answers[1]["line"], 2);
  EXPECT_TRUE(r.answers[1].contains("error"));
  EXPECT_TRUE(r.answers[2].contains("axes"));
  EXPECT_EQ(run("solve", "").exit_code, 2);
}

/// Nothing is thrown, every line has one answer: an error, or numbers that are numbers.
void expect_sound(const std::string& kind, const std::string& text, const std::string& what) {
  const Answers r = run(kind, text);
  for (const json& answer : r.answers) {
    if (answer.contains("error")) {
      EXPECT_FALSE(answer["error"].get<std::string>().empty()) << what;
      continue;
    }
    EXPECT_EQ(answer.dump().find("null"), std::string::npos) << what << ": " << text.substr(0, 400);
  }
}

TEST(TrajectoryLines, corpus_and_what_becomes_of_it_when_damaged) {
  const std::uint64_t seed = 71;
  std::mt19937_64 random(seed);
  const auto pick = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  static const std::vector<std::string> kPieces{
      "1e308", "-1e308", "1e-308", "0", "-0.0", "-1", "null", "[]",  "{}",
      "\"x\"", "1e9",    "true",   ",", "]",    "}",  ":",    "\xff"};
  int lines = 0;
  for (const char* kind : {"solve", "smooth", "sample"}) {
    std::ifstream file(std::string(HANDSEL_SOURCE_DIR) + "/tests/fuzz/trajectory_lines/" + kind +
                       ".jsonl");
    ASSERT_TRUE(file) << kind;
    for (std::string line; std::getline(file, line); ++lines) {
      expect_sound(kind, line, kind);
      for (int k = 0; k < 60; ++k) {
        std::string damaged = line;
        for (std::size_t hits = 1 + pick(3); hits > 0 && !damaged.empty(); --hits) {
          const std::size_t at = pick(damaged.size());
          const std::size_t number = damaged.find_first_of("0123456789", at);
          switch (pick(4)) {
            case 0:
              damaged.erase(at, 1 + pick(4));
              break;
            case 1:
              damaged.insert(at, kPieces[pick(kPieces.size())]);
              break;
            default:
              if (number != std::string::npos)
                damaged.replace(number, 1, kPieces[pick(kPieces.size())]);
          }
        }
        if (damaged.find('\n') != std::string::npos) continue;
        expect_sound(kind, damaged, "seed " + std::to_string(seed) + " " + kind);
      }
    }
  }
  EXPECT_GT(lines, 50);
}

Trajectory random_trajectory(std::mt19937_64& random) {
  const auto draw = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  const int n = std::uniform_int_distribution<int>(1, 7)(random);
  std::vector<VectorXd> nodes(4, VectorXd(n));
  for (VectorXd& q : nodes) {
    for (double& x : q) x = draw(-2, 2);
  }
  const Trajectory whole = smooth(nodes, {VectorXd::Constant(n, draw(0.3, 2)),
                                          VectorXd::Constant(n, 1), VectorXd::Constant(n, 5)})
                               .trajectory;
  return cut(whole, draw(0, 0.4) * whole.duration(), whole.duration());
}

bool same(const Trajectory& a, const Trajectory& b) {
  if (a.size() != b.size()) return false;
  for (int i = 0; i < a.size(); ++i) {
    const AxisTrajectory &x = a.axes[i], &y = b.axes[i];
    if (x.start.position != y.start.position || x.start.velocity != y.start.velocity ||
        x.start.acceleration != y.start.acceleration || x.segments.size() != y.segments.size()) {
      return false;
    }
    for (std::size_t k = 0; k < x.segments.size(); ++k) {
      if (x.segments[k].duration != y.segments[k].duration ||
          x.segments[k].jerk != y.segments[k].jerk)
        return false;
    }
  }
  return true;
}

TEST(TrajectoryForms, json_and_wire_give_back_every_bit) {
  std::mt19937_64 random(72);
  const MessageType& type = message_type<TrajectoryCommand>();
  for (int k = 0; k < 200; ++k) {
    const Trajectory t = random_trajectory(random);
    ASSERT_TRUE(same(t, trajectory_in(json::parse(json{{"axes", axes_of(t)}}.dump()))));
    TrajectoryCommand out, back;
    auto wire = type.new_wire();
    std::string why;
    type.fill(wire.get(), false);
    ASSERT_TRUE(type.from_wire(wire.get(), &out, why)) << why;
    out.trajectory = t;
    out.axes.clear();
    for (int i = 0; i < t.size(); ++i) out.axes.push_back(static_cast<std::uint32_t>(i));
    ASSERT_TRUE(type.to_wire(&out, 5, wire.get(), why)) << why;
    ASSERT_TRUE(type.from_wire(wire.get(), &back, why)) << why;
    ASSERT_TRUE(same(t, back.trajectory));
  }
}

}  // namespace
}  // namespace handsel::trajectory_lines_test
