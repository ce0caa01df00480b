// SPDX-License-Identifier: Apache-2.0
#include "common/bus/dds/dds_bus.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <random>
#include <vector>

#include "common/bus/dds/dds_configuration.hpp"
#include "common/bus/dds/dds_defaults.hpp"
#include "common/bus/dds/discovered_domain.hpp"
#include "common/bus/dds/qos.hpp"
#include "common/bus/dds/raw_reader.hpp"
#include "common/bus/dds/realtime.hpp"
#include "common/bus/dds/topic_entities.hpp"
#include "common/bus/dds/writer_discovery.hpp"
#include "common/bus/executor.hpp"
#include "common/bus/intake.hpp"
#include "common/bus/left_out.hpp"
#include "common/bus/resource_usage.hpp"
#include "common/bus/send_refusal.hpp"
#include "common/bus/writer_gate.hpp"
#include "common/config/resources.hpp"
#include "common/messages/system.hpp"

namespace handsel {
namespace {

constexpr Duration kDdsHealthPeriod = std::chrono::milliseconds(100);
constexpr Duration kRetryPeriod = std::chrono::milliseconds(5);
constexpr std::size_t kQueueBound = 64;  // max requests and replies waiting for the transport
constexpr int kSamplesPerTurn = 64;  // max samples of a topic before other topics have their turn

Stamp system_now() {
  timespec t{};
  clock_gettime(CLOCK_REALTIME, &t);
  return t.tv_sec * 1'000'000'000LL + t.tv_nsec;
}

}  // namespace

void use_default_dds_configuration() { use_dds_configuration(resource("dds")); }

struct Reader {
  Reader(DdsBus::Impl& owner, const MessageType& type, Intake::Callback callback, Duration period,
         Intake::Log log)
      : bus(owner),
        intake(type, std::move(callback), period, std::move(log)),
        sample(type.new_wire()) {}
  DdsBus::Impl& bus;
  Intake intake;
  std::shared_ptr<void> sample;
  WriterGate gate;
  dds_entity_t entity{0};
  std::atomic<std::int64_t> arrival{0};
  bool wakes{true};
  std::atomic<bool> pending{false};
  std::atomic<bool> matching_changed{false};
};

struct DdsBus::Impl {
  explicit Impl(const DdsBusSettings& s)
      : settings(s),
        executor([this](const std::string& what) { log(what); }),
        start(monotonic_now()) {
    incarnation = (std::uint64_t{std::random_device{}()} << 32) | std::random_device{}();
  }
  ~Impl() {
    if (participant > 0) dds_delete(participant);
  }

  DdsBusSettings settings;
  Executor executor;
  TimePoint start;
  dds_entity_t participant{0};
  TopicEntities topics{participant};
  std::vector<std::unique_ptr<Reader>> readers;
  std::mutex pending_mutex;
  std::vector<Reader*> pending, draining;
  std::uint64_t simulator{};  // incarnation of the simulator that grants time
  Reader* pace{};             // reader of sim_clock, if simulated time is followed
  std::unique_ptr<WriterDiscovery>
      discovery;  // created with the first reader of a topic with one writer
  std::atomic<bool> discovery_news{false};
  std::uint64_t incarnation{};
  HealthState state{HealthState::starting};
  std::string degraded, realtime_note;
  SendRefusal refusal;
  double last_cpu{0};
  TimePoint last_health{};
  LeftOutCounts left_out;
  ComponentHealth health_message;
  std::unique_ptr<Publisher<ComponentHealth>> health;
  std::unique_ptr<Publisher<ClockReached>> reached;
  ClockReached reached_message;

