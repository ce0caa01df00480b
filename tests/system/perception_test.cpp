// SPDX-License-Identifier: Apache-2.0
// The perception example from its author's side: built from an installed tree in an empty folder,
// its person receives the mug from the robot. With one injected fault each, `handsel doctor
// --perception` names the fault.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/bus/dds/dds_bus.hpp"
#include "common/messages/attention.hpp"
#include "common/messages/perception.hpp"
#include "tests/support/processes/background.hpp"
#include "tests/support/processes/shell.hpp"

namespace handsel::test::perception_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

constexpr int kDomain = 83, kFirstVariant = 84;
constexpr std::size_t kAtOnce = 5;  // variants tested in parallel

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

struct Edit {
  std::string find, replace;
};

/// The example with changed lines, and the required finding of the doctor.
struct Variant {
  std::string name;
  std::vector<Edit> edits;
  std::string subject, words;
};

/// Returns edits for a writer that does not use the project's library.
std::vector<Edit> own_writer(
    const std::string& topic, const std::string& tweak,
    const std::string& descriptor = "handsel_find_topic(\"human_observation\")->descriptor") {
  return {{"int main(",
           "static dds_entity_t own_writer(dds_entity_t participant) {\n  dds_qos_t *qos = "
           "handsel_topic_qos(\"human_observation\");\n  " +
               tweak + "\n  return dds_create_writer(participant, dds_create_topic(participant, " +
               descriptor + ", \"" + topic + "\", NULL, NULL), qos, NULL);\n}\n\nint main("},
          {"handsel_writer(participant, \"human_observation\")", "own_writer(participant)"}};
}

const std::string kStamp = "seen.stamp = things.stamp = dds_time();",
                  kNumbers = "joint->confidence = 0.9;";

std::vector<Variant> issue_variants() {
  return {
      {"topic", own_writer("handsel/human_observations", ""), "topic",
       "writes the topic handsel/human_observations, which no process reads"},
      {"qos", own_writer("handsel/human_observation", "dds_qset_deadline(qos, DDS_INFINITY);"),
       "QoS", "its DEADLINE is none, asked for is 0.2 s"},
      {"partition",
       own_writer("handsel/human_observation",
                  "const char *p = \"lab\"; dds_qset_partition(qos, 1, &p);"),
       "QoS", "its PARTITION is \"lab\""},
      {"rate", {{"next += period", "next += 12 * period"}}, "rate", "times a second"},
      {"age", {{kStamp, "seen.stamp = things.stamp = dds_time() - DDS_MSECS(600);"}}, "age", "0.6"},
      {"jitter",
       {{kStamp,
         "seen.stamp = things.stamp = dds_time() - (rand() % 5 == 0 ? DDS_MSECS(180) : 0);"}},
       "jitter",
       "varies by"},
      {"clock",
       {{kStamp, "seen.stamp = things.stamp = dds_time() + DDS_SECS(3);"}},
       "clock offset",
       "in the future"},
      {"frame",
       {{kNumbers, kNumbers + " { const double z = joint->position.z; joint->position.z = "
                              "joint->position.x; joint->position.x = "
                              "-joint->position.y; joint->position.y = 1.4 - z; }"}},
       "frame",
       "y points down, as in a camera's optical frame"},
      {"names",
       {{kNumbers, kNumbers + " joint->name[0] = (char)(joint->name[0] - 32);"}},
       "names",
       "joints that are not known"},
      {"nan",
       {{kNumbers, kNumbers + " if (i == 5) joint->position.z = NAN;"}},
       "malformed",
       "joints[5].position.z"},
      {"reach", {{kNumbers, kNumbers + " joint->position.x += 50;"}}, "reach", "out of reach"},
  };
}

std::vector<Variant> more_variants() {
  return {
      {"old_idl", own_writer("handsel/human_observation", "", "&handsel_HumanObservation_desc"),
       "IDL", "of another shape"},
      {"millimetres",
       {{kNumbers,
         kNumbers +
             " joint->position.x *= 1000; joint->position.y *= 1000; joint->position.z *= 1000;"}},
       "frame",
       "millimetres"},
      {"coverage",
       {{".coverage = {{-4, -4, -0.1}, {4, 4, 2.5}}", ".coverage = {{0, 0, 0}, {0, 0, 0}}"}},
       "coverage",
       "looks at no volume"},
      {"part_covered",
       {{".coverage = {{-4, -4, -0.1}, {4, 4, 2.5}}", ".coverage = {{0, -4, -0.1}, {4, 4, 2.5}}"}},
       "coverage",
       "does not contain the robot's reach"},
      {"gaze", {{"ahead.z / norm};", "2 * ahead.z / norm};"}}, "gaze", "gaze_direction"},
      {"ids",
       {{kStamp, kStamp + " snprintf(body.body, sizeof body.body, \"b%d\", rand());"}},
       "ids",
       "ids to 1 people"},
      {"frozen",
       {{"body_at(&person, t, &body);", "body_at(&person, 4.0, &body);"}},
       "frozen",
       "the very same body"},
      {"stamps",
       {{kStamp, "seen.stamp = things.stamp = dds_time() / 1000000;"}},
       "stamp",
       "looks like milliseconds"},
      {"models",
       {{"confidence = 1;", "confidence = 1; strcpy(o->model, \"cann\");"}},
       "names",
       "can (cann)"},
  };
}

