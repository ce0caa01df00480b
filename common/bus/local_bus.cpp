// SPDX-License-Identifier: Apache-2.0
#include "common/bus/local_bus.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "common/bus/local/local_parts.hpp"

namespace handsel {

namespace {

constexpr Stamp kVirtualEpoch =
    1'700'000'000'000'000'000;  // start of the virtual system clock [ns]
constexpr Duration kLocalHealthPeriod = std::chrono::milliseconds(100);

class LocalPublisher final : public AnyPublisher {
 public:
  LocalPublisher(LocalNetwork::Impl& network, std::shared_ptr<LocalBus::Writer> writer)
      : net_(network), writer_(std::move(writer)) {}
  ~LocalPublisher() override {
    if (writer_->alive) net_.lose(*writer_, Duration::zero());
  }
  bool publish(const void* message) override {
    LocalBus& bus = *writer_->bus;
    if (!writer_->alive) return false;
    const LocalBus::Sample sample = net_.sample(*writer_->type);
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
  std::shared_ptr<LocalBus::Writer> writer_;
};

}  // namespace

LocalBus::LocalBus(LocalNetwork::Impl& network, std::string component)
    : net_(network), component_(std::move(component)), metered_(net_.metered.contains(component_)) {
  health_ = advertise<ComponentHealth>();
  every(kLocalHealthPeriod, [this](TimePoint now) { publish_health(now); });
}

Duration LocalBus::lag_any(const MessageType& type) const {
  Duration min_age = Duration::max();
  for (const auto& s : subscriptions_)
    if (&s->intake.type() == &type) min_age = std::min(min_age, s->intake.status().age(net_.now));
  return min_age;
}

const TimerStatus& LocalBus::every(Duration period, std::function<void(TimePoint)> on_tick) {
  if (period <= Duration::zero()) throw std::invalid_argument("every: the period must be positive");
  timers_.push_back(
      std::make_unique<Timer>(Timer{period, std::move(on_tick), net_.now + period, {}}));
  Timer* timer = timers_.back().get();
  net_.schedule(timer->due, this, [this, timer] { tick(*timer); });
  return timer->status;
}

void LocalBus::after(Duration delay, std::function<void(TimePoint)> on_time) {
  net_.schedule(net_.now + std::max(delay, Duration::zero()), this,
                [this, f = std::move(on_time)] { f(net_.now); });
}

CancelToken LocalBus::run_job(std::function<Duration(const CancelToken&)> work,
                              std::function<void()> done) {
  CancelToken token;
  const Duration modelled = std::max(work(token), Duration::zero());
  worker_free_ = std::max(worker_free_, net_.now) + modelled;
  net_.schedule(worker_free_, this, std::move(done));
  return token;
}

Stamp LocalBus::stamp_now() const { return kVirtualEpoch + net_.now.time_since_epoch().count(); }

void LocalBus::log(const std::string& what) const {
  std::fprintf(stderr, "%s: %s\n", component_.c_str(), what.c_str());
}

void LocalBus::refused(const std::string& why) {
  if (refusal_.note(why, now())) log(refusal_.text(now()));
}

WriterIdentity LocalBus::identity() const {
  return {.components = component_, .name = component_, .matches = true, .ended = [this] {
            return killed_;
          }};
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

}  // namespace handsel
