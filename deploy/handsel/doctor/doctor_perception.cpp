// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include <nlohmann/json.hpp>

#include "common/bus/executor.hpp"
#include "common/config/resources.hpp"
#include "common/config/scenario.hpp"
#include "common/config/search_path.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/system.hpp"
#include "common/messages/world.hpp"
#include "components/spark/scene_model.hpp"
#include "deploy/handsel/doctor/doctor.hpp"
#include "deploy/handsel/doctor/halts.hpp"
#include "deploy/handsel/doctor/perception_review.hpp"
#include "deploy/handsel/doctor/probe.hpp"
#include "deploy/handsel/system/processes.hpp"
#include "deploy/handsel/system/session.hpp"
#include "sim/scene/scene_setup.hpp"

namespace handsel {
namespace {

using Json = nlohmann::json;

constexpr Duration kObservationTime = std::chrono::milliseconds(2500);
constexpr Duration kStart =
    std::chrono::milliseconds(600);  // until all participants are discovered
constexpr Duration kChildTimeout = std::chrono::seconds(20);
constexpr std::size_t kLikeness = 3;  // max edit distance of similar names

/// Reads a message of the table from any writer of its topic, without the deadline and the type
/// equality that components require; reports malformed samples.
class Lenient final : public MessageType {
 public:
  using OnMalformed = std::function<void(const std::string& why, bool whole)>;
  Lenient(const MessageType& type, OnMalformed on_malformed)
      : type_(type), row_(type.row()), on_malformed_(std::move(on_malformed)) {
    row_.profile = Profile::sensor;
    row_.deadline = 0;
  }
  const TopicRow& row() const override { return row_; }
  const void* descriptor() const override { return type_.descriptor(); }
  bool to_wire(const void* message, Stamp now, void* wire, std::string& why) const override {
    return type_.to_wire(message, now, wire, why);
  }
  using MessageType::from_wire;
  bool from_wire(const void* wire, void* message, std::string& why,
                 LeftOutElements& left_out) const override {
    const bool good = type_.from_wire(wire, message, why, left_out);
    if (!good) on_malformed_(why, true);
    if (good && left_out.count > 0) on_malformed_(left_out.why, false);
    return good;
  }
  Stamp stamp(const void* wire) const override { return type_.stamp(wire); }
  void set_stamp(void* wire, Stamp stamp) const override { type_.set_stamp(wire, stamp); }
  std::string_view key(const void* wire) const override { return type_.key(wire); }
  std::string to_json(const void* message) const override { return type_.to_json(message); }
  void leaves(void* wire, const std::function<void(const WireLeaf&)>& visit) const override {
    type_.leaves(wire, visit);
  }
  void fill(void* wire, bool full) const override { type_.fill(wire, full); }
  std::shared_ptr<void> new_wire() const override { return type_.new_wire(); }
  std::shared_ptr<void> new_message() const override { return type_.new_message(); }

 private:
  const MessageType& type_;
  TopicRow row_;
  OnMalformed on_malformed_;
};

std::string plain(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)))
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// Returns the edit distance: letters to change, add or omit.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
      diagonal = above;
    }
  }
  return row[b.size()];
}

bool meant(const DomainEndpoint& endpoint, const TopicRow& row) {
  if (endpoint.topic == row.topic || find_topic(endpoint.topic) != nullptr) return false;
  const std::string type = endpoint.type.substr(
      endpoint.type.rfind(':') == std::string::npos ? 0 : endpoint.type.rfind(':') + 1);
  const std::string topic = plain(endpoint.topic),
                    subject = plain(
                        std::string_view(row.topic).substr(std::string_view("handsel/").size()));
  return type == row.type || topic.find(subject) != std::string::npos ||
         distance(topic, plain(row.topic)) <= kLikeness;
}

std::string writer_text(const DomainEndpoint& endpoint) {
  const DomainParticipant& owner = endpoint.owner;
  const std::string name = !owner.component.empty() ? owner.component
                           : !owner.process.empty() ? owner.process
                                                    : "somebody";
  const std::string process = std::filesystem::path(name).filename();
  return process +
         (owner.pid > 0 ? " (pid " + std::to_string(owner.pid) + " on " + owner.host + ")" : "");
}

