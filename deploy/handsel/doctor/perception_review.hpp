// SPDX-License-Identifier: Apache-2.0
// What is wrong with the samples of perception processes, found from those of a few seconds. Pure:
// arrivals come in, findings go out.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/messages/perception.hpp"
#include "deploy/handsel/doctor/doctor.hpp"

namespace handsel {

/// What a source ought to see.
struct PerceptionGround {
  Coverage reach;  ///< of the robot, world [m]: sources of people together must look at all of it
  Vector3 base{Vector3::Zero()};  ///< of the robot, world [m]
  std::set<std::string> models;   ///< object descriptions there are
};

/// When the samples of one source came and were measured.
class SampleTimes {
 public:
  /// Arrival by the receiver's monotonic and system clocks.
  /// False: the sample before once more.
  bool add(Stamp stamp, TimePoint arrival, Stamp system_arrival);
  std::size_t count() const { return arrivals_.size(); }  ///< of samples, repeated ones included
  double rate() const;                                    ///< [Hz]; 0 with less than two
  double median_age() const;                              ///< [s] between stamp and arrival
  /// Rate, regularity, ages and clocks; `publisher` publishes `what`. Empty: all is well.
  std::vector<Finding> findings(const std::string& publisher, const std::string& what) const;

 private:
  std::vector<double> arrivals_;  // monotonic [s]
  std::vector<double> ages_;      // [s]
  std::size_t repeated_{0}, backwards_{0}, unstamped_{0};
  Stamp last_{0}, system_arrival_{0};
};

class PerceptionReview {
 public:
  explicit PerceptionReview(PerceptionGround ground) : ground_(std::move(ground)) {}

  /// Adds a sample of people, with its arrival by the monotonic and the system clock.
  void on(const HumanObservation&, TimePoint arrival, Stamp system_arrival);
  /// Adds a sample of objects, with its arrival by the monotonic and the system clock.
  void on(const ObjectObservation&, TimePoint arrival, Stamp system_arrival);
  /// A sample on this topic that was rejected, and why (`MessageType::from_wire`).
  /// `whole`: the sample was dropped; else an element of a list.
  void on_malformed(const std::string& topic, const std::string& why, bool whole = true);

  /// One sentence each; a source without a fault has one that is good. Sources and topics that
  /// never came have none.
  std::vector<Finding> findings() const;

 private:
  struct Bodies {
    SampleTimes times;
    Coverage coverage;
    std::size_t bodies{0}, max_at_once{0};  // seen in all, and at once
    std::set<std::string> ids, unknown_joints;
    // unsure: confidence so low that they are not counted
    std::size_t known_joints{0}, joints{0}, unsure{0};
    std::size_t frozen{0}, outside{0}, gazes{0}, mirrored{0};
    // [m] as reported; height of the feet, or 1.6 m below the head's
    std::vector<double> statures, lowest;
    std::vector<Vector3> up;  // from waist to head, unit
    double nearest{1e300};
    std::vector<ObservedPerson> last;
  };
  struct Things {
    SampleTimes times;
    std::set<std::string> ids, unknown_models;
    std::size_t things{0}, max_at_once{0};
    double lowest{1e300};
  };
  struct Malformed {
    std::size_t count{0}, whole{0};
    std::string last;
  };
  void add_person(Bodies& bodies, const ObservedPerson& person) const;
  void check_source(const std::string& source, const Bodies& bodies,
                    std::vector<Finding>& out) const;
  void check_frame(const std::string& source, const Bodies& bodies,
                   std::vector<Finding>& out) const;
  void check_source(const std::string& source, const Things& things,
                    std::vector<Finding>& out) const;
  void check_coverage(std::vector<Finding>& out) const;

  PerceptionGround ground_;
  std::map<std::string, Bodies> people_;
  std::map<std::string, Things> things_;
  std::map<std::string, Malformed> malformed_;
  std::map<std::string, std::size_t> received_;  // by topic
};

/// "RightWrist" -> "r_wrist"; empty when no joint of a body is meant.
std::string joint_meant(const std::string& name);

}  // namespace handsel
