// How a component talks: typed publishers and subscribers, timers and jobs. Two implementations: DdsBus (the product) and LocalBus
// (one process, virtual time, deterministic order). Everything a component registers is called on one executor thread of its node.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "common/base/time.hpp"
#include "common/bus/topics.hpp"   // template <class M> struct TopicOf; one row a message type

namespace handsel {

/// How a sample came.
struct Receipt {
  TimePoint arrival{};     ///< receiver's monotonic clock
  Duration age{};          ///< age at arrival: stamp offset - least offset seen from that writer (>= 0)
  std::uint64_t writer{};  ///< distinguishes writers (handle), stable while the writer lives
};

/// Asked by long work: stop as soon as possible?
class CancelToken {
 public:
  bool cancelled() const { return flag_->load(std::memory_order_relaxed); }
  void cancel() { flag_->store(true, std::memory_order_relaxed); }
 private:
  std::shared_ptr<std::atomic<bool>> flag_ = std::make_shared<std::atomic<bool>>(false);
};

template <class M>
class Publisher {
 public:
  virtual ~Publisher() = default;
  /// Never blocks. A zero stamp is filled with the system clock. Returns false (counted, logged once) when the message breaks its bounds.
  virtual bool publish(const M& message) = 0;
};

/// A component's door to everything else. One a component.
class Bus {
 public:
  virtual ~Bus() = default;

  template <class M>
  std::unique_ptr<Publisher<M>> advertise();
  /// Calls back on the executor thread with each valid sample; malformed ones are counted, logged once per source and dropped.
  template <class M>
  void subscribe(std::function<void(const M&, const Receipt&)> on_sample);
  /// Periodic on the monotonic clock; the callback gets the time it runs at. realtime: own priority SCHED_FIFO where permitted.
  virtual void every(Duration period, std::function<void(TimePoint)> on_tick) = 0;
  /// Long work: `work` runs off the executor (LocalBus: at once, finishing `modelled` later), then `done` on the executor.
  /// `work` returns the modelled compute time for LocalBus. The token cancels it.
  virtual CancelToken run_job(std::function<Duration(const CancelToken&)> work, std::function<void()> done) = 0;
  virtual TimePoint now() const = 0;
  virtual Stamp stamp_now() const = 0;
  /// Shown in ComponentHealth; empty reason = ok.
  virtual void set_degraded(const std::string& reason) = 0;
  virtual const std::string& component() const = 0;
};

}  // namespace handsel
