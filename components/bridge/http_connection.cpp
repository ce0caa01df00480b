// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/http_connection.hpp"

#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

#include "components/bridge/web_socket_client.hpp"

namespace handsel::bridge {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = boost::asio::ip::tcp;

constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; font-src 'self'; connect-src 'self'; "
    "img-src 'self' data: blob:; "
    "worker-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

constexpr std::size_t kMaxBody = 4096;  // of a command [bytes]

std::string text(beast::string_view view) { return {view.data(), view.size()}; }
std::string_view plain(beast::string_view view) { return {view.data(), view.size()}; }

http::status status_of(CommandGate::Verdict verdict) {
  switch (verdict) {
    case CommandGate::Verdict::admitted:
      return http::status::accepted;
    case CommandGate::Verdict::closed:
      return http::status::not_found;
    case CommandGate::Verdict::foreign:
      return http::status::forbidden;
    case CommandGate::Verdict::no_token:
    case CommandGate::Verdict::wrong_token:
      return http::status::unauthorized;
    case CommandGate::Verdict::too_many:
      return http::status::too_many_requests;
  }
  return http::status::forbidden;
}

}  // namespace

void HttpConnection::read() {
  parser_.emplace();
  parser_->header_limit(8192);
  parser_->body_limit(kMaxBody);
  expire();
  http::async_read(
      stream_, buffer_, *parser_, [self = shared_from_this()](Error error, std::size_t) {
        if (error == http::error::body_limit) {
          self->refuse(http::status::payload_too_large,
                       "a request may have at most " + std::to_string(kMaxBody) + " bytes\n", 11);
        } else if (error && error != http::error::end_of_stream &&
                   error.category() == http::make_error_code(http::error::bad_target).category()) {
          self->refuse(http::status::bad_request,
                       "this is no HTTP request served here: " + error.message() + "\n", 11);
        } else if (error) {
          self->end();
        } else {
          self->answer(self->parser_->release());
        }
      });
}

void HttpConnection::turn_away(const std::string& why) {
  ++state_.counters.refused_connections;
  state_.report("connection", "a connection is refused: " + why);
  send(make<http::string_body>(http::status::service_unavailable, 11, "text/plain; charset=utf-8",
                               why + "\n"),
       false);
}

void HttpConnection::end() {
  Error ignored;
  stream_.socket().shutdown(tcp::socket::shutdown_both, ignored);
  stream_.close();
  state_.connections.erase(shared_from_this());
}

void HttpConnection::expire() {
  stream_.expires_after(milliseconds(state_.settings.request_timeout));
}

template <class Body>
HttpConnection::Response<Body> HttpConnection::make(Status status, unsigned version,
                                                    const char* type,
                                                    typename Body::value_type body) {
  auto response = std::make_shared<http::response<Body>>(status, version);
  response->set(http::field::server, "handsel");
  response->set(http::field::content_type, type);
  response->set("Content-Security-Policy", kPolicy);
  response->set(http::field::cache_control, "no-store");
  response->set("X-Content-Type-Options", "nosniff");
  response->set("Referrer-Policy", "no-referrer");
  response->body() = std::move(body);
  response->prepare_payload();
  return response;
}

template <class Body>
void HttpConnection::send(Response<Body> response, bool keep) {
  response->keep_alive(keep);
  ++state_.counters.requests;
  expire();
  http::async_write(stream_, *response,
                    [self = shared_from_this(), response, keep](Error error, std::size_t n) {
                      self->state_.counters.sent_bytes += n;
                      if (error || !keep) return self->end();
                      self->read();
                    });
}

/// Sends the header only, with the length that the body would have.
void HttpConnection::send_head(Status status, unsigned version, const char* type,
                               std::uint64_t length, bool keep) {
  auto response = make<http::empty_body>(status, version, type, {});
  response->content_length(length);
  response->keep_alive(keep);
  ++state_.counters.requests;
  auto serializer = std::make_shared<http::response_serializer<http::empty_body>>(*response);
  expire();
  http::async_write_header(
      stream_, *serializer,
      [self = shared_from_this(), response, serializer, keep](Error error, std::size_t) {
        if (error || !keep) return self->end();
        self->read();
      });
}

void HttpConnection::refuse(Status status, const std::string& sentence, unsigned version) {
  ++state_.counters.refused_requests;
  send(make<http::string_body>(status, version, "text/plain; charset=utf-8", sentence), false);
}

