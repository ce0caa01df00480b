// SPDX-License-Identifier: Apache-2.0
// A plain WebSocket client on the HTTP client's socket, for tests: handshake, masked frames as
// given, the server's output as bytes.
#pragma once

#include <cstdint>
#include <string>

#include "tests/support/processes/http_client.hpp"

namespace handsel::test {

class WebSocketClient : public HttpClient {
 public:
  explicit WebSocketClient(std::uint16_t port,
                           const std::string& subprotocol = "foxglove.websocket.v1",
                           const std::string& more = {}, const std::string& target = "/")
      : HttpClient(port) {
    send("GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
         "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: "
         "13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
         (subprotocol.empty() ? "" : "Sec-WebSocket-Protocol: " + subprotocol + "\r\n") + more +
         "\r\n");
  }

  enum : std::uint8_t { kText = 1, kBinary = 2 };
  /// Sends a frame. `announced`: length in the header, by default the actual one. The mask is zero.
  void frame(std::uint8_t opcode, const std::string& payload,
             std::uint64_t announced = UINT64_MAX) {
    const std::uint64_t size = announced == UINT64_MAX ? payload.size() : announced;
    std::string bytes{static_cast<char>(0x80 | opcode)};
    const int width = size < 126 ? 0 : size < 65536 ? 2 : 8;
    bytes.push_back(static_cast<char>(0x80 | (width == 0 ? size : width == 2 ? 126 : 127)));
    for (int i = width - 1; i >= 0; --i) bytes.push_back(static_cast<char>(size >> (8 * i)));
    send(bytes + std::string(4, '\0') + payload);
  }
};

}  // namespace handsel::test
