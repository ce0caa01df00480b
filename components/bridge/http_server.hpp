// A small HTTP server on 127.0.0.1 for the page: fixed files, the newest state, and a stream of states (server-sent events). Read-only.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace handsel::bridge {

/// Path ("/index.html") -> bytes that live as long as the program.
using PageFiles = std::map<std::string, std::string_view>;
/// The files of web/.
PageFiles page_files();

struct HttpSettings {
  std::uint16_t port{8765};     ///< 0: any free one
  unsigned max_clients{16};     ///< connections at once; more are refused with 503
  double request_timeout{5.0};  ///< [s] to send a request, and for a reader of the stream to take what it was sent
};

class HttpServer {
 public:
  /// Listens on 127.0.0.1 and serves on a thread of its own. Throws std::runtime_error with one sentence when the port is taken.
  HttpServer(const HttpSettings& settings, PageFiles files);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  std::uint16_t port() const;
  /// The newest state (one line of JSON) for GET /state and for every stream; a slow reader misses the ones between.
  void update(std::string state);
  unsigned clients() const;  ///< connections now

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handsel::bridge