  void log(const std::string& what) const {
    std::fprintf(stderr, "%s: %s\n", settings.component.c_str(), what.c_str());
  }
  /// Returns the system clock; it is at rest while this component's time is.
  Stamp stamp_now() { return system_now() - (monotonic_now() - executor.now()).count(); }
  /// Creates a topic entity for one reader, filtered by the reader's gate.
  dds_entity_t gated_topic(Reader& reader) {
    const dds_entity_t entity = topics.make(reader.intake.type());
    reader.gate.filter(entity, [this, &reader] { mark(reader); });
    return entity;
  }
  void mark(Reader& reader);
  /// Adds the reader to the queue of drain().
  void queue(Reader& reader);
  void drain();
  bool knows_time();
  void take(Reader& reader);
  void look_at_matching(Reader& reader);
  void discover_writers();
  void follow_writers(Reader& reader);
  void publish_health(TimePoint wall);
  void follow_pace(const SimClock& clock);
};

namespace {

void on_data(dds_entity_t, void* arg) {
  Reader& reader = *static_cast<Reader*>(arg);
  reader.arrival.store(monotonic_now().time_since_epoch().count(), std::memory_order_relaxed);
  if (reader.wakes) return reader.bus.mark(reader);
  reader.bus.queue(reader);
  reader.bus.executor.remind();
}

void on_matching(Reader& reader) {
  reader.matching_changed.store(true, std::memory_order_release);
  reader.bus.mark(reader);
}

class DdsPublisher final : public AnyPublisher {
 public:
  DdsPublisher(DdsBus::Impl& bus, const MessageType& type)
      : bus_(bus), type_(type), sample_(type.new_wire()) {
    const Qos qos = writer_qos(type.row());
    writer_ =
        valid_entity(dds_create_writer(bus.participant, bus.topics.of(type), qos.get(), nullptr),
                     std::string("writer of ") + type.row().topic);
  }
  ~DdsPublisher() override {
    alive_->store(false);
    dds_delete(writer_);
  }

  bool publish(const void* message) override {
    std::string why;
    if (!type_.to_wire(message, bus_.stamp_now(), sample_.get(), why)) return refuse(why);
    if (!queue_.empty()) return enqueue();
    const dds_return_t result = dds_write(writer_, sample_.get());
    if (result == DDS_RETCODE_OK) return true;
    const bool queued =
        type_.row().profile == Profile::request || type_.row().profile == Profile::reply;
    if (result == DDS_RETCODE_TIMEOUT && queued) return enqueue();
    return refuse(std::string(type_.row().topic) + " has no room: " + dds_strretcode(-result));
  }
  int readers() const override {
    dds_publication_matched_status_t status{};
    return dds_get_publication_matched_status(writer_, &status) == DDS_RETCODE_OK
               ? static_cast<int>(status.current_count)
               : 0;
  }

 private:
  bool refuse(const std::string& why) {
    const TimePoint now = monotonic_now();
    if (bus_.refusal.note(why, now)) bus_.log(bus_.refusal.text(now));
    return false;
  }
  bool enqueue() {
    if (queue_.size() >= kQueueBound)
      return refuse(std::string(type_.row().topic) + " has no room: its queue is full");
    queue_.push_back(std::move(sample_));
    sample_ = type_.new_wire();
    if (queue_.size() == 1) retry_later();
    return true;
  }
  void retry_later() {
    bus_.executor.after(kRetryPeriod, [this, alive = alive_](TimePoint) {
      if (alive->load()) retry();
    });
  }
  void retry() {
    while (!queue_.empty() && dds_write(writer_, queue_.front().get()) == DDS_RETCODE_OK)
      queue_.pop_front();
    if (!queue_.empty()) retry_later();
  }

