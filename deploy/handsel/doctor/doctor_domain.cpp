// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <list>
#include <map>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include "common/base/errors.hpp"
#include "common/bus/dds/dds_configuration.hpp"
#include "common/bus/writer_pin.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "deploy/handsel/doctor/doctor.hpp"
#include "deploy/handsel/doctor/domain_findings.hpp"
#include "deploy/handsel/doctor/halts.hpp"
#include "deploy/handsel/doctor/probe.hpp"
#include "deploy/handsel/system/launcher.hpp"
#include "deploy/handsel/system/machine.hpp"
#include "deploy/handsel/system/session.hpp"
#include "deploy/handsel/system/status.hpp"

namespace handsel {
namespace {

using Json = nlohmann::json;

constexpr Duration kEnter = std::chrono::seconds(5);  // until one has entered, on a busy machine
constexpr Duration kMeet = std::chrono::seconds(3);   // until all have received each other
constexpr Duration kListenTime = std::chrono::milliseconds(800);
constexpr Duration kSpeak = std::chrono::milliseconds(50);
constexpr const char* kDefaultRemedy =
    "correct it, or unset CYCLONEDDS_URI: Handsel then uses deploy/dds/loopback.xml";

double wall_minus_monotonic() {
  timespec wall{}, monotonic{};
  clock_gettime(CLOCK_REALTIME, &wall);
  clock_gettime(CLOCK_MONOTONIC, &monotonic);
  return static_cast<double>(wall.tv_sec - monotonic.tv_sec) +
         static_cast<double>(wall.tv_nsec - monotonic.tv_nsec) * 1e-9;
}

/// Returns the first complaint of the transport on stderr (except about multicast), without its
/// time, thread and process; otherwise the last line.
std::string complaint(const std::string& said) {
  std::istringstream lines(said);
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t bracket = line.find("] "), colon = line.find(": ");
    const bool transport = !line.empty() && std::isdigit(static_cast<unsigned char>(line[0])) &&
                           bracket < colon && colon != std::string::npos;
    if (transport && line.find("not multicast-capable") == std::string::npos)
      return line.substr(colon + 2);
    if (!line.empty()) last = line;
  }
  return last;
}

/// Starts a process that publishes on the domain until it is ended; reports "in" once it has
/// entered.
Probe speaker(int domain, std::uint64_t meeting, std::uint64_t number) {
  return Probe([=](const Probe::Report& report) {
    DdsBus bus(
        {.component = "doctor", .domain = static_cast<std::uint32_t>(domain), .health = false});
    auto publisher = bus.advertise<StateVerdict>();
    bus.every(kSpeak, [&](TimePoint) {
      publisher->publish({.id = {.client = meeting, .number = number}});
    });
    report("in");
    bus.run_until([] { return interrupted(); }, std::chrono::minutes(1));
  });
}

/// Delay between stamp and arrival by this machine's wall clock; the min one is free of queueing.
struct Offset {
  std::uint64_t samples{};
  double min_delay{std::numeric_limits<double>::infinity()};
  void add(Stamp stamp, TimePoint arrival) {
    ++samples;
    min_delay = std::min(min_delay, to_seconds(arrival.time_since_epoch()) +
                                        wall_minus_monotonic() - to_seconds(Duration(stamp)));
  }
};

/// Returns the writers of each topic with one writer: name, and whether the table allows them.
Json writers_of(const DomainView& view) {
  Json out = Json::object();
  for (const DomainEndpoint& end : view.endpoints) {
    const TopicRow* row = end.writes ? find_topic(end.topic) : nullptr;
    if (row == nullptr || !has_one_writer(*row)) continue;
    const std::string name =
        (end.owner.component.empty() ? "process " + end.owner.process : end.owner.component) +
        " (pid " + std::to_string(end.owner.pid) + " on " + end.owner.host + ")";
    // The ROS 2 data path has a separate writer only while it hands over a command.
    if (row == &TopicOf<TrajectoryCommand>::row && end.owner.component == "ros2_lane") continue;
    out[row->topic].push_back(
        {{"who", name}, {"may", end.unmatched.empty() && may_write(*row, end.owner.component)}});
  }
  return out;
}

/// Observation of the domain by one participant during one or two seconds.
class DomainObservation {
 public:
  DomainObservation(const DoctorOptions& options, std::uint64_t meeting, std::size_t speakers)
      : options_(options), meeting_(meeting), speakers_(speakers), session_(options.domain) {
    DdsBus& bus = session_.bus();
    bus.subscribe<StateVerdict>([this](const StateVerdict& verdict, const Receipt&) {
      if (verdict.id.client == meeting_) received_.insert(verdict.id.number);
    });
    bus.subscribe<ComponentHealth>([this](const ComponentHealth& health, const Receipt& receipt) {
      clocks_[health.component].add(health.stamp, receipt.arrival);
    });
    bus.subscribe<SimClock>([this](const SimClock& clock, const Receipt& receipt) {
      halts_.announced(clock, receipt.arrival);
    });
    watch<RobotState>("the robot's state", [this](const RobotState& state) {
      bases_[state.robot] = state.T_world_base;
    });
    watch<HumanObservation>("people",
                            [this](const HumanObservation& seen) { sources_.insert(seen.source); });
    watch<ObjectObservation>(
        "objects", [this](const ObjectObservation& seen) { sources_.insert(seen.source); });
  }

