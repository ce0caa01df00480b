// SPDX-License-Identifier: Apache-2.0
#include "common/cost/cost_settings.hpp"

#include "common/config/settings_text.hpp"

namespace handsel {

CostSettings load_cost_settings(const std::filesystem::path& directory) {
  SettingsText text;
  const CostSettings out = settings::read_human_cost_settings(directory / "cost.txtpb", &text);
  if (!(out.w_safety + out.w_visibility + out.w_comfort > 0))
    text.refuse("w_safety", "is 0, as are the other weights; at least one must be above 0");
  return out;
}

}  // namespace handsel