bool is_ours(const DomainEndpoint& endpoint) {
  return std::find(kProcesses.begin(), kProcesses.end(), endpoint.owner.component) !=
         kProcesses.end();
}

Finding bad(const std::string& subject, const std::string& text, const std::string& remedy) {
  return {subject, Verdict::bad, text, remedy};
}

/// Reports writers that no component can receive, with the reason. `received`: number of writers on
/// the topic that the doctor itself receives.
void check_writers_of(const DomainView& view, const TopicRow& row, int received,
                      std::vector<Finding>& out) {
  const std::string type = std::string("handsel::") + row.type;
  std::vector<const DomainEndpoint*> right;
  for (const DomainEndpoint& endpoint : view.endpoints) {
    if (!endpoint.writes) continue;
    if (meant(endpoint, row)) {
      out.push_back(bad("topic",
                        writer_text(endpoint) + " writes the topic " + endpoint.topic +
                            ", which no process reads",
                        std::string("the topic is ") + row.topic + ", its type " + type));
    }
    if (endpoint.topic != row.topic) continue;
    if (endpoint.type != type) {
      out.push_back(
          bad("type",
              writer_text(endpoint) + " writes " + row.topic + " with the type " + endpoint.type,
              "the type is " + type));
      continue;
    }
    for (const std::string& policy : endpoint.unmatched)
      out.push_back(bad(
          "QoS",
          "no process receives " + writer_text(endpoint) + " on " + row.topic + ": its " + policy,
          "profile sensor: best effort, volatile, keep last 1, deadline 0.2 s, no partition"));
    if (endpoint.unmatched.empty()) right.push_back(&endpoint);
  }
  if (received >= static_cast<int>(right.size())) return;
  for (const DomainEndpoint* endpoint : right)
    if (!is_ours(*endpoint)) {
      out.push_back(
          bad("IDL",
              writer_text(*endpoint) + " writes " + type + " of another shape than this version's",
              "build it against the IDL of this version (idl/perception.idl, interface version in "
              "`handsel --version`)"));
    }
}

bool has_reader(const DomainView& view, const TopicRow& row) {
  return std::any_of(view.endpoints.begin(), view.endpoints.end(),
                     [&](const DomainEndpoint& endpoint) {
                       return !endpoint.writes && endpoint.topic == row.topic &&
                              endpoint.owner.component == "spark";
                     });
}

/// Returns pose and reach of the robot from the scenario's descriptions, as SPARK computes them.
PerceptionGround ground_of(const DoctorOptions& options) {
  PerceptionGround ground;
  const std::uint64_t seed = SystemOptions{}.seed;
  const config::Scenario scenario = read_scenario(scenario_file(options.scenario), seed);
  const RobotModel robot = RobotModel::load(robot_description(
      options.robot.empty() ? scenario_robot(options.scenario, seed) : options.robot));
  ground.base = sim::pose_of(scenario.base()).translation();
  ground.reach = spark::reach_of(robot, ground.base);
  for (const auto& file : all_files(FileKind::object)) ground.models.insert(file.stem());
  return ground;
}

