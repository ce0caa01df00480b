// SPDX-License-Identifier: Apache-2.0
// `handsel doctor` against injected faults: broken DDS settings, occupied ports and indices,
// namespaces without a network, clock offsets, descriptions with missing files. It must name each
// fault and report nothing on a correct system.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/prctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>

#include "common/bus/dds/dds_bus.hpp"
#include "common/bus/dds/dds_configuration.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "tests/support/processes/background.hpp"
#include "tests/support/processes/shell.hpp"

namespace handsel::test::doctor_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kDomain = 37;
const std::string kFolder = fs::path(HANDSEL_COMMAND).parent_path();

struct Diagnosis {
  int exit_code{-1};
  std::string err;
  std::vector<Json> findings;

  std::string all() const {
    std::string text = err;
    for (const Json& finding : findings) text += finding.dump() + "\n";
    return text;
  }
  /// The finding on a subject whose text contains `words`, or null.
  Json find(const std::string& subject, const std::string& words) const {
    for (const Json& finding : findings)
      if (finding["subject"] == subject &&
          finding["text"].get<std::string>().find(words) != std::string::npos)
        return finding;
    return {};
  }
};

/// `before` goes in front of the command: environment, unshare, ...
Diagnosis doctor(const std::string& arguments = {}, const std::string& before = {},
                 const std::string& command = HANDSEL_COMMAND) {
  const Outcome outcome =
      shell(before + " " + command + " doctor --json --domain " + std::to_string(kDomain) +
            (arguments.find("--port") == std::string::npos ? " --port 0 " : " ") + arguments);
  Diagnosis out{outcome.exit_code, outcome.err, {}};
  std::istringstream lines(outcome.out);
  for (std::string line; std::getline(lines, line);) out.findings.push_back(Json::parse(line));
  return out;
}

void expect_finding(const Diagnosis& diagnosis, int exit_code, const std::string& result,
                    const std::string& subject, const std::string& words) {
  EXPECT_EQ(diagnosis.exit_code, exit_code) << diagnosis.all();
  const Json finding = diagnosis.find(subject, words);
  ASSERT_FALSE(finding.is_null()) << "no finding on " << subject << " says \"" << words << "\":\n"
                                  << diagnosis.all();
  EXPECT_EQ(finding["result"], result) << finding.dump();
  EXPECT_FALSE(finding.value("remedy", "").empty()) << finding.dump();
  EXPECT_TRUE(diagnosis.err.empty()) << diagnosis.err;
}

/// Expects no finding except of the machine itself (processors, permission for real time).
void expect_silence(const Diagnosis& diagnosis) {
  EXPECT_EQ(diagnosis.exit_code, 0) << diagnosis.all();
  EXPECT_TRUE(diagnosis.err.empty()) << diagnosis.err;
  for (const Json& finding : diagnosis.findings) {
    const bool of_the_machine = finding["subject"] == "machine" ||
                                finding["subject"] == "real time" ||
                                finding["subject"] == "memory lock";
    EXPECT_TRUE(finding["result"] == "ok" || (of_the_machine && finding["result"] == "note"))
        << finding.dump();
  }
  EXPECT_GE(diagnosis.findings.size(), 14u) << diagnosis.all();
}

struct Folder {
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name) << text;
    return path / name;
  }
  fs::path path = fs::temp_directory_path() / ("handsel-doctor-" + std::to_string(getpid()));
};

/// dds/loopback.xml with one text replaced by another.
std::string settings(const Folder& folder, const std::string& what, const std::string& by) {
  std::ostringstream text;
  text << std::ifstream(HANDSEL_SOURCE_DIR "/deploy/dds/loopback.xml").rdbuf();
  std::string xml = text.str();
  const std::size_t at = xml.find(what);
  if (at == std::string::npos) throw std::runtime_error("loopback.xml has no " + what);
  return "CYCLONEDDS_URI=file://" + folder.write("dds.xml", xml.replace(at, what.size(), by));
}

