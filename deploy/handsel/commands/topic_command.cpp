// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <map>

#include <nlohmann/json.hpp>

#include "common/base/errors.hpp"
#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/system/session.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel {
namespace {

struct TopicOptions {
  int domain{0};
  bool json{false};
  std::string topic;
  double seconds{0.0};
  std::uint64_t count{0};
};

const MessageType& require_type(const std::string& topic) {
  const MessageType* type = find_message_type(topic);
  if (!type)
    throw ConfigError("there is no topic \"" + topic + "\"; `handsel topic list` names them");
  return *type;
}

int list(const TopicOptions& options) {
  const bool json = json_wanted(options.json);
  if (!json)
    std::printf("%-32s %-20s %-9s %6s %9s  %-24s %s\n", "topic", "type", "profile", "Hz",
                "deadline", "writers", "readers");
  for (const TopicRow& row : topics()) {
    if (json) {
      std::printf("%s\n", nlohmann::json{{"topic", row.topic},
                                         {"type", row.type},
                                         {"profile", name(row.profile)},
                                         {"rate_hz", row.rate},
                                         {"deadline_s", row.deadline},
                                         {"largest", row.largest},
                                         {"writers", row.writers},
                                         {"readers", row.readers}}
                              .dump()
                              .c_str());
    } else {
      std::printf("%-32s %-20s %-9s %6.0f %7.0f ms  %-24.24s %s\n", row.topic, row.type,
                  name(row.profile), row.rate, 1e3 * row.deadline, row.writers, row.readers);
    }
  }
  return 0;
}

int echo(const TopicOptions& options) {
  catch_interrupts();
  const MessageType& type = require_type(options.topic);
  Session session(options.domain);
  std::uint64_t seen = 0;
  bool unread = false;
  const auto done = [&] { return unread || (options.count > 0 && seen >= options.count); };
  session.bus().subscribe_any(type,
                              [&](const void* message, const Receipt&) {
                                if (done()) return;
                                std::printf("%s\n", type.to_json(message).c_str());
                                unread = nobody_reads();
                                ++seen;
                              },
                              {});
  session.wait(
      options.seconds > 0 ? from_seconds(options.seconds) : Duration(std::chrono::hours(24 * 365)),
      done);
  if (seen == 0) std::fprintf(stderr, "handsel: nothing came on %s\n", type.row().topic);
  return seen > 0 ? 0 : 1;
}

int rate(const TopicOptions& options) {
  catch_interrupts();
  const MessageType& type = require_type(options.topic);
  Session session(options.domain);
  std::uint64_t count = 0;
  TimePoint first{}, last{};
  Duration max_gap{0}, min_gap = Duration::max();
  session.bus().subscribe_any(type,
                              [&](const void*, const Receipt& receipt) {
                                if (count++ == 0) {
                                  first = receipt.arrival;
                                } else {
                                  max_gap = std::max(max_gap, receipt.arrival - last);
                                  min_gap = std::min(min_gap, receipt.arrival - last);
                                }
                                last = receipt.arrival;
                              },
                              {});
  session.listen(from_seconds(options.seconds > 0 ? options.seconds : 2.0));
  if (count < 2) {
    std::fprintf(stderr, "handsel: %s came on %s\n", count ? "one sample" : "nothing",
                 type.row().topic);
    return 1;
  }
  const double hz = static_cast<double>(count - 1) / to_seconds(last - first);
  if (json_wanted(options.json)) {
    std::printf("%s\n", nlohmann::json{{"topic", type.row().topic},
                                       {"rate_hz", hz},
                                       {"samples", count},
                                       {"min_gap_s", to_seconds(min_gap)},
                                       {"max_gap_s", to_seconds(max_gap)}}
                            .dump()
                            .c_str());
  } else {
    std::printf("%s: %.1f Hz, gaps %.1f to %.1f ms over %llu samples\n", type.row().topic, hz,
                1e3 * to_seconds(min_gap), 1e3 * to_seconds(max_gap),
                static_cast<unsigned long long>(count));
  }
  return 0;
}

}  // namespace

void add_topic_commands(CLI::App& app, int& exit_code) {
  CLI::App* topic = app.add_subcommand("topic", "prints what is sent over DDS");
  topic->require_subcommand(1);
  const auto add = [&](const char* word, const char* help, int (*action)(const TopicOptions&),
                       bool named) {
    auto options = std::make_shared<TopicOptions>();
    CLI::App* command = topic->add_subcommand(word, help);
    command->add_flag("--json", options->json, "print JSON Lines");
    if (named) {
      add_domain_option(*command, options->domain);
      command->add_option("topic", options->topic, "topic or message type, e.g. robot_state")
          ->required();
      command->add_option("--seconds", options->seconds, "duration [s]")->check(kAboveZero);
      if (action == echo) command->add_option("--count", options->count, "max number of samples");
    }
    command->callback([options, action, &exit_code] { exit_code = action(*options); });
  };
  add("list", "prints each topic with its type, profile, rate, writers and readers", list, false);
  add("echo", "prints each sample as one line of JSON", echo, true);
  add("hz", "measures the rate of samples", rate, true);
}

}  // namespace handsel