std::vector<Finding> look(const DoctorOptions& options) {
  PerceptionReview review(ground_of(options));
  const Lenient humans(message_type<HumanObservation>(), [&](const std::string& why, bool whole) {
    review.on_malformed(TopicOf<HumanObservation>::row.topic, why, whole);
  });
  const Lenient objects(message_type<ObjectObservation>(), [&](const std::string& why, bool whole) {
    review.on_malformed(TopicOf<ObjectObservation>::row.topic, why, whole);
  });
  DdsBus bus({.component = "doctor",
              .domain = static_cast<std::uint32_t>(options.domain),
              .health = false});
  SimulatorHalts halts;
  bus.subscribe<SimClock>([&](const SimClock& clock, const Receipt& receipt) {
    halts.announced(clock, receipt.arrival);
  });
  bool counts = false;
  std::set<std::string> received;
  const auto watch = [&]<class M>(const Lenient& type, const std::string& topic,
                                  M*) -> const SubscriptionStatus& {
    return bus.subscribe_any(type,
                             [&, topic](const void* message, const Receipt& receipt) {
                               received.insert(topic);
                               if (counts)
                                 review.on(*static_cast<const M*>(message), receipt.arrival,
                                           bus.stamp_now() - halts.at(receipt.arrival).count());
                             },
                             {});
  };
  const SubscriptionStatus& of_people =
      watch(humans, TopicOf<HumanObservation>::row.topic, static_cast<HumanObservation*>(nullptr));
  const SubscriptionStatus& of_objects = watch(objects, TopicOf<ObjectObservation>::row.topic,
                                               static_cast<ObjectObservation*>(nullptr));
  bus.every(std::chrono::milliseconds(20), [](TimePoint) {});
  const TimePoint begin = bus.now();
  bus.run_until(
      [&] { return interrupted() || (received.size() == 2 && bus.now() - begin > kStart / 3); },
      kStart);
  counts = true;
  bus.run_until([] { return interrupted(); }, kObservationTime);

  const DomainView view = bus.discovered_domain();
  std::vector<Finding> out;
  std::vector<Finding> silent;
  bool reader = false;
  for (const auto& [row, status, what] :
       {std::tuple{&TopicOf<HumanObservation>::row, &of_people, "people"},
        std::tuple{&TopicOf<ObjectObservation>::row, &of_objects, "objects"}}) {
    const std::size_t before = out.size();
    check_writers_of(view, *row, status->writers, out);
    reader = reader || has_reader(view, *row);
    if (status->received + status->rejected > 0 || out.size() > before) continue;
    const bool writer = std::any_of(view.endpoints.begin(), view.endpoints.end(),
                                    [r = row](const DomainEndpoint& e) {
                                      return e.writes && e.topic == r->topic && !is_ours(e);
                                    });
    silent.push_back(
        {"inputs", Verdict::missing,
         std::string("nothing comes on ") + row->topic + " of domain " +
             std::to_string(options.domain),
         writer
             ? "its writer is there but silent: publish at an even rate, also while nobody is there"
             : std::string("start the program that measures ") + what + " on this domain"});
  }
  for (Finding& finding : silent) {
    if (silent.size() == 1)
      finding.verdict = Verdict::note;  // people alone, or objects alone, may be intended
    out.push_back(std::move(finding));
  }
  for (Finding& finding : review.findings()) out.push_back(std::move(finding));
  if (!reader)
    out.push_back({"readers", Verdict::note,
                   "no process reads people or objects yet: no system runs on domain " +
                       std::to_string(options.domain),
                   "start one with `handsel up`; the published samples were checked nevertheless"});
  return out;
}

Json to_json(const Finding& finding) {
  return {{"subject", finding.subject},
          {"verdict", static_cast<int>(finding.verdict)},
          {"text", finding.text},
          {"remedy", finding.remedy}};
}

}  // namespace

std::vector<Finding> check_perception(const DoctorOptions& options) {
  use_default_dds_configuration();
  Probe probe([&](const Probe::Report& report) {
    for (const Finding& finding : look(options))
      report(to_json(finding).dump(-1, ' ', false, Json::error_handler_t::replace));
    report("end");
  });
  std::vector<Finding> out;
  const TimePoint deadline = monotonic_now() + kChildTimeout;
  for (;;) {
    const auto line = probe.line(deadline - monotonic_now());
    if (!line) {
      out.push_back({"DDS", Verdict::bad,
                     "perception on domain " + std::to_string(options.domain) +
                         " could not be checked: " + probe.said(),
                     "`handsel doctor` without --inputs-only says what is wrong with DDS here"});
      return out;
    }
    if (*line == "end") return out;
    const Json finding = Json::parse(*line);
    out.push_back({finding["subject"], static_cast<Verdict>(finding["verdict"].get<int>()),
                   finding["text"], finding["remedy"]});
  }
}

}  // namespace handsel