/// Another process on the domain that publishes until the test is over.
template <class M>
class Publishing {
 public:
  explicit Publishing(const std::function<M(Stamp now)>& message,
                      const std::string& component = "stranger") {
    child_ = fork();
    if (child_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    DdsBus bus({.component = component, .domain = kDomain, .health = false});
    auto publisher = bus.advertise<M>();
    bus.every(from_seconds(0.05), [&](TimePoint) { publisher->publish(message(bus.stamp_now())); });
    bus.run();
    _exit(0);
  }
  ~Publishing() {
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }
  Publishing(const Publishing&) = delete;
  Publishing& operator=(const Publishing&) = delete;

 private:
  pid_t child_{};
};

Stamp after(Stamp now, double seconds) { return now + static_cast<Stamp>(seconds * 1e9); }

class BoundPort {
 public:
  BoundPort(int type, int port) : fd_(socket(AF_INET, type | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = type == SOCK_STREAM ? htonl(INADDR_LOOPBACK) : INADDR_ANY;
    bound_ = bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
             (type != SOCK_STREAM || listen(fd_, 1) == 0);
    socklen_t size = sizeof address;
    getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~BoundPort() { close(fd_); }
  BoundPort(BoundPort&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)), port_(other.port_), bound_(other.bound_) {}
  BoundPort(const BoundPort&) = delete;
  BoundPort& operator=(const BoundPort&) = delete;
  int port() const { return port_; }
  bool bound() const { return bound_; }

 private:
  int fd_{-1}, port_{};
  bool bound_{};
};

class Doctor : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1);
    setenv("CYCLONEDDS_URI", "file://" HANDSEL_SOURCE_DIR "/deploy/dds/loopback.xml", 1);
    setenv("XDG_STATE_HOME", (fs::temp_directory_path() / "handsel-doctor-state").c_str(), 1);
  }
  Folder folder;

  /// deploy/ and the scenarios, to break something in.
  std::string copied_home() const {
    fs::copy(HANDSEL_SOURCE_DIR "/deploy", folder.path / "deploy", fs::copy_options::recursive);
    fs::copy(HANDSEL_SOURCE_DIR "/sim/scenarios", folder.path / "deploy/scenarios",
             fs::copy_options::recursive);
    return "HANDSEL_HOME=" + (folder.path / "deploy").string();
  }
};

TEST_F(Doctor, is_silent_on_a_healthy_machine) {
  expect_silence(doctor("", "env -u CYCLONEDDS_URI"));
}

TEST_F(Doctor, is_silent_beside_a_healthy_system_and_sees_its_inputs) {
  Background up(
      {HANDSEL_COMMAND, "up", "--headless", "--port", "0", "--domain", std::to_string(kDomain)});
  ASSERT_TRUE(up.wait_for("watch it at")) << up.said();
  const Diagnosis diagnosis = doctor("--perception --driver");
  expect_silence(diagnosis);
  EXPECT_FALSE(diagnosis.find("system", "all processes ok").is_null()) << diagnosis.all();
  EXPECT_FALSE(diagnosis.find("commander", "trajectory_controller").is_null()) << diagnosis.all();
  EXPECT_FALSE(diagnosis.find("inputs", "handsel/human_observation comes").is_null())
      << diagnosis.all();
}

/// The process of the simulator on kDomain; -1: none.
pid_t simulator() {
  for (const fs::directory_entry& process : fs::directory_iterator("/proc")) {
    std::ifstream file(process.path() / "cmdline");
    std::vector<std::string> arguments;
    for (std::string argument; std::getline(file, argument, '\0');) arguments.push_back(argument);
    if (arguments.size() > 2 && fs::path(arguments[0]).filename() == "handsel_sim" &&
        arguments[1] == "--domain" && arguments[2] == std::to_string(kDomain))
      return std::stoi(process.path().filename());
  }
  return -1;
}

