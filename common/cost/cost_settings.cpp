#include "common/cost/cost_settings.hpp"

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"
#include "common/config/schema/cost.pb.h"

namespace handsel {

CostSettings load_cost_settings(const std::filesystem::path& directory) {
  config::HumanCostSettings file;
  load_text_proto(directory / "cost.txtpb", file);
  if (!(file.safety_radius() > 0) || !(file.visibility_cutoff() > 0))
    throw ConfigError("cost.txtpb: safety_radius and visibility_cutoff must be > 0");
  if (!(file.w_safety() >= 0 && file.w_visibility() >= 0 && file.w_comfort() >= 0 &&
        file.w_safety() + file.w_visibility() + file.w_comfort() > 0))
    throw ConfigError("cost.txtpb: the weights must be >= 0 and at least one > 0");
  return {file.safety_radius(), file.visibility_cutoff(), file.w_safety(), file.w_visibility(), file.w_comfort()};
}

}  // namespace handsel
