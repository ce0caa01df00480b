// SPDX-License-Identifier: Apache-2.0
// State that the connections of the server share. Belongs to the server's thread, except what is
// published for the thread that gives samples.
#pragma once

#include <bitset>
#include <chrono>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "components/bridge/commands/command_gate.hpp"
#include "components/bridge/server.hpp"

namespace handsel::bridge {

class HttpConnection;
class WebSocketClient;

/// Largest number of channels that a server offers.
constexpr std::size_t kMaxChannels = 64;

/// Converts seconds to whole milliseconds.
std::chrono::milliseconds milliseconds(double seconds);

/// Returns the time of a clock that never jumps.
TimePoint monotonic();

/// State of the server's thread.
struct ServerState {
  ServerState(ServerSettings s, Site where, Catalogue catalogue, std::string json);

  ServerSettings settings;  ///< As given.
  Site site;                ///< Files that are served.
  Hub hub;                  ///< Protocol state of all viewers.
  std::string config;       ///< JSON of /config.json.
  CommandGate gate;         ///< Who may command.
  CommandQueue queue;       ///< Commands that other threads take.
  /// Host names with port that a request may address; any other is another site's name for this
  /// machine.
  std::set<std::string> hosts;
  std::set<std::string> origins;                          ///< Origins of pages that may connect.
  std::set<std::shared_ptr<HttpConnection>> connections;  ///< Open HTTP connections.
  std::set<std::shared_ptr<WebSocketClient>> clients;     ///< Open WebSocket connections.
  Counters counters;                                      ///< Counts up to now.
  std::set<std::string> reported_kinds;                   ///< Kinds of refusal that were printed.

  mutable std::mutex mutex;          ///< Protects `published` and `wanted`.
  Counters published;                ///< Counters that other threads read.
  std::bitset<kMaxChannels> wanted;  ///< Channels with a subscriber.

  /// Prints the first refusal of each kind; the caller counts every one.
  void report(const std::string& kind, const std::string& what);
  /// Makes the counters visible to other threads.
  void publish_counters();
  /// Updates `wanted` from the subscriptions of all clients and drops unwanted samples.
  void update_wanted();
};

}  // namespace handsel::bridge