TEST_F(Doctor, accepts_stamps_beside_a_simulator_that_has_halted_the_time) {
  Background up(
      {HANDSEL_COMMAND, "up", "--headless", "--port", "0", "--domain", std::to_string(kDomain)});
  ASSERT_TRUE(up.wait_for("watch it at")) << up.said();
  const pid_t sim = simulator();
  ASSERT_GT(sim, 0);
  DdsBus bus({.component = "stranger", .domain = kDomain, .health = false});
  double waited = -1;
  bus.subscribe<SimClock>([&](const SimClock& clock, const Receipt&) { waited = clock.waited; });
  bus.every(from_seconds(0.02), [](TimePoint) {});
  ASSERT_TRUE(bus.run_until([&] { return waited >= 0; }, from_seconds(10)));
  for (int stop = 0; stop < 10 && waited < 1.3; ++stop) {
    const double before = waited;
    kill(sim, SIGSTOP);
    bus.run_until([] { return false; }, from_seconds(0.5));
    kill(sim, SIGCONT);
    ASSERT_TRUE(bus.run_until([&] { return waited > before + 0.3; }, from_seconds(5))) << waited;
  }
  ASSERT_GT(waited, 1.3) << "the doctor would accept older stamps than this anyway";
  const Diagnosis diagnosis = doctor("--driver");
  const Json clocks = diagnosis.find("clocks", "");
  ASSERT_FALSE(clocks.is_null()) << diagnosis.all();
  EXPECT_EQ(clocks["result"], "ok") << diagnosis.all();
}

TEST_F(Doctor, finds_that_peers_do_not_answer) {
  expect_finding(doctor("", settings(folder, "address=\"127.0.0.1\"", "address=\"192.0.2.1\"")), 1,
                 "bad", "DDS", "the peers 192.0.2.1 do not answer");
  expect_finding(doctor("", settings(folder, "<ParticipantIndex>auto", "<ParticipantIndex>none")),
                 1, "bad", "DDS", "but ParticipantIndex is none");
}

TEST_F(Doctor, finds_that_loopback_has_no_multicast) {
  if (shell("unshare -n true").exit_code != 0)
    GTEST_SKIP() << "network namespaces are not permitted here";
  const std::string alone = "unshare -n sh -c 'ip link set lo up; exec \"$0\" \"$@\"'";
  expect_finding(doctor("", "CYCLONEDDS_URI='<CycloneDDS/>' " + alone), 1, "bad", "DDS",
                 "MaxAutoParticipantIndex is 9, and the interface has no multicast");

  std::ostringstream xml;
  xml << std::ifstream(HANDSEL_SOURCE_DIR "/deploy/dds/loopback.xml").rdbuf();
  const std::string text = std::regex_replace(
      std::regex_replace(std::regex_replace(xml.str(), std::regex("<Peer .*/>"), ""),
                         std::regex("multicast=\"false\""), "multicast=\"true\""),
      std::regex("<AllowMulticast>false"), "<AllowMulticast>true");
  expect_finding(doctor("", "CYCLONEDDS_URI=" + folder.write("multicast.xml", text) +
                                " unshare -n sh -c 'ip link set lo up; echo 0 > "
                                "/proc/sys/net/ipv4/igmp_max_memberships; exec \"$0\" \"$@\"'"),
                 1, "bad", "DDS", "it cannot join the multicast group");
}

TEST_F(Doctor, finds_that_loopback_is_down_and_needs_nothing_else) {
  if (shell("unshare -n true").exit_code != 0)
    GTEST_SKIP() << "network namespaces are not permitted here";
  expect_finding(doctor("", "unshare -n"), 1, "bad", "DDS", "no process can enter domain 37");
  expect_silence(doctor("", "unshare -n sh -c 'ip link set lo up; exec \"$0\" \"$@\"'"));
}

