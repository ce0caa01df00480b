// SPDX-License-Identifier: Apache-2.0
// Communication of a component: typed publishers and subscribers, timers and jobs. Two
// implementations: DdsBus (the product) and LocalBus (one process, virtual time, deterministic
// order). Everything a component registers is called on one executor thread of its node; everything
// here except CancelToken may be called from that thread only (and before it runs).
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "common/base/time.hpp"
#include "common/topics/topics.hpp"
#include "common/wire/message_type.hpp"

namespace handsel {

/// Circumstances of a sample's arrival.
struct Receipt {
  TimePoint arrival{};  ///< receiver's monotonic clock
  Duration age{};       ///< age at arrival: stamp offset - min offset seen from that writer (>= 0)
  std::uint64_t writer{};  ///< distinguishes writers (handle), stable while the writer lives
};

/// Counters of a subscription. Lives as long as the bus.
struct SubscriptionStatus {
  std::uint64_t received{};         ///< valid samples handed over
  std::uint64_t rejected{};         ///< malformed samples dropped
  std::uint64_t deadline_misses{};  ///< silences longer than the topic's deadline, one each
  std::uint64_t writers_lost{};     ///< writers that died, left or lost their lease
  int writers{};                    ///< alive and matched now
  TimePoint last_arrival{};    ///< arrival of the last valid sample; the epoch while there was none
  Duration last_age{};         ///< age at arrival of the last sample
  std::string last_rejection;  ///< one sentence
  std::uint64_t left_out{};    ///< malformed elements of lists that were left out of valid samples
  std::string last_left_out;   ///< one sentence
  /// Samples of another writer than the accepted one, on a topic with one writer.
  std::uint64_t refused{};
  std::string second_writer;  ///< identity of that other writer while it is there; else empty

  /// Returns whether no valid sample has arrived yet.
  bool never_seen() const { return received == 0; }
  /// Returns the age of the newest sample now: time since arrival + age at arrival; Duration::max()
  /// without any sample.
  Duration age(TimePoint now) const {
    return never_seen() ? Duration::max() : now - last_arrival + last_age;
  }
};

/// Punctuality of a timer. Lives as long as the bus.
struct TimerStatus {
  std::uint64_t cycles{};       ///< calls so far
  std::uint64_t late_cycles{};  ///< calls that began more than one period after they were due
  std::uint64_t skipped{};      ///< ticks left out because a later one was already due
  Duration worst{};             ///< max lateness so far
};

/// Request to long work to stop as soon as possible. Each query is also a sign of life of the job.
class CancelToken {
 public:
  /// Returns whether the work shall stop, and counts as a sign of life. Any thread.
  bool cancelled() const {
    state_->beats.fetch_add(1, std::memory_order_relaxed);
    return state_->flag.load(std::memory_order_relaxed);
  }
  /// Asks the work to stop; returns at once. Any thread.
  void cancel() { state_->flag.store(true, std::memory_order_relaxed); }
  /// Returns how often cancelled() was called: a running job whose count stays the same is silent.
  std::uint64_t beats() const { return state_->beats.load(std::memory_order_relaxed); }

 private:
  struct State {
    std::atomic<bool> flag{false};
    std::atomic<std::uint64_t> beats{0};
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

/// Publisher of one message type known at run time; Publisher<M> is its typed wrapper.
class AnyPublisher {
 public:
  virtual ~AnyPublisher() = default;
  /// As Publisher::publish(); `message` points to the domain struct of the publisher's type.
  virtual bool publish(const void* message) = 0;
  /// Returns the number of matched readers now; 0 when the transport gives no answer.
  virtual int readers() const = 0;
};

template <class M>
class Publisher {
 public:
  explicit Publisher(std::unique_ptr<AnyPublisher> publisher) : publisher_(std::move(publisher)) {}
  /// Sends the message without blocking; a zero stamp is sent as the system clock. Returns false
  /// (counted, logged once) when the message breaks its bounds or the transport has no room.
  bool publish(const M& message) { return publisher_->publish(&message); }
  /// Returns the number of matched readers now.
  int readers() const { return publisher_->readers(); }

