// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/base/errors.hpp"
#include "common/record/mcap.hpp"
#include "common/record/mcap_format.hpp"

namespace handsel::mcap {
namespace {

constexpr std::uint64_t kHead = 9;  // size of a record header: type and length [bytes]
constexpr std::uint64_t kEarliestMagic = kMagic.size();
constexpr std::uint64_t kMaxRecord =
    256u << 20;  // max size of a record read into memory; chunks have a few MB [bytes]
constexpr std::size_t kMaxMessages = 1'000'000;  // max messages of one chunk

/// Returns whether the reader uses a record of this type; others are skipped unread.
bool is_used(Op op) {
  return op == Op::schema || op == Op::channel || op == Op::metadata || op == Op::message ||
         op == Op::chunk || op == Op::data_end;
}

/// Reads the fields of a record's content in sequence; `short_of` is set once data is missing.
class Fields {
 public:
  explicit Fields(std::string_view bytes) : bytes_(bytes) {}
  template <class Number>
  Number number() {
    Number value{};
    const std::string_view raw = part(sizeof value);
    if (!short_) std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }
  std::string_view text() { return part(number<std::uint32_t>()); }
  std::string_view part(std::uint64_t size) {
    if (short_ || size > bytes_.size()) {
      short_ = true;
      return {};
    }
    const std::string_view out = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return out;
  }
  std::string_view rest() const { return bytes_; }
  bool empty() const { return bytes_.empty() || short_; }
  bool short_of() const { return short_; }

 private:
  std::string_view bytes_;
  bool short_{};
};

}  // namespace

struct Reader::Record {
  Op op{};
  std::uint64_t at{};  ///< start in the file [bytes]
  std::string content;
};

void Reader::damaged(std::uint64_t at, const std::string& what) const {
  throw ConfigError(file_.string() + ": at byte " + std::to_string(at) + ": " + what);
}

Reader::Reader(const std::filesystem::path& file) : file_(file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw MissingError("no recording " + file.string());
  if (!std::filesystem::is_regular_file(file, error))
    throw ConfigError(file.string() + " is not a file");
  in_.open(file, std::ios::binary);
  if (!in_) throw MissingError("cannot read " + file.string());
  size_ = std::filesystem::file_size(file);
  std::string magic(kEarliestMagic, '\0');
  in_.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (!in_ || magic != kMagic)
    throw ConfigError(file.string() + " is no MCAP recording: it does not begin like one");
  at_ = kMagic.size();
  // Records before the first chunk: channels and metadata of the file.
  Record record;
  while (waiting_.empty() && !ended_ && read(record)) take(record);
}

bool Reader::read(Record& record) {
  char head[kHead];
  if (size_ - at_ >= kHead) in_.read(head, kHead);
  if (size_ - at_ < kHead || !in_) {
    ended_ = cut_ = true;
    return false;
  }
  std::uint64_t length = 0;
  std::memcpy(&record.op, head, 1);
  std::memcpy(&length, head + 1, sizeof length);
  record.at = at_;
  if (length > size_ - at_ - kHead) {
    ended_ = cut_ = true;
    return false;
  }
  if (!is_used(record.op)) {
    record.content.clear();
    in_.seekg(static_cast<std::streamoff>(length), std::ios::cur);
    at_ += kHead + length;
    return true;
  }
  if (length > kMaxRecord)
    damaged(record.at, "a record of " + std::to_string(length >> 20) + " MB; it may have " +
                           std::to_string(kMaxRecord >> 20) + " MB");
  record.content.resize(length);
  in_.read(record.content.data(), static_cast<std::streamsize>(length));
  if (!in_) damaged(record.at, "cannot be read");
  at_ += kHead + length;
  return true;
}

void Reader::take(const Record& record) {
  Fields fields(record.content);
  switch (record.op) {
    case Op::schema: {
      const auto id = fields.number<std::uint16_t>();
      Channel& schema = schemas_[id];
      schema.schema_name = fields.text();
      schema.schema_encoding = fields.text();
      schema.schema = fields.text();
      break;
    }
    case Op::channel: {
      const auto id = fields.number<std::uint16_t>();
      const auto schema = schemas_.find(fields.number<std::uint16_t>());
      Channel channel = schema == schemas_.end() ? Channel{} : schema->second;
      channel.topic = fields.text();
      channel.encoding = fields.text();
      channels_[id] = channel;
      break;
    }
    case Op::metadata: {
      fields.text();
      Fields entries(fields.text());
      while (!entries.empty()) {
        const std::string key(entries.text());
        metadata_[key] = entries.text();
      }
      if (entries.short_of()) damaged(record.at, "its metadata are cut");
      break;
    }
    case Op::message: {
      Message message;
      message.channel = fields.number<std::uint16_t>();
      fields.number<std::uint32_t>();
      message.time = static_cast<std::int64_t>(fields.number<std::uint64_t>());
      fields.number<std::uint64_t>();
      if (!channels_.contains(message.channel))
        damaged(record.at, "a message of channel " + std::to_string(message.channel) +
                               ", which was not announced");
      if (message.time < 0) damaged(record.at, "a message from after the year 2262");
      if (waiting_.size() == kMaxMessages)
        damaged(record.at, "a chunk of more than a million messages");
      message.data.assign(fields.rest().begin(), fields.rest().end());
      waiting_.push_back(std::move(message));
      break;
    }
    case Op::chunk:
      take_chunk(record);
      break;
    case Op::data_end:
      ended_ = true;
      break;
    default:
      break;  // indexes, attachments, and what later versions add
  }
  if (fields.short_of()) damaged(record.at, "a record is shorter than its fields");
}

void Reader::take_chunk(const Record& record) {
  Fields fields(record.content);
  fields.part(16);
  fields.number<std::uint64_t>();
  const auto crc = fields.number<std::uint32_t>();
  const std::string_view compression = fields.text();
  const std::string_view records = fields.part(fields.number<std::uint64_t>());
  if (fields.short_of()) damaged(record.at, "a chunk is shorter than its fields");
  if (!compression.empty())
    damaged(record.at, "a chunk compressed with " + std::string(compression.substr(0, 20)) +
                           "; `mcap compress --compression none` makes it readable here");
  if (crc != 0 && crc != crc32(records))
    damaged(record.at, "a chunk is damaged: its checksum does not fit");
  Record inner;
  for (std::size_t at = 0; at < records.size();) {
    if (records.size() - at < kHead) damaged(record.at, "a chunk ends within a record");
    std::uint64_t length = 0;
    std::memcpy(&inner.op, records.data() + at, 1);
    std::memcpy(&length, records.data() + at + 1, sizeof length);
    if (length > records.size() - at - kHead) damaged(record.at, "a chunk ends within a record");
    if (inner.op == Op::chunk) damaged(record.at, "a chunk within a chunk");
    inner.at = record.at;
    inner.content = records.substr(at + kHead, length);
    take(inner);
    at += kHead + length;
  }
}

bool Reader::next(Message& out) {
  while (next_ == waiting_.size() && !ended_) {
    waiting_.clear();
    next_ = 0;
    Record record;
    while (waiting_.empty() && !ended_ && read(record)) take(record);
  }
  if (next_ == waiting_.size()) return false;
  if (next_ == 0)
    std::stable_sort(waiting_.begin(), waiting_.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
  out = std::move(waiting_[next_++]);
  return true;
}

}  // namespace handsel::mcap