TEST_F(Doctor, finds_that_participant_indices_are_too_few) {
  const Diagnosis diagnosis =
      doctor("", settings(folder, "<MaxAutoParticipantIndex>60</MaxAutoParticipantIndex>",
                          "<MaxAutoParticipantIndex>9</MaxAutoParticipantIndex>"));
  expect_finding(diagnosis, 1, "bad", "DDS", "MaxAutoParticipantIndex is 9");
  EXPECT_FALSE(diagnosis.find("DDS", "only 9 of 12").is_null()) << diagnosis.all();
}

TEST_F(Doctor, finds_that_participant_indices_are_in_use) {
  std::vector<BoundPort> bound;
  for (int index = 0; index < 60; ++index)
    bound.emplace_back(SOCK_DGRAM, participant_port(kDomain, index));
  for (const BoundPort& port : bound) ASSERT_TRUE(port.bound()) << port.port();
  const Diagnosis diagnosis = doctor();
  expect_finding(diagnosis, 1, "bad", "DDS", "all 60 participant indices are in use");
  EXPECT_FALSE(diagnosis.find("DDS", "(pid " + std::to_string(getpid()) + ")").is_null())
      << diagnosis.all();
}

TEST_F(Doctor, finds_settings_that_are_not_there_no_xml_or_dangerous) {
  expect_finding(doctor("", "CYCLONEDDS_URI=file:///nowhere.xml"), 3, "missing", "DDS settings",
                 "/nowhere.xml is not there");
  expect_finding(doctor("", "CYCLONEDDS_URI=" + folder.write("half.xml", "<CycloneDDS><Domain>")),
                 3, "missing", "DDS settings", "half.xml is no XML");
  expect_finding(doctor("", settings(folder, "<SPDPInterval>", "<Banana>3</Banana><SPDPInterval>")),
                 1, "bad", "DDS", "Banana");
  expect_finding(doctor("", settings(folder, "8MiB", "1MiB")), 1, "bad", "DDS settings",
                 "MaxSampleSize is 1.00 MiB");
  expect_finding(doctor("", settings(folder, "<MaxSampleSize>8MiB</MaxSampleSize>", "")), 0, "note",
                 "DDS settings", "MaxSampleSize is not set");
}

TEST_F(Doctor, finds_a_clock_that_is_off) {
  const Publishing<ComponentHealth> ahead([](Stamp now) {
    return ComponentHealth{.stamp = after(now, 0.3),
                           .component = "camera",
                           .incarnation = 1,
                           .pid = 1,
                           .state = HealthState::ok};
  });
  expect_finding(doctor(), 1, "bad", "clocks", "the clock of camera is 0.");
}

TEST_F(Doctor, finds_measurements_from_the_future_and_from_long_ago) {
  const auto observation = [](double offset) {
    return [offset](Stamp now) {
      return ObjectObservation{.stamp = after(now, offset), .source = "tracker"};
    };
  };
  {
    const Publishing<ObjectObservation> future(observation(0.5));
    expect_finding(doctor(), 1, "bad", "clocks", "s in the future");
  }
  const Publishing<ObjectObservation> past(observation(-20.0));
  expect_finding(doctor(), 1, "bad", "clocks", "measurements of objects are stamped 20.");
}

TEST_F(Doctor, finds_a_wall_clock_that_jumps) {
  expect_finding(doctor("", "LD_PRELOAD=" HANDSEL_CLOCK_JUMP), 1, "bad", "clocks",
                 "the wall clock jumped by 1.0");
}

