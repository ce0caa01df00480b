// SPDX-License-Identifier: Apache-2.0
// A plain HTTP client on a socket, for tests: sends bytes as given, reads until the connection ends
// or a text has arrived.
#pragma once

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <string>

namespace handsel::test {

class HttpClient {
 public:
  explicit HttpClient(std::uint16_t port)
      : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)), port_(port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~HttpClient() { close(fd_); }
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  bool connected() const { return connected_; }
  void send(const std::string& bytes) {
    [[maybe_unused]] const ssize_t n = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  /// A request with the right Host; asks for the connection to be closed, so that read() ends.
  void request(const std::string& method, const std::string& target) {
    request(method, target, "127.0.0.1:" + std::to_string(port_));
  }
  void request(const std::string& method, const std::string& target, const std::string& host) {
    send(method + " " + target + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n");
  }
  /// Reads until the connection closes, `until` arrives or 5 s have passed.
  std::string read(const std::string& until = {}) {
    while (until.empty() || text_.find(until) == std::string::npos) {
      pollfd fd{fd_, POLLIN, 0};
      char bytes[4096];
      if (poll(&fd, 1, 5000) <= 0) break;
      const ssize_t n = recv(fd_, bytes, sizeof bytes, 0);
      if (n <= 0) break;
      text_.append(bytes, static_cast<std::size_t>(n));
    }
    return text_;
  }
  void forget() { text_.clear(); }

 private:
  int fd_{-1};
  std::uint16_t port_;
  bool connected_{false};
  std::string text_;
};

}  // namespace handsel::test
