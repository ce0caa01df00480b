// SPDX-License-Identifier: Apache-2.0
// Records the samples of a domain into a file, unchanged, with the IDL that defines their meaning.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/dds/cdr.hpp"
#include "common/bus/dds/raw.hpp"
#include "common/bus/local_bus.hpp"
#include "common/record/mcap.hpp"

namespace handsel {

class DdsBus;

/// A channel for each row of the table of topics, in its order.
std::vector<mcap::Channel> recorded_channels();

/// Every topic of a domain, from construction on. On the bus's own thread.
class Recorder {
 public:
  /// Throws ConfigError when the file is there already or cannot be written, MissingError when the
  /// transport refuses.
  Recorder(RawBus& bus, const std::filesystem::path& file, const mcap::Metadata& metadata);

  /// Takes the samples that came, at least every kPollPeriod, or fast topics lose samples. Throws
  /// ConfigError when the disk refuses.
  void poll();
  /// Takes the last samples and ends the file. Throws ConfigError when the disk refuses.
  void close();
  const mcap::Writer& file() const { return file_; }  ///< for its counts

  /// Longest time between two calls of look().
  static constexpr Duration kPollPeriod = std::chrono::milliseconds(20);

 private:
  mcap::Writer file_;
  std::vector<std::unique_ptr<RawReader>> readers_;  ///< in the order of the table
  std::vector<mcap::Message> batch_;
  TimePoint flushed_{};
};

/// Records what a command performs, when a file was named: takes samples by itself while the
/// session's bus runs. A disk that refuses ends the recording, reported on stderr once, and nothing
/// else.
class Recording {
 public:
  /// `file` empty: does nothing. Throws as Recorder.
  Recording(DdsBus& bus, const std::filesystem::path& file, const mcap::Metadata& metadata);
  ~Recording();  ///< ends the file and says on stderr what is in it
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

 private:
  struct State;
  /// The bus's timer outlives this and knows it weakly; null: nothing is recorded.
  std::shared_ptr<State> state_;
};

/// Every sample of a network in virtual time, stamped with that.
class LocalRecording {
 public:
  /// As Recorder.
  LocalRecording(LocalNetwork& network, const std::filesystem::path& file,
                 const mcap::Metadata& metadata);
  ~LocalRecording();
  LocalRecording(const LocalRecording&) = delete;
  LocalRecording& operator=(const LocalRecording&) = delete;
  /// Ends the file. Throws ConfigError when the disk refuses.
  void close();

 private:
  LocalNetwork& network_;
  mcap::Writer file_;
  CdrCodec codec_;
};

/// "12 345 messages, 6.7 MB".
std::string amount(const mcap::Writer& file);

}  // namespace handsel
