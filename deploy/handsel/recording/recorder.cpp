// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/recording/recorder.hpp"

#include <algorithm>
#include <cstdio>

#include "common/base/errors.hpp"
#include "common/bus/dds/dds_bus.hpp"
#include "common/bus/executor.hpp"
#include "common/wire/schema.hpp"

namespace handsel {
namespace {

constexpr Duration kFlush = std::chrono::milliseconds(500);  // max loss at a sudden end

}  // namespace

std::vector<mcap::Channel> recorded_channels() {
  std::vector<mcap::Channel> channels;
  for (const TopicRow& row : topics())
    channels.push_back({row.topic, "cdr", idl_name(row), "omgidl", idl_schema(row)});
  return channels;
}

Recorder::Recorder(RawBus& bus, const std::filesystem::path& file, const mcap::Metadata& metadata)
    : file_(file, recorded_channels(), metadata) {
  for (std::size_t i = 0; i < topics().size(); ++i)
    readers_.push_back(bus.read_raw(message_type(i), RawDepth::many));
}

void Recorder::poll() {
  RawSample sample;
  for (std::size_t i = 0; i < readers_.size(); ++i) {
    while (readers_[i]->take(sample)) {
      if (!sample.gone)
        batch_.push_back({static_cast<std::uint16_t>(i), sample.stamp, std::move(sample.cdr)});
    }
  }
  std::stable_sort(batch_.begin(), batch_.end(),
                   [](const mcap::Message& a, const mcap::Message& b) { return a.time < b.time; });
  for (const mcap::Message& message : batch_) file_.write(message);
  batch_.clear();
  if (const TimePoint now = monotonic_now(); now - flushed_ >= kFlush) {
    file_.flush();
    flushed_ = now;
  }
}

void Recorder::close() {
  poll();
  file_.close();
}

struct Recording::State {
  State(RawBus& bus, const std::filesystem::path& file, const mcap::Metadata& metadata)
      : path(file), recorder(bus, file, metadata) {}

  void guarded(void (Recorder::*action)()) {
    if (failed) return;
    try {
      (recorder.*action)();
    } catch (const ConfigError& error) {
      failed = true;
      std::fprintf(stderr, "handsel: the recording ends here: %s\n", error.what());
    }
  }

  std::filesystem::path path;
  Recorder recorder;
  bool failed{};
};

Recording::Recording(DdsBus& bus, const std::filesystem::path& file,
                     const mcap::Metadata& metadata) {
  if (file.empty()) return;
  state_ = std::make_shared<State>(bus, file, metadata);
  bus.every(Recorder::kPollPeriod, [weak = std::weak_ptr(state_)](TimePoint) {
    if (const auto state = weak.lock()) state->guarded(&Recorder::poll);
  });
}

Recording::~Recording() {
  if (!state_) return;
  state_->guarded(&Recorder::close);
  if (!state_->failed)
    std::fprintf(stderr, "%s: %s\n", state_->path.c_str(), amount(state_->recorder.file()).c_str());
}

LocalRecording::LocalRecording(LocalNetwork& network, const std::filesystem::path& file,
                               const mcap::Metadata& metadata)
    : network_(network), file_(file, recorded_channels(), metadata) {
  network.tap([this](const MessageType& type, const void* wire, Stamp sent) {
    const auto row = std::find_if(topics().begin(), topics().end(),
                                  [&](const TopicRow& r) { return &r == &type.row(); });
    if (row != topics().end())
      file_.write(
          {static_cast<std::uint16_t>(row - topics().begin()), sent, codec_.encode(type, wire)});
  });
}

LocalRecording::~LocalRecording() { network_.tap({}); }

void LocalRecording::close() { file_.close(); }

std::string amount(const mcap::Writer& file) {
  char text[80];
  std::snprintf(text, sizeof text, "%llu messages, %.1f MB",
                static_cast<unsigned long long>(file.messages()),
                1e-6 * static_cast<double>(file.bytes()));
  return text;
}

}  // namespace handsel
