// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/expected_effects.hpp"

#include "components/supervisor/task/action_check.hpp"

namespace handsel::supervisor {

State ExpectedEffects::believed(World& world, TimePoint now) const {
  State state = world.state;
  if (action_ && pending(now) && !shows(domain_, world, *action_, state))
    apply(domain_, world, *action_, state);
  return state;
}

}  // namespace handsel::supervisor
