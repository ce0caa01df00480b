// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/doctor/domain_findings.hpp"

#include <cmath>
#include <set>

#include "common/config/resources.hpp"
#include "common/messages/robot.hpp"
#include "common/topics/topics.hpp"
#include "components/spark/calibration.hpp"

namespace handsel {
namespace {

using Json = nlohmann::json;

constexpr double kOffset =
    0.05;  // max difference of clocks [s]; exceeds any transit on one machine or a local network
constexpr double kFuture = 0.01;  // max time of a measurement in the future [s]
constexpr double kOld = 1.0;      // exceeds the latency of any sensor [s]
constexpr double kJump = 0.005;   // max step of the wall clock against the monotonic one [s]
constexpr double kBaseOff = 0.01,
                 kBaseTurned = 0.01;  // max deviation of the base from calibration [m], [rad]

/// Returns whether check_perception checks the topic of people or objects in more detail.
bool left_to_perception(const DoctorOptions& options, const std::string& topic) {
  return options.perception && topic != TopicOf<RobotState>::row.topic;
}

void check_clocks(const DoctorOptions& options, const Json& seen, std::vector<Finding>& out) {
  const double jump = seen["jump"];
  if (std::abs(jump) > kJump) {
    out.push_back({"clocks", Verdict::bad,
                   finding_text("the wall clock jumped by %.3f s while it was checked", jump),
                   "let one service alone set the clock (chrony or PTP), and let it slew"});
  }
  double worst = 0.0;
  for (const auto& [component, offset] : seen["clocks"].items()) {
    const double by = offset;
    if (std::abs(by) > std::abs(worst)) worst = by;
    if (std::abs(by) <= kOffset) continue;
    out.push_back({"clocks", Verdict::bad,
                   finding_text("the clock of %s is %.3f s %s this machine's", component.c_str(),
                                std::abs(by), by > 0 ? "behind" : "ahead of"),
                   "run chrony or PTP on both hosts"});
  }
  for (const Json& input : seen["inputs"]) {
    if (input["least"].is_null() || left_to_perception(options, input["topic"])) continue;
    const double by = input["least"];
    if (by >= -kFuture && by <= kOld) continue;
    out.push_back(
        {"clocks", Verdict::bad,
         finding_text("measurements of %s are stamped %.3f s %s",
                      input["what"].get<std::string>().c_str(), std::abs(by),
                      by > 0 ? "ago when they come" : "in the future"),
         "stamp them with the time of measurement, and run chrony or PTP on the host that does"});
  }
  if (!out.empty() && out.back().subject == "clocks") return;
  if (seen["clocks"].empty()) {
    out.push_back(
        {"clocks", Verdict::good,
         "this machine's clock runs steadily; nobody else is on " + domain_text(options.domain),
         ""});
  } else {
    out.push_back(
        {"clocks", Verdict::good,
         finding_text("stamps and arrivals differ by at most %.1f ms", 1e3 * std::abs(worst)), ""});
  }
}

/// Checks that required inputs arrive at half their rate or more and well formed; others are
/// reported only if malformed.
void check_inputs(const DoctorOptions& options, const Json& seen, std::vector<Finding>& out) {
  for (const Json& input : seen["inputs"]) {
    const std::string what = input["what"], topic = input["topic"];
    const double rate = input["rate"], wanted = input["wanted"];
    if (left_to_perception(options, topic)) continue;
    if (input["rejected"].get<std::uint64_t>() > 0) {
      out.push_back(
          {"inputs", Verdict::bad,
           "malformed samples on " + topic + ": " + input["last_rejection"].get<std::string>(),
           "correct the program that sends them; idl/ says what each field means"});
      continue;
    }
    if (!options.driver || topic != TopicOf<RobotState>::row.topic) continue;
    if (rate == 0.0) {
      out.push_back({"inputs", Verdict::missing,
                     "nothing comes on " + topic + " of " + domain_text(options.domain),
                     "start the program that measures " + what + " on this domain"});
    } else if (rate < wanted / 2.0) {
      out.push_back({"inputs", Verdict::bad,
                     finding_text("%s comes %.0f times a second instead of %.0f", topic.c_str(),
                                  rate, wanted),
                     "look at the load of its program and of the network"});
    } else {
      out.push_back({"inputs", Verdict::good,
                     finding_text("%s comes %.0f times a second", topic.c_str(), rate), ""});
    }
  }
}

/// Compares the calibration with received poses. Its own errors are reported with the descriptions.
void compare_calibration(const DoctorOptions& options, const Json& seen,
                         std::vector<Finding>& out) {
  const std::string file = resource("config/calibration.txtpb");
  spark::Calibration calibration;
  try {
    calibration = spark::Calibration(file);
  } catch (const std::exception&) {
    return;
  }
  const std::set<std::string> received = seen["sources"];
  const std::size_t before = out.size();
  for (const std::string& source : received)
    if (!calibration.sources().empty() && !calibration.sources().contains(source))
      out.push_back({"calibration", Verdict::bad,
                     "source " + source + " publishes, and is not in " + file +
                         ": taken to speak in frame world",
                     "say there where it stands, or that it speaks_in WORLD"});
  for (const auto& [name, source] : calibration.sources())
    if (options.perception && !received.contains(name))
      out.push_back(
          {"calibration", Verdict::missing,
           "source " + name + " of " + file + " says nothing on " + domain_text(options.domain),
           "start it, or take it out of the file"});
  for (const auto& [name, numbers] : seen["bases"].items()) {
    const auto robot = calibration.robots().find(name);
    if (robot == calibration.robots().end()) continue;
    const std::vector<double> is = numbers;
    const Pose T =
        robot->second.T_world_base.inverse() * Pose(Eigen::Map<const Eigen::Matrix4d>(is.data()));
    const double off = T.translation().norm(), turned = Eigen::AngleAxisd(T.linear()).angle();
    if (off <= kBaseOff && turned <= kBaseTurned) continue;
    out.push_back({"calibration", Verdict::bad,
                   finding_text("the base of %s is %.3f m and %.1f degrees from where %s says",
                                name.c_str(), off, turned * 180 / M_PI, file.c_str()),
                   "measure it again, or correct what its driver reports as T_world_base"});
  }
  if (out.size() == before && (!received.empty() || !seen["bases"].empty()) &&
      !(calibration.sources().empty() && calibration.robots().empty()))
    out.push_back({"calibration", Verdict::good,
                   "what comes on " + domain_text(options.domain) + " is as the file says", ""});
}

/// Checks that a topic with one writer has no other, and none that the table does not name.
void check_writers(const DoctorOptions& options, const Json& seen, std::vector<Finding>& out) {
  const std::size_t before = out.size();
  for (const auto& [topic, writers] : seen["writers"].items()) {
    std::string names;
    bool strange = false;
    for (const Json& writer : writers) {
      names += (names.empty() ? "" : ", ") + writer["who"].get<std::string>();
      strange = strange || !writer["may"].get<bool>();
    }
    if (writers.size() > 1)
      out.push_back({"second_writer", Verdict::bad,
                     "more than one process writes " + topic + " on " +
                         domain_text(options.domain) + ": " + names,
                     "end all but the rightful one; samples of the others are refused"});
    else if (strange)
      out.push_back(
          {"second_writer", Verdict::bad,
           topic + " on " + domain_text(options.domain) + " is written by " + names +
               ", which is no writer of this topic; its samples are refused",
           "end it, or give its participant the name of the component that it stands for"});
  }
  if (out.size() == before)
    out.push_back({"second_writer", Verdict::good,
                   "no topic with one writer has another on " + domain_text(options.domain), ""});
}

void check_other_systems(const DoctorOptions& options, const Json& seen, bool held,
                         std::vector<Finding>& out) {
  std::string commanders;
  for (const Json& commander : seen["commanders"])
    commanders += (commanders.empty() ? "" : ", ") + commander["who"].get<std::string>();
  const std::size_t count = seen["commanders"].size();
  if (count > 1) {
    out.push_back({"commander", Verdict::bad,
                   "more than one process sends set-points on " + domain_text(options.domain) +
                       ": " + commanders,
                   "end all but one"});
  } else if (count == 1 && !held && seen["commanders"][0]["elsewhere"].get<bool>() &&
             seen["system"].get<bool>()) {
    out.push_back({"commander", Verdict::note,
                   "a system on another host moves the robot on " + domain_text(options.domain) +
                       ": " + commanders,
                   "choose another domain with --domain if it is not meant to be this one"});
  } else if (count == 1 && !held) {
    out.push_back({"commander", Verdict::bad,
                   "the robot on " + domain_text(options.domain) +
                       " has a commander that was not started here: " + commanders,
                   "end it, or choose another domain with --domain"});
  } else {
    out.push_back(
        {"commander", Verdict::good,
         count == 0 ? "nobody sends set-points on " + domain_text(options.domain) : commanders,
         ""});
  }
  if (!seen["strangers"].empty()) {
    out.push_back({"hosts", Verdict::note,
                   "other hosts are on " + domain_text(options.domain) + ": " +
                       seen["strangers"][0].get<std::string>(),
                   "choose another domain with --domain if they are not meant to be"});
  }
  if (!seen["system"].get<bool>()) {
    out.push_back(
        {"system", Verdict::good, "none runs on " + domain_text(options.domain) + " now", ""});
  } else if (held && seen["troubles"].empty()) {
    out.push_back({"system", Verdict::good,
                   "runs on " + domain_text(options.domain) + ", all processes ok", ""});
  } else if (held) {
    for (const Json& trouble : seen["troubles"])
      out.push_back({"system", Verdict::note, trouble.get<std::string>(),
                     "look at `handsel status` and at the log of the process"});
  }
  for (const Json& one : seen["left_out"])
    out.push_back({"left out", Verdict::note, one.get<std::string>(),
                   "less of it, or a higher quota: components/spark/README.md says what is kept"});
}

}  // namespace

std::string domain_text(int domain) { return "domain " + std::to_string(domain); }

void add_domain_findings(const DoctorOptions& options, const nlohmann::json& seen, bool held,
                         std::vector<Finding>& out) {
  check_clocks(options, seen, out);
  check_inputs(options, seen, out);
  compare_calibration(options, seen, out);
  check_writers(options, seen, out);
  check_other_systems(options, seen, held, out);
}

}  // namespace handsel
