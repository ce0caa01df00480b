// SPDX-License-Identifier: Apache-2.0
// Recordings: written samples are read, also from damaged files; a replay gives the recorded
// samples with present time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "common/base/errors.hpp"
#include "common/bus/local_bus.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/robot.hpp"
#include "common/record/mcap.hpp"
#include "deploy/handsel/recording/recorder.hpp"
#include "deploy/handsel/recording/replay.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::test::record_test {
namespace {

using testing::HasSubstr;

const std::vector<mcap::Channel> kChannels{{"a", "cdr", "A", "omgidl", "struct A {};"},
                                           {"b", "cdr", "B", "omgidl", "struct B {};"}};

mcap::Message message(std::mt19937& random, std::int64_t time) {
  mcap::Message out{static_cast<std::uint16_t>(random() % kChannels.size()), time, {}};
  out.data.resize(random() % 300);
  for (auto& byte : out.data) byte = static_cast<std::uint8_t>(random());
  return out;
}

bool same(const mcap::Message& a, const mcap::Message& b) {
  return a.channel == b.channel && a.time == b.time && a.data == b.data;
}

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// Some chunks of some messages each, in the order of their times.
std::vector<mcap::Message> write_some(const std::filesystem::path& file, std::mt19937& random) {
  std::vector<mcap::Message> sent;
  mcap::Writer writer(file, kChannels, {{"robot", "jido"}});
  for (std::int64_t time = 1; time < 60; ++time) {
    sent.push_back(message(random, time));
    writer.write(sent.back());
    if (random() % 8 == 0) writer.flush();
  }
  return sent;
}

TEST(Mcap, what_was_written_is_read) {
  const TemporaryFolder folder;
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const auto sent = write_some(folder.path() / "x.mcap", random);
  mcap::Reader reader(folder.path() / "x.mcap");
  EXPECT_EQ(reader.channels().at(1).topic, "b");
  EXPECT_EQ(reader.channels().at(1).schema, "struct B {};");
  EXPECT_EQ(reader.metadata().at("robot"), "jido");
  mcap::Message read;
  for (const mcap::Message& expected : sent) {
    ASSERT_TRUE(reader.next(read));
    EXPECT_TRUE(same(read, expected));
  }
  EXPECT_FALSE(reader.next(read));
  EXPECT_FALSE(reader.cut());
}

TEST(Mcap, of_a_file_that_was_cut_anywhere_everything_before_the_cut_chunk_is_read) {
  const TemporaryFolder folder;
  std::mt19937 random(7);
  const auto sent = write_some(folder.path() / "x.mcap", random);
  const std::string whole = text_of(folder.path() / "x.mcap");
  std::size_t most = 0;
  for (std::size_t length = 8; length < whole.size(); length += 1 + random() % 120) {
    mcap::Reader reader(folder.write("cut.mcap", whole.substr(0, length)));
    mcap::Message read;
    std::size_t count = 0;
    for (; reader.next(read); ++count) ASSERT_TRUE(same(read, sent[count])) << length;
    EXPECT_GE(count, most) << length;
    most = count;
  }
  EXPECT_EQ(most, sent.size());
}

TEST(Mcap, a_damaged_file_is_refused_with_its_place_or_read_and_never_more) {
  const TemporaryFolder folder;
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const auto sent = write_some(folder.path() / "x.mcap", random);
  const std::string whole = text_of(folder.path() / "x.mcap");
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string bad = whole;
    for (unsigned n = 1 + random() % 4; n > 0; --n)
      bad[random() % bad.size()] = static_cast<char>(random());
    const auto file = folder.write("bad.mcap", bad);
    try {
      mcap::Reader reader(file);
      mcap::Message read;
      for (std::size_t count = 0; reader.next(read); ++count) ASSERT_LT(count, sent.size());
    } catch (const ConfigError& error) {
      ++refused;
      EXPECT_THAT(error.what(), HasSubstr("bad.mcap"));
    }
  }
  EXPECT_GT(refused, 200);
}

TEST(Mcap, what_is_no_recording_or_would_be_overwritten_is_said) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of<MissingError>([&] { mcap::Reader(folder.path() / "none.mcap"); }),
              HasSubstr("no recording"));
  EXPECT_THAT(message_of<ConfigError>(
                  [&] { mcap::Reader(folder.write("text.mcap", "hello, this is a text")); }),
              HasSubstr("is no MCAP recording"));
  const auto there = folder.write("there.mcap", "precious");
  EXPECT_THAT(message_of<ConfigError>([&] { mcap::Writer(there, kChannels, {}); }),
              HasSubstr("is there already"));
  EXPECT_EQ(text_of(there), "precious");
  EXPECT_THAT(message_of<ConfigError>(
                  [&] { mcap::Writer(folder.path() / "no" / "x.mcap", kChannels, {}); }),
              HasSubstr("cannot write"));
}

