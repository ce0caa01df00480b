// SPDX-License-Identifier: Apache-2.0
// Bad scenarios and stories: no process of the system may start.
#include "tests/system/bad_files/bad_files.hpp"

namespace handsel::test {
namespace {

void add_places(BadFiles& table) {
  const std::string good = source_file("sim/scenarios/give_mug.txtpb");
  const std::string run = "run --headless --domain {domain} --scenario {}";
  const auto scenario = [&](const std::string& name, const std::string& content,
                            const std::string& says, int exit_code = 2) {
    table.push_back({"scenario/" + name + ".txtpb", content, run, says, exit_code});
  };
  scenario("empty", "", "no tasks");
  scenario("binary", std::string("\0\1\377", 3), "binary.txtpb:1");
  scenario("cut", good.substr(0, 300), "cut.txtpb:");
  scenario("unknown_key", good + "weather: \"fine\"\n", "weather");
  scenario("wrong_type", with(good, "timeout: 90", "timeout: \"long\""), "wrong_type.txtpb:");
  scenario("timeout_nan", with(good, "timeout: 90", "timeout: nan"), "timeout: is nan");
  scenario("timeout_negative", with(good, "timeout: 90", "timeout: -1"), "timeout: is -1");
  scenario("person_infinite", with(good, "x: 1.40", "x: inf"), "x: is inf");
  scenario("person_far", with(good, "x: 1.40", "x: 5000"), "x: is 5000");
  scenario("stature", with(good, "stature: 1.72", "stature: 17"), "stature of anna is 17");
  scenario("box_negative", with(good, "size { x: 0.7", "size { x: -0.7"),
           "box table has a size that is not above 0");
  scenario("box_nan", with(good, "z: 0.36", "z: nan"), "z: is nan");
  scenario("model_unknown", with(good, "model: \"mug\"", "model: \"dragon\""), "dragon", 3);
  scenario("on_nothing", with(good, "on: \"table\"", "on: \"cloud\""), "cloud");
  scenario("object_twice", good + "objects { id: \"mug\" model: \"box\" on: \"table\" }\n",
           "\"mug\" is there twice");
  scenario("person_twice", good + "people { id: \"anna\" x: 2 }\n", "\"anna\" is there twice");
  scenario("box_twice", good + "boxes { id: \"table\" size { x: 1 y: 1 z: 1 } }\n",
           "\"table\" is there twice");
  scenario("no_name", good + "objects { model: \"box\" on: \"table\" }\n", "has no id");
  scenario(
      "thousand_objects",
      good +
          [] {
            std::string all;
            for (int i = 0; i < 1000; ++i)
              all +=
                  "objects { id: \"o" + std::to_string(i) + "\" model: \"box\" on: \"table\" }\n";
            return all;
          }(),
      "at most");
  scenario("robot_unknown", with(good, "robot: \"jido\"", "robot: \"hal\""), "hal", 3);
  scenario("start_unknown", good + "start { key: \"tail\" value: 1 }\n", "tail");
  scenario("start_nan", good + "start { key: \"shoulder_pan\" value: nan }\n", "value: is nan");
  scenario("sensor_rate", with(good, "rate: 30 latency: 0.04 noise: 0.004", "rate: 0"),
           "rate is 0, must be between 1 and 1000");
  scenario("sensor_latency", with(good, "latency: 0.04 noise: 0.004", "latency: -1"),
           "latency is -1, must be between 0 and 10");
  scenario("sensor_no_name", with(good, "source: \"kinect\"", "source: \"\""),
           "a sensor has no source");
  scenario("disturbance", good + "disturbances { at: 1 action: \"explode\" }\n", "explode");
  scenario("disturbance_at", good + "disturbances { at: -1 action: \"pause\" }\n", "at: is -1");
  scenario("giver_without", good + "people { id: \"bert\" behaviour: GIVER object: \"crown\" }\n",
           "crown");
  scenario("recording_missing",
           good + "people { id: \"bert\" behaviour: RECORDING recording: \"/nowhere.csv\" }\n",
           "nowhere.csv", 3);
  scenario("varies", with(good, "behaviour: PARTNER", "behaviour: PARTNER varies { absent: 2 }"),
           "must be between 0 and 1");
  scenario("long_name", with(good, "name: \"give_mug\"", "name: \"" + repeated("n", 5000) + "\""),
           "5000 bytes long");
  table.push_back(
      {"scenario/missing.txtpb", "", run, "missing.txtpb", 3, "", BadFile::Kind::missing});
  table.push_back(
      {"scenario/folder.txtpb", "", run, "is not a file", 2, "", BadFile::Kind::folder});
}

void add_stories(BadFiles& table) {
  const auto story = [&](const std::string& name, const std::string& content,
                         const std::string& says) {
    table.push_back({"story/" + name + ".story", content, "story --domain {domain} {}", says});
  };
  story("empty", "", "no step");
  story("binary", std::string("\0\1\377\2", 4), "binary.story:1");
  story("no_start", "task give mug\n", "no_start.story:1: a story begins with start");
  story("two_starts", "start give_mug\nstart give_mug\n",
        "two_starts.story:2: a story starts once");
  story("unknown_step", "start give_mug\ndance\n", "unknown_step.story:2");
  story("unknown_condition", "start give_mug\nexpect joy within 1s\n", "unknown_condition.story:2");
  story("no_time", "start give_mug\nwait ready\n", "within");
  story("time_nan", "start give_mug\nwait ready within nans\n", "needs a time");
  story("time_infinite", "start give_mug\nwait ready within 1e400s\n", "needs a time");
  story("time_negative", "start give_mug\nat -1s pause\n", "needs a time");
  story("speed_nan", "start give_mug\nspeed nan\n", "needs a number");
  story("speed_infinite", "start give_mug\nexpect speed below inf within 1s\n", "needs a number");
  story("long_word", "start give_mug\n" + repeated("x", 1 << 20) + "\n", "long_word.story:2");
  story("five_megabytes", "start give_mug\n" + repeated("# nothing\n", 600000), "may have 4 MB");
  story("cut", "start give_mug\nkill", "a process should follow");
  table.push_back(
      {"story/missing.story", "", "story {}", "missing.story", 3, "", BadFile::Kind::missing});
  table.push_back(
      {"story/folder.story", "", "story {}", "is not a file", 2, "", BadFile::Kind::folder});
}

}  // namespace

void add_scenarios(BadFiles& table) {
  add_places(table);
  add_stories(table);
}

}  // namespace handsel::test
