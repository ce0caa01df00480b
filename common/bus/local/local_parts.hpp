// SPDX-License-Identifier: Apache-2.0
// For the sources of LocalNetwork: what the network and the bus of one component consist of.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/hash.hpp"
#include "common/bus/foreign.hpp"
#include "common/bus/intake.hpp"
#include "common/bus/left_out.hpp"
#include "common/bus/local_bus.hpp"
#include "common/bus/send_refusal.hpp"
#include "common/messages/system.hpp"

namespace handsel {

class LocalBus;

struct LocalNetwork::Impl {
  using Sample = std::shared_ptr<void>;

  struct Writer {
    std::uint64_t id{};         ///< unique in the network
    const MessageType* type{};  ///< of its samples
    LocalBus* bus{};            ///< of the component that writes
    bool alive{true};           ///< false: its publisher or its component has ended
    std::map<std::string, Sample, std::less<>> kept;  ///< last sample a key, for late joiners
    int readers{};                                    ///< number of subscriptions
    std::uint64_t sent{};                             ///< number of samples
  };

  struct Waiting {
    Sample sample;           ///< as it was sent
    std::uint64_t writer{};  ///< id of its writer
    std::string key;         ///< of the sample
  };

  struct Subscription {
    Subscription(const MessageType& type, Intake::Callback callback, Duration poll_period,
                 Intake::Log log)
        : intake(type, std::move(callback), poll_period, std::move(log)), period(poll_period) {}
    Intake intake;    ///< validates samples and passes them to the component
    Duration period;  ///< of polling; 0: a sample is delivered when it arrives
    LocalBus* bus{};  ///< of the component that reads
    std::map<std::uint64_t, TimePoint> last_arrival;  ///< per writer: samples do not overtake
    std::deque<Waiting> waiting;  ///< while the component is paused, or until the next poll
  };

  struct Timer {
    Duration period;                         ///< between two calls
    std::function<void(TimePoint)> on_tick;  ///< called each time
    TimePoint due;                           ///< of the next call
    TimerStatus status;                      ///< of the calls so far
  };

  struct Event {
    TimePoint at;               ///< when it happens
    std::uint64_t order;        ///< of events of the same time
    LocalBus* owner;            ///< nullptr: the network's own
    std::function<void()> run;  ///< what happens
    bool operator<(const Event& other) const {
      return at != other.at ? at > other.at : order > other.order;
    }  // heap: earliest on top
  };

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

  explicit Impl(const LocalNetworkSettings& s);
  ~Impl();

  double uniform();  ///< the next random number, [0, 1)
  Duration delay();  ///< of the next sample
  /// Returns the topic's number in `subscriptions` and `pools`.
  std::size_t index(const MessageType& type);
  /// Adds an event; `owner`: nullptr: the network.
  void schedule(TimePoint at, LocalBus* owner, std::function<void()> run);
  /// Handles the next event unless it is after `limit`; returns whether there was one.
  bool step(TimePoint limit);
  /// Returns a sample that is no longer used, or a new one.
  Sample sample(const MessageType& type);
  /// Returns the bus of a living component. Throws std::invalid_argument.
  LocalBus& find(const std::string& component);
  /// Sends a sample to all subscriptions of its topic.
  void send(Writer& writer, const Sample& sample);
  /// Sends a sample to one subscription, unless it is lost.
  void travel(Writer& writer, Subscription& to, const Sample& sample);
  /// Adds a sample to those that wait for a subscription, within the depth of the topic.
  void arrive(Subscription& to, std::uint64_t writer, const Sample& sample);
  void hand_over(Subscription& to);  ///< delivers what waits
  /// Ends a writer; its readers notice after this time.
  void lose(Writer& writer, Duration after);
  /// Adds a sample to the hash of the outputs.
  void take_down(const MessageType& type, void* wire);
};

class LocalBus final : public Bus {
 public:
  using Sample = LocalNetwork::Impl::Sample;
  using Writer = LocalNetwork::Impl::Writer;
  using Subscription = LocalNetwork::Impl::Subscription;
  using Timer = LocalNetwork::Impl::Timer;
  using Event = LocalNetwork::Impl::Event;

  LocalBus(LocalNetwork::Impl& network, std::string component);

  std::unique_ptr<AnyPublisher> advertise_any(const MessageType& type, int strength) override;
  const SubscriptionStatus& subscribe_any(
      const MessageType& type, std::function<void(const void*, const Receipt&)> on_sample,
      const SubscribeOptions& options) override;
  Duration lag_any(const MessageType& type) const override;
  const TimerStatus& every(Duration period, std::function<void(TimePoint)> on_tick) override;
  void after(Duration delay, std::function<void(TimePoint)> on_time) override;
  CancelToken run_job(std::function<Duration(const CancelToken&)> work,
                      std::function<void()> done) override;
  TimePoint now() const override { return net_.now; }
  Stamp stamp_now() const override;
  void set_degraded(const std::string& reason) override { degraded_ = reason; }
  void count_left_out(const std::string& what, std::uint64_t more) override {
    left_out_.add(what, more);
  }
  const std::string& component() const override { return component_; }

  void log(const std::string& what) const;  ///< on stderr, after the component's name
  /// Notes that a sample could not be sent, and logs it.
  void refused(const std::string& why);
  /// Returns the component as its readers see it.
  WriterIdentity identity() const;
  void tick(Timer& timer);             ///< calls it and schedules its next call
  void publish_health(TimePoint now);  ///< as DdsBus does
  void resume();                       ///< handles what waited while the component was paused

  // NOLINTBEGIN(readability-identifier-naming): private to all but the network
  LocalNetwork::Impl& net_;  ///< the network that this bus is part of
  std::string component_;    ///< name of the component
  bool metered_;             ///< CPU time of its callbacks is counted
  bool killed_{false};       ///< none of its callbacks runs any more
  bool paused_{false};       ///< what comes waits for it
  bool isolated_{false};     ///< nothing comes from others or reaches them
  std::string degraded_;     ///< why it works with restrictions; empty: it does not
  SendRefusal refusal_;      ///< of samples that could not be sent
  LeftOutCounts left_out_;   ///< as counted by the component
  TimePoint worker_free_{};  ///< when its last job ends
  double cpu_{0};            ///< time of its callbacks [s]
  std::vector<std::unique_ptr<Subscription>> subscriptions_;  ///< in the order they were made
  std::vector<std::unique_ptr<Timer>> timers_;                ///< in the order they were made
  std::vector<Event> held_;                                   ///< other events while paused
  std::unique_ptr<Publisher<ComponentHealth>> health_;        ///< of the component
  // NOLINTEND(readability-identifier-naming)
};

}  // namespace handsel
