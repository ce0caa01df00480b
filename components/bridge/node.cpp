// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/node.hpp"

#include <cstdio>
#include <stdexcept>

#include "common/config/resources.hpp"
#include "common/config/settings/attention.hpp"
#include "common/config/settings/bridge.hpp"
#include "common/config/settings/spark.hpp"
#include "common/messages/system.hpp"
#include "components/bridge/catalogue.hpp"
#include "components/bridge/environment.hpp"

namespace handsel::bridge {
namespace {

constexpr Duration kRetry = std::chrono::seconds(5);
constexpr Duration kClock = std::chrono::milliseconds(100);
constexpr Duration kGraphPeriod = std::chrono::seconds(1);

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      raw_(dynamic_cast<RawBus*>(&bus)),
      site_(find_web_folder(), resource_root()),
      readers_(topics().size()),
      drawing_(context.robot, context.objects) {
  const auto settings = settings::read_bridge_settings(context.settings / "bridge.txtpb");
  settings_ = server_settings(settings);
  if (!settings_.token.empty()) steering_.emplace(bus);

  const auto zones = settings::read_attention_settings(context.settings / "attention.txtpb");
  const auto people = settings::read_spark_settings(context.settings / "spark.txtpb");
  const SystemFacts facts{
      .scenario = context.scenario.stem(),
      .domain = raw_ ? raw_->domain() : 0,
      .version = HANDSEL_VERSION,
      .session = std::to_string(bus.stamp_now()),
      .zones = {zones.contact_zone, zones.danger_zone, zones.interaction_zone, zones.social_zone},
      .attentive_angle = people.attentive_angle};
  catalogue_ = make_catalogue(*context.robot, resource_root(), facts);
  for (Channel& channel : Drawing::channels()) catalogue_.channels.push_back(std::move(channel));
  for (const OwnMesh& own : own_meshes(resource_root())) site_.serve(own.address, own.mesh);
  config_ = config_json(*context.robot, resource_root(), facts);

  bus_.subscribe<ComponentHealth>(
      [this](const ComponentHealth& m, const Receipt& receipt) { graph_.on(m, receipt.arrival); },
      {.period = kGraphPeriod});
  start_server();
  bus_.every(kRetry, [this](TimePoint) { start_server(); });
  bus_.every(from_seconds(1.0 / settings.rate), [this](TimePoint) {
    publish_samples();
    if (steering_ && server_) steering_->run(server_->commands());
  });
  bus_.every(kClock, [this](TimePoint) {
    if (!server_ || !server_->any_client()) return;
    server_->set_time(bus_.stamp_now());
    draw();
  });
  bus_.every(kGraphPeriod, [this](TimePoint now) {
    if (server_) server_->set_graph(graph(now));
  });
}

void Node::start_server() {
  if (server_) return;
  try {
    server_ = std::make_unique<Server>(settings_, site_, catalogue_, config_);
    bus_.set_degraded(raw_ ? "" : "this bus has no serialised samples; viewers see no topic");
    std::fprintf(stderr, "bridge: the page is at http://127.0.0.1:%u/\n", server_->port());
  } catch (const std::runtime_error& error) {
    bus_.set_degraded(error.what());
  }
}

void Node::publish_samples() {
  if (!server_ || !raw_) return;
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < readers_.size(); ++i) {
    if (!server_->wanted(i)) {
      readers_[i].reset();
      continue;
    }
    if (!readers_[i] && !read(i)) continue;
    for (RawSample raw; readers_[i]->take(raw);) {
      Sample sample{.channel = i,
                    .instance = raw.instance,
                    .gone = raw.gone,
                    .stamp = raw.stamp,
                    .bytes = {}};
      if (!raw.gone)
        sample.bytes = std::make_shared<const std::vector<std::uint8_t>>(std::move(raw.cdr));
      samples.push_back(std::move(sample));
    }
  }
  server_->publish(std::move(samples));
}

bool Node::read(std::size_t topic) {
  try {
    readers_[topic] = raw_->read_raw(message_type(topic));
    bus_.set_degraded("");  // an earlier attempt may have failed
    return true;
  } catch (const MissingError& error) {
    bus_.set_degraded(error.what());
    return false;
  }
}

void Node::draw() {
  const std::size_t transforms = topics().size(), scene = transforms + 1;
  if (!server_->wanted(transforms) && !server_->wanted(scene)) return;
  if (!drawing_listens_) {
    drawing_listens_ = true;
    bus_.subscribe<RobotState>([this](const RobotState& m, const Receipt&) { drawing_.take(m); },
                               {.period = kClock});
    bus_.subscribe<HumanState>([this](const HumanState& m, const Receipt&) { drawing_.take(m); },
                               {.period = kClock});
    bus_.subscribe<Scene>([this](const Scene& m, const Receipt&) { drawing_.take(m); },
                          {.period = kClock});
  }
  std::vector<Sample> samples;
  const auto add = [&](std::size_t channel, const std::string& bytes) {
    if (bytes.empty() || !server_->wanted(channel)) return;
    samples.push_back(
        {.channel = channel,
         .instance = 0,
         .gone = false,
         .stamp = bus_.stamp_now(),
         .bytes = std::make_shared<const std::vector<std::uint8_t>>(bytes.begin(), bytes.end())});
  };
  add(transforms, drawing_.transforms(bus_.stamp_now()));
  add(scene, drawing_.scene(bus_.stamp_now()));
  server_->publish(std::move(samples));
}

Graph Node::graph(TimePoint now) const {
  std::vector<bool> read_here;
  for (const auto& reader : readers_) read_here.push_back(reader != nullptr);
  return graph_.graph(now, read_here);
}

}  // namespace handsel::bridge
