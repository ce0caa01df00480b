#include "components/bridge/node.hpp"

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "common/config/bridge.pb.h"
#include "common/config/resources.hpp"

namespace handsel::bridge {
namespace {

constexpr Duration kRetry = std::chrono::seconds(5);

std::uint16_t port_of(const config::BridgeSettings& settings) {
  if (const char* text = std::getenv("HANDSEL_WEB_PORT"); text && *text) {
    const std::string value = text;
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), port);
    if (error != std::errc() || end != value.data() + value.size())
      throw ConfigError("HANDSEL_WEB_PORT is \"" + value + "\"; it must be a port, 0..65535");
    return port;
  }
  if (settings.port() > 65535) throw ConfigError("bridge.txtpb: port is " + std::to_string(settings.port()) + "; it must be 0..65535");
  return static_cast<std::uint16_t>(settings.port());
}

}  // namespace

template <class M>
void Node::show(double max_rate) {
  const SubscribeOptions options{.period = max_rate > 0 ? from_seconds(1.0 / max_rate) : Duration{}};
  bus_.subscribe<M>([this](const M& sample, const Receipt& receipt) { view_.take(sample, receipt.arrival); }, options);
}

Node::Node(Bus& bus, const NodeContext& context) : bus_(bus), view_(context.robot) {
  config::BridgeSettings settings;
  load_text_proto(context.settings / "bridge.txtpb", settings);
  if (!(settings.rate() > 0.0 && settings.rate() <= 10.0))
    throw ConfigError("bridge.txtpb: rate is " + std::to_string(settings.rate()) + "; it must be in (0, 10] Hz");
  if (settings.max_clients() == 0) throw ConfigError("bridge.txtpb: max_clients is 0; it must be at least 1");
  settings_.port = port_of(settings);
  settings_.max_clients = settings.max_clients();

  const double rate = settings.rate();
  show<RobotState>(rate);
  show<HumanState>(rate);
  show<ActiveTrajectory>(rate);
  show<TrajectoryForecast>(rate);
  show<AttentionAdvice>(rate);
  show<ExecutionStatus>(rate);
  show<Scene>(0);
  show<Facts>(0);
  show<TaskStatus>(0);
  show<ActionStatus>(0);
  show<AttentionState>(0);
  show<ComponentHealth>(0);

  open_page();
  bus_.every(kRetry, [this](TimePoint) { open_page(); });
  bus_.every(from_seconds(1.0 / rate), [this](TimePoint now) {
    if (server_) server_->update(view_.json(now));
  });
}

void Node::open_page() {
  if (server_) return;
  try {
    server_ = std::make_unique<HttpServer>(settings_, page_files());
    bus_.set_degraded("");
    std::fprintf(stderr, "bridge: the page is at http://127.0.0.1:%u/\n", server_->port());
  } catch (const std::runtime_error& error) {
    bus_.set_degraded(error.what());
  }
}

}  // namespace handsel::bridge
