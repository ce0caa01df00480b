// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/recording/replay.hpp"

#include <algorithm>

#include "common/base/errors.hpp"
#include "common/bus/writer_pin.hpp"
#include "common/wire/schema.hpp"

namespace handsel {

std::vector<std::string> input_topics() {
  std::vector<std::string> inputs;
  for (const TopicRow& row : topics())
    if (row.profile == Profile::sensor) inputs.emplace_back(row.topic);
  return inputs;
}

namespace {

/// Reads the whole file first, so that nothing of a damaged file is sent.
void require_sound(const std::filesystem::path& file) {
  constexpr std::int64_t kMaxLength =
      30ll * 24 * 3600 * 1'000'000'000;  // one month [ns]; larger times of a message are wrong
  mcap::Reader reader(file);
  mcap::Message message;
  std::int64_t begin = -1;
  while (reader.next(message)) {
    if (begin < 0) begin = message.time;
    if (message.time - begin > kMaxLength)
      throw ConfigError(file.string() + ": a message " +
                        std::to_string((message.time - begin) / 1'000'000'000) +
                        " s after the first; a recording has at most 30 days");
  }
}

}  // namespace

std::string replay_name(const std::vector<std::string>& topics) {
  std::string name = "replay";
  for (const std::string& topic : topics.empty() ? input_topics() : topics) {
    const TopicRow* row = find_topic(topic);
    if (row == nullptr || !has_one_writer(*row) || may_write(*row, name)) continue;
    const std::string_view writers = row->writers;
    name += " " + std::string(writers.substr(0, writers.find(' ')));
  }
  return name;
}

Replay::Replay(Bus& bus, const Settings& settings) : reader_(settings.file), from_(settings.from) {
  require_sound(settings.file);
  std::vector<const TopicRow*> wanted;
  for (const std::string& name : settings.topics.empty() ? input_topics() : settings.topics) {
    const TopicRow* row = find_topic(name);
    if (!row)
      throw ConfigError("there is no topic \"" + name + "\"; `handsel topic list` names them");
    wanted.push_back(row);
  }
  for (const auto& [id, channel] : reader_.channels()) {
    const auto row =
        std::find_if(wanted.begin(), wanted.end(),
                     [&topic = channel.topic](const TopicRow* r) { return topic == r->topic; });
    if (row == wanted.end()) continue;
    if (channel.encoding != "cdr" || channel.schema != idl_schema(**row))
      throw ConfigError(settings.file.string() + ": " + channel.topic +
                        " was recorded with another IDL than this version's");
    const MessageType& type = *find_message_type((*row)->type);
    channels_[id] = {&type, bus.advertise_any(type, 0), type.new_wire(), type.new_message()};
    counts_[channel.topic] = {};
  }
  if (channels_.empty())
    throw ConfigError(settings.file.string() + " has none of the topics to replay");
}

bool Replay::advance() {
  while (reader_.next(sample_)) {
    if (begin_ < 0) begin_ = sample_.time;
    if (channels_.contains(sample_.channel) && due() >= 0) return true;
  }
  return false;
}

double Replay::due() const { return 1e-9 * static_cast<double>(sample_.time - begin_) - from_; }

void Replay::send(Stamp began) {
  const Channel& channel = channels_.at(sample_.channel);
  Count& count = counts_[channel.type->row().topic];
  std::string why = "its bytes are no such sample";
  bool sent = codec_.decode(*channel.type, sample_.data, channel.wire.get());
  if (sent) {
    // A measurement keeps the age that it had when it was sent.
    const Stamp stamp = channel.type->stamp(channel.wire.get());
    const Stamp age = stamp >= 0 && stamp < sample_.time ? sample_.time - stamp : 0;
    channel.type->set_stamp(channel.wire.get(), began + static_cast<Stamp>(1e9 * due()) - age);
    sent = channel.type->from_wire(channel.wire.get(), channel.message.get(), why) &&
           channel.out->publish(channel.message.get());
  }
  ++(sent ? count.sent : count.refused);
  if (!sent && count.refusal.empty())
    count.refusal = why.empty() ? "the transport has no room" : why;
}

}  // namespace handsel
