// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/situation.hpp"

namespace handsel::supervisor {
namespace {
constexpr std::size_t kMaxMet = 1024;  // max number of stored people
}  // namespace

void Situation::on(const Facts& facts, TimePoint now) {
  if (!known() && scene_) known_since_ = now;
  facts_ = facts;
  for (const Fact& fact : facts.facts)
    if (known_predicates()[static_cast<std::size_t>(fact.kind)].types[0] == Type::human)
      met_.insert(fact.subject);
  while (met_.size() > kMaxMet) met_.erase(met_.begin());
  world_.reset();
}

void Situation::on(const Scene& scene, TimePoint now) {
  if (!known() && facts_) known_since_ = now;
  scene_ = scene;
  world_.reset();
}

void Situation::on(const ActionStatus& status) {
  const bool other =
      !action_ || action_->holding != status.holding || action_->object != status.object;
  action_ = status;
  if (other) world_.reset();
}

World& Situation::world() {
  if (world_) return *world_;
  world_ = make_world(*facts_, *scene_, ability_, people_);
  // The hand measures its load before SPARK reports it.
  const Atom empty{predicate_of(Derived::hand_empty)};
  if (action_ && action_->holding && world_->is(Type::object, action_->object) &&
      world_->state.holds(empty)) {
    const Symbol o = world_->symbol(action_->object);
    if (!world_->state.holds({predicate_of(FactKind::held_by_human), {o, kAny}})) {
      world_->state.remove(empty);
      world_->state.remove({predicate_of(FactKind::on_surface), {o, kAny}});
      world_->state.set({predicate_of(FactKind::held_by_robot), {o, kNothing}});
    }
  }
  return *world_;
}

std::string Situation::held() {
  const State& state = world().state;
  const auto [first, last] = state.range(predicate_of(FactKind::held_by_robot));
  return first < last ? world().text(state.entries()[first].atom.args[0]) : std::string();
}

std::string Situation::surface_of(const std::string& object) {
  const Atom pattern{predicate_of(FactKind::on_surface), {world().symbol(object), kAny}};
  const auto [first, last] = world().state.range(pattern.predicate);
  for (std::size_t i = first; i < last; ++i)
    if (State::fits(world().state.entries()[i].atom, pattern))
      return world().text(world().state.entries()[i].atom.args[1]);
  return "";
}

std::string Situation::person_with(const std::string& object) {
  if (!world().is(Type::object, object)) return "";
  const Atom pattern{predicate_of(FactKind::held_by_human), {world().symbol(object), kAny}};
  const auto [first, last] = world().state.range(pattern.predicate);
  for (std::size_t i = first; i < last; ++i)
    if (State::fits(world().state.entries()[i].atom, pattern))
      return world().text(world().state.entries()[i].atom.args[1]);
  return "";
}

std::string Situation::fate_of(const std::string& object) {
  if (!world().is(Type::object, object)) return object + " is gone";
  if (const std::string person = person_with(object); !person.empty())
    return person + " took " + object;
  const std::string on = surface_of(object);
  return on.empty() ? "" : object + " is on " + on + " now";
}

}  // namespace handsel::supervisor
