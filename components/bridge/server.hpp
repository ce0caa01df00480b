// SPDX-License-Identifier: Apache-2.0
// One port, on 127.0.0.1 unless set otherwise: HTTP for the page, and a Foxglove WebSocket on "/".
// Runs on a thread of its own; what it is given may come from any one other thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "components/bridge/commands/command_queue.hpp"
#include "components/bridge/foxglove.hpp"
#include "components/bridge/site.hpp"

namespace handsel::bridge {

struct ServerSettings {
  std::uint16_t port{8765};  ///< 0: any free one
  /// WebSocket clients at once; four times as many connections altogether; more are refused with
  /// 503.
  unsigned max_clients{16};
  double request_timeout{5.0};  ///< [s] to send a request, and to take the answer
  /// [s] a WebSocket client may take for one message before it is cut.
  double stall_timeout{5.0};
  /// Pages of other hosts that may connect, as in their Origin header.
  std::vector<std::string> allowed_origins;
  /// IPv4, of the interface it listens on; pages still name this machine as 127.0.0.1 or localhost.
  std::string address{"127.0.0.1"};
  std::string token{};  ///< secret that a command must present; empty: no commands
};

struct Counters {
  std::uint64_t connections{};                  ///< accepted so far
  std::uint64_t requests{};                     ///< answered over HTTP
  std::uint64_t refused_connections{};          ///< too many at once
  std::uint64_t refused_requests{};             ///< HTTP and upgrades
  std::uint64_t commands{};                     ///< accepted
  std::uint64_t refused_messages{};             ///< of WebSocket clients
  std::uint64_t cut_clients{};                  ///< stalled, flooding, sent too much
  std::uint64_t sent_messages{}, sent_bytes{};  ///< over WebSocket; bytes also over HTTP
  std::uint64_t dropped_samples{};              ///< given up because a client was slow
  std::uint64_t clients{};                      ///< WebSocket clients now
  std::uint64_t open{};                         ///< connections now
};

class Server {
 public:
  /// `config`: the JSON of /config.json. Throws std::runtime_error with one sentence when the port
  /// cannot be used.
  Server(const ServerSettings& settings, Site site, Catalogue catalogue, std::string config);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Returns the port it listens on, also where the settings ask for any free one.
  std::uint16_t port() const;
  /// Is anybody subscribed to the channel (place in the catalogue)?
  bool wanted(std::size_t channel) const;
  /// Returns whether a WebSocket client was there at the last set_time() or connection, or is
  /// subscribed to a channel.
  bool any_client() const;
  /// Sends samples to all viewers that want them. Given up, and counted, when the server is far
  /// behind.
  void publish(std::vector<Sample> samples);
  /// Sends the time [ns] to every client and brings counters() up to date; left out when the server
  /// is far behind.
  void set_time(Stamp now);
  /// Sends what has changed in the graph to the clients that want the graph.
  void set_graph(Graph graph);
  /// Returns the counters as of the last set_time(), connection or request of /counters.json.
  Counters counters() const;
  /// Returns the accepted commands of visitors; who carries them out is set there.
  CommandQueue& commands();

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace handsel::bridge
