// SPDX-License-Identifier: Apache-2.0
// One WebSocket client of the server: reads its messages and sends it what waits in its outbox.
#pragma once

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <memory>
#include <string>

#include "components/bridge/server_state.hpp"

namespace handsel::bridge {

/// Connection over WebSocket, from the upgrade to the end. Ends itself and leaves the state's set
/// of clients when the client closes, stalls or breaks the protocol.
class WebSocketClient : public std::enable_shared_from_this<WebSocketClient> {
 public:
  WebSocketClient(boost::beast::tcp_stream&& stream, ServerState& state);

  /// Accepts the upgrade with the given subprotocol, then reads and sends.
  void open(const boost::beast::http::request<boost::beast::http::string_body>& request,
            const std::string& subprotocol);
  /// Returns the protocol state of this client.
  Viewer& viewer() { return viewer_; }
  /// Sends what waits, one message at a time.
  void flush();
  /// Closes the connection without a word.
  void end();

 private:
  using Error = boost::beast::error_code;

  void read();
  void end_after_error(Error error);
  void cut(const std::string& why);
  void close(boost::beast::websocket::close_code code, const std::string& why);
  void count();

  boost::beast::websocket::stream<boost::beast::tcp_stream> ws_;
  boost::asio::steady_timer stall_;
  ServerState& state_;
  Viewer viewer_;
  boost::beast::flat_buffer buffer_;
  Frame frame_;
  std::uint64_t refused_{0}, dropped_{0};
  bool accepted_{false}, writing_{false}, ended_{false};
};

}  // namespace handsel::bridge
