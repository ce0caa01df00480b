#include "common/bus/local_bus.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <deque>
#include <map>
#include <stdexcept>
#include <vector>

#include "common/base/hash.hpp"
#include "common/bus/foreign.hpp"
#include "common/bus/intake.hpp"
#include "common/bus/left_out.hpp"
#include "common/bus/resource_usage.hpp"
#include "common/bus/send_refusal.hpp"
#include "common/messages/system.hpp"

namespace handsel {

class LocalBus;

namespace {

constexpr Stamp kVirtualEpoch =
    1'700'000'000'000'000'000;  // where the virtual system clock starts [ns]
constexpr Duration kHealthPeriod = std::chrono::milliseconds(100);
constexpr std::size_t kKeepAllBound = 64;

bool transient_local(Profile p) { return p == Profile::state || p == Profile::latch; }
bool best_effort(Profile p) { return p == Profile::sensor || p == Profile::setpoint; }
std::size_t depth(Profile p) {
  if (p == Profile::request || p == Profile::reply) return kKeepAllBound;
  return p == Profile::command || p == Profile::goal ? 8 : 1;
}

using Sample = std::shared_ptr<void>;

struct Writer {
  std::uint64_t id{};
  const MessageType* type{};
  LocalBus* bus{};
  bool alive{true};
  std::map<std::string, Sample, std::less<>> kept;  // last sample a key, for late joiners
  int readers{};
  std::uint64_t sent{};
};

struct Waiting {
  Sample sample;
  std::uint64_t writer{};
  std::string key;
};

struct Subscription {
  Subscription(const MessageType& type, Intake::Callback callback, Duration look_period,
               Intake::Log log)
      : intake(type, std::move(callback), look_period, std::move(log)), period(look_period) {}
  Intake intake;
  Duration period;
  LocalBus* bus{};
  std::map<std::uint64_t, TimePoint> last_arrival;  // per writer: samples do not overtake
  std::deque<Waiting> waiting;  // while the component is paused, or until the next look
};

struct Timer {
  Duration period;
  std::function<void(TimePoint)> on_tick;
  TimePoint due;
  TimerStatus status;
  bool missed{false};
};

struct Event {
  TimePoint at;
  std::uint64_t order;
  LocalBus* owner;  // nullptr: the network's own
  std::function<void()> run;
  bool operator<(const Event& other) const {
    return at != other.at ? at > other.at : order > other.order;
  }  // heap: earliest on top
};

}  // namespace

struct LocalNetwork::Impl {
  LocalNetworkSettings settings;
  TimePoint now{};
  std::uint64_t order{0};
  std::uint64_t handled{0};
  std::uint64_t random;
  std::uint64_t next_writer{1};
  std::vector<Event> events;
  std::vector<std::unique_ptr<LocalBus>> buses;
  std::vector<std::shared_ptr<Writer>> writers;
  std::deque<std::vector<Subscription*>> subscriptions{
      std::size(kTopics)};  // in the order of the table, then foreign ones
  std::deque<std::vector<Sample>> pools{std::size(kTopics)};
  std::map<std::string, std::size_t, std::less<>> foreign;  // topic -> index
  std::set<std::string> metered;
  bool hashed{false}, at_work{false};
  std::uint64_t outputs{kHashBasis};
  std::function<void(const MessageType&, const void*, Stamp)> tapped;

  explicit Impl(const LocalNetworkSettings& s) : settings(s), random(mix_bits(s.seed)) {}

  double uniform() {
    random = mix_bits(random);
    return static_cast<double>(random >> 11) * 0x1.0p-53;
  }
  Duration delay() {
    return from_seconds(settings.delay_min + (settings.delay_max - settings.delay_min) * uniform());
  }
  std::size_t index(const MessageType& type) {
    if (in_table(type.row())) return static_cast<std::size_t>(&type.row() - kTopics);
    const auto [at, fresh] = foreign.emplace(type.row().topic, subscriptions.size());
    if (fresh) {
      subscriptions.emplace_back();
      pools.emplace_back();
    }
    return at->second;
  }