  Json operator()() {
    const double before = wall_minus_monotonic();
    const TimePoint begin = monotonic_now();
    const bool met = session_.wait(kMeet, [this] { return received_.size() >= speakers_; });
    const double took = to_seconds(monotonic_now() - begin);
    session_.listen(kListenTime);
    const double observed = to_seconds(monotonic_now() - begin);
    Json out{{"received", received_.size()},
             {"met", met},
             {"took", took},
             {"jump", wall_minus_monotonic() - before}};
    const SystemStatus status = make_status(session_.snapshot(), session_.bus().now());
    out["system"] = !session_.snapshot().health.empty();
    out["troubles"] = status.troubles;
    out["left_out"] = status.left_out;
    out["clocks"] = Json::object();
    for (const auto& [component, offset] : clocks_) out["clocks"][component] = offset.min_delay;
    out["inputs"] = Json::array();
    for (const Input& input : inputs_) {
      out["inputs"].push_back(
          {{"what", input.what},
           {"topic", input.row->topic},
           {"wanted", input.row->rate},
           {"rate", static_cast<double>(input.status->received) / observed},
           {"rejected", input.status->rejected},
           {"last_rejection", input.status->last_rejection},
           {"least", input.offset->samples ? Json(input.offset->min_delay) : Json()}});
    }
    out["sources"] = sources_;
    out["bases"] = Json::object();
    for (const auto& [robot, T] : bases_)
      out["bases"][robot] = std::vector<double>(T.data(), T.data() + 16);
    const DomainView view = session_.bus().discovered_domain();
    out["commanders"] = Json::array();
    char host[256] = {};
    gethostname(host, sizeof host - 1);
    for (const DomainParticipant& commander : view.commanders)
      out["commanders"].push_back(
          {{"who", commander.component + " (pid " + std::to_string(commander.pid) + " on " +
                       commander.host + ")"},
           {"elsewhere", commander.host != host}});
    out["writers"] = writers_of(view);
    out["strangers"] = Json::array();
    for (const DomainParticipant& one : view.participants)
      if (!one.host.empty() && one.host != host)
        out["strangers"].push_back(one.component + " on " + one.host);
    return out;
  }