TEST_F(Doctor, finds_what_is_missing_of_robot_hand_objects_and_scenario) {
  const std::string home = copied_home();
  const fs::path deploy = folder.path / "deploy";
  const auto without = [&](const std::string& file, const std::string& subject) {
    SCOPED_TRACE(file);
    fs::rename(deploy / file, folder.path / "aside");
    expect_finding(doctor("", home), 3, "missing", subject, fs::path(file).filename());
    fs::rename(folder.path / "aside", deploy / file);
  };
  without("objects/mug/mug.obj", "objects");
  without("hands/sah/sah.urdf", "hand");
  without("robots/jido/jido.srdf", "robot");
  expect_finding(doctor("--scenario nowhere", home), 3, "missing", "scenario", "nowhere");

  std::ostringstream urdf;
  urdf << std::ifstream(deploy / "robots/jido/jido.urdf").rdbuf();
  std::string text = urdf.str();
  text.insert(text.rfind("</robot>"),
              "<link name=\"badge\"><collision><geometry><mesh "
              "filename=\"badge.obj\"/></geometry></collision></link>"
              "<joint name=\"badge_fixed\" type=\"fixed\"><parent link=\"palm\"/><child "
              "link=\"badge\"/></joint>");
  std::ofstream(deploy / "robots/jido/jido.urdf") << text;
  expect_finding(doctor("", home), 3, "missing", "robot", "badge.obj");
}

TEST_F(Doctor, finds_settings_no_component_would_start_with) {
  const std::string home = copied_home();
  std::ofstream(folder.path / "deploy/config/spark.txtpb", std::ios::app) << "banana: 3\n";
  expect_finding(doctor("", home), 1, "bad", "settings", "spark.txtpb");
}

TEST_F(Doctor, finds_a_calibration_that_is_wrong_stale_or_not_what_comes) {
  const std::string home = copied_home(), file = "deploy/config/calibration.txtpb";
  folder.write(file,
               "sources { source: \"side\" speaks_in: CAMERA T_world_camera { rotation: [1, 0, 0, "
               "0, 1, 0, 0, 0, -1] } }\n");
  expect_finding(doctor("", home), 1, "bad", "calibration",
                 "calibration.txtpb:1: source side has a rotation that mirrors");

  folder.write(file,
               "sources { source: \"side\" measured: \"2020-01-01\" } robots { robot: \"jido\" "
               "T_world_base { position { x: 0.2 } } } "
               "valid_days: 180\n");
  const Publishing<HumanObservation> people(
      [](Stamp now) { return HumanObservation{.stamp = now, .source = "top"}; });
  const Publishing<RobotState> robot(
      [](Stamp now) {
        RobotState state;
        state.stamp = now;
        state.robot = "jido";
        state.position = state.velocity = Vector::Zero(7);
        return state;
      },
      "driver");
  const Diagnosis diagnosis = doctor("--perception", home);
  for (const char* words : {"source side was measured", "source top publishes, and is not in",
                            "source side of", "the base of jido is 0.200 m and 0.0 degrees from"})
    EXPECT_FALSE(diagnosis.find("calibration", words).is_null()) << words << "\n"
                                                                 << diagnosis.all();
}

TEST_F(Doctor, finds_that_the_port_is_taken_and_by_whom) {
  const BoundPort taken(SOCK_STREAM, 0);
  const std::string port = std::to_string(taken.port());
  const Diagnosis diagnosis = doctor("--port " + port);
  expect_finding(diagnosis, 1, "bad", "port", "port " + port + " of the page is taken by");
  EXPECT_FALSE(diagnosis.find("port", "(pid " + std::to_string(getpid()) + ")").is_null())
      << diagnosis.all();

  Background up(
      {HANDSEL_COMMAND, "up", "--headless", "--port", port, "--domain", std::to_string(kDomain)});
  ASSERT_TRUE(up.wait_for("no page")) << up.said();
  EXPECT_THAT(up.said(), testing::HasSubstr("port " + port))
      << "the system runs without its page, and says so";
}