  void schedule(TimePoint at, LocalBus* owner, std::function<void()> run) {
    events.push_back({at, order++, owner, std::move(run)});
    std::push_heap(events.begin(), events.end());
  }
  bool step(TimePoint limit);
  Sample sample(const MessageType& type) {
    auto& pool = pools[index(type)];
    for (Sample& s : pool)
      if (s.use_count() == 1) return s;
    pool.push_back(type.new_wire());
    return pool.back();
  }
  LocalBus& find(const std::string& component);
  void send(Writer& writer, const Sample& sample);
  void travel(Writer& writer, Subscription& to, const Sample& sample);
  void arrive(Subscription& to, std::uint64_t writer, const Sample& sample);
  void hand_over(Subscription& to);
  void lose(Writer& writer, Duration after);
  void take_down(const MessageType& type, void* wire);
};

namespace {

/// Counts the thread's CPU time of a callback for its component. It is looked at by whoever
/// reports, and decides nothing.
class Meter {
 public:
  Meter(LocalNetwork::Impl& network, LocalBus* bus);
  ~Meter();
  Meter(const Meter&) = delete;
  Meter& operator=(const Meter&) = delete;

 private:
  LocalNetwork::Impl& net_;
  LocalBus* bus_;  // null: nothing is counted
  double begin_{};
};

}  // namespace

class LocalBus final : public Bus {
 public:
  LocalBus(LocalNetwork::Impl& network, std::string component)
      : net_(network),
        component_(std::move(component)),
        metered_(net_.metered.contains(component_)) {
    health_ = advertise<ComponentHealth>();
    every(kHealthPeriod, [this](TimePoint now) { publish_health(now); });
  }

  std::unique_ptr<AnyPublisher> advertise_any(const MessageType& type, int strength) override;
  const SubscriptionStatus& subscribe_any(
      const MessageType& type, std::function<void(const void*, const Receipt&)> on_sample,
      const SubscribeOptions& options) override;
  Duration lag_any(const MessageType& type) const override {
    Duration least = Duration::max();
    for (const auto& s : subscriptions_)
      if (&s->intake.type() == &type) least = std::min(least, s->intake.status().age(net_.now));
    return least;
  }
  const TimerStatus& every(Duration period, std::function<void(TimePoint)> on_tick) override {
    if (period <= Duration::zero())
      throw std::invalid_argument("every: the period must be positive");
    timers_.push_back(
        std::make_unique<Timer>(Timer{period, std::move(on_tick), net_.now + period, {}, false}));
    Timer* timer = timers_.back().get();
    net_.schedule(timer->due, this, [this, timer] { tick(*timer); });
    return timer->status;
  }
  void after(Duration delay, std::function<void(TimePoint)> on_time) override {
    net_.schedule(net_.now + std::max(delay, Duration::zero()), this,
                  [this, f = std::move(on_time)] { f(net_.now); });
  }
  CancelToken run_job(std::function<Duration(const CancelToken&)> work,
                      std::function<void()> done) override {
    CancelToken token;
    const Duration modelled = std::max(work(token), Duration::zero());
    worker_free_ = std::max(worker_free_, net_.now) + modelled;
    net_.schedule(worker_free_, this, std::move(done));
    return token;
  }
  TimePoint now() const override { return net_.now; }
  Stamp stamp_now() const override { return kVirtualEpoch + net_.now.time_since_epoch().count(); }
  void set_degraded(const std::string& reason) override { degraded_ = reason; }
  void count_left_out(const std::string& what, std::uint64_t more) override {
    left_out_.add(what, more);
  }
  const std::string& component() const override { return component_; }

  void log(const std::string& what) const {
    std::fprintf(stderr, "%s: %s\n", component_.c_str(), what.c_str());
  }
  void refused(const std::string& why) {
    if (refusal_.note(why, now())) log(refusal_.text(now()));
  }
  WriterIdentity identity() const {
    return {.components = component_, .name = component_, .matches = true, .ended = [this] {
              return killed_;
            }};
  }
  void tick(Timer& timer);
  void publish_health(TimePoint now);
  void resume();

  LocalNetwork::Impl& net_;
  std::string component_;
  bool metered_, killed_{false}, paused_{false}, isolated_{false};
  std::string degraded_;
  SendRefusal refusal_;
  LeftOutCounts left_out_;
  TimePoint worker_free_{};
  double cpu_{0};
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  std::vector<std::unique_ptr<Timer>> timers_;
  std::vector<Event> held_;  // other events while paused
  std::unique_ptr<Publisher<ComponentHealth>> health_;
};

namespace {

class LocalPublisher final : public AnyPublisher {
 public:
  LocalPublisher(LocalNetwork::Impl& network, std::shared_ptr<Writer> writer)
      : net_(network), writer_(std::move(writer)) {}
  ~LocalPublisher() override {
    if (writer_->alive) net_.lose(*writer_, Duration::zero());
  }
  bool publish(const void* message) override {
    LocalBus& bus = *writer_->bus;
    if (!writer_->alive) return false;
    const Sample sample = net_.sample(*writer_->type);
    std::string why;
    if (!writer_->type->to_wire(message, bus.stamp_now(), sample.get(), why)) {
      bus.refused(why);
      return false;
    }
    ++writer_->sent;
    if (net_.hashed) net_.take_down(*writer_->type, sample.get());
    if (net_.tapped) net_.tapped(*writer_->type, sample.get(), bus.stamp_now());
    net_.send(*writer_, sample);
    return true;
  }
  int readers() const override { return writer_->readers; }

