// SPDX-License-Identifier: Apache-2.0
// Events, writers and subscriptions of the network, and its interface.
#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "common/bus/local/local_parts.hpp"
#include "common/bus/resource_usage.hpp"

namespace handsel {

namespace {

constexpr std::size_t kMaxWaitingCalls = 64;  // max waiting requests or replies

bool transient_local(Profile p) { return p == Profile::state || p == Profile::latch; }
bool best_effort(Profile p) { return p == Profile::sensor || p == Profile::setpoint; }
std::size_t depth(Profile p) {
  if (p == Profile::request || p == Profile::reply) return kMaxWaitingCalls;
  return p == Profile::command || p == Profile::goal ? 8 : 1;
}

/// Measures the thread's CPU time of a callback for its component. Used in reports only; no effect
/// on behaviour.
class Meter {
 public:
  Meter(LocalNetwork::Impl& network, LocalBus* bus);
  ~Meter();
  Meter(const Meter&) = delete;
  Meter& operator=(const Meter&) = delete;

 private:
  LocalNetwork::Impl& net_;
  LocalBus* bus_;  // null: no measurement
  double begin_{};
};

Meter::Meter(LocalNetwork::Impl& network, LocalBus* bus)
    : net_(network), bus_(bus && bus->metered_ && !network.at_work ? bus : nullptr) {
  if (bus_ == nullptr) return;
  net_.at_work = true;
  begin_ = thread_cpu_seconds();
}

Meter::~Meter() {
  if (bus_ == nullptr) return;
  bus_->cpu_ += thread_cpu_seconds() - begin_;
  net_.at_work = false;
}

}  // namespace

LocalNetwork::Impl::Impl(const LocalNetworkSettings& s) : settings(s), random(mix_bits(s.seed)) {}
LocalNetwork::Impl::~Impl() = default;

double LocalNetwork::Impl::uniform() {
  random = mix_bits(random);
  return static_cast<double>(random >> 11) * 0x1.0p-53;
}

Duration LocalNetwork::Impl::delay() {
  return from_seconds(settings.delay_min + (settings.delay_max - settings.delay_min) * uniform());
}

std::size_t LocalNetwork::Impl::index(const MessageType& type) {
  if (in_table(type.row())) return static_cast<std::size_t>(&type.row() - kTopics);
  const auto [at, fresh] = foreign.emplace(type.row().topic, subscriptions.size());
  if (fresh) {
    subscriptions.emplace_back();
    pools.emplace_back();
  }
  return at->second;
}

void LocalNetwork::Impl::schedule(TimePoint at, LocalBus* owner, std::function<void()> run) {
  events.push_back({at, order++, owner, std::move(run)});
  std::push_heap(events.begin(), events.end());
}

LocalNetwork::Impl::Sample LocalNetwork::Impl::sample(const MessageType& type) {
  auto& pool = pools[index(type)];
  for (Sample& s : pool)
    if (s.use_count() == 1) return s;
  pool.push_back(type.new_wire());
  return pool.back();
}

void LocalNetwork::Impl::take_down(const MessageType& type, void* wire) {
  const std::int64_t at = now.time_since_epoch().count();
  outputs = handsel::hashed(outputs, &at, sizeof at);
  outputs = handsel::hashed(outputs, type.row().topic, std::strlen(type.row().topic));
  type.leaves(wire, [this](const WireLeaf& leaf) {
    const auto* text = static_cast<const char*>(leaf.value);
    outputs = handsel::hashed(outputs, leaf.value,
                              leaf.kind == WireLeaf::Kind::text ? std::strlen(text) : leaf.size);
  });
}

bool LocalNetwork::Impl::step(TimePoint limit) {
  if (events.empty() || events.front().at > limit) return false;
  std::pop_heap(events.begin(), events.end());
  Event event = std::move(events.back());
  events.pop_back();
  now = event.at;
  ++handled;
  if (event.owner && event.owner->killed_) return true;
  if (event.owner && event.owner->paused_) {
    event.owner->held_.push_back(std::move(event));
    return true;
  }
  const Meter meter(*this, event.owner);
  event.run();
  return true;
}

LocalBus& LocalNetwork::Impl::find(const std::string& component) {
  for (const auto& bus : buses)
    if (bus->component_ == component && !bus->killed_) return *bus;
  throw std::invalid_argument("LocalNetwork: there is no living component \"" + component + '"');
}

void LocalNetwork::Impl::send(Writer& writer, const Sample& sample) {
  if (transient_local(writer.type->row().profile)) {
    const std::string_view key = writer.type->key(sample.get());
    const auto at = writer.kept.find(key);
    if (at == writer.kept.end())
      writer.kept.emplace(std::string(key), sample);
    else
      at->second = sample;
  }
  for (Subscription* to : subscriptions[index(*writer.type)]) travel(writer, *to, sample);
}

void LocalNetwork::Impl::travel(Writer& writer, Subscription& to, const Sample& sample) {
  const Duration transit = delay();
  const bool lost =
      best_effort(writer.type->row().profile) && settings.loss > 0 && uniform() < settings.loss;
  if (lost || to.bus->killed_ ||
      (writer.bus != to.bus && (writer.bus->isolated_ || to.bus->isolated_)))
    return;
  TimePoint& last = to.last_arrival[writer.id];
  last = std::max(last + Duration(1), now + transit);
  schedule(last, nullptr, [this, &to, id = writer.id, sample] { arrive(to, id, sample); });
}

void LocalNetwork::Impl::arrive(Subscription& to, std::uint64_t writer, const Sample& sample) {
  if (to.bus->killed_ || !to.intake.admits(writer, now)) return;
  const TopicRow& row = to.intake.type().row();
  const std::string_view key = to.intake.type().key(sample.get());
  std::size_t same_key = 0;
  for (const Waiting& w : to.waiting) same_key += w.key == key;
  if (same_key >= depth(row.profile)) {
    const auto oldest = std::find_if(to.waiting.begin(), to.waiting.end(),
                                     [&](const Waiting& w) { return w.key == key; });
    if (row.profile == Profile::request || row.profile == Profile::reply) return;
    to.waiting.erase(oldest);
  }
  to.waiting.push_back({sample, writer, std::string(key)});
  if (!to.bus->paused_ && to.period == Duration::zero()) hand_over(to);
}

void LocalNetwork::Impl::hand_over(Subscription& to) {
  while (!to.waiting.empty() && !to.bus->killed_ && !to.bus->paused_) {
    const Waiting next = std::move(to.waiting.front());
    to.waiting.pop_front();
    const Meter meter(*this, to.bus);
    to.intake.deliver(next.sample.get(), next.writer, now);
  }
}

void LocalNetwork::Impl::lose(Writer& writer, Duration after) {
  writer.alive = false;
  writer.kept.clear();
  const std::size_t topic = index(*writer.type);
  schedule(now + after, nullptr, [this, topic, id = writer.id] {
    for (Subscription* s : subscriptions[topic]) {
      --s->intake.status().writers;
      ++s->intake.status().writers_lost;
      s->intake.writer_gone(id);
      s->intake.writer_left(id, now);
      s->last_arrival.erase(id);
    }
  });
}

LocalNetwork::LocalNetwork(std::uint64_t seed) : LocalNetwork(LocalNetworkSettings{.seed = seed}) {}
LocalNetwork::LocalNetwork(const LocalNetworkSettings& settings)
    : impl_(std::make_unique<Impl>(settings)) {}
LocalNetwork::~LocalNetwork() { impl_->buses.clear(); }

Bus& LocalNetwork::add(const std::string& component) {
  impl_->buses.push_back(std::make_unique<LocalBus>(*impl_, component));
  return *impl_->buses.back();
}

TimePoint LocalNetwork::now() const { return impl_->now; }
std::uint64_t LocalNetwork::events() const { return impl_->handled; }

std::vector<LocalNetwork::Endpoint> LocalNetwork::endpoints() const {
  std::vector<Endpoint> out;
  for (const auto& writer : impl_->writers)
    out.push_back({writer->bus->component_, writer->type->row().type, true, writer->sent});
  for (const auto& bus : impl_->buses)
    for (const auto& s : bus->subscriptions_)
      out.push_back(
          {bus->component_, s->intake.type().row().type, false, s->intake.status().received});
  return out;
}

void LocalNetwork::meter(const std::set<std::string>& components) {
  impl_->metered = components;
  for (const auto& bus : impl_->buses) bus->metered_ = components.contains(bus->component_);
}
void LocalNetwork::hash_outputs() { impl_->hashed = true; }
void LocalNetwork::tap(std::function<void(const MessageType&, const void*, Stamp)> on_sample) {
  impl_->tapped = std::move(on_sample);
}
std::uint64_t LocalNetwork::output_hash() const { return impl_->outputs; }

double LocalNetwork::cpu(const std::string& component) const { return impl_->find(component).cpu_; }

void LocalNetwork::run_until(TimePoint t) {
  if (t < impl_->now) throw std::logic_error("LocalNetwork: time does not run backwards");
  while (impl_->step(t)) {
  }
  impl_->now = t;
}

bool LocalNetwork::run_until(const std::function<bool()>& done, TimePoint limit) {
  if (done()) return true;
  while (impl_->step(limit))
    if (done()) return true;
  impl_->now = std::max(impl_->now, limit);
  return false;
}

void LocalNetwork::kill(const std::string& component) {
  LocalBus& bus = impl_->find(component);
  bus.killed_ = true;
  for (const auto& writer : impl_->writers)
    if (writer->bus == &bus && writer->alive)
      impl_->lose(*writer, from_seconds(impl_->settings.lease));
}

void LocalNetwork::pause(const std::string& component) { impl_->find(component).paused_ = true; }
void LocalNetwork::resume(const std::string& component) { impl_->find(component).resume(); }
void LocalNetwork::isolate(const std::string& component, bool cut) {
  impl_->find(component).isolated_ = cut;
}

}  // namespace handsel