TEST_F(Doctor, finds_that_real_time_and_locked_memory_are_not_permitted) {
  const std::string before =
      "prlimit --rtprio=0 --memlock=65536 setpriv --inh-caps -all --bounding-set "
      "-sys_nice,-ipc_lock";
  if (geteuid() != 0 || shell(before + " true").exit_code != 0)
    GTEST_SKIP() << "capabilities cannot be dropped here";
  const Diagnosis diagnosis = doctor("", before);
  expect_finding(diagnosis, 0, "note", "real time", "not permitted");
  expect_finding(diagnosis, 0, "note", "memory lock", "cannot be locked");
}

TEST_F(Doctor, finds_that_logs_have_no_room) {
  expect_finding(doctor("", "XDG_STATE_HOME=/proc/nothing"), 1, "bad", "logs", "cannot be written");
  if (shell("unshare -m true").exit_code != 0)
    GTEST_SKIP() << "mount namespaces are not permitted here";
  const std::string mount = "mount -t tmpfs -o size=1m none " + folder.path.string();
  expect_finding(doctor("", "unshare -m sh -c '" + mount + "; XDG_STATE_HOME=" +
                                folder.path.string() + " exec \"$0\" \"$@\"'"),
                 1, "bad", "logs", "only 1 MB are free");
}

TEST_F(Doctor, finds_processes_an_earlier_system_left) {
  Background costmap({kFolder + "/handsel_costmap", "--domain", std::to_string(kDomain)});
  const Diagnosis diagnosis = doctor();
  expect_finding(diagnosis, 1, "bad", "processes", "handsel_costmap (pid ");
}

TEST_F(Doctor, finds_another_commander) {
  const auto command = [](Stamp now) {
    JointCommand out{.stamp = now, .robot = "jido"};
    out.position = out.velocity = out.acceleration = Vector::Zero(1);
    return out;
  };
  const Publishing<JointCommand> one(command);
  expect_finding(doctor(), 1, "bad", "commander",
                 "has a commander that was not started here: stranger (pid ");
  const Publishing<JointCommand> two(command);
  expect_finding(doctor(), 1, "bad", "commander", "more than one process sends set-points");
}

TEST_F(Doctor, finds_programs_that_are_missing_or_of_another_version) {
  fs::create_directories(folder.path / "bin");
  fs::copy_file(HANDSEL_COMMAND, folder.path / "bin/handsel");
  for (const auto& entry : fs::directory_iterator(kFolder)) {
    const std::string name = entry.path().filename();
    if (name.rfind("handsel_", 0) == 0)
      fs::create_symlink(entry.path(), folder.path / "bin" / name);
  }
  const std::string command = folder.path / "bin/handsel";
  const fs::path spark = folder.path / "bin/handsel_spark";
  fs::remove(spark);
  expect_finding(doctor("", "", command), 3, "missing", "programs", "handsel_spark is not there");
  std::ofstream(spark) << "#!/bin/sh\necho 'handsel 0.0.1, interface 00000000'\n";
  fs::permissions(spark, fs::perms::owner_all);
  expect_finding(doctor("", "", command), 1, "bad", "programs",
                 "handsel_spark says \"handsel 0.0.1");
}

TEST_F(Doctor, finds_that_nobody_measures) {
  const Diagnosis diagnosis = doctor("--perception --driver");
  expect_finding(diagnosis, 3, "missing", "inputs", "nothing comes on handsel/human_observation");
  expect_finding(diagnosis, 3, "missing", "inputs", "nothing comes on handsel/robot_state");
}

TEST_F(Doctor, says_the_same_in_a_locale_with_other_numbers) {
  const std::string locale = (folder.path / "de_DE.UTF-8").string();
  ASSERT_EQ(shell("localedef -i de_DE -f UTF-8 " + locale).exit_code, 0)
      << "no definition of a German locale is installed (Debian: locales)";
  expect_silence(doctor("", "LOCPATH=" + folder.path.string() + " LC_ALL=de_DE.UTF-8"));
}

}  // namespace
}  // namespace handsel::test::doctor_test
