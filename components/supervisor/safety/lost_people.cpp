// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/safety/lost_people.hpp"

#include <algorithm>
#include <utility>

namespace handsel::supervisor {

LostPeople::LostPeople(double after, std::size_t max_people, const std::vector<Person>& restored,
                       TimePoint now)
    : after_(after), max_people_(max_people) {
  for (const Person& person : restored)
    known_.push_back({.person = person, .shown = now, .here = false, .lost = true});
}

void LostPeople::on(const HumanState& people, TimePoint arrival, std::uint64_t writer) {
  if (writer != writer_) {
    writer_ = writer;
    for (Known& known : known_) {
      changed_ = changed_ || !known.lost;
      known.here = false;
      known.lost = true;  // until the new SPARK process reports the person
    }
  }
  std::vector<Known> next;
  for (const Person& person : people.people) {
    const auto before = std::find_if(known_.begin(), known_.end(),
                                     [&](const Known& k) { return k.person.id == person.id; });
    Known now{.person = person, .shown = arrival, .here = true, .lost = person.age > after_};
    now.person.hands.clear();
    changed_ = changed_ || now.lost != (before != known_.end() && before->lost);
    next.push_back(std::move(now));
  }
  for (const Known& known : known_) {
    const bool shown = std::any_of(people.people.begin(), people.people.end(),
                                   [&](const Person& p) { return p.id == known.person.id; });
    if (shown) continue;
    const bool left_out = !known.here || people.left_out > 0;
    if (known.lost && left_out)
      next.push_back(known);
    else
      changed_ = changed_ || known.lost;
  }
  known_ = std::move(next);
  keep_most_recent(arrival);
}

void LostPeople::on_spark_started(TimePoint started) {
  for (Known& known : known_)
    known.here = known.here || known.shown - from_seconds(known.person.age) > started;
}

void LostPeople::clear(const std::string& id) {
  changed_ = std::erase_if(
                 known_,
                 [&](const Known& k) { return k.lost && (id.empty() || k.person.id == id); }) > 0 ||
             changed_;
}

void LostPeople::keep_most_recent(TimePoint now) {
  const auto lost = static_cast<std::size_t>(
      std::count_if(known_.begin(), known_.end(), [](const Known& k) { return k.lost; }));
  if (lost <= max_people_) return;
  left_out_ += lost - max_people_;
  std::stable_sort(known_.begin(), known_.end(),
                   [&](const Known& a, const Known& b) { return a.age(now) < b.age(now); });
  std::size_t kept = 0;
  std::erase_if(known_, [&](const Known& k) { return k.lost && ++kept > max_people_; });
}

bool LostPeople::changed(TimePoint now) {
  for (Known& known : known_) {
    if (known.lost || known.age(now) <= after_) continue;
    known.lost = changed_ = true;  // SPARK does not report
  }
  return std::exchange(changed_, false);
}

std::vector<Person> LostPeople::people(TimePoint now) const {
  std::vector<Person> out;
  for (const Known& known : known_) {
    if (!known.lost) continue;
    out.push_back(known.person);
    out.back().age = known.age(now);
  }
  return out;
}

}  // namespace handsel::supervisor
