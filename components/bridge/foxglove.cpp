// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/foxglove.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace handsel::bridge {
namespace {

using Json = nlohmann::json;

enum Binary : std::uint8_t { kMessageData = 1, kTime = 2, kAssetReply = 4 };
enum Level { kInfo = 0, kWarning = 1, kError = 2 };
constexpr std::size_t kMaxInstances = 64;

template <class T>
void little_endian(std::vector<std::uint8_t>& out, T value) {
  for (std::size_t i = 0; i < sizeof value; ++i)
    out.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
}

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json endpoints(const std::map<std::string, std::set<std::string>>& now,
               const std::map<std::string, std::set<std::string>>& before, const char* ids) {
  Json list = Json::array();
  for (const auto& [topic, components] : now) {
    const auto known = before.find(topic);
    if (known == before.end() || known->second != components)
      list.push_back({{"name", topic}, {ids, components}});
  }
  return list;
}

std::uint32_t id_of(const Json& value, const char* what) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > UINT32_MAX)
    throw std::invalid_argument(std::string(what) + " must be a whole number from 0 to 4294967295");
  return value.get<std::uint32_t>();
}

const Json& field(const Json& message, const char* name) {
  const auto at = message.find(name);
  if (at == message.end())
    throw std::invalid_argument(std::string("the field ") + name + " is missing");
  return *at;
}

const Json& list(const Json& message, const char* name) {
  const Json& value = field(message, name);
  if (!value.is_array()) throw std::invalid_argument(std::string(name) + " must be a list");
  return value;
}

}  // namespace

std::string choose_subprotocol(std::string_view header) {
  while (!header.empty()) {
    const std::size_t comma = header.find(',');
    std::string_view one = header.substr(0, comma);
    header = comma == std::string_view::npos ? std::string_view() : header.substr(comma + 1);
    while (!one.empty() && (one.front() == ' ' || one.front() == '\t')) one.remove_prefix(1);
    while (!one.empty() && (one.back() == ' ' || one.back() == '\t')) one.remove_suffix(1);
    if (std::find(kSubprotocols.begin(), kSubprotocols.end(), one) != kSubprotocols.end())
      return std::string(one);
  }
  return {};
}

Hub::Hub(Catalogue catalogue, std::function<Asset(const std::string&)> fetch)
    : catalogue_(std::move(catalogue)),
      fetch_(std::move(fetch)),
      kept_(catalogue_.channels.size()) {
  greeting_ = std::make_shared<std::string>(
      dump({{"op", "serverInfo"},
            {"name", catalogue_.name},
            {"capabilities", {"time", "connectionGraph", "assets", "parameters"}},
            {"supportedEncodings", Json::array()},
            {"metadata", catalogue_.metadata},
            {"sessionId", catalogue_.session}}));
  Json list = Json::array();
  for (std::size_t i = 0; i < catalogue_.channels.size(); ++i) {
    const Channel& c = catalogue_.channels[i];
    list.push_back({{"id", i + 1},
                    {"topic", c.topic},
                    {"encoding", c.encoding},
                    {"schemaName", c.schema_name},
                    {"schema", c.schema},
                    {"schemaEncoding", c.schema_encoding}});
  }
  channels_ =
      std::make_shared<std::string>(dump({{"op", "advertise"}, {"channels", std::move(list)}}));
}

void Hub::keep(const Sample& sample) {
  if (!catalogue_.channels[sample.channel].kept) return;
  auto& instances = kept_[sample.channel];
  if (sample.gone) {
    instances.erase(sample.instance);
  } else if (instances.contains(sample.instance) || instances.size() < kMaxInstances) {
    instances[sample.instance] = sample;
  }
}

Viewer::Viewer(Hub& hub, const OutboxSettings& settings) : hub_(hub), outbox_(settings) {
  outbox_.put({hub.greeting(), {}, {}});
  outbox_.put({hub.channels(), {}, {}});
}

void Viewer::put(std::string text) {
  if (!outbox_.put({std::make_shared<const std::string>(std::move(text)), {}, {}}))
    cut_ = "it asks and does not read the answers";
}

void Viewer::status(int level, const std::string& message) {
  put(dump({{"op", "status"}, {"level", level}, {"message", message}}));
}

void Viewer::refuse(const std::string& why) {
  ++refused_;
  if (++errors_ > kMaxErrors) {
    cut_ = "more than " + std::to_string(kMaxErrors) +
           " of its messages were refused; the last: " + why;
    return;
  }
  status(kError, why);
}

bool Viewer::flooding(TimePoint now) {
  if (limit_.admit(now)) return false;
  ++refused_;
  cut_ = "more than " + std::to_string(kMaxMessages) + " messages in a second";
  return true;
}

void Viewer::binary(TimePoint now) {
  if (!flooding(now)) refuse("publishing and services are not offered; this server only shows");
}

