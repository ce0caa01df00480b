// SPDX-License-Identifier: Apache-2.0
// One HTTP connection of the server: answers GET and HEAD, takes commands by POST, and upgrades to
// a WebSocketClient.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <memory>
#include <optional>
#include <string>

#include "components/bridge/server_state.hpp"

namespace handsel::bridge {

/// Connection over HTTP. Leaves the state's set of connections when it ends or is upgraded.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(boost::asio::ip::tcp::socket&& socket, ServerState& state)
      : stream_(std::move(socket)), state_(state) {}

  /// Reads requests and answers them until the connection ends.
  void read();
  /// Answers 503 with the reason, without a request, and ends.
  void turn_away(const std::string& why);
  /// Closes the connection.
  void end();

 private:
  using Error = boost::beast::error_code;
  using Request = boost::beast::http::request<boost::beast::http::string_body>;
  using Status = boost::beast::http::status;
  template <class Body>
  using Response = std::shared_ptr<boost::beast::http::response<Body>>;

  void expire();
  template <class Body>
  Response<Body> make(Status status, unsigned version, const char* type,
                      typename Body::value_type body);
  template <class Body>
  void send(Response<Body> response, bool keep);
  void send_head(Status status, unsigned version, const char* type, std::uint64_t length,
                 bool keep);
  void refuse(Status status, const std::string& sentence, unsigned version);
  void answer(const Request& request);
  void json(const std::string& content, const Request& request, bool body);
  void file(const std::string& path, const Request& request, bool body);
  void command(const Request& request);
  void upgrade(const Request& request);
  std::string counters();

  boost::beast::tcp_stream stream_;
  ServerState& state_;
  boost::beast::flat_buffer buffer_{16384};
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;
};

}  // namespace handsel::bridge
