// SPDX-License-Identifier: Apache-2.0
// A whole system in one process and virtual time: same seed, same order, bit for bit. Every sample
// passes the wire conversions, travels for a seeded delay and meets the same depths (set-points: 1
// instead of 32), ownership and late-join rules as over DDS.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace handsel {

struct LocalNetworkSettings {
  std::uint64_t seed{1};  ///< of the transport delays and losses
  /// Transport delay of a sample, uniform between these [s]; order per writer and reader is kept.
  double delay_min{0.0001};
  double delay_max{0.0003};  ///< [s]
  double loss{};             ///< fraction of best-effort samples lost, [0, 1)
  double lease{0.3};         ///< a killed component is noticed by its readers after this [s]
};

class LocalNetwork {
 public:
  explicit LocalNetwork(std::uint64_t seed);
  explicit LocalNetwork(const LocalNetworkSettings& settings);
  ~LocalNetwork();
  LocalNetwork(const LocalNetwork&) = delete;
  LocalNetwork& operator=(const LocalNetwork&) = delete;

  /// Returns the bus of a new component; the bus lives as long as the network. The node built on it
  /// must not be destroyed before its last event unless the component was killed.
  Bus& add(const std::string& component);

  /// Returns the virtual time; it starts at zero.
  TimePoint now() const;
  /// Handles every event up to and including t. Throws std::logic_error for a t before now().
  void run_until(TimePoint t);
  /// Handles every event of the next `d`; see run_until().
  void run_for(Duration d) { run_until(now() + d); }
  /// Handles events until `done` holds (asked after each event) or `limit` is reached; true if it
  /// held.
  bool run_until(const std::function<bool()>& done, TimePoint limit);
  std::uint64_t events() const;  ///< number of events handled so far

  /// A writer or reader that exists or existed.
  struct Endpoint {
    std::string component;    ///< name given to LocalNetwork::add()
    std::string type;         ///< message type, as in the table of topics
    bool writes{};            ///< true: a writer; false: a reader
    std::uint64_t samples{};  ///< sent, or received and valid
  };
  /// Returns all writers, then all readers, those of killed components included.
  std::vector<Endpoint> endpoints() const;

  /// Counts the CPU time of these components' callbacks and jobs from now on; results do not depend
  /// on it.
  void meter(const std::set<std::string>& components);
  /// Returns the CPU time counted so far [s]. Throws std::invalid_argument without such a living
  /// component.
  double cpu(const std::string& component) const;
  /// Hashes every value sent from now on, with its time, into output_hash(): equal numbers, equal
  /// runs.
  void hash_outputs();
  /// Returns that number; without hash_outputs() a constant.
  std::uint64_t output_hash() const;
  /// Calls `on_sample` with every sample sent from now on, in its IDL struct, and its time; results
  /// must not depend on that call.
  void tap(std::function<void(const MessageType&, const void* wire, Stamp sent)> on_sample);

  /// Ends a component as kill -9 does: none of its callbacks runs any more, nothing of it is sent,
  /// its readers notice after the lease.
  void kill(const std::string& component);
  /// Stops a component as SIGSTOP does: while paused nothing of it runs; samples wait for it within
  /// the depth of their topic.
  void pause(const std::string& component);
  /// Runs a paused component again: what waited is handled now. Throws std::invalid_argument
  /// without such a living component.
  void resume(const std::string& component);
  /// Cuts (or restores) all traffic of a component in both directions; the component keeps running.
  void isolate(const std::string& component, bool cut);

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace handsel
