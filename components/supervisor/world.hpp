// The world as the task planner sees it: names, and what holds between them. Pure.
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
inline constexpr Symbol kNothing = 0;  ///< "-": an argument that is left out
inline constexpr Symbol kAny = -1;     ///< "*", in patterns only

enum class Type : std::uint8_t { object, surface, human, name };
/// Returns the word for the type in a task domain: "object", "surface", "human" or "name".
const char* name(Type);

/// What holds between names, beside SPARK's facts.
enum class Derived : std::uint8_t {
  hand_empty,  ///< the robot holds nothing
  room,        ///< surface: free places within reach of any arm; the value is their number
  heavy,       ///< object: too heavy for one hand
  too_heavy,   ///< object: too heavy for all hands
  two_hands,   ///< the robot has more than one
  one_arm,     ///< object, surface: one arm reaches both; an object in a hand: that arm
  model,       ///< object, name: what kind of thing it is
  thing,       ///< name: it is an object of the scene
  given,       ///< anything: it is not left out
  same,        ///< two names: they are one
  drives,      ///< the robot has a platform that drives
  near,        ///< surface, human: an arm serves from where the robot stands
};

/// Signature of a predicate.
struct PredicateSign {
  std::string name;         ///< as in conditions of a task domain
  std::vector<Type> types;  ///< of the arguments, at most two
};
/// SPARK's facts in the order of FactKind, then the derived ones in theirs.
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

/// What holds, each with a value (1 for plain facts), in order.
class State {
 public:
  /// Adds the atom, or replaces its value.
  void set(const Atom& atom, double value = 1);
  /// Removes all atoms that fit the pattern; kAny fits every argument.
  void remove(const Atom& pattern);
  /// Returns the value of exactly this atom; nullptr: the atom does not hold. Invalid after a
  /// change.
  const double* find(const Atom& atom) const;
  /// Returns whether an atom that fits the pattern holds.
  bool holds(const Atom& pattern) const;
  /// An atom that holds, with its value.
  struct Entry {
    Atom atom;     ///< without kAny
    double value;  ///< 1 for plain facts, else a distance [m], a mass [kg] or a count
  };
  /// Everything that holds, ordered by predicate and arguments.
  const std::vector<Entry>& entries() const { return entries_; }
  /// Those of one predicate: [first, second).
  std::pair<std::size_t, std::size_t> range(int predicate) const;
  /// Returns whether the atom equals the pattern, where kAny stands for every argument.
  static bool fits(const Atom& atom, const Atom& pattern);
  /// Returns a hash of atoms and values; equal states have equal hashes.
  std::uint64_t hash() const;

 private:
  std::vector<Entry> entries_;
};

/// Names with their types and what holds between them; name 0 is "-".
class World {
 public:
  World() : texts_{"-"}, symbols_{{"-", kNothing}} {}
  /// Returns the number of a name, adding the name when new. Names are numbered in this order.
  Symbol symbol(const std::string& text);
  /// Returns the name of a symbol of this world; kAny has none and must not be passed.
  const std::string& text(Symbol symbol) const { return texts_[static_cast<std::size_t>(symbol)]; }
  /// Adds a name to a type, once; a name may have several types.
  void add(Type type, const std::string& text);
  /// All names of a type, in the order of add().
  const std::vector<Symbol>& all(Type type) const { return all_[static_cast<std::size_t>(type)]; }
  /// Returns whether the name was added to the type.
  bool is(Type type, const std::string& text) const;

  State state;  ///< what holds between the names

 private:
  std::vector<std::string> texts_;
  std::map<std::string, Symbol> symbols_;
  std::array<std::vector<Symbol>, 4> all_;
};

/// What the robot can carry and reach.
struct Ability {
  double payload{};  ///< of one hand [kg]; 0: any weight
  int hands{1};      ///< number of hands, whose payloads add up
  /// An arm of the robot.
  struct Arm {
    std::string hand;                   ///< group of its hand, as SceneObject::holder_id has it
    Vector3 shoulder{Vector3::Zero()};  ///< world [m]
    double reach{};                     ///< from the shoulder [m]
  };
  std::vector<Arm> arms{};  ///< empty: not known, everything counts as within reach
  bool drives{};            ///< the robot brings its arms to where they are needed
  double person_reach{};    ///< a person at most this far beyond an arm's reach is near [m]
  double spot{0.15};        ///< distance kept between things on a surface [m]
  /// Finds an object model by the name of the model; nullptr: unknown.
  std::function<const ObjectModel*(const std::string&)> objects{};
};

/// Names in alphabetical order, so that equal worlds give equal plans. `people`: where the people
/// of the facts are, for a robot that drives.
World make_world(const Facts& facts, const Scene& scene, const Ability& ability,
                 const HumanState& people = {});

}  // namespace handsel::supervisor
