// Emulated perception: rate, latency, noise and coverage of people and object trackers. Pure, seeded.
#pragma once

#include <deque>
#include <random>
#include <string>
#include <vector>

#include "common/messages/perception.hpp"
#include "common/messages/world.hpp"

namespace handsel::sim {

struct SensorSettings {
  std::string source;
  double rate{30};       ///< [Hz]
  double latency{0.03};  ///< from the instant seen to delivery [s]
  double noise{0.0};     ///< standard deviation of each coordinate [m]
  Coverage coverage;
};

/// A message with the instant it shows and the instant it is handed over [s of simulated time].
template <class M>
struct Delivery {
  double seen{}, due{};
  M message;
};

class HumanSensor {
 public:
  HumanSensor(const SensorSettings&, std::uint64_t seed);
  void observe(double now, const std::vector<const Person*>& people);
  /// Moves what is due by `now` to `out`.
  void collect(double now, std::vector<Delivery<HumanObservation>>& out);
  const std::string& source() const { return settings_.source; }

 private:
  SensorSettings settings_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0, 1};
  double next_{0};
  std::deque<Delivery<HumanObservation>> pending_;
};

/// An object as it truly is.
struct TrueObject {
  std::string id, model;
  Pose T_world_object{Pose::Identity()};
};

class ObjectSensor {
 public:
  ObjectSensor(const SensorSettings&, std::uint64_t seed);
  void observe(double now, const std::vector<TrueObject>& objects);
  void collect(double now, std::vector<Delivery<ObjectObservation>>& out);
  const std::string& source() const { return settings_.source; }

 private:
  SensorSettings settings_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0, 1};
  double next_{0};
  std::deque<Delivery<ObjectObservation>> pending_;
};

}  // namespace handsel::sim
