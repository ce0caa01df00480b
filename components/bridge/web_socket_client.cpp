// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/web_socket_client.hpp"

#include <array>
#include <boost/asio/ip/tcp.hpp>

namespace handsel::bridge {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;

constexpr std::size_t kMaxMessage = 65536;  // max size of a message of a client [bytes]
constexpr int kSendBuffer = 512 * 1024;     // kernel buffer [bytes]; stale if a client is slow

}  // namespace

WebSocketClient::WebSocketClient(beast::tcp_stream&& stream, ServerState& state)
    : ws_(std::move(stream)),
      stall_(ws_.get_executor()),
      state_(state),
      viewer_(state.hub),
      buffer_(kMaxMessage) {}

void WebSocketClient::open(const http::request<http::string_body>& request,
                           const std::string& subprotocol) {
  websocket::stream_base::timeout timeout{};
  timeout.handshake_timeout = milliseconds(state_.settings.request_timeout);
  timeout.idle_timeout = std::chrono::seconds(30);
  timeout.keep_alive_pings = true;
  beast::get_lowest_layer(ws_).expires_never();
  ws_.set_option(timeout);
  ws_.set_option(
      websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
        response.set(http::field::sec_websocket_protocol, subprotocol);
        response.set(http::field::server, "handsel");
      }));
  ws_.read_message_max(kMaxMessage);
  ws_.auto_fragment(false);
  Error ignored;
  ws_.next_layer().socket().set_option(tcp::no_delay(true), ignored);
  ws_.next_layer().socket().set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
  ws_.async_accept(request, [self = shared_from_this()](Error error) {
    if (error) return self->end();
    self->accepted_ = true;
    self->read();
    self->flush();
  });
}

/// Sends the waiting messages one by one.
void WebSocketClient::flush() {
  count();
  if (!accepted_ || ended_ || writing_) return;
  if (!viewer_.cut().empty()) return close(websocket::close_code::policy_error, viewer_.cut());
  if (viewer_.outbox().empty()) return;
  writing_ = true;
  frame_ = viewer_.outbox().pop();
  ws_.binary(!frame_.text);
  std::array<asio::const_buffer, 2> buffers{};
  if (frame_.text) {
    buffers[0] = asio::buffer(*frame_.text);
  } else {
    buffers[0] = asio::buffer(frame_.head);
    if (frame_.body) buffers[1] = asio::buffer(*frame_.body);
  }
  stall_.expires_after(milliseconds(state_.settings.stall_timeout));
  stall_.async_wait([self = shared_from_this()](Error error) {
    if (!error && self->writing_)
      self->cut("it took nothing for " +
                std::to_string(self->state_.settings.stall_timeout).substr(0, 4) + " s");
  });
  ws_.async_write(buffers, [self = shared_from_this()](Error error, std::size_t n) {
    self->writing_ = false;
    self->stall_.cancel();
    if (error) return self->end();
    ++self->state_.counters.sent_messages;
    self->state_.counters.sent_bytes += n;
    self->flush();
  });
}

void WebSocketClient::end() {
  if (ended_) return;
  ended_ = true;
  count();
  stall_.cancel();
  Error ignored;
  beast::get_lowest_layer(ws_).socket().shutdown(tcp::socket::shutdown_both, ignored);
  beast::get_lowest_layer(ws_).close();
  state_.clients.erase(shared_from_this());
  state_.update_wanted();
}

void WebSocketClient::read() {
  ws_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
    if (error) return self->end_after_error(error);
    if (self->ws_.got_binary()) {
      self->viewer_.binary(monotonic());
    } else {
      const auto data = self->buffer_.cdata();
      self->viewer_.text({static_cast<const char*>(data.data()), data.size()}, monotonic());
    }
    self->buffer_.consume(self->buffer_.size());
    self->state_.update_wanted();
    self->flush();
    if (self->viewer_.cut().empty()) self->read();
  });
}

/// Closes the connection of a protocol error. Beast does so and sends the reason itself, unless the
/// client does not answer in time.
void WebSocketClient::end_after_error(Error error) {
  const bool went = error == websocket::error::closed || error == asio::error::eof ||
                    error == asio::error::connection_reset || error == asio::error::broken_pipe;
  if (ended_ || went || !viewer_.cut().empty()) return end();
  ++state_.counters.refused_messages;
  cut("it broke the protocol, sent a message of more than " + std::to_string(kMaxMessage) +
      " bytes or fell silent (" + error.message() + ")");
}

void WebSocketClient::cut(const std::string& why) {
  if (ended_) return;
  ++state_.counters.cut_clients;
  state_.report("cut", "a client is cut: " + why);
  end();
}

void WebSocketClient::close(websocket::close_code code, const std::string& why) {
  ++state_.counters.cut_clients;
  state_.report("cut", "a client is cut: " + why);
  writing_ = true;  // no other message is sent
  stall_.expires_after(milliseconds(state_.settings.stall_timeout));
  stall_.async_wait([self = shared_from_this()](Error error) {
    if (!error) self->end();
  });
  ws_.async_close({code, why.substr(0, 120)}, [self = shared_from_this()](Error) { self->end(); });
}

/// Adds the viewer's counts since the last call.
void WebSocketClient::count() {
  state_.counters.refused_messages += viewer_.refused() - refused_;
  refused_ = viewer_.refused();
  state_.counters.dropped_samples += viewer_.outbox().dropped() - dropped_;
  dropped_ = viewer_.outbox().dropped();
}

}  // namespace handsel::bridge
