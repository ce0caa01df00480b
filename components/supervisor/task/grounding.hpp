// SPDX-License-Identifier: Apache-2.0
// Literals and actions of a domain with their variables bound to names of a world. Pure.
#pragma once

#include <string>
#include <vector>

#include "components/supervisor/task/domain.hpp"
#include "components/supervisor/task/htn.hpp"

namespace handsel::supervisor {

using Frame = std::vector<Symbol>;      ///< value of each variable; kUnbound: none yet
inline constexpr Symbol kUnbound = -2;  ///< value of a variable that is not bound

/// Evaluates parts of a domain for the values of a frame.
struct Ground {
  World& world;  ///< whose names are used; names of the domain are added

  /// Returns the name a term stands for, kAny for "*" and kNothing for "-".
  Symbol symbol(const Term& term, const Frame& frame) const;
  /// Returns the atom of a literal; a variable that is not bound stays kUnbound.
  Atom atom(const Literal& literal, const Frame& frame) const;
  /// Returns whether a literal holds whose variables are all bound.
  bool holds(const Literal& literal, const Frame& frame, const State& state) const;
  /// Returns the sum of the costs whose conditions hold.
  double extra(const std::vector<Extra>& extras, const Frame& frame, const State& state) const;
  /// Returns a text for people, with every variable ("?x") replaced by the name of its value.
  std::string fill(const std::string& text, const std::vector<std::string>& names,
                   const std::vector<Type>& types, const Frame& frame) const;
};

/// Returns the frame of arguments; "" and "-" are left out.
Frame frame_of(World& world, const std::vector<std::string>& args);
/// Returns the first condition that does not hold; nullptr: all do.
const Test* failing(const Ground& ground, const std::vector<Test>& tests, const Frame& frame,
                    const State& state);
/// Changes the state by the effects of an action.
void change(const Ground& ground, const CompiledAction& action, const Frame& frame, State& state);
/// Returns the action with its arguments, without extra costs. `index`: in Domain::actions.
PlannedAction planned(const Domain& domain, const Ground& ground, int index, const Frame& frame);

}  // namespace handsel::supervisor