  DdsBus::Impl& bus_;
  const MessageType& type_;
  std::shared_ptr<void> sample_;
  std::deque<std::shared_ptr<void>> queue_;
  std::shared_ptr<std::atomic<bool>> alive_ = std::make_shared<std::atomic<bool>>(true);
  dds_entity_t writer_{0};
};

}  // namespace

void DdsBus::Impl::queue(Reader& reader) {
  if (reader.pending.exchange(true, std::memory_order_acq_rel)) return;
  const std::lock_guard lock(pending_mutex);
  pending.push_back(&reader);
}

void DdsBus::Impl::mark(Reader& reader) {
  queue(reader);
  executor.wake();
}

/// Reports changes of the writers of topics with one writer to their readers.
void DdsBus::Impl::discover_writers() {
  if (!discovery) return;
  discovery->take(
      [this](std::uint64_t writer, const TopicRow& row, const WriterDiscovery::Found* found) {
        for (const auto& reader : readers) {
          if (&reader->intake.type().row() != &row) continue;
          if (found != nullptr)
            reader->intake.writer_appeared(writer, found->identity, executor.now());
          else
            reader->intake.writer_left(writer, executor.now());
          reader->gate.open_for(reader->intake.pinned());
        }
      });
}

/// Reports the known writers of its topic to a new reader.
void DdsBus::Impl::follow_writers(Reader& reader) {
  if (!has_one_writer(reader.intake.type().row())) return;
  if (!discovery) {
    discovery = std::make_unique<WriterDiscovery>(participant, [this] {
      discovery_news.store(true, std::memory_order_release);
      executor.wake();
    });
  }
  discover_writers();
  for (const auto& [writer, found] : discovery->writers())
    if (found.row == &reader.intake.type().row())
      reader.intake.writer_appeared(writer, found.identity, executor.now());
  reader.gate.open_for(reader.intake.pinned());
}

/// Returns whether this component knows the present time. A process that was stopped knows it from
/// the next grant on; samples are not taken before that, as they would arrive in the past and all
/// later ones would count as late.
bool DdsBus::Impl::knows_time() {
  if (pace == nullptr || !executor.stale()) return true;
  pace->pending.store(false, std::memory_order_release);
  take(*pace);
  return !executor.stale();
}

void DdsBus::Impl::drain() {
  if (!knows_time()) return;  // the next grant wakes this executor
  if (discovery_news.exchange(false, std::memory_order_acq_rel)) discover_writers();
  {
    const std::lock_guard lock(pending_mutex);
    draining.swap(pending);
  }
  for (Reader* reader : draining) {
    reader->pending.store(false, std::memory_order_release);
    if (reader->matching_changed.exchange(false, std::memory_order_acq_rel))
      look_at_matching(*reader);
    reader->gate.report_refusals(reader->intake, executor.now());
    take(*reader);
  }
  draining.clear();
}

void DdsBus::Impl::take(Reader& reader) {
  for (int i = 0; i < kSamplesPerTurn; ++i) {
    void* samples[1] = {reader.sample.get()};
    dds_sample_info_t info{};
    const dds_return_t n = dds_take(reader.entity, samples, &info, 1, 1);
    if (n <= 0) return;
    if (!info.valid_data) continue;
    const std::int64_t arrival = reader.arrival.load(std::memory_order_relaxed);
    const TimePoint now = executor.now();
    const TimePoint at =
        arrival > 0 ? std::min(executor.past(TimePoint(Duration(arrival))), now) : now;
    if (!reader.intake.knows(info.publication_handle)) discover_writers();
    reader.intake.deliver(reader.sample.get(), info.publication_handle, at);
  }
  mark(reader);
}

void DdsBus::Impl::look_at_matching(Reader& reader) {
  dds_liveliness_changed_status_t liveliness{};
  if (dds_get_liveliness_changed_status(reader.entity, &liveliness) != DDS_RETCODE_OK) return;
  SubscriptionStatus& status = reader.intake.status();
  const int alive = static_cast<int>(liveliness.alive_count);
  if (alive < status.writers) {
    status.writers_lost += static_cast<std::uint64_t>(status.writers - alive);
    reader.intake.writer_gone(liveliness.last_publication_handle);
  }
  status.writers = alive;
}

/// Acknowledges every grant, so that the simulator knows this component has had its turn.
void DdsBus::Impl::follow_pace(const SimClock& clock) {
  if (!executor.grant({clock.incarnation, TimePoint(from_seconds(clock.granted_until)),
                       from_seconds(clock.waited)}))
    return;
  if (clock.incarnation != simulator) {
    simulator = clock.incarnation;
    for (const auto& reader : readers) reader->intake.forget_ages();
  }
  reached_message.component = settings.component;
  reached_message.incarnation = static_cast<std::uint64_t>(getpid());
  reached_message.sequence = clock.sequence;
  reached->publish(reached_message);
}

/// Publishes the heartbeat, in real time, as it shows that the process lives.
void DdsBus::Impl::publish_health(TimePoint wall) {
  const TimePoint now = executor.now();
  ComponentHealth& m = health_message;
  m.stamp = system_now();
  m.component = settings.component;
  m.incarnation = incarnation;
  m.pid = static_cast<std::uint32_t>(getpid());
  m.uptime = to_seconds(wall - start);
  m.memory_mb = resident_mb();
  const double cpu = process_cpu_seconds();
  if (last_health != TimePoint{} && wall > last_health)
    m.cpu = std::max(0.0, (cpu - last_cpu) / to_seconds(wall - last_health));
  last_cpu = cpu;
  last_health = wall;
  SecondWriters others;
  for (const auto& reader : readers) {
    reader->gate.report_refusals(reader->intake, now);
    reader->intake.watch(now);
    reader->gate.open_for(reader->intake.pinned());
    others.add(reader->intake);
  }
  m.job_silent = executor.job_silent(wall);
  m.reason = m.job_silent ? "a job in the background gives no sign of life" : "";
  for (const std::string& reason : {others.reason(), degraded})
    if (!reason.empty()) m.reason += (m.reason.empty() ? "" : "; ") + reason;
  if (m.reason.empty()) m.reason = refusal.text(wall);
  m.state = state != HealthState::ok ? state
            : m.reason.empty()       ? HealthState::ok
                                     : HealthState::degraded;
  m.topics.clear();
  m.left_out = left_out.counts();
  for (const auto& reader : readers) {
    add_left_out(reader->intake, m.left_out);
    if (m.topics.size() < 64) m.topics.push_back(reader->intake.health(now));
  }
  if (health) health->publish(m);
}

DdsBus::DdsBus(const DdsBusSettings& settings) : impl_(std::make_unique<Impl>(settings)) {
  use_default_dds_configuration();
  // This must come first: the threads of the transport inherit the priority.
  impl_->realtime_note = enter_realtime({.cpu = settings.cpu,
                                         .wanted = settings.realtime,
                                         .priority = static_cast<int>(settings.urgency)});
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_entity_name(qos.get(), settings.component.c_str());
  impl_->participant = valid_entity(create_participant(settings.domain, qos.get()),
                                    "domain " + std::to_string(settings.domain));
  impl_->executor.on_wake([this] { impl_->drain(); });
  if (settings.health) {
    impl_->health = advertise<ComponentHealth>();
    impl_->executor.every_real(kDdsHealthPeriod, [this](TimePoint wall) {
      impl_->publish_health(wall);
      impl_->executor.wake();  // samples may wait for a grant of a simulator that has ended
    });
  }
  if (settings.sim_time) {
    impl_->reached = advertise<ClockReached>();
    subscribe<SimClock>(
        [this](const SimClock& clock, const Receipt&) { impl_->follow_pace(clock); });
    impl_->pace = impl_->readers.back().get();
  }
}

DdsBus::~DdsBus() {
  impl_->reached.reset();
  impl_->health.reset();
  for (const auto& reader : impl_->readers) dds_delete(reader->entity);
}

void DdsBus::run() { impl_->executor.run(); }
void DdsBus::stop() noexcept { impl_->executor.stop(); }
bool DdsBus::end_jobs(Duration limit) { return impl_->executor.end_jobs(limit); }
bool DdsBus::run_until(const std::function<bool()>& done, Duration limit) {
  return impl_->executor.run_until(done, limit);
}
const std::string& DdsBus::realtime_note() const { return impl_->realtime_note; }
DomainView DdsBus::discovered_domain() const {
  return handsel::discovered_domain(impl_->participant);
}
std::uint64_t DdsBus::incarnation() const { return impl_->incarnation; }

void DdsBus::set_ready() {
  impl_->state = HealthState::ok;
  impl_->publish_health(monotonic_now());
}

void DdsBus::set_stopping() {
  impl_->state = HealthState::stopping;
  impl_->publish_health(monotonic_now());
}

bool DdsBus::has_twin(Duration wait) {
  bool twin = false;
  subscribe<ComponentHealth>([&](const ComponentHealth& health, const Receipt&) {
    if (health.component != component() || health.incarnation == incarnation() ||
        health.state == HealthState::stopping)
      return;
    twin = twin || health.state != HealthState::starting || health.incarnation < incarnation();
  });
  const std::unique_ptr<Reader> reader = std::move(impl_->readers.back());
  impl_->readers.pop_back();
  impl_->executor.run_until([&] { return twin; }, wait);
  dds_delete(reader->entity);
  const std::lock_guard lock(impl_->pending_mutex);
  std::erase(impl_->pending, reader.get());
  return twin;
}

std::unique_ptr<AnyPublisher> DdsBus::advertise_any(const MessageType& type, int) {
  return std::make_unique<DdsPublisher>(*impl_, type);
}

const SubscriptionStatus& DdsBus::subscribe_any(
    const MessageType& type, std::function<void(const void*, const Receipt&)> on_sample,
    const SubscribeOptions& options) {
  impl_->readers.push_back(
      std::make_unique<Reader>(*impl_, type, std::move(on_sample), options.period,
                               [impl = impl_.get()](const std::string& what) { impl->log(what); }));
  Reader* reader = impl_->readers.back().get();
  reader->wakes = options.wakes;
  const bool polled = options.period > Duration::zero();
  dds_listener_t* listener = dds_create_listener(reader);
  if (!polled) dds_lset_data_available(listener, &on_data);
  dds_lset_liveliness_changed(listener, [](dds_entity_t, const dds_liveliness_changed_status_t,
                                           void* arg) { on_matching(*static_cast<Reader*>(arg)); });
  const Qos qos = reader_qos(type.row());
  const dds_entity_t topic =
      has_one_writer(type.row()) ? impl_->gated_topic(*reader) : impl_->topics.of(type);
  reader->entity = dds_create_reader(impl_->participant, topic, qos.get(), nullptr);
  valid_entity(reader->entity, std::string("reader of ") + type.row().topic);
  dds_set_listener(reader->entity, listener);
  dds_delete_listener(listener);
  if (polled)
    impl_->executor.every(options.period,
                          [impl = impl_.get(), reader](TimePoint) { impl->take(*reader); });
  reader->matching_changed.store(true);
  impl_->follow_writers(*reader);
  impl_->mark(*reader);
  return reader->intake.status();
}

std::unique_ptr<RawReader> DdsBus::read_raw(const MessageType& type, RawDepth depth) {
  const Qos qos = depth == RawDepth::many ? recorder_qos(type.row()) : observer_qos(type.row());
  return make_raw_reader(valid_entity(
      dds_create_reader(impl_->participant, impl_->topics.of(type), qos.get(), nullptr),
      std::string("reader of ") + type.row().topic));
}

std::uint32_t DdsBus::domain() const { return impl_->settings.domain; }

Duration DdsBus::lag_any(const MessageType& type) const {
  Duration min_age = Duration::max();
  for (const auto& reader : impl_->readers)
    if (&reader->intake.type() == &type)
      min_age = std::min(min_age, reader->intake.status().age(now()));
  return min_age;
}

const TimerStatus& DdsBus::every(Duration period, std::function<void(TimePoint)> on_tick) {
  return impl_->executor.every(period, std::move(on_tick));
}
void DdsBus::after(Duration delay, std::function<void(TimePoint)> on_time) {
  impl_->executor.after(delay, std::move(on_time));
}
CancelToken DdsBus::run_job(std::function<Duration(const CancelToken&)> work,
                            std::function<void()> done) {
  return impl_->executor.run_job(std::move(work), std::move(done));
}
TimePoint DdsBus::now() const { return impl_->executor.now(); }
Stamp DdsBus::stamp_now() const { return impl_->stamp_now(); }
void DdsBus::set_degraded(const std::string& reason) { impl_->degraded = reason; }
void DdsBus::count_left_out(const std::string& what, std::uint64_t more) {
  impl_->left_out.add(what, more);
}
const std::string& DdsBus::component() const { return impl_->settings.component; }

}  // namespace handsel
