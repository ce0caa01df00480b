#include "components/bridge/server.hpp"

#include <array>
#include <atomic>
#include <bitset>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cstdio>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>

namespace handsel::bridge {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Request = http::request<http::empty_body>;
using Error = beast::error_code;

constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; font-src 'self'; connect-src 'self'; img-src 'self' data: blob:; "
    "worker-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
constexpr std::size_t kLargestMessage = 64 * 1024;  // of a client [bytes]
constexpr int kSendBuffer = 512 * 1024;             // of the kernel [bytes]: what is in it is old when a client is slow
constexpr int kMostBatches = 64;                    // that wait for the server's thread
constexpr std::size_t kMostChannels = 64;

std::chrono::milliseconds milliseconds(double seconds) { return std::chrono::milliseconds(static_cast<int>(1e3 * seconds)); }

TimePoint monotonic() { return TimePoint(std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch())); }

std::string text(beast::string_view view) { return {view.data(), view.size()}; }

class Connection;
class Client;

struct Shared {
  Shared(ServerSettings s, Site where, Catalogue catalogue, std::string json)
      : settings(std::move(s)),
        site(std::move(where)),
        hub(std::move(catalogue), [this](const std::string& uri) { return site.fetch(uri); }),
        config(std::move(json)) {}

  ServerSettings settings;
  Site site;
  Hub hub;
  std::string config;
  std::set<std::string> hosts;    // what a browser on this machine calls us; anything else is another site's name for us
  std::set<std::string> origins;  // of pages that may connect
  std::set<std::shared_ptr<Connection>> connections;
  std::set<std::shared_ptr<Client>> clients;
  Counters counters;  // on the server's thread
  std::set<std::string> told;

  mutable std::mutex mutex;  // of what the other side reads
  Counters published;
  std::bitset<kMostChannels> wanted;

  /// The first refusal of each kind is said; all are counted.
  void say(const std::string& kind, const std::string& what) {
    if (told.insert(kind).second) std::fprintf(stderr, "bridge: %s; more of this kind are only counted\n", what.c_str());
  }
  void publish_counters();
  void look_at_wishes();
};

/// One WebSocket client.
class Client : public std::enable_shared_from_this<Client> {
 public:
  Client(beast::tcp_stream&& stream, Shared& shared)
      : ws_(std::move(stream)), stall_(ws_.get_executor()), shared_(shared), viewer_(shared.hub) {}

  void open(const Request& request, const std::string& subprotocol) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = milliseconds(shared_.settings.request_timeout);
    timeout.idle_timeout = std::chrono::seconds(30);
    timeout.keep_alive_pings = true;
    beast::get_lowest_layer(ws_).expires_never();
    ws_.set_option(timeout);
    ws_.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, subprotocol);
      response.set(http::field::server, "handsel");
    }));
    ws_.read_message_max(kLargestMessage);
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

  Viewer& viewer() { return viewer_; }

  /// Sends what waits, one message at a time.
  void flush() {
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
    stall_.expires_after(milliseconds(shared_.settings.stall_timeout));
    stall_.async_wait([self = shared_from_this()](Error error) {
      if (!error && self->writing_)
        self->cut("it took nothing for " + std::to_string(self->shared_.settings.stall_timeout).substr(0, 4) + " s");
    });
    ws_.async_write(buffers, [self = shared_from_this()](Error error, std::size_t n) {
      self->writing_ = false;
      self->stall_.cancel();
      if (error) return self->end();
      ++self->shared_.counters.sent_messages;
      self->shared_.counters.sent_bytes += n;
      self->flush();
    });
  }

  void end() {
    if (ended_) return;
    ended_ = true;
    count();
    stall_.cancel();
    Error ignored;
    beast::get_lowest_layer(ws_).socket().shutdown(tcp::socket::shutdown_both, ignored);
    beast::get_lowest_layer(ws_).close();
    shared_.clients.erase(shared_from_this());
    shared_.look_at_wishes();
  }

 private:
  void read() {
    ws_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->leave(error);
      if (self->ws_.got_binary()) {
        self->viewer_.binary(monotonic());
      } else {
        const auto data = self->buffer_.cdata();
        self->viewer_.text({static_cast<const char*>(data.data()), data.size()}, monotonic());
      }
      self->buffer_.consume(self->buffer_.size());
      self->shared_.look_at_wishes();
      self->flush();
      if (self->viewer_.cut().empty()) self->read();
    });
  }

  /// Beast ends a broken conversation itself and says so, unless the client does not answer that in time.
  void leave(Error error) {
    const bool went = error == websocket::error::closed || error == asio::error::eof || error == asio::error::connection_reset ||
                      error == asio::error::broken_pipe;
    if (ended_ || went || !viewer_.cut().empty()) return end();
    ++shared_.counters.refused_messages;
    cut("it broke the protocol, sent a message of more than " + std::to_string(kLargestMessage) + " bytes or fell silent (" +
        error.message() + ")");
  }

  void cut(const std::string& why) {
    if (ended_) return;
    ++shared_.counters.cut_clients;
    shared_.say("cut", "a client is cut: " + why);
    end();
  }

  void close(websocket::close_code code, const std::string& why) {
    ++shared_.counters.cut_clients;
    shared_.say("cut", "a client is cut: " + why);
    writing_ = true;  // nothing else is sent
    stall_.expires_after(milliseconds(shared_.settings.stall_timeout));
    stall_.async_wait([self = shared_from_this()](Error error) {
      if (!error) self->end();
    });
    ws_.async_close({code, why.substr(0, 120)}, [self = shared_from_this()](Error) { self->end(); });
  }

  /// Adds what the viewer counted since the last time.
  void count() {
    shared_.counters.refused_messages += viewer_.refused() - refused_;
    refused_ = viewer_.refused();
    shared_.counters.dropped_samples += viewer_.outbox().dropped() - dropped_;
    dropped_ = viewer_.outbox().dropped();
  }

  websocket::stream<beast::tcp_stream> ws_;
  asio::steady_timer stall_;
  Shared& shared_;
  Viewer viewer_;
  beast::flat_buffer buffer_{kLargestMessage};
  Frame frame_;
  std::uint64_t refused_{0}, dropped_{0};
  bool accepted_{false}, writing_{false}, ended_{false};
};

