// SPDX-License-Identifier: Apache-2.0
#include <boost/crc.hpp>

#include <algorithm>
#include <cerrno>
#include <stdexcept>

#include "common/base/errors.hpp"
#include "common/record/mcap.hpp"
#include "common/record/mcap_format.hpp"

namespace handsel::mcap {
namespace {

constexpr std::size_t kChunk = 1 << 20;  // min size of a completed chunk [bytes]

std::string map_record(const Metadata& map) {
  std::string entries, out;
  for (const auto& [key, value] : map) {
    append_text(entries, key);
    append_text(entries, value);
  }
  append_text(out, entries);
  return out;
}

}  // namespace

std::uint32_t crc32(std::string_view bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

struct Writer::ChunkPlace {
  std::uint64_t first{}, last{}, offset{}, length{}, index_length{}, size{};
  std::map<std::uint16_t, std::uint64_t> indexes;  ///< offset of the index of each channel
};

Writer::Writer(const std::filesystem::path& file, const std::vector<Channel>& channels,
               const Metadata& metadata)
    : file_(file), counts_(channels.size()), sequences_(channels.size()) {
  if (std::filesystem::exists(file))
    throw ConfigError(file.string() + " is there already; a recording overwrites nothing");
  out_.open(file, std::ios::binary);
  if (!out_) throw ConfigError("cannot write " + file.string() + ": " + std::strerror(errno));
  open_ = true;
  std::string head(kMagic), content;
  append_text(content, "");
  append_text(content, "handsel");
  append_record(head, Op::header, content);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    content.clear();
    append(content, static_cast<std::uint16_t>(i + 1));  // 0 means none
    append_text(content, channels[i].schema_name);
    append_text(content, channels[i].schema_encoding);
    append_text(content, channels[i].schema);
    append_record(announced_, Op::schema, content);
    content.clear();
    append(content, static_cast<std::uint16_t>(i));
    append(content, static_cast<std::uint16_t>(i + 1));
    append_text(content, channels[i].topic);
    append_text(content, channels[i].encoding);
    append_text(content, "");
    append_record(announced_, Op::channel, content);
  }
  head += announced_;
  content.clear();
  append_text(content, "handsel");
  content += map_record(metadata);
  const std::uint64_t offset = head.size();
  append_record(head, Op::metadata, content);
  std::string place;
  append(place, offset);
  append(place, static_cast<std::uint64_t>(head.size()) - offset);
  append_text(place, "handsel");
  append_record(metadata_index_, Op::metadata_index, place);
  put(head);
  out_.flush();
}

Writer::~Writer() {
  try {
    close();
  } catch (const std::exception&) {
    return;  // no receiver of the error is left
  }
}

void Writer::put(const std::string& bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out_.flush();
  if (!out_) {
    open_ = false;
    throw ConfigError("cannot write " + file_.string() + ": " + std::strerror(errno));
  }
  written_ += bytes.size();
}

void Writer::write(const Message& message) {
  if (!open_) throw std::logic_error("the recording is closed");
  if (message.channel >= counts_.size())
    throw std::logic_error("no channel " + std::to_string(message.channel) + " was announced");
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(0, message.time));
  index_[message.channel].emplace_back(time, chunk_.size());
  std::string head;
  append(head, message.channel);
  append(head, sequences_[message.channel]++);
  append(head, time);
  append(head, time);  // log time and publish time: the same clock
  append(chunk_, Op::message);
  append(chunk_, static_cast<std::uint64_t>(head.size() + message.data.size()));
  chunk_ += head;
  chunk_.append(message.data.begin(), message.data.end());
  first_ = messages_ == 0 ? time : std::min(first_, time);
  last_ = std::max(last_, time);
  ++messages_;
  ++counts_[message.channel];
  if (chunk_.size() >= kChunk) flush();
}

void Writer::flush() {
  if (!open_ || chunk_.empty()) return;
  ChunkPlace place;
  place.first = index_.begin()->second.front().first;
  place.offset = written_;
  place.size = chunk_.size();
  for (auto& [channel, entries] : index_) {
    std::sort(entries.begin(), entries.end());
    place.first = std::min(place.first, entries.front().first);
    place.last = std::max(place.last, entries.back().first);
  }
  std::string content, out;
  append(content, place.first);
  append(content, place.last);
  append(content, place.size);
  append(content, crc32(chunk_));
  append_text(content, "");
  append(content, place.size);
  content += chunk_;
  append_record(out, Op::chunk, content);
  place.length = out.size();
  for (const auto& [channel, entries] : index_) {
    place.indexes[channel] = written_ + out.size();
    content.clear();
    append(content, channel);
    append(content, static_cast<std::uint32_t>(16 * entries.size()));
    for (const auto& [time, offset] : entries) {
      append(content, time);
      append(content, offset);
    }
    append_record(out, Op::message_index, content);
  }
  place.index_length = out.size() - place.length;
  put(out);
  chunks_.push_back(place);
  chunk_.clear();
  index_.clear();
}

void Writer::close() {
  if (!open_) return;
  flush();
  std::string out, content;
  append(content, std::uint32_t{0});  // no checksum of the file
  append_record(out, Op::data_end, content);

  struct Group {
    Op op;
    std::uint64_t start, length;
  };
  std::vector<Group> groups;
  const std::uint64_t summary = written_ + out.size();
  const auto group = [&](Op op, const std::string& records) {
    if (!records.empty()) groups.push_back({op, written_ + out.size(), records.size()});
    out += records;
  };
  // The schemas and channels are adjacent, so that no separate offset is needed.
  out += announced_;
  std::string records;
  for (const ChunkPlace& chunk : chunks_) {
    content.clear();
    for (const std::uint64_t number : {chunk.first, chunk.last, chunk.offset, chunk.length})
      append(content, number);
    append(content, static_cast<std::uint32_t>(10 * chunk.indexes.size()));
    for (const auto& [channel, offset] : chunk.indexes) {
      append(content, channel);
      append(content, offset);
    }
    append(content, chunk.index_length);
    append_text(content, "");
    append(content, chunk.size);
    append(content, chunk.size);
    append_record(records, Op::chunk_index, content);
  }
  group(Op::chunk_index, records);
  content.clear();
  append(content, messages_);
  append(content, static_cast<std::uint16_t>(counts_.size()));
  append(content, static_cast<std::uint32_t>(counts_.size()));
  append(content, std::uint32_t{0});
  append(content, std::uint32_t{1});
  append(content, static_cast<std::uint32_t>(chunks_.size()));
  append(content, first_);
  append(content, last_);
  append(content, static_cast<std::uint32_t>(10 * counts_.size()));
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    append(content, static_cast<std::uint16_t>(i));
    append(content, counts_[i]);
  }
  records.clear();
  append_record(records, Op::statistics, content);
  group(Op::statistics, records);
  group(Op::metadata_index, metadata_index_);

  const std::uint64_t offsets = written_ + out.size();
  for (const Group& one : groups) {
    content.clear();
    append(content, one.op);
    append(content, one.start);
    append(content, one.length);
    append_record(out, Op::summary_offset, content);
  }
  content.clear();
  append(content, summary);
  append(content, offsets);
  append(content, std::uint32_t{0});  // no checksum of the summary
  append_record(out, Op::footer, content);
  out += kMagic;
  put(out);
  out_.close();
  open_ = false;
}

}  // namespace handsel::mcap