 private:
  struct Input {
    const char* what;
    const TopicRow* row;
    const SubscriptionStatus* status;
    std::shared_ptr<Offset> offset = std::make_shared<Offset>();
  };
  template <class M>
  void watch(const char* what, std::function<void(const M&)> handle) {
    auto offset = std::make_shared<Offset>();
    const SubscriptionStatus& status = session_.bus().subscribe<M>(
        [this, offset, handle](const M& message, const Receipt& receipt) {
          offset->add(message.stamp, receipt.arrival - halts_.at(receipt.arrival));
          handle(message);
        });
    inputs_.push_back({what, &TopicOf<M>::row, &status, offset});
  }

  DoctorOptions options_;
  std::uint64_t meeting_;
  std::size_t speakers_;
  Session session_;
  std::set<std::uint64_t> received_;
  SimulatorHalts halts_;
  std::map<std::string, Offset> clocks_;
  std::vector<Input> inputs_;
  std::set<std::string> sources_;
  std::map<std::string, Pose> bases_;
};

Finding check_configuration(const DdsConfiguration& dds) {
  if (!dds.error.empty()) return {"DDS settings", Verdict::missing, dds.error, kDefaultRemedy};
  const std::string source = dds.source.empty() ? "Cyclone's defaults" : dds.source;
  std::size_t largest = 0;
  for (const TopicRow& row : topics()) largest = std::max(largest, row.largest);
  if (dds.max_sample_size && *dds.max_sample_size < largest) {
    return {
        "DDS settings", Verdict::bad,
        finding_text("MaxSampleSize is %.2f MiB in %s; messages of up to %.2f MiB would be dropped",
                     static_cast<double>(*dds.max_sample_size) / (1 << 20), source.c_str(),
                     static_cast<double>(largest) / (1 << 20)),
        "set Internal/MaxSampleSize to 8MiB"};
  }
  if (!dds.max_sample_size) {
    return {
        "DDS settings", Verdict::note,
        "MaxSampleSize is not set in " + source + "; a single hostile message may take all memory",
        "set Internal/MaxSampleSize to 8MiB"};
  }
  return {"DDS settings", Verdict::good, "read from " + source, ""};
}

std::string holders_of_indices(const DoctorOptions& options, int count) {
  std::set<std::string> holders;
  for (int index = 0; index < count; ++index) {
    const std::string holder =
        port_holder("udp", participant_port(static_cast<std::uint32_t>(options.domain), index));
    if (!holder.empty()) holders.insert(holder);
  }
  std::string text;
  for (const std::string& holder : holders) {
    if (text.size() > 80) return text + ", ...";
    text += (text.empty() ? "" : ", ") + holder;
  }
  return text;
}

/// Returns the finding that not every process of a system could enter the domain.
Finding not_entered(const DoctorOptions& options, const DdsConfiguration& dds, std::size_t entered,
                    std::size_t wanted, const std::string& held_before, const std::string& said) {
  const std::string what = complaint(said),
                    no_multicast = said.find("not multicast-capable") == std::string::npos
                                       ? ""
                                       : ", and the interface has no multicast";
  const std::string prefix = (entered == 0 ? "no process"
                                           : "only " + std::to_string(entered) + " of " +
                                                 std::to_string(wanted) + " processes") +
                             " can enter " + domain_text(options.domain) + ": ";
  if (said.find("free participant index") == std::string::npos) {
    if (what.find("join") != std::string::npos) {
      return {"DDS", Verdict::bad,
              prefix + "it cannot join the multicast group of its settings (" + what + ")",
              "set General/AllowMulticast to false and name <Peer address=\"127.0.0.1\"/> under "
              "Discovery/Peers, as "
              "deploy/dds/loopback.xml does"};
    }
    const bool interface = what.find("interface") != std::string::npos;
    return {"DDS", Verdict::bad, prefix + what,
            interface ? "bring the interface up (ip link set lo up), or name another one in the "
                        "DDS configuration"
                      : kDefaultRemedy};
  }
  if (static_cast<std::size_t>(dds.max_auto_index) >= wanted) {
    return {"DDS", Verdict::bad,
            prefix + "all " + std::to_string(dds.max_auto_index) +
                " participant indices are in use" +
                (held_before.empty() ? "" : " by " + held_before),
            "end the processes that hold them, or choose another domain with --domain"};
  }
  return {
      "DDS", Verdict::bad,
      prefix + "MaxAutoParticipantIndex is " + std::to_string(dds.max_auto_index) + no_multicast,
      "set Discovery/MaxAutoParticipantIndex to 60" +
          (dds.source.empty() ? std::string() : " in " + dds.source) +
          ", or unset CYCLONEDDS_URI: deploy/dds/loopback.xml does"};
}

Finding not_met(const DoctorOptions& options, const DdsConfiguration& dds, const Json& seen,
                std::size_t speakers) {
  const std::string text =
      finding_text("%zu of %zu processes on domain %d are found within 3 s",
                   seen["received"].get<std::size_t>(), speakers, options.domain);
  if (dds.peers.empty()) {
    return {"DDS", Verdict::bad,
            text + ": no peer is named and multicast does not reach this machine's own processes",
            "name a peer: <Peer address=\"127.0.0.1\"/> under Discovery/Peers"};
  }
  if (dds.participant_index != "auto") {
    return {"DDS", Verdict::bad,
            text +
                ": peers are asked at the ports of participant indices, but ParticipantIndex is " +
                dds.participant_index,
            "set Discovery/ParticipantIndex to auto"};
  }
  return {"DDS", Verdict::bad,
          text + ": the peers " + dds.peers.front() + (dds.peers.size() > 1 ? ", ..." : "") +
              " do not answer",
          "look whether a firewall drops UDP on the interface, and whether the peers name this "
          "machine"};
}

}  // namespace

