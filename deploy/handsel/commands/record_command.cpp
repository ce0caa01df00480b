// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <set>

#include <nlohmann/json.hpp>

#include "common/base/errors.hpp"
#include "common/wire/interface_id.hpp"
#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/cli/finite_options.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/recording/recorder.hpp"
#include "deploy/handsel/recording/replay.hpp"
#include "deploy/handsel/system/session.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel {
namespace {

struct RecordOptions {
  int domain{0};
  std::string file;
  double seconds{0.0};
};

struct ReplayOptions {
  int domain{0};
  bool json{false};
  Replay::Settings what;
};

int record(const RecordOptions& options) {
  catch_interrupts();
  DdsBus bus({.component = "recorder",
              .domain = static_cast<std::uint32_t>(options.domain),
              .health = false});
  Recorder recorder(bus, options.file,
                    {{"domain", std::to_string(options.domain)}, {"version", version_text()}});
  bus.every(Recorder::kPollPeriod, [&](TimePoint) { recorder.poll(); });
  std::fprintf(stderr, "recording DDS domain %d into %s; Ctrl-C ends it\n", options.domain,
               options.file.c_str());
  bus.run_until([] { return interrupted(); }, options.seconds > 0
                                                  ? from_seconds(options.seconds)
                                                  : Duration(std::chrono::hours(24 * 365)));
  recorder.close();
  std::fprintf(stderr, "%s: %s\n", options.file.c_str(), amount(recorder.file()).c_str());
  if (recorder.file().messages() == 0)
    std::fprintf(stderr, "handsel: nothing was said on domain %d\n", options.domain);
  return recorder.file().messages() > 0 ? 0 : 1;
}

/// Refuses a replay of topics that have a live writer: a robot must not receive two states, a
/// system not two observations.
void require_silence(DdsBus& bus, const std::vector<std::string>& topics) {
  bus.run_until([] { return interrupted(); },
                std::chrono::milliseconds(1500));  // until all participants are discovered
  const std::set<std::string> fed(topics.begin(), topics.end());
  for (const DomainEndpoint& end : bus.discovered_domain().endpoints) {
    const TopicRow* row = end.writes ? find_topic(end.topic) : nullptr;
    if (!row || (row->profile != Profile::sensor && !has_one_writer(*row)) ||
        is_of_all_systems(*row) || !fed.contains(row->topic))
      continue;
    throw ConfigError((end.owner.component.empty() ? "process " + std::to_string(end.owner.pid)
                                                   : end.owner.component) +
                      " writes " + row->topic +
                      " already; start the system with `handsel up --without sim`, or choose "
                      "others with --topics");
  }
}

int replay(const ReplayOptions& options) {
  catch_interrupts();
  DdsBus bus({.component = replay_name(options.what.topics),
              .domain = static_cast<std::uint32_t>(options.domain),
              .health = false});
  Replay replay(bus, options.what);
  std::vector<std::string> fed;
  for (const auto& [topic, count] : replay.counts()) fed.push_back(topic);
  require_silence(bus, fed);
  const TimePoint start = bus.now();
  const Stamp began = bus.stamp_now();
  double length = 0;
  while (!interrupted() && replay.advance()) {
    length = replay.due();
    bus.run_until([] { return interrupted(); }, start + from_seconds(length) - bus.now());
    if (!interrupted()) replay.send(began);
  }
  nlohmann::json topics = nlohmann::json::object();
  std::uint64_t sent = 0;
  for (const auto& [topic, count] : replay.counts()) {
    sent += count.sent;
    topics[topic] = {{"sent", count.sent}, {"refused", count.refused}};
    if (count.refused > 0)
      std::fprintf(stderr, "handsel: %s: %llu refused: %s\n", topic.c_str(),
                   static_cast<unsigned long long>(count.refused), count.refusal.c_str());
  }
  if (replay.cut())
    std::fprintf(stderr, "handsel: %s was not ended in order; what is in it was replayed\n",
                 options.what.file.c_str());
  if (json_wanted(options.json)) {
    std::printf("%s\n", nlohmann::json{{"duration_s", length}, {"topics", topics}}.dump().c_str());
  } else {
    std::printf("%.1f s replayed\n", length);
    for (const auto& [topic, count] : replay.counts())
      std::printf("  %-32s %8llu\n", topic.c_str(), static_cast<unsigned long long>(count.sent));
  }
  return sent > 0 ? 0 : 1;
}

}  // namespace

void add_record_commands(CLI::App& app, int& exit_code) {
  auto recorded = std::make_shared<RecordOptions>();
  CLI::App* command =
      app.add_subcommand("record", "records all messages on a domain into an MCAP file");
  command->add_option("file", recorded->file, "file to write, e.g. today.mcap; must not exist")
      ->required();
  add_domain_option(*command, recorded->domain);
  command
      ->add_option("--seconds", recorded->seconds,
                   "duration of the recording [s] (default: until Ctrl-C)")
      ->check(kAboveZero);
  command->callback([recorded, &exit_code] { exit_code = record(*recorded); });

  auto replayed = std::make_shared<ReplayOptions>();
  command = app.add_subcommand(
      "replay",
      "sends the recorded robot states and observations to a system that was started without sim");
  command->add_option("file", replayed->what.file, "MCAP file written by `handsel record`")
      ->required();
  add_domain_option(*command, replayed->domain);
  command
      ->add_option("--from", replayed->what.from,
                   "time of the recording at which the replay begins [s]")
      ->check(kNotNegative);
  command
      ->add_option(
          "--topics", replayed->what.topics,
          "topics to send instead of robot states and observations, e.g. human_observation")
      ->delimiter(',');
  command->add_flag("--json", replayed->json, "print the numbers of sent messages as JSON");
  command->callback([replayed, &exit_code] { exit_code = replay(*replayed); });
}

}  // namespace handsel
