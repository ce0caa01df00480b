// SPDX-License-Identifier: Apache-2.0
// The Foxglove WebSocket protocol, server side, without a socket: what is announced, what a viewer
// asks, what it is sent. Pure. Source: the public description of the protocol (subprotocols
// foxglove.websocket.v1 and foxglove.sdk.v1).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.hpp"
#include "components/bridge/outbox.hpp"
#include "components/bridge/rate_limit.hpp"

namespace handsel::bridge {

inline constexpr std::array<const char*, 2> kSubprotocols{"foxglove.sdk.v1",
                                                          "foxglove.websocket.v1"};
/// Returns the first of kSubprotocols in a Sec-WebSocket-Protocol header; empty when there is none.
std::string choose_subprotocol(std::string_view header);

struct Channel {
  std::string topic;            ///< "handsel/robot_state"
  std::string encoding;         ///< "cdr", "protobuf"
  std::string schema_name;      ///< "handsel::RobotState"
  std::string schema;           ///< omgidl: the text; protobuf: the FileDescriptorSet in base64
  std::string schema_encoding;  ///< "omgidl", "protobuf"
  bool queued{};                ///< every sample is wanted; else the newest of each instance
  bool kept{};                  ///< the last sample of each instance is given to late subscribers
};

/// What is announced to every viewer; the same for all. A channel's id is its place in `channels` +
/// 1.
struct Catalogue {
  std::string name;                             ///< of the server: "handsel" and the robot's name
  std::string session;                          ///< changes with every start
  std::map<std::string, std::string> metadata;  ///< robot, scenario, DDS domain, version
  /// At most 64: those of the table of topics, then those drawn.
  std::vector<Channel> channels;
  std::map<std::string, std::string> parameters;  ///< read-only
};

struct Sample {
  std::size_t channel{};     ///< place in the catalogue
  std::uint64_t instance{};  ///< value of the topic's key, stable while the reader lives
  bool gone{};               ///< the instance is no more; no bytes
  Stamp stamp{};             ///< when it was written [ns, system clock of the writer]
  Bytes bytes;               ///< serialised in the channel's encoding; null when gone
};

/// Topic -> components, alive, that write and read it.
struct Graph {
  std::map<std::string, std::set<std::string>> writers, readers;  ///< by topic
  bool operator==(const Graph&) const = default;
};

struct Asset {
  Bytes bytes;         ///< null: refused
  std::string reason;  ///< of the refusal
};

/// What all viewers share: the announcements, made once, and the samples kept for late subscribers.
class Hub {
 public:
  explicit Hub(Catalogue catalogue, std::function<Asset(const std::string& uri)> fetch);

  /// Returns the announcements as given at construction.
  const Catalogue& catalogue() const { return catalogue_; }
  const SharedText& greeting() const { return greeting_; }  ///< serverInfo
  const SharedText& channels() const { return channels_; }  ///< advertise
  /// Returns the file of an asset's address, or why it is refused.
  Asset fetch(const std::string& uri) const { return fetch_(uri); }
  /// Keeps the newest sample of each instance (64 at most; others are not kept) where the channel
  /// asks for that; removes an instance that is gone.
  void keep(const Sample& sample);
  /// Drops the kept samples of a channel without readers, as they would become stale.
  void forget(std::size_t channel) { kept_[channel].clear(); }
  /// Returns the kept samples of a channel by instance; empty where nothing is kept.
  const std::map<std::uint64_t, Sample>& kept(std::size_t channel) const { return kept_[channel]; }
  /// Replaces the graph; viewers get it by Viewer::graph_changed().
  void set_graph(Graph graph) { graph_ = std::move(graph); }
  /// Returns the graph set last, at first an empty one.
  const Graph& graph() const { return graph_; }

 private:
  Catalogue catalogue_;
  std::function<Asset(const std::string&)> fetch_;
  SharedText greeting_, channels_;
  std::vector<std::map<std::uint64_t, Sample>> kept_;
  Graph graph_;
};

/// One client: what it subscribed to and what waits for it.
class Viewer {
 public:
  static constexpr std::size_t kMaxSubscriptions = 256;  ///< more are refused
  /// Refused messages; one more and the client is cut.
  static constexpr unsigned kMaxErrors = 100;
  /// [bytes] of answers waiting to be sent; beyond, assets are refused.
  static constexpr std::size_t kMaxAssetBytes = 64u << 20;
  /// From the client in a second; one more and it is cut.
  static constexpr unsigned kMaxMessages = 2000;

  /// The hub must outlive it. Announces server and channels.
  explicit Viewer(Hub& hub, const OutboxSettings& settings = {});

  /// What the client sent. Broken or refused messages are answered with a status and counted.
  void text(std::string_view message, TimePoint now);
  /// Refuses a binary message of the client: publishing and services are not offered.
  void binary(TimePoint now);

  /// Queues a sample once for each subscription to its channel; nothing for an instance that is
  /// gone.
  void sample(const Sample& sample);
  /// Queues the time [ns]; only the newest one waits.
  void time(Stamp now);
  /// The graph of the hub has changed.
  void graph_changed();

  /// Returns the messages that wait for the client.
  Outbox& outbox() { return outbox_; }
  /// Returns whether the client is subscribed to the channel (place in the catalogue).
  bool wants(std::size_t channel) const { return by_channel_.contains(channel); }
  /// Returns how many messages and assets were refused so far.
  std::uint64_t refused() const { return refused_; }
  /// Not empty: the client is to be cut, and why.
  const std::string& cut() const { return cut_; }

 private:
  void status(int level, const std::string& message);
  void refuse(const std::string& why);
  void put(std::string text);
  bool flooding(TimePoint now);
  void send(std::uint32_t subscription, const Sample& sample);
  void send_graph(const Graph& before, const Graph& now);
  void fetch(const std::string& uri, std::uint32_t request);

  Hub& hub_;
  Outbox outbox_;
  std::map<std::uint32_t, std::size_t> subscriptions_;  // id of the client -> channel
  std::multimap<std::size_t, std::uint32_t> by_channel_;
  std::optional<Graph> reported_graph_;  // set while it wants the graph
  std::uint64_t refused_{0};
  unsigned errors_{0};
  RateLimit limit_{kMaxMessages};
  std::string cut_;
};

}  // namespace handsel::bridge
