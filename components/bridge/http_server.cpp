#include "components/bridge/http_server.hpp"

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/version.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>

namespace handsel::bridge {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = asio::ip::tcp;
using Response = http::response<http::string_body>;
using Error = beast::error_code;

constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

const char* content_type(const std::string& path) {
  const auto ends = [&](std::string_view end) {
    return path.size() >= end.size() && path.compare(path.size() - end.size(), end.size(), end) == 0;
  };
  if (ends(".html")) return "text/html; charset=utf-8";
  if (ends(".js")) return "text/javascript; charset=utf-8";
  if (ends(".css")) return "text/css; charset=utf-8";
  if (ends(".svg")) return "image/svg+xml";
  return "application/octet-stream";
}

struct Shared {
  PageFiles files;
  std::string state{"{}"};
  std::set<std::string> hosts;  // what a browser on this machine calls us; anything else is another site's name for us
  double timeout{5.0};
  std::atomic<unsigned> clients{0};
};

class Connection;
using Connections = std::set<std::shared_ptr<Connection>>;

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket&& socket, Shared& shared, Connections& all) : stream_(std::move(socket)), shared_(shared), all_(all) {
    ++shared_.clients;
  }
  ~Connection() { --shared_.clients; }

  void read() {
    parser_.emplace();
    parser_->header_limit(8192);
    parser_->body_limit(0);
    expire();
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->end();
      self->answer(self->parser_->release());
    });
  }

  void refuse(http::status status, const std::string& sentence) { send(make(status, "text/plain; charset=utf-8", sentence, 11), false); }

  void push() {
    if (!streaming_) return;
    stale_ = writing_;  // what it is being sent is no longer the newest
    if (writing_) return;
    writing_ = true;
    event_ = "data: " + shared_.state + "\n\n";
    expire();
    asio::async_write(stream_, asio::buffer(event_), [self = shared_from_this()](Error error, std::size_t) {
      self->writing_ = false;
      if (error) return self->end();
      self->stream_.expires_never();
      if (self->stale_) self->push();
    });
  }

  void end() {
    Error ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_both, ignored);
    stream_.close();
    all_.erase(shared_from_this());
  }

 private:
  void expire() { stream_.expires_after(std::chrono::milliseconds(static_cast<int>(1e3 * shared_.timeout))); }

  std::shared_ptr<Response> make(http::status status, const char* type, std::string body, unsigned version) {
    auto response = std::make_shared<Response>(status, version);
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

  void send(std::shared_ptr<Response> response, bool keep, bool body = true) {
    response->keep_alive(keep);
    if (!body) response->body().clear();
    expire();
    http::async_write(stream_, *response, [self = shared_from_this(), response, keep](Error error, std::size_t) {
      if (error || !keep) return self->end();
      self->read();
    });
  }

  void answer(http::request<http::empty_body> request) {
    const unsigned version = request.version();
    const auto reply = [&](http::status status, const std::string& sentence) {
      send(make(status, "text/plain; charset=utf-8", sentence, version), false);
    };
    if (!shared_.hosts.count(std::string(request[http::field::host])))
      return reply(http::status::forbidden, "this page is for this machine only\n");
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return reply(http::status::method_not_allowed, "read-only\n");
    const bool body = request.method() == http::verb::get;
    std::string path(request.target());
    path = path.substr(0, path.find('?'));
    if (path == "/") path = "/index.html";
    if (path == "/events" && body) return stream(version);
    if (path == "/state")
      return send(make(http::status::ok, "application/json", shared_.state + "\n", version), request.keep_alive(), body);
    const auto file = shared_.files.find(path);
    if (file == shared_.files.end()) return reply(http::status::not_found, "there is no such page\n");
    send(make(http::status::ok, content_type(path), std::string(file->second), version), request.keep_alive(), body);
  }

  void stream(unsigned version) {
    head_.emplace(http::status::ok, version);
    head_->set(http::field::content_type, "text/event-stream");
    head_->set(http::field::cache_control, "no-store");
    head_->set("Content-Security-Policy", kPolicy);
    head_->keep_alive(false);
    serializer_.emplace(*head_);
    expire();
    http::async_write_header(stream_, *serializer_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->end();
      self->streaming_ = true;
      self->push();
      self->watch_for_end();
    });
  }

  void watch_for_end() {
    stream_.socket().async_read_some(asio::buffer(dropped_), [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->end();
      self->watch_for_end();
    });
  }

  beast::tcp_stream stream_;
  Shared& shared_;
  Connections& all_;
  beast::flat_buffer buffer_{16384};
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<http::response<http::empty_body>> head_;
  std::optional<http::response_serializer<http::empty_body>> serializer_;
  std::string event_;
  char dropped_[256];
  bool streaming_{false}, writing_{false}, stale_{false};
};

}  // namespace

struct HttpServer::Impl {
  HttpSettings settings;
  Shared shared;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  Connections connections;
  std::thread thread;

  void accept() {
    acceptor.async_accept([this](Error error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) {
        auto connection = std::make_shared<Connection>(std::move(socket), shared, connections);
        const bool full = connections.size() >= settings.max_clients;
        connections.insert(connection);
        if (full) {
          connection->refuse(http::status::service_unavailable, "too many pages are open\n");
        } else {
          connection->read();
        }
      }
      accept();
    });
  }
};

HttpServer::HttpServer(const HttpSettings& settings, PageFiles files) : impl_(std::make_unique<Impl>()) {
  Impl& impl = *impl_;
  impl.settings = settings;
  impl.shared.files = std::move(files);
  impl.shared.timeout = settings.request_timeout;
  const tcp::endpoint endpoint(asio::ip::address_v4::loopback(), settings.port);
  Error error;
  impl.acceptor.open(endpoint.protocol());
  impl.acceptor.set_option(tcp::acceptor::reuse_address(true));
  impl.acceptor.bind(endpoint, error);
  if (!error) impl.acceptor.listen(16, error);
  if (error)
    throw std::runtime_error("port " + std::to_string(settings.port) + " on 127.0.0.1 cannot be used for the page: " + error.message());
  for (const char* host : {"127.0.0.1", "localhost"}) impl.shared.hosts.insert(std::string(host) + ":" + std::to_string(port()));
  impl.accept();
  impl.thread = std::thread([this] { impl_->context.run(); });
}

HttpServer::~HttpServer() {
  impl_->context.stop();
  impl_->thread.join();
  impl_->connections.clear();
}

std::uint16_t HttpServer::port() const { return impl_->acceptor.local_endpoint().port(); }

void HttpServer::update(std::string state) {
  asio::post(impl_->context, [this, fresh = std::move(state)]() mutable {
    impl_->shared.state = std::move(fresh);
    const Connections now = impl_->connections;
    for (const auto& connection : now) connection->push();
  });
}

unsigned HttpServer::clients() const { return impl_->shared.clients.load(); }

}  // namespace handsel::bridge
