// People lost from sight: which must be remembered over a restart of SPARK, and for how long nobody
// has seen them. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/messages/world.hpp"

namespace handsel::supervisor {

/// A person counts as lost when nobody has seen them for longer than `after`. They stay until the
/// SPARK that has shown them lost shows them seen or no longer (gone, or cleared by an operator); a
/// SPARK that has just started, and does not know them yet, removes nobody.
class LostPeople {
 public:
  /// `after`: age from which a person counts as lost [s]; `max_people`: those lost most recently
  /// are remembered; `restored`: people lost before the start, `age` counts from `now`.
  LostPeople(double after, std::size_t max_people, const std::vector<Person>& restored,
             TimePoint now);

  /// Takes what SPARK shows. `writer` tells one SPARK process from another.
  void on(const HumanState& people, TimePoint arrival, std::uint64_t writer);
  /// SPARK has run since `started`: it knows of itself everybody who was last seen later.
  void on_spark_started(TimePoint started);
  /// An operator says that a lost person is gone: `id`, or everybody lost when it is empty.
  void clear(const std::string& id);
  /// Returns whether somebody was lost or found since the last call.
  bool changed(TimePoint now);
  /// Returns the lost people, `age` as of `now`.
  std::vector<Person> people(TimePoint now) const;
  /// Returns how many were left out because there were more than `max_people`.
  std::uint64_t left_out() const { return left_out_; }

 private:
  struct Known {
    Person person;
    TimePoint shown{};  ///< when SPARK showed them last; the age in `person` counts from then
    bool here{};        ///< shown by the present SPARK process
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