void Shared::look_at_wishes() {
  std::bitset<kMostChannels> now;
  for (std::size_t i = 0; i < hub.catalogue().channels.size(); ++i) {
    for (const auto& client : clients) now[i] = now[i] || client->viewer().wants(i);
    if (!now[i]) hub.forget(i);
  }
  const std::lock_guard lock(mutex);
  wanted = now;
}

void Shared::publish_counters() {
  counters.clients = clients.size();
  counters.open = connections.size() + clients.size();
  const std::lock_guard lock(mutex);
  published = counters;
}

/// One HTTP connection; becomes a Client when it asks to.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket&& socket, Shared& shared) : stream_(std::move(socket)), shared_(shared) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(8192);
    parser_->body_limit(0);
    expire();
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](Error error, std::size_t) {
      if (error && error != http::error::end_of_stream && error.category() == http::make_error_code(http::error::bad_target).category()) {
        self->refuse(http::status::bad_request, "this is no HTTP request served here: " + error.message() + "\n", 11);
      } else if (error) {
        self->end();
      } else {
        self->answer(self->parser_->release());
      }
    });
  }

  void turn_away(const std::string& why) {
    ++shared_.counters.refused_connections;
    shared_.say("connection", "a connection is refused: " + why);
    send(make<http::string_body>(http::status::service_unavailable, 11, "text/plain; charset=utf-8", why + "\n"), false);
  }

  void end() {
    Error ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_both, ignored);
    stream_.close();
    shared_.connections.erase(shared_from_this());
  }

 private:
  void expire() { stream_.expires_after(milliseconds(shared_.settings.request_timeout)); }

  template <class Body>
  std::shared_ptr<http::response<Body>> make(http::status status, unsigned version, const char* type, typename Body::value_type body) {
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
  void send(std::shared_ptr<http::response<Body>> response, bool keep) {
    response->keep_alive(keep);
    ++shared_.counters.requests;
    expire();
    http::async_write(stream_, *response, [self = shared_from_this(), response, keep](Error error, std::size_t n) {
      self->shared_.counters.sent_bytes += n;
      if (error || !keep) return self->end();
      self->read();
    });
  }

  /// The head alone, with the length the body would have.
  void send_head(http::status status, unsigned version, const char* type, std::uint64_t length, bool keep) {
    auto response = make<http::empty_body>(status, version, type, {});
    response->content_length(length);
    response->keep_alive(keep);
    ++shared_.counters.requests;
    auto serializer = std::make_shared<http::response_serializer<http::empty_body>>(*response);
    expire();
    http::async_write_header(stream_, *serializer, [self = shared_from_this(), response, serializer, keep](Error error, std::size_t) {
      if (error || !keep) return self->end();
      self->read();
    });
  }

  void refuse(http::status status, const std::string& sentence, unsigned version) {
    ++shared_.counters.refused_requests;
    send(make<http::string_body>(status, version, "text/plain; charset=utf-8", sentence), false);
  }

  void answer(const Request& request) {
    const unsigned version = request.version();
    if (!shared_.hosts.contains(text(request[http::field::host])))
      return refuse(http::status::forbidden, "this page is for this machine only\n", version);
    if (websocket::is_upgrade(request)) return upgrade(request);
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return refuse(http::status::method_not_allowed, "read-only\n", version);
    const bool body = request.method() == http::verb::get;
    std::string path = text(request.target());
    path = path.substr(0, path.find('?'));
    if (path == "/config.json") return json(shared_.config, request, body);
    if (path == "/counters.json") return json(counters(), request, body);
    file(path, request, body);
  }

  void json(const std::string& content, const Request& request, bool body) {
    constexpr const char* kType = "application/json";
    if (!body) return send_head(http::status::ok, request.version(), kType, content.size(), request.keep_alive());
    send(make<http::string_body>(http::status::ok, request.version(), kType, content), request.keep_alive());
  }

  void file(const std::string& path, const Request& request, bool body) {
    const auto found = shared_.site.find(path);
    if (!found) {
      const bool no_page = path == "/" && !shared_.site.has_page();
      return refuse(http::status::not_found, no_page ? "the page is not built; ./run --build-only builds it\n" : "there is no such page\n",
                    request.version());
    }
    Error error;
    http::file_body::value_type content;
    content.open(found->c_str(), beast::file_mode::scan, error);
    if (error) return refuse(http::status::not_found, "there is no such page\n", request.version());
    const char* type = content_type(*found);
    if (!body) return send_head(http::status::ok, request.version(), type, content.size(), request.keep_alive());
    send(make<http::file_body>(http::status::ok, request.version(), type, std::move(content)), request.keep_alive());
  }

  void upgrade(const Request& request) {
    const unsigned version = request.version();
    const std::string origin = text(request[http::field::origin]);
    if (!origin.empty() && !shared_.origins.contains(origin))
      return refuse(http::status::forbidden,
                    "pages of " + origin.substr(0, 80) + " may not connect; allowed_origins in bridge.txtpb lists who may\n", version);
    const std::string subprotocol = choose_subprotocol(text(request[http::field::sec_websocket_protocol]));
    if (request.target() != "/" || subprotocol.empty())
      return refuse(http::status::bad_request, "a WebSocket here is on / and speaks foxglove.sdk.v1 or foxglove.websocket.v1\n", version);
    if (shared_.clients.size() >= shared_.settings.max_clients)
      return turn_away("there are " + std::to_string(shared_.clients.size()) + " viewers already");
    const auto client = std::make_shared<Client>(std::move(stream_), shared_);
    shared_.clients.insert(client);
    shared_.connections.erase(shared_from_this());
    client->open(request, subprotocol);
  }

  std::string counters() {
    shared_.publish_counters();
    const Counters& c = shared_.counters;
    return nlohmann::json{{"connections", c.connections},
                          {"requests", c.requests},
                          {"refused_connections", c.refused_connections},
                          {"refused_requests", c.refused_requests},
                          {"refused_messages", c.refused_messages},
                          {"cut_clients", c.cut_clients},
                          {"sent_messages", c.sent_messages},
                          {"sent_bytes", c.sent_bytes},
                          {"dropped_samples", c.dropped_samples},
                          {"clients", c.clients},
                          {"open", c.open}}
        .dump();
  }

  beast::tcp_stream stream_;
  Shared& shared_;
  beast::flat_buffer buffer_{16384};
  std::optional<http::request_parser<http::empty_body>> parser_;
};

}  // namespace

