// SPDX-License-Identifier: Apache-2.0
// The product's bus: one Cyclone DDS participant and one executor thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/dds/domain_view.hpp"
#include "common/bus/dds/raw.hpp"

namespace handsel {

/// Priorities under SCHED_FIFO. Threads of equal priority do not interrupt each other: what
/// computes for milliseconds now and then must not share one with what answers every cycle.
enum class Urgency : int { perceive = 20, control = 40 };

struct DdsBusSettings {
  std::string component;    ///< entity name of the participant and key of its ComponentHealth
  std::uint32_t domain{0};  ///< DDS domain, 0 to 230
  bool realtime{false};     ///< SCHED_FIFO and locked memory for the executor; see realtime_note()
  Urgency urgency{Urgency::perceive};  ///< scheduling priority where `realtime` is in force
  int cpu{-1};                         ///< pins the executor; -1: none
  bool health{true};                   ///< publishes ComponentHealth (tools do not)
  /// Time as the simulator grants it (common/bus/paced_clock), which waits for this component.
  bool sim_time{false};
};

/// Sets CYCLONEDDS_URI to dds/loopback.xml of the resource root when the environment has none.
void use_default_dds_configuration();

class DdsBus : public Bus, public RawBus {
 public:
  /// Throws MissingError when the domain cannot be entered.
  explicit DdsBus(const DdsBusSettings& settings);
  ~DdsBus() override;

  /// Runs callbacks on the calling thread until stop() (any thread, or a signal handler).
  void run();
  /// Ends run() and run_until() after the callbacks that are under way. Any thread, or a signal
  /// handler.
  void stop() noexcept;
  /// Cancels every job and waits for the running one, so that the node may be destroyed; returns
  /// false if that one is still at work after `limit`.
  bool end_jobs(Duration limit);
  /// Runs callbacks until `done` holds (asked after each wake-up) or the time is over; true if it
  /// held.
  bool run_until(const std::function<bool()>& done, Duration limit);
  /// Returns why real-time scheduling is not in force; empty: it is.
  const std::string& realtime_note() const;
  /// Reports ok in ComponentHealth from now on (starting before).
  void set_ready();
  /// Reports stopping in ComponentHealth, at once.
  void set_stopping();
  /// Returns the random number of this process start, as in ComponentHealth.
  std::uint64_t incarnation() const;
  /// Serves callbacks for at most `wait`. Returns whether another live process of the same
  /// component exists. Of two that start together only the one with the larger incarnation gets
  /// true, so that one of them remains.
  bool has_twin(Duration wait);
  /// Returns the participants and endpoints discovered on the domain so far. For tools: allocates
  /// memory and queries the transport.
  DomainView discovered_domain() const;

  std::unique_ptr<AnyPublisher> advertise_any(const MessageType& type, int strength) override;
  const SubscriptionStatus& subscribe_any(
      const MessageType& type, std::function<void(const void*, const Receipt&)> on_sample,
      const SubscribeOptions& options) override;
  Duration lag_any(const MessageType& type) const override;
  std::unique_ptr<RawReader> read_raw(const MessageType& type,
                                      RawDepth depth = RawDepth::newest) override;
  std::uint32_t domain() const override;
  const TimerStatus& every(Duration period, std::function<void(TimePoint)> on_tick) override;
  void after(Duration delay, std::function<void(TimePoint)> on_time) override;
  CancelToken run_job(std::function<Duration(const CancelToken&)> work,
                      std::function<void()> done) override;
  TimePoint now() const override;
  Stamp stamp_now() const override;
  void set_degraded(const std::string& reason) override;
  void count_left_out(const std::string& what, std::uint64_t more) override;
  const std::string& component() const override;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace handsel
