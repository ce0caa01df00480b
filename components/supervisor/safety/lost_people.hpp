// SPDX-License-Identifier: Apache-2.0
// Stores the lost people over a restart of SPARK, with the time since their last observation. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/messages/world.hpp"

namespace handsel::supervisor {

/// A person counts as lost if not observed for longer than `after`. The person remains until the
/// SPARK process that has reported the person lost reports the person observed or no longer (gone,
/// or cleared by an operator). A SPARK process that has just started does not remove anybody.
class LostPeople {
 public:
  /// `after`: age from which a person counts as lost [s]; `max_people`: max number of stored
  /// people, the most recently lost ones; `restored`: people lost before the start, with `age` at
  /// `now`.
  LostPeople(double after, std::size_t max_people, const std::vector<Person>& restored,
             TimePoint now);

  /// Takes the state from SPARK. `writer` identifies the SPARK process.
  void on(const HumanState& people, TimePoint arrival, std::uint64_t writer);
  /// Sets the start of SPARK, which itself knows all people observed later.
  void on_spark_started(TimePoint started);
  /// Removes the lost person `id`, or all lost people if empty, by order of an operator.
  void clear(const std::string& id);
  /// Returns whether a person was lost or found since the last call.
  bool changed(TimePoint now);
  /// Returns the lost people, `age` as of `now`.
  std::vector<Person> people(TimePoint now) const;
  /// Returns the number of lost people left out beyond `max_people`.
  std::uint64_t left_out() const { return left_out_; }

 private:
  struct Known {
    Person person;
    TimePoint shown{};  ///< last report by SPARK, to which the age in `person` refers
    bool here{};        ///< whether the present SPARK process has reported the person
    bool lost{};
    double age(TimePoint now) const { return person.age + to_seconds(now - shown); }
  };
  void keep_most_recent(TimePoint now);

  double after_;
  std::size_t max_people_;
  std::vector<Known> known_;
  std::uint64_t writer_{}, left_out_{};
  bool changed_{};
};

}  // namespace handsel::supervisor
