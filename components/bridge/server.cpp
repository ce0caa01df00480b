// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/server.hpp"

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "components/bridge/http_connection.hpp"
#include "components/bridge/server_state.hpp"
#include "components/bridge/web_socket_client.hpp"

namespace handsel::bridge {
namespace {

namespace asio = boost::asio;
using tcp = asio::ip::tcp;
using Error = boost::system::error_code;

constexpr int kMaxBatches = 64;  // max batches that wait for the server's thread

}  // namespace

struct Server::Impl {
  Impl(ServerSettings settings, Site site, Catalogue catalogue, std::string config)
      : state(std::move(settings), std::move(site), std::move(catalogue), std::move(config)) {}

  asio::io_context context{1};
  ServerState state;
  tcp::acceptor acceptor{context};
  std::atomic<int> batches{0};
  std::atomic<std::uint64_t> given_up{0};
  std::thread thread;

  void accept() {
    acceptor.async_accept([this](Error error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) {
        ++state.counters.connections;
        const std::size_t open = state.connections.size() + state.clients.size();
        const auto connection = std::make_shared<HttpConnection>(std::move(socket), state);
        if (open >= std::size_t{8} * state.settings.max_clients) {
          ++state.counters.refused_connections;  // refused without an answer, as that would occupy
                                                 // a connection
        } else {
          state.connections.insert(connection);
          if (open >= std::size_t{4} * state.settings.max_clients) {
            connection->turn_away("too many connections are open");
          } else {
            connection->read();
          }
        }
      }
      state.publish_counters();
      accept();
    });
  }
};

Server::Server(const ServerSettings& settings, Site site, Catalogue catalogue, std::string config)
    : impl_(std::make_unique<Impl>(settings, std::move(site), std::move(catalogue),
                                   std::move(config))) {
  Impl& impl = *impl_;
  if (impl.state.hub.catalogue().channels.size() > kMaxChannels)
    throw std::logic_error("more channels than the server has room for");
  Error error;
  const tcp::endpoint endpoint(asio::ip::make_address_v4(settings.address, error), settings.port);
  if (error)
    throw std::runtime_error("\"" + settings.address + "\" is no IPv4 address to show the page at");
  impl.acceptor.open(endpoint.protocol());
  impl.acceptor.set_option(tcp::acceptor::reuse_address(true));
  impl.acceptor.bind(endpoint, error);
  if (!error) impl.acceptor.listen(64, error);
  if (error)
    throw std::runtime_error("port " + std::to_string(settings.port) + " on " + settings.address +
                             " cannot be used for the page: " + error.message());
  for (const char* host : {"127.0.0.1", "localhost"}) {
    const std::string name = std::string(host) + ":" + std::to_string(port());
    impl.state.hosts.insert(name);
    impl.state.origins.insert("http://" + name);
  }
  impl.state.origins.insert(settings.allowed_origins.begin(), settings.allowed_origins.end());
  impl.accept();
  impl.thread = std::thread([this] { impl_->context.run(); });
}

Server::~Server() {
  impl_->context.stop();
  impl_->thread.join();
  impl_->state.connections.clear();
  impl_->state.clients.clear();
}

std::uint16_t Server::port() const { return impl_->acceptor.local_endpoint().port(); }

bool Server::wanted(std::size_t channel) const {
  const std::lock_guard lock(impl_->state.mutex);
  return impl_->state.wanted[channel];
}

bool Server::any_client() const {
  const std::lock_guard lock(impl_->state.mutex);
  return impl_->state.published.clients > 0 || impl_->state.wanted.any();
}

void Server::publish(std::vector<Sample> samples) {
  if (samples.empty()) return;
  if (impl_->batches.load() >= kMaxBatches) {
    impl_->given_up += samples.size();
    return;
  }
  ++impl_->batches;
  asio::post(impl_->context, [this, samples = std::move(samples)] {
    --impl_->batches;
    ServerState& state = impl_->state;
    const auto clients = state.clients;
    for (const Sample& sample : samples) {
      if (state.wanted[sample.channel]) state.hub.keep(sample);
      for (const auto& client : clients) client->viewer().sample(sample);
    }
    for (const auto& client : clients) client->flush();
  });
}

void Server::set_time(Stamp now) {
  if (impl_->batches.load() >= kMaxBatches) return;
  ++impl_->batches;
  asio::post(impl_->context, [this, now] {
    --impl_->batches;
    const auto clients = impl_->state.clients;
    for (const auto& client : clients) {
      client->viewer().time(now);
      client->flush();
    }
    impl_->state.publish_counters();
  });
}

void Server::set_graph(Graph graph) {
  asio::post(impl_->context, [this, graph = std::move(graph)]() mutable {
    if (graph == impl_->state.hub.graph()) return;
    impl_->state.hub.set_graph(std::move(graph));
    const auto clients = impl_->state.clients;
    for (const auto& client : clients) {
      client->viewer().graph_changed();
      client->flush();
    }
  });
}

CommandQueue& Server::commands() { return impl_->state.queue; }

Counters Server::counters() const {
  const std::lock_guard lock(impl_->state.mutex);
  Counters counters = impl_->state.published;
  counters.dropped_samples += impl_->given_up.load();
  return counters;
}

}  // namespace handsel::bridge
