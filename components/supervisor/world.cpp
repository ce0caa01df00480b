// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/world.hpp"

#include <algorithm>
#include <bit>
#include <set>

#include "common/messages/names.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/object_extent.hpp"

namespace handsel::supervisor {
namespace {

std::vector<Type> types_of(FactKind kind) {
  using T = Type;
  switch (kind) {
    case FactKind::in_contact_zone:
    case FactKind::in_danger_zone:
    case FactKind::in_interaction_zone:
    case FactKind::in_social_zone:
    case FactKind::approaching:
    case FactKind::attentive:
      return {T::human};
    case FactKind::hand_near_object:
    case FactKind::offering:
    case FactKind::waiting_to_receive:
    case FactKind::withdrawn:
      return {T::human, T::object};
    case FactKind::reaching:
    case FactKind::looking_at:
      return {T::human, T::name};
    case FactKind::on_surface:
      return {T::object, T::surface};
    case FactKind::held_by_robot:
    case FactKind::reachable_by_robot:
      return {T::object};
    case FactKind::held_by_human:
    case FactKind::reachable_by_human:
    case FactKind::visible_to:
      return {T::object, T::human};
    case FactKind::inside:
    case FactKind::next_to:
      return {T::object, T::object};
    case FactKind::moving:
      return {T::name};
    case FactKind::released:
      return {T::object, T::name};
  }
  return {};
}

bool reaches(const Ability::Arm& arm, const Vector3& p) {
  return (p - arm.shoulder).norm() <= arm.reach;
}

/// Returns whether an arm reaches a point; true if no arm is known.
bool reach(const std::vector<Ability::Arm>& arms, const Vector3& p) {
  return arms.empty() || std::any_of(arms.begin(), arms.end(),
                                     [&](const Ability::Arm& arm) { return reaches(arm, p); });
}

/// Returns the number of free places within reach of one of `arms`, at most as many as are counted.
double places_on(const SceneBox& box, const Scene& scene, const std::vector<Ability::Arm>& arms,
                 const Ability& ability) {
  const double top = box.size.z() / 2;
  std::vector<Vector3> occupied;  // box frame
  for (const auto& object : scene.objects)
    if (object.holder == Holder::surface && object.holder_id == box.id)
      occupied.push_back(box.T_world_box.inverse() * object.T_world_object.translation());
  double found = 0;
  const double x_end = std::max(0.0, box.size.x() / 2 - ability.min_edge),
               y_end = std::max(0.0, box.size.y() / 2 - ability.min_edge);
  for (double x = -x_end; x <= x_end + 1e-9 && found < ability.max_places; x += ability.place_step)
    for (double y = -y_end; y <= y_end + 1e-9 && found < ability.max_places;
         y += ability.place_step) {
      const Vector3 p(x, y, top);
      if (!reach(arms, box.T_world_box * p)) continue;
      const bool free = std::all_of(occupied.begin(), occupied.end(), [&](const Vector3& t) {
        return (t - p).head<2>().norm() >= ability.spot;
      });
      if (!free) continue;
      occupied.push_back(p);
      ++found;
    }
  return found;
}

/// Returns the arms with a free place of the surface within reach.
std::vector<Ability::Arm> arms_with_room(const SceneBox& box, const Scene& scene,
                                         const Ability& ability) {
  std::vector<Ability::Arm> out;
  for (const Ability::Arm& arm : ability.arms)
    if (places_on(box, scene, {arm}, ability) > 0) out.push_back(arm);
  return out;
}

/// Returns whether a person is within reach of an extended arm; true if no arm is known.
bool is_near(const Person& person, const Ability& ability) {
  const Vector3& torso =
      person.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  return ability.arms.empty() ||
         std::any_of(ability.arms.begin(), ability.arms.end(), [&](const Ability::Arm& arm) {
           return (torso - arm.shoulder).norm() <= arm.reach + ability.person_reach;
         });
}

/// Returns whether the arm that holds or reaches an object is among `near`. A person brings a held
/// object within reach of any arm.
bool can_bring(const SceneObject& object, const Ability& ability,
               const std::vector<Ability::Arm>& near) {
  if (ability.arms.empty()) return true;
  if (object.holder == Holder::human) return !near.empty();
  if (object.holder != Holder::robot)
    return !near.empty() && reach(near, object.T_world_object.translation());
  const std::string& hand = object.holder_id.empty() ? ability.arms.front().hand : object.holder_id;
  return std::any_of(near.begin(), near.end(),
                     [&](const Ability::Arm& arm) { return arm.hand == hand; });
}

/// Returns the larger level extent of an object in its frame; 0: not known [m].
double width_of(const ObjectModel* model, const SceneObject& object) {
  const Eigen::AlignedBox3d box = object_extent(model, object.primitive);
  return box.isEmpty() ? 0.0 : box.sizes().head<2>().maxCoeff();
}

bool in_someones_hands(const Facts& facts, const std::string& object, FactKind kind) {
  return std::any_of(facts.facts.begin(), facts.facts.end(),
                     [&](const Fact& f) { return f.kind == kind && f.subject == object; });
}

}  // namespace

const char* name(Type type) {
  constexpr const char* kNames[] = {"object", "surface", "human", "name"};
  return kNames[static_cast<std::size_t>(type)];
}

const std::vector<PredicateSign>& known_predicates() {
  static const std::vector<PredicateSign> all = [] {
    std::vector<PredicateSign> out;
    for (std::size_t i = 0; i < std::size(kFactNames); ++i)
      out.push_back({kFactNames[i], types_of(static_cast<FactKind>(i))});
    using T = Type;
    out.insert(out.end(), {{"hand_empty", {}},
                           {"room", {T::surface}},
                           {"heavy", {T::object}},
                           {"too_heavy", {T::object}},
                           {"two_handed", {T::object}},
                           {"two_hands", {}},
                           {"one_arm", {T::object, T::surface}},
                           {"model", {T::object, T::name}},
                           {"thing", {T::name}},
                           {"given", {T::name}},
                           {"same", {T::name, T::name}},
                           {"drives", {}},
                           {"near", {T::name}}});
    return out;
  }();
  return all;
}

int predicate_of(FactKind kind) { return static_cast<int>(kind); }
int predicate_of(Derived kind) {
  return static_cast<int>(std::size(kFactNames)) + static_cast<int>(kind);
}

void State::set(const Atom& atom, double value) {
  const auto at = std::lower_bound(entries_.begin(), entries_.end(), atom,
                                   [](const Entry& e, const Atom& a) { return e.atom < a; });
  if (at != entries_.end() && at->atom == atom)
    at->value = value;
  else
    entries_.insert(at, {atom, value});
}

bool State::fits(const Atom& atom, const Atom& pattern) {
  return atom.predicate == pattern.predicate &&
         (pattern.args[0] == kAny || pattern.args[0] == atom.args[0]) &&
         (pattern.args[1] == kAny || pattern.args[1] == atom.args[1]);
}

void State::remove(const Atom& pattern) {
  std::erase_if(entries_, [&](const Entry& e) { return fits(e.atom, pattern); });
}

const double* State::find(const Atom& atom) const {
  const auto at = std::lower_bound(entries_.begin(), entries_.end(), atom,
                                   [](const Entry& e, const Atom& a) { return e.atom < a; });
  return at != entries_.end() && at->atom == atom ? &at->value : nullptr;
}

std::pair<std::size_t, std::size_t> State::range(int predicate) const {
  const auto before = [](const Entry& e, int p) { return e.atom.predicate < p; };
  const auto first = std::lower_bound(entries_.begin(), entries_.end(), predicate, before);
  const auto last = std::lower_bound(first, entries_.end(), predicate + 1, before);
  return {static_cast<std::size_t>(first - entries_.begin()),
          static_cast<std::size_t>(last - entries_.begin())};
}

bool State::holds(const Atom& pattern) const {
  if (pattern.args[0] != kAny && pattern.args[1] != kAny) return find(pattern) != nullptr;
  const auto [first, last] = range(pattern.predicate);
  for (std::size_t i = first; i < last; ++i)
    if (fits(entries_[i].atom, pattern)) return true;
  return false;
}

std::uint64_t State::hash() const {
  std::uint64_t h = 1469598103934665603ULL;
  const auto mix = [&h](std::uint64_t v) { h = (h ^ v) * 1099511628211ULL, h ^= h >> 29; };
  for (const Entry& e : entries_) {
    mix(static_cast<std::uint64_t>(e.atom.predicate));
    mix(static_cast<std::uint64_t>(e.atom.args[0]) << 32 ^
        static_cast<std::uint64_t>(e.atom.args[1]));
    mix(std::bit_cast<std::uint64_t>(e.value));
  }
  return h;
}

Symbol World::symbol(const std::string& text) {
  const auto [at, is_new] = symbols_.try_emplace(text, static_cast<Symbol>(texts_.size()));
  if (is_new) texts_.push_back(text);
  return at->second;
}

void World::add(Type type, const std::string& text) {
  auto& names = all_[static_cast<std::size_t>(type)];
  const Symbol s = symbol(text);
  if (std::find(names.begin(), names.end(), s) == names.end()) names.push_back(s);
}

bool World::is(Type type, const std::string& text) const {
  const auto at = symbols_.find(text);
  const auto& names = all(type);
  return at != symbols_.end() && std::find(names.begin(), names.end(), at->second) != names.end();
}

World make_world(const Facts& facts, const Scene& scene, const Ability& ability,
                 const HumanState& people_now) {
  World world;
  std::set<std::string> objects, surfaces, people;
  for (const auto& object : scene.objects) objects.insert(object.id);
  for (const auto& box : scene.boxes)
    if (box.supports) surfaces.insert(box.id);
  for (const Fact& fact : facts.facts) {
    const auto& types = known_predicates()[static_cast<std::size_t>(fact.kind)].types;
    if (types[0] == Type::human) people.insert(fact.subject);
    if (types.size() > 1 && types[1] == Type::human) people.insert(fact.object);
  }
  for (const auto& text : objects) world.add(Type::object, text);
  for (const auto& text : surfaces) world.add(Type::surface, text);
  for (const auto& text : people) world.add(Type::human, text);

  State& state = world.state;
  bool holds = false;
  for (const Fact& fact : facts.facts) {
    const auto& types = known_predicates()[static_cast<std::size_t>(fact.kind)].types;
    if (types[0] == Type::object && !objects.contains(fact.subject)) continue;
    if (fact.kind == FactKind::on_surface &&
        in_someones_hands(facts, fact.subject, FactKind::held_by_robot))
      continue;
    holds = holds || fact.kind == FactKind::held_by_robot;
    state.set({static_cast<int>(fact.kind),
               {world.symbol(fact.subject),
                types.size() > 1 && !fact.object.empty() ? world.symbol(fact.object) : kNothing}},
              fact.value);
  }
  if (!holds) state.set({predicate_of(Derived::hand_empty)});
  if (ability.hands > 1) state.set({predicate_of(Derived::two_hands)});
  if (ability.drives) state.set({predicate_of(Derived::drives)});
  const auto set_near = [&](const std::string& text) {
    state.set({predicate_of(Derived::near), {world.symbol(text), kNothing}});
  };
  for (const std::string& text : people)
    if (!ability.drives) set_near(text);
  for (const Person& person : people_now.people)
    if (ability.drives && people.contains(person.id) && is_near(person, ability))
      set_near(person.id);
  Ability anywhere = ability;  // a mobile robot reaches any place of a surface
  if (ability.drives) anywhere.arms.clear();
  for (const auto& object : scene.objects) {
    const Symbol o = world.symbol(object.id);
    state.set({predicate_of(Derived::thing), {o, kNothing}});
    if (!object.model.empty())
      state.set({predicate_of(Derived::model), {o, world.symbol(object.model)}});
    const ObjectModel* model = ability.objects ? ability.objects(object.model) : nullptr;
    const bool is_wide =
        ability.hands > 1 && ability.max_width > 0 && width_of(model, object) > ability.max_width;
    const bool is_heavy = model != nullptr && ability.payload > 0 && model->mass > ability.payload;
    if (is_wide || is_heavy) state.set({predicate_of(Derived::two_handed), {o, kNothing}});
    if (model == nullptr || ability.payload <= 0) continue;
    if (is_heavy) state.set({predicate_of(Derived::heavy), {o, kNothing}}, model->mass);
    if (model->mass > ability.payload * ability.hands)
      state.set({predicate_of(Derived::too_heavy), {o, kNothing}}, model->mass);
  }
  for (const auto& box : scene.boxes) {
    if (!box.supports) continue;
    const double places = places_on(box, scene, anywhere.arms, ability);
    if (places <= 0) continue;
    const Symbol s = world.symbol(box.id);
    if (!ability.drives || places_on(box, scene, ability.arms, ability) > 0) set_near(box.id);
    state.set({predicate_of(Derived::room), {s, kNothing}}, places);
    state.set({predicate_of(Derived::one_arm), {kNothing, s}});
    const std::vector<Ability::Arm> near = arms_with_room(box, scene, anywhere);
    for (const auto& object : scene.objects)
      if (can_bring(object, anywhere, near))
        state.set({predicate_of(Derived::one_arm), {world.symbol(object.id), s}});
  }
  return world;
}

}  // namespace handsel::supervisor
