// SPDX-License-Identifier: Apache-2.0
// A study's run is recorded completely, with its marks; its replay into a system without a robot
// shows the same person.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "common/bus/dds/cdr.hpp"
#include "common/messages/system.hpp"
#include "common/messages/world.hpp"
#include "common/record/mcap.hpp"
#include "deploy/handsel/system/system.hpp"
#include "tests/support/processes/background.hpp"
#include "tests/support/processes/shell.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::test::recorded_run_test {
namespace {

using testing::HasSubstr;

const std::string kHandsel = HANDSEL_COMMAND;
constexpr int kDomain = 205;

struct Recorded {
  mcap::Metadata metadata;
  std::map<std::string, int> samples;
  std::vector<StudyMark> marks;
  Vector3 head{Vector3::Zero()};  // of the last person seen
  bool cut{};
};

template <class M>
M decoded(CdrCodec& codec, const mcap::Message& message) {
  const MessageType& type = message_type<M>();
  const auto wire = type.new_wire();
  M out;
  std::string why;
  EXPECT_TRUE(codec.decode(type, message.data, wire.get()));
  EXPECT_TRUE(type.from_wire(wire.get(), &out, why)) << why;
  return out;
}

Recorded read(const std::filesystem::path& file) {
  mcap::Reader reader(file);
  CdrCodec codec;
  Recorded out;
  for (mcap::Message message; reader.next(message);) {
    const std::string& topic = reader.channels().at(message.channel).topic;
    ++out.samples[topic];
    if (topic == "handsel/study_mark") out.marks.push_back(decoded<StudyMark>(codec, message));
    if (topic != "handsel/human_state") continue;
    const auto people = decoded<HumanState>(codec, message).people;
    if (!people.empty()) out.head = people[0].joints[0].position;
  }
  out.metadata = reader.metadata();
  out.cut = reader.cut();
  return out;
}

TEST(RecordedRun, holds_everything_with_its_marks_and_comes_again) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "run.mcap").string(),
                    domain = " --domain " + std::to_string(kDomain);
  const auto scenario = folder.write("pick.txtpb", R"(
name: "pick"
boxes { id: "table" pose { xyz { x: 0.85 y: -0.62 z: 0.36 } } size { x: 0.7 y: 0.7 z: 0.72 }
    supports: true }
objects { id: "mug" model: "mug" on: "table" pose { xyz { x: 0.68 y: -0.42 } } }
people { id: "anna" x: 1.60 y: 0.30 yaw: 3.1416 stature: 1.72 behaviour: STILL }
human_sensors { source: "kinect" rate: 30 latency: 0.04 noise: 0.004 }
object_sensors { source: "object_tracker" rate: 30 latency: 0.04 noise: 0.001 }
tasks { kind: "pick" object: "mug" }
timeout: 40
)");
  const Outcome run =
      shell(kHandsel + " run --headless --port 0 --scenario " + scenario.string() + domain +
            " --record " + file + " --participant p07 --condition calm --trial 3");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr(file));
  const Recorded recorded = read(file);
  EXPECT_FALSE(recorded.cut);
  EXPECT_EQ(recorded.metadata.at("participant"), "p07");
  EXPECT_EQ(recorded.metadata.at("condition"), "calm");
  EXPECT_EQ(recorded.metadata.at("trial"), "3");
  EXPECT_EQ(recorded.metadata.at("robot"), "jido");
  ASSERT_EQ(recorded.marks.size(), 2u);
  EXPECT_EQ(recorded.marks[0].text, "begin");
  EXPECT_EQ(recorded.marks[1].text, "done");
  EXPECT_EQ(recorded.marks[1].participant, "p07");
  EXPECT_EQ(recorded.marks[1].trial, 3u);
  // Fast topics are complete: ground truth has a tenth of the rate of the robot's state.
  EXPECT_GT(recorded.samples.at("handsel/robot_state"),
            9 * recorded.samples.at("handsel/ground_truth"));
  for (const char* topic : {"attention_state", "attention_advice", "task_status", "costmap",
                            "component_health", "trajectory", "joint_command"})
    EXPECT_GT(recorded.samples.at(std::string("handsel/") + topic), 0) << topic;
  const Outcome twice = shell(kHandsel + " up --headless --port 0" + domain + " --record " + file);
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.err, HasSubstr("is there already"));

  Background up({kHandsel, "up", "--headless", "--port", "0", "--without", "sim", "--scenario",
                 scenario.string(), "--domain", std::to_string(kDomain)});
  Session session(kDomain);
  Vector3 head = Vector3::Zero();
  int seen = 0;
  session.bus().subscribe<HumanState>([&](const HumanState& people, const Receipt&) {
    if (people.people.empty()) return;
    head = people.people[0].joints[0].position;
    ++seen;
  });
  ASSERT_TRUE(session.wait(std::chrono::seconds(20),
                           [&] { return why_not_ready(session.snapshot(), "spark").empty(); }));
  Background replay({kHandsel, "replay", file, "--from", "2", "--domain", std::to_string(kDomain)});
  EXPECT_TRUE(session.wait(std::chrono::seconds(20), [&] { return seen > 60; })) << seen;
  EXPECT_LT((head - recorded.head).norm(), 0.05)
      << head.transpose() << " against " << recorded.head.transpose();
  const Outcome second = shell(kHandsel + " replay " + file + domain);
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.err, HasSubstr("replay sim writes handsel/"));
}

}  // namespace
}  // namespace handsel::test::recorded_run_test