class Perception : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    fs::remove_all(folder());
    fs::create_directories(folder());
    installed() = shell(HANDSEL_CMAKE " --install " HANDSEL_BUILD_DIR " --strip --prefix " +
                        prefix().string());
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }
  void SetUp() override { ASSERT_EQ(installed().exit_code, 0) << installed().err; }

  static fs::path folder() {
    return fs::temp_directory_path() / ("handsel-perception-" + std::to_string(getpid()));
  }
  static fs::path prefix() { return folder() / "prefix"; }
  static fs::path example() { return prefix() / "share/handsel/examples/perception"; }
  static Outcome& installed() {
    static Outcome outcome;
    return outcome;
  }
  /// With nothing of this environment but where programs are.
  static std::string clean() { return "env -i PATH=/usr/bin:/bin HOME=" + folder().string() + " "; }
  static std::string build(const fs::path& source) {
    const std::string out = (source / "build").string();
    const Outcome built = shell(clean() + HANDSEL_CMAKE " -S " + source.string() + " -B " + out +
                                " -DCMAKE_PREFIX_PATH=" + prefix().string() +
                                " -DCMAKE_C_FLAGS='-Wall -Wextra -Werror -pedantic' && " + clean() +
                                HANDSEL_CMAKE " --build " + out + " -j2");
    EXPECT_EQ(built.exit_code, 0) << built.out << built.err;
    return out;
  }
  static std::vector<std::string> run_example(const std::string& program, int domain) {
    return {"/usr/bin/env",
            "-i",
            "HANDSEL_DOMAIN=" + std::to_string(domain),
            program,
            "--repeat",
            "5",
            (example() / "person.csv").string(),
            (example() / "objects.csv").string()};
  }
  static std::pair<int, std::string> doctor(int domain, const std::string& options) {
    const std::string file = (folder() / ("doctor-" + std::to_string(domain))).string();
    const int status = std::system(
        (clean() + (prefix() / "bin/handsel").string() + " doctor --json --perception " + options +
         " --port 0 --domain " + std::to_string(domain) + " > " + file + " 2>&1")
            .c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128, text_of(file)};
  }

  void expect_named(const std::vector<Variant>& variants) {
    const fs::path source = folder() / ("variants-" + variants.front().name);
    fs::create_directories(source);
    std::string names;
    for (const Variant& variant : variants) {
      std::string text = text_of(example() / "perception.c");
      for (const Edit& edit : variant.edits) {
        const std::size_t at = text.find(edit.find);
        ASSERT_NE(at, std::string::npos) << variant.name << ": the example has no " << edit.find;
        text.replace(at, edit.find.size(), edit.replace);
      }
      if (variant.name == "old_idl") text = older(source, text);
      std::ofstream(source / (variant.name + ".c")) << text;
      names += variant.name + " ";
    }
    std::ofstream(source / "CMakeLists.txt")
        << "cmake_minimum_required(VERSION 3.16)\nproject(variants LANGUAGES "
           "C)\nfind_package(handsel REQUIRED)\n"
        << "foreach(name " << names << ")\n  add_executable(${name} ${name}.c)\n"
        << "  target_link_libraries(${name} handsel::idl m)\nendforeach()\n"
        << "if(TARGET old_idl)\n  target_sources(old_idl PRIVATE old/perception.c old/geometry.c "
           "old/attention.c)\n"
        << "  target_include_directories(old_idl BEFORE PRIVATE old)\nendif()\n";
    const std::string out = build(source);
    for (std::size_t first = 0; first < variants.size(); first += kAtOnce) {
      std::vector<std::unique_ptr<Background>> running;
      std::vector<std::future<std::pair<int, std::string>>> answers;
      const std::size_t end = std::min(first + kAtOnce, variants.size());
      for (std::size_t i = first; i < end; ++i)
        running.push_back(std::make_unique<Background>(
            run_example(out + "/" + variants[i].name, kFirstVariant + static_cast<int>(i))));
      for (std::size_t i = first; i < end; ++i)
        answers.push_back(std::async(std::launch::async, [i] {
          return doctor(kFirstVariant + static_cast<int>(i), "--inputs-only");
        }));
      for (std::size_t i = first; i < end; ++i) {
        const auto [code, said] = answers[i - first].get();
        SCOPED_TRACE(variants[i].name + ":\n" + said + running[i - first]->said());
        EXPECT_EQ(code, 1);
        bool named = false;
        std::istringstream lines(said);
        for (std::string line; std::getline(lines, line);) {
          const Json finding = Json::parse(line, nullptr, false);
          if (finding.is_discarded() || finding["result"] != "bad") continue;
          named = named || (finding["subject"] == variants[i].subject &&
                            finding["text"].get<std::string>().find(variants[i].words) !=
                                std::string::npos &&
                            !finding["remedy"].get<std::string>().empty());
        }
        EXPECT_TRUE(named) << "no finding on " << variants[i].subject << " says \""
                           << variants[i].words << "\"";
      }
    }
  }

  /// Of an IDL in which joints had no confidence yet.
  static std::string older(const fs::path& source, std::string text) {
    fs::create_directories(source / "old");
    fs::copy(prefix() / "share/handsel/idl", source / "idl",
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    std::string idl = text_of(source / "idl/perception.idl");
    const std::size_t at = idl.find("  double confidence;");
    idl.erase(at, idl.find('\n', at) - at);
    std::ofstream(source / "idl/perception.idl") << idl;
    const Outcome made =
        shell("cd " + (source / "idl").string() + " && idlc -l c -o " + (source / "old").string() +
              " geometry.idl && idlc -l c -o " + (source / "old").string() +
              " perception.idl && idlc -l c -o " + (source / "old").string() + " attention.idl");
    EXPECT_EQ(made.exit_code, 0) << made.out << made.err;
    for (const Edit& edit :
         {Edit{"#include <handsel/idl/attention.h>", "#include \"attention.h\""},
          Edit{"#include <handsel/idl/perception.h>", "#include \"perception.h\""},
          Edit{kNumbers, ""}})
      text.replace(text.find(edit.find), edit.find.size(), edit.replace);
    return text;
  }
};