/// States and commands, recorded on one network, replayed on another.
class Replayed : public testing::Test {
 protected:
  void record() {
    LocalNetwork network(3);
    Bus& bus = network.add("sim");
    auto states = bus.advertise<RobotState>();
    auto commands = bus.advertise<JointCommand>();
    LocalRecording recording(network, file_, {{"seed", "3"}});
    for (int i = 0; i < 50; ++i) {
      RobotState state;
      state.robot = "jido";
      state.sequence = static_cast<std::uint64_t>(i);
      state.position = Vector::Constant(7, 0.01 * i);
      state.velocity = Vector::Constant(7, 1.0);
      EXPECT_TRUE(states->publish(state));
      JointCommand command;
      command.robot = "jido";
      command.position = command.velocity = command.acceleration = Vector::Zero(7);
      commands->publish(command);
      network.run_for(std::chrono::milliseconds(20));
    }
    recording.close();
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "x.mcap";
};

TEST_F(Replayed, the_inputs_come_again_in_their_order_at_their_pace_and_as_new) {
  record();
  LocalNetwork network(4);
  Bus& bus = network.add("replay sim");
  std::vector<std::pair<std::uint64_t, Stamp>> heard;
  int commands = 0;
  Bus& ear = network.add("ear");
  ear.subscribe<RobotState>([&](const RobotState& state, const Receipt&) {
    heard.emplace_back(state.sequence, state.stamp);
  });
  ear.subscribe<JointCommand>([&](const JointCommand&, const Receipt&) { ++commands; });
  Replay replay(bus, {.file = file_, .topics = {}, .from = 0.5});
  network.run_for(std::chrono::seconds(100));  // long after the recording
  const TimePoint start = bus.now();
  const Stamp began = bus.stamp_now();
  while (replay.advance()) {
    network.run_until(start + from_seconds(replay.due()));
    replay.send(began);
  }
  network.run_for(std::chrono::milliseconds(10));
  ASSERT_EQ(heard.size(), 25u);
  for (std::size_t i = 0; i < heard.size(); ++i) {
    EXPECT_EQ(heard[i].first, 25 + i);
    EXPECT_NEAR(static_cast<double>(heard[i].second - began), 2e7 * static_cast<double>(i), 1e6);
  }
  EXPECT_EQ(commands, 0) << "a command comes from inside";
  EXPECT_EQ(replay.counts().at("handsel/robot_state").sent, 25u);
}

TEST_F(Replayed, who_replays_speaks_for_a_component_that_may_write) {
  EXPECT_EQ(replay_name({}), "replay sim");
  EXPECT_EQ(replay_name({"human_observation"}), "replay");
  EXPECT_EQ(replay_name({"human_state", "scene", "go"}), "replay spark supervisor");
}

TEST_F(Replayed, what_was_recorded_with_another_idl_is_refused) {
  std::vector<mcap::Channel> channels = recorded_channels();
  channels[0].schema += "\n// one field more";
  { mcap::Writer writer(file_, channels, {}); }
  LocalNetwork network(4);
  Bus& bus = network.add("replay sim");
  EXPECT_THAT(message_of<ConfigError>(
                  [&] { Replay(bus, {.file = file_, .topics = {"robot_state"}, .from = 0}); }),
              HasSubstr("handsel/robot_state was recorded with another IDL"));
  EXPECT_THAT(message_of<ConfigError>(
                  [&] { Replay(bus, {.file = file_, .topics = {"dance"}, .from = 0}); }),
              HasSubstr("no topic \"dance\""));
}

TEST_F(Replayed, nothing_is_sent_of_a_recording_that_is_damaged_further_on) {
  record();
  {
    std::string bytes = text_of(file_);
    const std::size_t last = bytes.rfind("jido");  // within the last sample
    bytes[last] = 'J';
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes;
  }
  LocalNetwork network(4);
  Bus& bus = network.add("replay");
  EXPECT_THAT(
      message_of<ConfigError>([&] { Replay(bus, {.file = file_, .topics = {}, .from = 0}); }),
      HasSubstr("x.mcap: at byte "));
}

TEST_F(Replayed, a_message_of_another_century_is_refused) {
  {
    mcap::Writer writer(file_, recorded_channels(), {});
    writer.write({0, 1000, {1}});
    writer.write({0, 3'155'760'000'000'000'000, {1}});
  }
  LocalNetwork network(4);
  Bus& bus = network.add("replay");
  EXPECT_THAT(message_of<ConfigError>(
                  [&] { Replay(bus, {.file = file_, .topics = {"robot_state"}, .from = 0}); }),
              HasSubstr("a recording has at most 30 days"));
}

TEST_F(Replayed, a_sample_that_breaks_its_bounds_is_refused_and_the_rest_comes) {
  {
    mcap::Writer writer(file_, recorded_channels(), {});
    CdrCodec codec;
    const MessageType& type = message_type<RobotState>();
    RobotState state;
    state.robot = "jido";
    state.position = state.velocity = Vector::Zero(7);
    auto wire = type.new_wire();
    std::string why;
    ASSERT_TRUE(type.to_wire(&state, 1, wire.get(), why)) << why;
    const auto good = codec.encode(type, wire.get());
    type.leaves(wire.get(), [](const WireLeaf& leaf) {
      if (leaf.path() == "position[3]") *static_cast<double*>(leaf.value) = 1e300;
    });
    writer.write({0, 1000, good});
    writer.write({0, 2000, codec.encode(type, wire.get())});
    writer.write({0, 3000, {1, 2, 3}});
    writer.write({0, 4000, good});
  }
  LocalNetwork network(4);
  Bus& bus = network.add("replay sim");
  Replay replay(bus, {.file = file_, .topics = {}, .from = 0});
  while (replay.advance()) replay.send(bus.stamp_now());
  const Replay::Count& count = replay.counts().at("handsel/robot_state");
  EXPECT_EQ(count.sent, 2u);
  EXPECT_EQ(count.refused, 2u);
  EXPECT_THAT(count.refusal, HasSubstr("RobotState.position"));
}

}  // namespace
}  // namespace handsel::test::record_test
