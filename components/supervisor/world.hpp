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
const char* name(Type);

/// What holds between names, beside SPARK's facts.
enum class Derived : std::uint8_t {
  hand_empty,       ///< the robot holds nothing
  room,             ///< surface: places free on it within the robot's reach; its value is how many
  heavy,            ///< object: too heavy for one hand
  too_heavy,        ///< object: too heavy for all hands
  two_hands,        ///< the robot has more than one
  near_a_hand,      ///< object: within reach of one of the robot's arms, whichever
  room_for_a_hand,  ///< surface: places free on it within reach of one of them; its value is how many
  model,            ///< object, name: what kind of thing it is
  thing,            ///< name: it is an object of the scene
  given,            ///< anything: it is not left out
  same,             ///< two names: they are one
};

struct PredicateSign {
  std::string name;
  std::vector<Type> types;
};
/// SPARK's facts in the order of FactKind, then the derived ones in theirs.
const std::vector<PredicateSign>& known_predicates();
int predicate_of(FactKind kind);
int predicate_of(Derived kind);

struct Atom {
  int predicate{};
  std::array<Symbol, 2> args{kNothing, kNothing};
  friend auto operator<=>(const Atom&, const Atom&) = default;
  friend bool operator==(const Atom&, const Atom&) = default;
};

/// What holds, each with a value (1 for plain facts), in order.
class State {
 public:
  void set(const Atom& atom, double value = 1);
  /// kAny fits everything.
  void remove(const Atom& pattern);
  const double* find(const Atom& atom) const;
  bool holds(const Atom& pattern) const;
  struct Entry {
    Atom atom;
    double value;
  };
  const std::vector<Entry>& entries() const { return entries_; }
  /// Those of one predicate: [first, second).
  std::pair<std::size_t, std::size_t> range(int predicate) const;
  static bool fits(const Atom& atom, const Atom& pattern);
  std::uint64_t hash() const;

 private:
  std::vector<Entry> entries_;
};

class World {
 public:
  World() : texts_{"-"}, symbols_{{"-", kNothing}} {}
  Symbol symbol(const std::string& text);
  const std::string& text(Symbol symbol) const { return texts_[static_cast<std::size_t>(symbol)]; }
  void add(Type type, const std::string& text);
  const std::vector<Symbol>& all(Type type) const { return all_[static_cast<std::size_t>(type)]; }
  bool is(Type type, const std::string& text) const;

  State state;

 private:
  std::vector<std::string> texts_;
  std::map<std::string, Symbol> symbols_;
  std::array<std::vector<Symbol>, 4> all_;
};

/// What the robot can carry and reach.
struct Ability {
  double payload{};  ///< of one hand [kg]; 0: any weight
  int hands{1};
  bool reach_known{false};
  Vector3 shoulder{Vector3::Zero()};  ///< world [m]
  double reach{};                     ///< [m]
  struct Arm {
    Vector3 shoulder{Vector3::Zero()};
    double reach{};
  };
  std::vector<Arm> other_arms{};                                    ///< where reach_known
  double spot{0.2};                                                 ///< a thing on a surface wants a square of this side [m]
  std::function<const ObjectModel*(const std::string&)> objects{};  ///< by name of the model; nullptr: unknown
};

/// Names in alphabetical order, so that equal worlds give equal plans.
World make_world(const Facts& facts, const Scene& scene, const Ability& ability);

}  // namespace handsel::supervisor
