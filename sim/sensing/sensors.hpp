// Emulated perception: several sources of people and objects, each with its own rate, latency, jitter, noise, drop-outs, view and faults.
// Pure, seeded. Chance that is switched off is not drawn, so a source without it is the same bit for bit.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "common/geometry/line_of_sight.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::sim {

/// repeated_empty: the same picture, with nobody in it, again and again; elsewhere: it looks at another place, `shift` away, where nobody
/// is.
enum class SensorFaultKind { gap, frozen, repeated, teleport, swap, late, blind, repeated_empty, elsewhere };

struct SensorFault {
  SensorFaultKind kind{};
  double at{}, length{};           ///< [s]
  Vector3 shift{Vector3::Zero()};  ///< teleport, elsewhere: world [m]
  double delay{};                  ///< late [s]
};

enum class GazeOutput { with_body, none, only };

/// Fields as in SensorDescription of common/config/schema/scenario.proto.
struct SensorSettings {
  std::string source;
  double rate{30};       ///< [Hz]
  double latency{0.03};  ///< from the instant seen to delivery [s]
  double noise{0.0};     ///< standard deviation of each coordinate [m]
  Coverage coverage;
  double jitter{};                          ///< [s]
  double dropout{}, joint_dropout{};        ///< shares
  double burst_rate{}, burst_length{};      ///< [1/s], [s]
  std::optional<Pose> T_world_sensor;       ///< looks along +x
  std::string link;                         ///< that carries it; empty: it stands in the room
  Pose T_link_sensor{Pose::Identity()};     ///< where a link carries it
  double fov_horizontal{}, fov_vertical{};  ///< [rad]
  double range{};                           ///< [m]
  bool occlusion{};
  std::vector<std::string> joints;  ///< tracked; empty: all
  GazeOutput gaze{GazeOutput::with_body};
  double gaze_noise{};    ///< [rad]
  double gaze_dropout{};  ///< share
  double swap_rate{};     ///< [1/s]
  std::vector<SensorFault> faults;
};

/// Whether the point is inside range and field of view.
bool in_view(const SensorSettings&, const Vector3& point);

/// Moves it. What it claims to have looked at is nothing: a point where it is.
void carried_to(SensorSettings&, const Pose& T_world_sensor);
/// Whether a point can be seen at all: a sensor in the room sees what it claims to look at, one that is carried what is before it.
bool in_reach(const SensorSettings&, const Vector3& point);

/// Empty, or one sentence: which corner of the coverage it claims to look at lies outside its view.
std::string claims_too_much(const SensorSettings&);

/// A message with the instant it shows and the instant it is handed over [s of simulated time].
template <class M>
struct Delivery {
  double seen{}, due{};
  M message;
};

/// An object as it truly is.
struct TrueObject {
  std::string id, model;
  Pose T_world_object{Pose::Identity()};
};

/// All there is to see.
struct Sight {
  std::vector<const Person*> people;
  std::vector<std::vector<BodyCapsule>> bodies;  ///< of `people`, for occlusion
  std::vector<TrueObject> objects;
  std::vector<SightCapsule> robot;
  std::vector<SightBox> boxes;
};

/// When samples are made, lost and handed over; shared by all kinds of sensors.
template <class M>
class SampleStream {
 public:
  SampleStream(const SensorSettings& settings, std::uint64_t seed) : settings_(settings), chance_(seed ^ 0xd1ce'5eedULL) {}

  /// True once a period.
  bool due(double now);
  /// Whether the sample of this instant is lost.
  bool lost(double now);
  void send(double now, M message);
  void collect(double now, std::vector<Delivery<M>>& out);
  const SensorFault* fault(double now, SensorFaultKind kind) const;
  /// In addition to the faults of its settings.
  void disturb(const SensorFault& fault);
  /// Ends all disturbances.
  void restore();
  /// True with this probability; draws only when it is above 0.
  bool happens(double probability) { return probability > 0 && uniform_(chance_) < probability; }
  double uniform() { return uniform_(chance_); }

 private:
  SensorSettings settings_;
  std::mt19937_64 chance_;
  std::uniform_real_distribution<double> uniform_{0, 1};
  double next_{0}, burst_until_{-1}, last_due_{0};
  std::optional<Delivery<M>> last_, empty_;  // sent last; the picture of repeated_empty
  std::deque<Delivery<M>> pending_;
  std::vector<SensorFault> disturbances_;
};

class HumanSensor {
 public:
  HumanSensor(const SensorSettings&, std::uint64_t seed);
  bool due(double now) { return stream_.due(now); }
  /// Where it is now, for one that the robot carries.
  void carry_to(const Pose& T_world_sensor) { carried_to(settings_, T_world_sensor); }
  /// A disturbance, in addition to the faults of its settings.
  void disturb(const SensorFault& fault) { stream_.disturb(fault); }
  /// Ends all disturbances.
  void restore() { stream_.restore(); }
  /// To be called when due.
  void observe(double now, const Sight&);
  /// Moves what is due by `now` to `out`.
  void collect(double now, std::vector<Delivery<HumanObservation>>& out) { stream_.collect(now, out); }
  const SensorSettings& settings() const { return settings_; }

 private:
  bool sees(const Sight&, std::size_t person, const Vector3& point) const;
  void exchange_ids(const Sight&);
  const std::string& shown_id(const std::string& id);

  SensorSettings settings_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0, 1};
  SampleStream<HumanObservation> stream_;
  std::map<std::string, std::string> shown_;  // true id -> the tracker's, where it differs
  int renamed_{0};
};

class ObjectSensor {
 public:
  ObjectSensor(const SensorSettings&, std::uint64_t seed);
  bool due(double now) { return stream_.due(now); }
  void carry_to(const Pose& T_world_sensor) { carried_to(settings_, T_world_sensor); }
  void observe(double now, const Sight&);
  void collect(double now, std::vector<Delivery<ObjectObservation>>& out) { stream_.collect(now, out); }
  const SensorSettings& settings() const { return settings_; }

 private:
  SensorSettings settings_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0, 1};
  SampleStream<ObjectObservation> stream_;
};

}  // namespace handsel::sim