std::vector<Finding> check_domain(const DoctorOptions& options) {
  use_default_dds_configuration();
  const char* uri = std::getenv("CYCLONEDDS_URI");
  const DdsConfiguration dds =
      read_dds_configuration(uri ? uri : "", static_cast<std::uint32_t>(options.domain));
  std::vector<Finding> out{check_configuration(dds)};
  if (!dds.error.empty()) return out;

  const bool held = domain_is_held(
      options.domain);  // the processes of the system are already in, and one more is a fair sample
  const std::size_t wanted = held ? 1 : kProcesses.size();
  const std::string held_before = holders_of_indices(options, dds.max_auto_index);
  const auto meeting = static_cast<std::uint64_t>(getpid());
  std::list<Probe> speakers;
  for (std::size_t i = 0; i < wanted; ++i) speakers.push_back(speaker(options.domain, meeting, i));
  std::string said;
  std::erase_if(speakers, [&](Probe& probe) {
    if (probe.line(kEnter)) return false;
    said += probe.said();
    return true;
  });
  const std::size_t entered = speakers.size();
  if (entered < wanted) {
    out.push_back(not_entered(options, dds, entered, wanted, held_before, said));
    if (entered == 0) return out;
    speakers.pop_back();  // frees a place for the observer
  }

  Probe looker([&](const Probe::Report& report) {
    report(DomainObservation(options, meeting, speakers.size())().dump());
  });
  const auto answer = looker.line(kEnter + kMeet + kListenTime);
  for (const Probe& probe : speakers) probe.end();
  if (!answer) {
    if (entered == wanted)
      out.push_back(not_entered(options, dds, entered, wanted + 1, held_before, looker.said()));
    return out;
  }
  const Json seen = Json::parse(*answer);
  if (entered == wanted && !seen["met"].get<bool>())
    out.push_back(not_met(options, dds, seen, speakers.size()));
  if (entered == wanted && seen["met"].get<bool>()) {
    out.push_back(
        {"DDS", Verdict::good,
         finding_text("%zu processes on domain %d found each other after %.0f ms",
                      speakers.size() + 1, options.domain, 1e3 * seen["took"].get<double>()),
         ""});
  }
  add_domain_findings(options, seen, held, out);
  return out;
}

}  // namespace handsel
