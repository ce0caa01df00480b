// SPDX-License-Identifier: Apache-2.0
// The symbolic world of the task planner: names and the atoms that hold for them. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/messages/world.hpp"
#include "common/model/object_model.hpp"

namespace handsel::supervisor {

using Symbol = int;
inline constexpr Symbol kNothing = 0;  ///< "-": an omitted argument
inline constexpr Symbol kAny = -1;     ///< "*", in patterns only

enum class Type : std::uint8_t { object, surface, human, name };
/// Returns the word for the type in a task domain: "object", "surface", "human" or "name".
const char* name(Type);

/// Derived predicates, besides SPARK's facts.
enum class Derived : std::uint8_t {
  hand_empty,  ///< the robot holds nothing
  room,        ///< surface: has free places within reach of an arm; value: their number
  heavy,       ///< object: too heavy for one hand
  too_heavy,   ///< object: too heavy for all hands
  two_handed,  ///< object: too heavy or too wide for one hand
  two_hands,   ///< the robot has more than one hand
  one_arm,     ///< object, surface: one arm reaches both; an object in a hand: that arm
  model,       ///< object, name: model of the object
  thing,       ///< name: an object of the scene
  given,       ///< any type: the argument is given
  same,        ///< two names: equal
  drives,      ///< the robot has a mobile platform
  near,        ///< surface, human: within reach from the robot's present place
};

/// Signature of a predicate.
struct PredicateSign {
  std::string name;         ///< name in conditions of a task domain
  std::vector<Type> types;  ///< types of the arguments, at most two
};
/// Returns SPARK's facts in the order of FactKind, then the derived predicates in theirs.
const std::vector<PredicateSign>& known_predicates();
/// Returns the index of a fact of SPARK in known_predicates().
int predicate_of(FactKind kind);
/// Returns the index of a derived predicate in known_predicates().
int predicate_of(Derived kind);

/// A predicate applied to names.
struct Atom {
  int predicate{};                                 ///< index in Domain::predicates
  std::array<Symbol, 2> args{kNothing, kNothing};  ///< kAny in patterns only
  friend auto operator<=>(const Atom&, const Atom&) = default;
  friend bool operator==(const Atom&, const Atom&) = default;
};

/// The atoms that hold, each with a value (1 for plain facts), in order.
class State {
 public:
  /// Adds the atom, or replaces its value.
  void set(const Atom& atom, double value = 1);
  /// Removes all atoms that match the pattern; kAny matches every argument.
  void remove(const Atom& pattern);
  /// Returns the value of exactly this atom; nullptr: the atom does not hold. Invalid after a
  /// change.
  const double* find(const Atom& atom) const;
  /// Returns whether an atom that matches the pattern holds.
  bool holds(const Atom& pattern) const;
  /// An atom that holds, with its value.
  struct Entry {
    Atom atom;     ///< without kAny
    double value;  ///< 1 for plain facts, else a distance [m], a mass [kg] or a count
  };
  /// Returns all atoms that hold, ordered by predicate and arguments.
  const std::vector<Entry>& entries() const { return entries_; }
  /// Returns the range [first, second) of the atoms of one predicate.
  std::pair<std::size_t, std::size_t> range(int predicate) const;
  /// Returns whether the atom equals the pattern, where kAny stands for every argument.
  static bool fits(const Atom& atom, const Atom& pattern);
  /// Returns a hash of atoms and values; equal states have equal hashes.
  std::uint64_t hash() const;

 private:
  std::vector<Entry> entries_;
};

/// Names with their types and the atoms that hold; name 0 is "-".
class World {
 public:
  World() : texts_{"-"}, symbols_{{"-", kNothing}} {}
  /// Returns the number of a name, adding a new name. Names are numbered in this order.
  Symbol symbol(const std::string& text);
  /// Returns the name of a symbol of this world; kAny has none and must not be passed.
  const std::string& text(Symbol symbol) const { return texts_[static_cast<std::size_t>(symbol)]; }
  /// Adds a name to a type, once; a name may have several types.
  void add(Type type, const std::string& text);
  /// Returns all names of a type, in the order of add().
  const std::vector<Symbol>& all(Type type) const { return all_[static_cast<std::size_t>(type)]; }
  /// Returns whether the name was added to the type.
  bool is(Type type, const std::string& text) const;

  State state;  ///< atoms that hold

 private:
  std::vector<std::string> texts_;
  std::map<std::string, Symbol> symbols_;
  std::array<std::vector<Symbol>, 4> all_;
};

/// Payload and reach of the robot.
struct Ability {
  double payload{};    ///< max payload of one hand [kg]; 0: unlimited
  int hands{1};        ///< number of hands; their payloads add up
  double max_width{};  ///< max width of an object in one hand [m]; 0: unlimited
  /// An arm of the robot.
  struct Arm {
    std::string hand;                   ///< group of the hand, as in SceneObject::holder_id
    Vector3 shoulder{Vector3::Zero()};  ///< position of the shoulder, world [m]
    double reach{};                     ///< max distance from the shoulder [m]
  };
  std::vector<Arm> arms{};  ///< empty: unknown, everything counts as within reach
  bool drives{};            ///< whether the robot is mobile
  double person_reach{};    ///< max distance of a near person beyond an arm's reach [m]
  double spot{0.15};        ///< min distance between objects on a surface [m]
  double min_edge{0.08};    ///< min distance of an object from the edge of a surface [m]
  double place_step{0.05};  ///< step of the grid of tested places of a surface [m]
  double max_places{24};    ///< max number of places of a surface that are counted
  /// Returns the object model with a name; nullptr: unknown.
  std::function<const ObjectModel*(const std::string&)> objects{};
};

/// Returns the world, with names in alphabetical order so that equal worlds give equal plans.
/// `people`: positions of the people of the facts, for a mobile robot.
World make_world(const Facts& facts, const Scene& scene, const Ability& ability,
                 const HumanState& people = {});

}  // namespace handsel::supervisor