void HttpConnection::answer(const Request& request) {
  const unsigned version = request.version();
  if (!state_.hosts.contains(text(request[http::field::host])))
    return refuse(http::status::forbidden, "this page is for this machine only\n", version);
  if (websocket::is_upgrade(request)) return upgrade(request);
  if (request.method() == http::verb::post && request.target() == "/command")
    return command(request);
  if (request.method() != http::verb::get && request.method() != http::verb::head)
    return refuse(http::status::method_not_allowed, "read-only\n", version);
  const bool body = request.method() == http::verb::get;
  std::string path = text(request.target());
  path = path.substr(0, path.find('?'));
  if (path == "/config.json") return json(state_.config, request, body);
  if (path == "/counters.json") return json(counters(), request, body);
  file(path, request, body);
}

void HttpConnection::json(const std::string& content, const Request& request, bool body) {
  constexpr const char* kType = "application/json";
  if (!body)
    return send_head(http::status::ok, request.version(), kType, content.size(),
                     request.keep_alive());
  send(make<http::string_body>(http::status::ok, request.version(), kType, content),
       request.keep_alive());
}

void HttpConnection::file(const std::string& path, const Request& request, bool body) {
  const auto found = state_.site.find(path);
  if (!found) {
    const bool no_page = path == "/" && !state_.site.is_built();
    return refuse(http::status::not_found,
                  no_page ? "the page is not built; ./run --build-only builds it\n"
                          : "there is no such page\n",
                  request.version());
  }
  Error error;
  http::file_body::value_type content;
  content.open(found->c_str(), beast::file_mode::scan, error);
  if (error) return refuse(http::status::not_found, "there is no such page\n", request.version());
  const char* type = content_type(*found);
  if (!body)
    return send_head(http::status::ok, request.version(), type, content.size(),
                     request.keep_alive());
  send(make<http::file_body>(http::status::ok, request.version(), type, std::move(content)),
       request.keep_alive());
}

/// Takes a command of a holder of the token; answers 202 with the id of a task.
void HttpConnection::command(const Request& request) {
  const unsigned version = request.version();
  const auto refused = [&](Status status, const std::string& sentence) {
    state_.report("command " + std::to_string(static_cast<unsigned>(status)),
                  "a command is refused: " + sentence);
    refuse(status, sentence + "\n", version);
  };
  const CommandGate::Answer answer =
      state_.gate.admit({.authorization = plain(request[http::field::authorization]),
                         .origin = plain(request[http::field::origin]),
                         .host = plain(request[http::field::host])},
                        monotonic());
  if (answer.verdict != CommandGate::Verdict::admitted)
    return refused(status_of(answer.verdict), answer.refusal);
  CommandReading reading = read_command(request.body());
  if (!reading.command) return refused(http::status::bad_request, reading.refusal);
  const CommandQueue::Receipt receipt = state_.queue.put(std::move(*reading.command));
  if (receipt.outcome == CommandQueue::Outcome::too_many)
    return refused(http::status::too_many_requests, receipt.refusal);
  if (receipt.outcome == CommandQueue::Outcome::nobody_takes_it)
    return refused(http::status::service_unavailable, receipt.refusal);
  ++state_.counters.commands;
  send(make<http::string_body>(http::status::accepted, version, "application/json",
                               nlohmann::json{{"task", receipt.task}}.dump()),
       request.keep_alive());
}

void HttpConnection::upgrade(const Request& request) {
  const unsigned version = request.version();
  const std::string origin = text(request[http::field::origin]);
  if (!origin.empty() && !state_.origins.contains(origin))
    return refuse(http::status::forbidden,
                  "pages of " + origin.substr(0, 80) +
                      " may not connect; allowed_origins in bridge.txtpb lists who may\n",
                  version);
  const std::string subprotocol =
      choose_subprotocol(text(request[http::field::sec_websocket_protocol]));
  if (request.target() != "/" || subprotocol.empty())
    return refuse(http::status::bad_request,
                  "a WebSocket here is on / and speaks foxglove.sdk.v1 or foxglove.websocket.v1\n",
                  version);
  if (state_.clients.size() >= state_.settings.max_clients)
    return turn_away("there are " + std::to_string(state_.clients.size()) + " viewers already");
  const auto client = std::make_shared<WebSocketClient>(std::move(stream_), state_);
  state_.clients.insert(client);
  state_.connections.erase(shared_from_this());
  client->open(request, subprotocol);
}

std::string HttpConnection::counters() {
  state_.publish_counters();
  const Counters& c = state_.counters;
  return nlohmann::json{{"connections", c.connections},
                        {"requests", c.requests},
                        {"refused_connections", c.refused_connections},
                        {"refused_requests", c.refused_requests},
                        {"commands", c.commands},
                        {"refused_messages", c.refused_messages},
                        {"cut_clients", c.cut_clients},
                        {"sent_messages", c.sent_messages},
                        {"sent_bytes", c.sent_bytes},
                        {"dropped_samples", c.dropped_samples},
                        {"clients", c.clients},
                        {"open", c.open}}
      .dump();
}

}  // namespace handsel::bridge
