// SPDX-License-Identifier: Apache-2.0
// Feeds what came in from outside, as it was recorded, into a running system once more.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/dds/cdr.hpp"
#include "common/record/mcap.hpp"

namespace handsel {

/// Topics by which the world outside is known: robot state, observations of people and things.
/// Goals are none: a recorded robot does not follow a new plan.
std::vector<std::string> input_topics();

/// Name of the participant that replays these topics (empty: input_topics()): "replay" and a
/// component that may write each of those with one writer, in whose place it speaks.
std::string replay_name(const std::vector<std::string>& topics);

/// Every sample of the chosen topics, in their order and at their pace, stamped as if it were now.
class Replay {
 public:
  struct Settings {
    std::filesystem::path file;       ///< MCAP recording of Recorder or LocalRecording
    std::vector<std::string> topics;  ///< names; empty: input_topics()
    double from{};                    ///< [s] of the recording; what is earlier is left out
  };
  /// Throws MissingError / ConfigError for a file that cannot be read or was recorded with another
  /// IDL, and for unknown topics.
  Replay(Bus& bus, const Settings& settings);

  /// Reads on to the next sample to send; false at the end of the recording. Throws ConfigError for
  /// a damaged file.
  bool advance();
  /// When the sample at hand is due, after the begin of the replay [s].
  double due() const;
  /// Sends it, stamped `began` + due().
  void send(Stamp began);

  struct Count {
    /// Samples published; samples that were malformed or found no room.
    std::uint64_t sent{}, refused{};
    std::string refusal;  ///< why the first was
  };
  /// By topic, those replayed only.
  const std::map<std::string, Count>& counts() const { return counts_; }
  /// Returns true after the end when the recording has no regular end.
  bool cut() const { return reader_.cut(); }

 private:
  struct Channel {
    const MessageType* type{};
    std::unique_ptr<AnyPublisher> out;
    std::shared_ptr<void> wire, message;
  };
  mcap::Reader reader_;
  CdrCodec codec_;
  std::map<std::uint16_t, Channel> channels_;  ///< by channel of the file
  std::map<std::string, Count> counts_;
  mcap::Message sample_;
  double from_;
  std::int64_t begin_{-1};  ///< time of the first message of all [ns]
};

}  // namespace handsel