 private:
  std::unique_ptr<AnyPublisher> publisher_;
};

struct SubscribeOptions {
  /// 0: each sample as it arrives. Otherwise the topic is polled once per period and the waiting
  /// samples are handed over: for slow readers of fast topics, which are then not woken by every
  /// sample.
  Duration period{};
  /// true: a sample wakes the component. false: the sample waits for the next callback of the
  /// component and is handed over before that callback; for samples that only a timer uses. A bus
  /// without threads hands every sample over as it arrives.
  bool wakes{true};
};

/// Communication of one component with all others; one bus per component.
class Bus {
 public:
  virtual ~Bus() = default;

  /// Creates a writer of the message's topic. `strength` has no effect: of a topic with one writer
  /// (has_one_writer) the first living one counts (common/bus/writer_pin).
  template <class M>
  std::unique_ptr<Publisher<M>> advertise(int strength = 0) {
    return std::make_unique<Publisher<M>>(advertise_any(message_type<M>(), strength));
  }
  /// Calls `on_sample` on the executor thread with each valid sample; malformed ones are counted,
  /// logged once per source and dropped. The message is valid during the call only.
  template <class M>
  const SubscriptionStatus& subscribe(std::function<void(const M&, const Receipt&)> on_sample,
                                      const SubscribeOptions& options = {}) {
    return subscribe_any(
        message_type<M>(),
        [f = std::move(on_sample)](const void* m, const Receipt& r) {
          f(*static_cast<const M*>(m), r);
        },
        options);
  }
  /// Returns the age of the newest sample of a subscribed topic; Duration::max() without any sample
  /// or subscription.
  template <class M>
  Duration lag() const {
    return lag_any(message_type<M>());
  }

  /// As advertise(), for a type known at run time only; the type must outlive the bus.
  virtual std::unique_ptr<AnyPublisher> advertise_any(const MessageType& type, int strength) = 0;
  /// As subscribe(), for a type known at run time only; `on_sample` receives a pointer to its
  /// domain struct.
  virtual const SubscriptionStatus& subscribe_any(
      const MessageType& type, std::function<void(const void*, const Receipt&)> on_sample,
      const SubscribeOptions& options) = 0;
  /// As lag(); the min age if the component subscribed more than once.
  virtual Duration lag_any(const MessageType& type) const = 0;

  /// Calls `on_tick` periodically in the component's time, without drift and with the time of the
  /// call; ticks that can no longer be kept are skipped and counted.
  virtual const TimerStatus& every(Duration period, std::function<void(TimePoint)> on_tick) = 0;
  /// Calls `on_time` once, after `delay`.
  virtual void after(Duration delay, std::function<void(TimePoint)> on_time) = 0;
  /// Runs long work: `work` runs off the executor (LocalBus: at once, finishing `modelled` later),
  /// then `done` on the executor, always, cancelled or not. `work` returns the modelled computing
  /// time, which only LocalBus uses. Jobs of a bus run one after the other.
  virtual CancelToken run_job(std::function<Duration(const CancelToken&)> work,
                              std::function<void()> done) = 0;
  /// Returns the component's time: all ages, timers and deadlines refer to it.
  virtual TimePoint now() const = 0;
  /// Returns the system clock [ns, UTC] at now().
  virtual Stamp stamp_now() const = 0;
  /// Reports the component as degraded in ComponentHealth; an empty reason as ok.
  virtual void set_degraded(const std::string& reason) = 0;
  /// Adds to a count of ComponentHealth.left_out. `what` says what was left out and why, e.g.
  /// "people: farther than the nearest 16"; at most 23 such texts are distinguished, so that it
  /// must hold nothing received from outside.
  virtual void count_left_out(const std::string& what, std::uint64_t more) = 0;
  /// Returns the name the bus was created with.
  virtual const std::string& component() const = 0;
};

}  // namespace handsel