/// Returns the number of samples of people a second over three seconds on `domain` while attention
/// asks `source` for `people_rate` [Hz].
double rate_of_people(int domain, const std::string& source, double people_rate) {
  DdsBus bus(
      {.component = "tester", .domain = static_cast<std::uint32_t>(domain), .health = false});
  int samples = 0;
  bool counting = false;
  bus.subscribe<HumanObservation>(
      [&](const HumanObservation&, const Receipt&) { samples += counting ? 1 : 0; });
  const auto requests = bus.advertise<SensorRequest>();
  SensorRequest request;
  request.source = source;
  request.people_rate = people_rate;
  bus.every(std::chrono::milliseconds(100), [&](TimePoint) { requests->publish(request); });
  bus.run_until([] { return false; }, std::chrono::seconds(1));
  counting = true;
  bus.run_until([] { return false; }, std::chrono::seconds(3));
  return samples / 3.0;
}

TEST_F(Perception, robot_hands_the_mug_to_the_person_published_from_outside) {
  const fs::path mine = folder() / "my_perception";
  fs::create_directories(mine);
  for (const char* file : {"perception.c", "CMakeLists.txt"})
    fs::copy_file(example() / file, mine / file);
  const Background perception(run_example(build(mine) + "/perception", kDomain));
  const auto [code, said] = doctor(kDomain, "--inputs-only");  // the person has arrived
  EXPECT_EQ(code, 0) << said;
  EXPECT_THAT(said, HasSubstr("from body_tracker"));
  EXPECT_NEAR(rate_of_people(kDomain, "body_tracker", 12), 12, 3);
  EXPECT_GT(rate_of_people(kDomain, "another_tracker", 12), 24) << "its own rate is 30 Hz";
  const std::string report = (folder() / "report.json").string();
  Background robot({(prefix() / "bin/handsel").string(), "run", "--scenario", "give_mug_external",
                    "--headless", "--port", "0", "--domain", std::to_string(kDomain), "--report",
                    report, "--json"});
  EXPECT_EQ(robot.wait(120), 0) << robot.said();
  const Json out = Json::parse(text_of(report));
  EXPECT_TRUE(out["success"].get<bool>()) << out["failure"] << robot.said();
  EXPECT_EQ(out["human"], "visitor") << "who took it";
  EXPECT_EQ(out["oracle"]["carrier"], "human");
  EXPECT_TRUE(out["oracle"]["handover_done"].get<bool>());
  EXPECT_EQ(out["oracle"]["limit_violations"], 0);
  EXPECT_EQ(out["ssm_violations"], 0);
}

TEST_F(Perception, doctor_names_the_fault_of_each_broken_variant) {
  expect_named(issue_variants());
}

using PerceptionMore = Perception;
TEST_F(PerceptionMore, doctor_names_the_fault_of_each_broken_variant) {
  expect_named(more_variants());
}

TEST(Recording, is_what_its_generator_makes) {
  const fs::path made =
      fs::temp_directory_path() / ("handsel-person-" + std::to_string(getpid()) + ".csv");
  const Outcome outcome =
      shell("python3 " HANDSEL_SOURCE_DIR "/examples/perception/generate.py " + made.string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(text_of(made), text_of(HANDSEL_SOURCE_DIR "/examples/perception/person.csv"));
  fs::remove(made);
}

}  // namespace
}  // namespace handsel::test::perception_test