 private:
  LocalNetwork::Impl& net_;
  std::shared_ptr<Writer> writer_;
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
  const Duration on_the_way = delay();
  const bool lost =
      best_effort(writer.type->row().profile) && settings.loss > 0 && uniform() < settings.loss;
  if (lost || to.bus->killed_ ||
      (writer.bus != to.bus && (writer.bus->isolated_ || to.bus->isolated_)))
    return;
  TimePoint& last = to.last_arrival[writer.id];
  last = std::max(last + Duration(1), now + on_the_way);
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

std::unique_ptr<AnyPublisher> LocalBus::advertise_any(const MessageType& type, int) {
  auto writer = std::make_shared<Writer>();
  writer->id = net_.next_writer++;
  writer->type = &type;
  writer->bus = this;
  const auto& readers = net_.subscriptions[net_.index(type)];
  writer->readers = static_cast<int>(readers.size());
  for (Subscription* s : readers) {
    ++s->intake.status().writers;
    s->intake.writer_appeared(writer->id, identity(), net_.now);
  }
  net_.writers.push_back(writer);
  return std::make_unique<LocalPublisher>(net_, std::move(writer));
}

const SubscriptionStatus& LocalBus::subscribe_any(
    const MessageType& type, std::function<void(const void*, const Receipt&)> on_sample,
    const SubscribeOptions& options) {
  subscriptions_.push_back(std::make_unique<Subscription>(
      type, std::move(on_sample), options.period, [this](const std::string& what) { log(what); }));
  Subscription* subscription = subscriptions_.back().get();
  subscription->bus = this;
  net_.subscriptions[net_.index(type)].push_back(subscription);
  for (const auto& writer : net_.writers) {
    if (!writer->alive || writer->type != &type) continue;
    ++subscription->intake.status().writers;
    subscription->intake.writer_appeared(writer->id, writer->bus->identity(), net_.now);
    ++writer->readers;
    for (const auto& [key, sample] : writer->kept) net_.travel(*writer, *subscription, sample);
  }
  if (options.period > Duration::zero())
    every(options.period, [this, subscription](TimePoint) { net_.hand_over(*subscription); });
  return subscription->intake.status();
}

void LocalBus::tick(Timer& timer) {
  const TimePoint now = net_.now;
  const Duration late = now - timer.due;
  const std::int64_t skipped = late / timer.period;
  ++timer.status.cycles;
  timer.status.late_cycles += late > timer.period;
  timer.status.skipped += static_cast<std::uint64_t>(skipped);
  timer.status.worst = std::max(timer.status.worst, late);
  timer.due += timer.period * (skipped + 1);
  net_.schedule(timer.due, this, [this, &timer] { tick(timer); });
  timer.on_tick(now);
}

void LocalBus::resume() {
  paused_ = false;
  std::vector<Event> held = std::move(held_);
  held_.clear();
  for (Event& event : held) net_.schedule(net_.now, this, std::move(event.run));
  for (const auto& s : subscriptions_)
    if (s->period == Duration::zero())
      net_.schedule(net_.now, this, [this, sub = s.get()] { net_.hand_over(*sub); });
}

void LocalBus::publish_health(TimePoint now) {
  ComponentHealth health;
  health.component = component_;
  health.incarnation = mix_bits(std::hash<std::string>{}(component_));
  health.uptime = to_seconds(now.time_since_epoch());
  SecondWriters others;
  for (const auto& s : subscriptions_) {
    s->intake.watch(now);
    others.add(s->intake);
  }
  health.reason = others.reason();
  if (!degraded_.empty()) health.reason += (health.reason.empty() ? "" : "; ") + degraded_;
  if (health.reason.empty()) health.reason = refusal_.text(now);
  health.state = health.reason.empty() ? HealthState::ok : HealthState::degraded;
  health.left_out = left_out_.counts();
  for (const auto& s : subscriptions_) {
    add_left_out(s->intake, health.left_out);
    if (health.topics.size() < 64) health.topics.push_back(s->intake.health(now));
  }
  health_->publish(health);
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