struct Server::Impl {
  Impl(ServerSettings settings, Site site, Catalogue catalogue, std::string config)
      : shared(std::move(settings), std::move(site), std::move(catalogue), std::move(config)) {}

  asio::io_context context{1};
  Shared shared;
  tcp::acceptor acceptor{context};
  std::atomic<int> batches{0};
  std::atomic<std::uint64_t> given_up{0};
  std::thread thread;

  void accept() {
    acceptor.async_accept([this](Error error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) {
        ++shared.counters.connections;
        const std::size_t open = shared.connections.size() + shared.clients.size();
        const auto connection = std::make_shared<Connection>(std::move(socket), shared);
        if (open >= 8u * shared.settings.max_clients) {
          ++shared.counters.refused_connections;  // not even told: answering takes a place too
        } else {
          shared.connections.insert(connection);
          if (open >= 4u * shared.settings.max_clients) {
            connection->turn_away("too many connections are open");
          } else {
            connection->read();
          }
        }
      }
      shared.publish_counters();
      accept();
    });
  }
};

Server::Server(const ServerSettings& settings, Site site, Catalogue catalogue, std::string config)
    : impl_(std::make_unique<Impl>(settings, std::move(site), std::move(catalogue), std::move(config))) {
  Impl& impl = *impl_;
  if (impl.shared.hub.catalogue().channels.size() > kMostChannels) throw std::logic_error("more channels than the server has room for");
  Error error;
  const tcp::endpoint endpoint(asio::ip::make_address_v4(settings.address, error), settings.port);
  if (error) throw std::runtime_error("\"" + settings.address + "\" is no IPv4 address to show the page at");
  impl.acceptor.open(endpoint.protocol());
  impl.acceptor.set_option(tcp::acceptor::reuse_address(true));
  impl.acceptor.bind(endpoint, error);
  if (!error) impl.acceptor.listen(64, error);
  if (error)
    throw std::runtime_error("port " + std::to_string(settings.port) + " on " + settings.address +
                             " cannot be used for the page: " + error.message());
  for (const char* host : {"127.0.0.1", "localhost"}) {
    const std::string name = std::string(host) + ":" + std::to_string(port());
    impl.shared.hosts.insert(name);
    impl.shared.origins.insert("http://" + name);
  }
  impl.shared.origins.insert(settings.allowed_origins.begin(), settings.allowed_origins.end());
  impl.accept();
  impl.thread = std::thread([this] { impl_->context.run(); });
}

