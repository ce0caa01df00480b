// SPDX-License-Identifier: Apache-2.0
// Recordings in the MCAP container, version 0 (mcap.dev/spec): messages in chunks with their
// indexes, so that Lichtblick, Foxglove and the `mcap` tools open them. Uncompressed. The container
// only: what a message means is defined by its channel's schema.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace handsel::mcap {

struct Channel {
  std::string topic;            ///< "handsel/robot_state"
  std::string encoding;         ///< of messages: "cdr"
  std::string schema_name;      ///< "handsel::RobotState"
  std::string schema_encoding;  ///< "omgidl"
  std::string schema;           ///< its text
};

struct Message {
  std::uint16_t channel{};         ///< index in the list of channels
  std::int64_t time{};             ///< when it was written [ns, system clock], >= 0
  std::vector<std::uint8_t> data;  ///< serialised sample, in the encoding of its channel
};

using Metadata = std::map<std::string, std::string>;

/// Writes one file. Messages for which flush() has returned are readable whatever happens to the
/// process; close() adds the summary, with which a reader finds data without reading the whole
/// file.
class Writer {
 public:
  /// Throws ConfigError when the file is there already or cannot be written.
  Writer(const std::filesystem::path& file, const std::vector<Channel>& channels,
         const Metadata& metadata);
  ~Writer();  ///< closes; what cannot be written then is lost in silence
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Throws ConfigError when the disk refuses, std::logic_error for a channel that was not
  /// announced.
  void write(const Message& message);
  /// Ends the chunk and hands it to the system. Throws ConfigError when the disk refuses.
  void flush();
  void close();  ///< as flush()
  /// Returns the number of messages written, those of the open chunk included.
  std::uint64_t messages() const { return messages_; }
  /// Returns the size of the file so far [bytes], without the open chunk.
  std::uint64_t bytes() const { return written_; }

 private:
  struct ChunkPlace;
  void put(const std::string& bytes);

  std::filesystem::path file_;
  std::ofstream out_;
  std::uint64_t written_{}, messages_{};
  // records of schemas and channels, at the begin of the file and in its summary
  std::string announced_;
  std::string metadata_index_;
  std::string chunk_;  // records of the chunk that is being filled
  // of the chunk: time and offset
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;
  std::vector<ChunkPlace> chunks_;
  std::vector<std::uint64_t> counts_;
  std::vector<std::uint32_t> sequences_;
  std::uint64_t first_{}, last_{};
  bool open_{};
};

/// Reads one file from its begin to its end, and what was written before a sudden end.
class Reader {
 public:
  /// Throws MissingError when there is no such file, ConfigError naming file and place when it is
  /// no MCAP file.
  explicit Reader(const std::filesystem::path& file);

  /// Reads the next message, in order of time within a chunk; false at the end. Throws ConfigError
  /// naming file and position for data that are damaged, compressed or of an unknown channel.
  bool next(Message& out);
  /// Channels by their number in the file, of those read so far.
  const std::map<std::uint16_t, Channel>& channels() const { return channels_; }
  /// Returns the metadata read so far; complete after construction for files of Writer.
  const Metadata& metadata() const { return metadata_; }
  /// After the end: the file ends within a record, or without its closing one.
  bool cut() const { return cut_; }

 private:
  struct Record;
  bool read(Record& record);
  void take(const Record& record);
  void take_chunk(const Record& record);
  [[noreturn]] void damaged(std::uint64_t at, const std::string& what) const;

  std::filesystem::path file_;
  std::ifstream in_;
  std::uint64_t size_{}, at_{};
  std::map<std::uint16_t, Channel> schemas_, channels_;
  Metadata metadata_;
  std::vector<Message> waiting_;  // of the chunk read last
  std::size_t next_{};
  bool ended_{}, cut_{};
};

}  // namespace handsel::mcap