void Viewer::text(std::string_view message, TimePoint now) {
  if (flooding(now)) return;
  const Json json = Json::parse(message, nullptr, false);
  if (!json.is_object()) return refuse("a message must be a JSON object");
  const auto op = json.find("op");
  if (op == json.end() || !op->is_string()) return refuse("a message must name its \"op\"");
  const std::string name = *op;
  try {
    if (name == "subscribe") {
      for (const Json& one : list(json, "subscriptions")) {
        if (!one.is_object())
          throw std::invalid_argument("subscriptions must be a list of objects");
        const std::uint32_t id = id_of(field(one, "id"), "id"),
                            channel = id_of(field(one, "channelId"), "channelId");
        if (channel == 0 || channel > hub_.catalogue().channels.size())
          throw std::invalid_argument("there is no channel " + std::to_string(channel));
        if (subscriptions_.contains(id))
          throw std::invalid_argument("subscription " + std::to_string(id) + " is in use");
        if (subscriptions_.size() >= kMaxSubscriptions)
          throw std::invalid_argument("more than " + std::to_string(kMaxSubscriptions) +
                                      " subscriptions");
        subscriptions_[id] = channel - 1;
        by_channel_.emplace(channel - 1, id);
        for (const auto& [instance, sample] : hub_.kept(channel - 1)) send(id, sample);
      }
    } else if (name == "unsubscribe") {
      for (const Json& one : list(json, "subscriptionIds")) {
        const std::uint32_t id = id_of(one, "a subscription id");
        const auto known = subscriptions_.find(id);
        if (known == subscriptions_.end())
          throw std::invalid_argument("there is no subscription " + std::to_string(id));
        std::erase_if(by_channel_, [id](const auto& entry) { return entry.second == id; });
        subscriptions_.erase(known);
        outbox_.forget(id);
      }
    } else if (name == "getParameters") {
      Json values = Json::array();
      std::set<std::string> wanted;
      for (const Json& one : list(json, "parameterNames"))
        if (one.is_string()) wanted.insert(one.get<std::string>());
      for (const auto& [parameter, value] : hub_.catalogue().parameters)
        if (wanted.empty() || wanted.contains(parameter))
          values.push_back({{"name", parameter}, {"value", value}});
      Json answer{{"op", "parameterValues"}, {"parameters", std::move(values)}};
      if (const auto id = json.find("id"); id != json.end() && id->is_string()) answer["id"] = *id;
      put(dump(answer));
    } else if (name == "fetchAsset") {
      const Json& uri = field(json, "uri");
      if (!uri.is_string()) throw std::invalid_argument("uri must be a text");
      fetch(uri, id_of(field(json, "requestId"), "requestId"));
    } else if (name == "subscribeConnectionGraph") {
      reported_graph_.emplace();
      send_graph({}, hub_.graph());
    } else if (name == "unsubscribeConnectionGraph") {
      reported_graph_.reset();
    } else {
      refuse("\"" + name.substr(0, 40) + "\" is not offered; this server only shows");
    }
  } catch (const std::invalid_argument& error) {
    refuse(name + ": " + error.what());
  }
}

void Viewer::sample(const Sample& sample) {
  if (sample.gone) return;
  const auto [first, last] = by_channel_.equal_range(sample.channel);
  for (auto at = first; at != last; ++at) send(at->second, sample);
}

void Viewer::send(std::uint32_t subscription, const Sample& sample) {
  Frame frame;
  frame.head.reserve(13);
  frame.head.push_back(kMessageData);
  little_endian(frame.head, subscription);
  little_endian(frame.head, sample.stamp);
  frame.body = sample.bytes;
  if (hub_.catalogue().channels[sample.channel].queued) {
    outbox_.put_queued(subscription, std::move(frame));
  } else {
    outbox_.put_newest(subscription, sample.instance, std::move(frame));
  }
}

void Viewer::time(Stamp now) {
  Frame frame;
  frame.head.push_back(kTime);
  little_endian(frame.head, now);
  constexpr std::uint32_t kNoSubscription = UINT32_MAX;
  outbox_.put_newest(kNoSubscription, UINT64_MAX, std::move(frame));
}

void Viewer::graph_changed() {
  if (reported_graph_) send_graph(*reported_graph_, hub_.graph());
}

void Viewer::send_graph(const Graph& before, const Graph& now) {
  Json removed = Json::array();
  for (const auto* known : {&before.writers, &before.readers})
    for (const auto& [topic, components] : *known)
      if (!now.writers.contains(topic) && !now.readers.contains(topic)) removed.push_back(topic);
  put(dump({{"op", "connectionGraphUpdate"},
            {"publishedTopics", endpoints(now.writers, before.writers, "publisherIds")},
            {"subscribedTopics", endpoints(now.readers, before.readers, "subscriberIds")},
            {"advertisedServices", Json::array()},
            {"removedTopics", std::move(removed)},
            {"removedServices", Json::array()}}));
  reported_graph_ = now;
}

void Viewer::fetch(const std::string& uri, std::uint32_t request) {
  Asset asset;
  if (outbox_.control_bytes() > kMaxAssetBytes) {
    asset.reason = "too many assets are being sent to this client";
  } else {
    asset = hub_.fetch(uri);
  }
  Frame frame;
  frame.head.push_back(kAssetReply);
  little_endian(frame.head, request);
  frame.head.push_back(asset.bytes ? 0 : 1);
  little_endian(frame.head, static_cast<std::uint32_t>(asset.reason.size()));
  frame.head.insert(frame.head.end(), asset.reason.begin(), asset.reason.end());
  frame.body = asset.bytes;
  if (!asset.bytes) ++refused_;
  if (!outbox_.put(std::move(frame))) cut_ = "it asks and does not read the answers";
}

}  // namespace handsel::bridge