Server::~Server() {
  impl_->context.stop();
  impl_->thread.join();
  impl_->shared.connections.clear();
  impl_->shared.clients.clear();
}

std::uint16_t Server::port() const { return impl_->acceptor.local_endpoint().port(); }

bool Server::wanted(std::size_t channel) const {
  const std::lock_guard lock(impl_->shared.mutex);
  return impl_->shared.wanted[channel];
}

bool Server::any_client() const {
  const std::lock_guard lock(impl_->shared.mutex);
  return impl_->shared.published.clients > 0 || impl_->shared.wanted.any();
}

void Server::publish(std::vector<Sample> samples) {
  if (samples.empty()) return;
  if (impl_->batches.load() >= kMostBatches) {
    impl_->given_up += samples.size();
    return;
  }
  ++impl_->batches;
  asio::post(impl_->context, [this, samples = std::move(samples)] {
    --impl_->batches;
    Shared& shared = impl_->shared;
    const auto clients = shared.clients;
    for (const Sample& sample : samples) {
      if (shared.wanted[sample.channel]) shared.hub.keep(sample);
      for (const auto& client : clients) client->viewer().sample(sample);
    }
    for (const auto& client : clients) client->flush();
  });
}

void Server::set_time(Stamp now) {
  if (impl_->batches.load() >= kMostBatches) return;
  ++impl_->batches;
  asio::post(impl_->context, [this, now] {
    --impl_->batches;
    const auto clients = impl_->shared.clients;
    for (const auto& client : clients) {
      client->viewer().time(now);
      client->flush();
    }
    impl_->shared.publish_counters();
  });
}

void Server::set_graph(Graph graph) {
  asio::post(impl_->context, [this, graph = std::move(graph)]() mutable {
    if (graph == impl_->shared.hub.graph()) return;
    impl_->shared.hub.set_graph(std::move(graph));
    const auto clients = impl_->shared.clients;
    for (const auto& client : clients) {
      client->viewer().graph_changed();
      client->flush();
    }
  });
}

Counters Server::counters() const {
  const std::lock_guard lock(impl_->shared.mutex);
  Counters counters = impl_->shared.published;
  counters.dropped_samples += impl_->given_up.load();
  return counters;
}

}  // namespace handsel::bridge
