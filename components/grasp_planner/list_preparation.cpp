// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/list_preparation.hpp"

#include <memory>

namespace handsel::grasp_planner {

ListPreparation::ListPreparation(Bus& bus, ObjectLibrary objects, std::vector<ArmGrasps> arms)
    : bus_(bus), objects_(std::move(objects)), arms_(std::move(arms)) {}

void ListPreparation::run(const Work& work) {
  const auto problem = std::make_shared<std::string>();
  bus_.run_job(
      [work, problem](const CancelToken& token) {
        try {
          return work([&token] { return token.cancelled(); });
        } catch (const ConfigError& e) {
          *problem = e.what();
          return Duration{};
        }
      },
      [this, problem] {
        if (!problem->empty()) bus_.set_degraded(*problem);
      });
}

void ListPreparation::prepare_pairs(const std::shared_ptr<GraspCache>& cache,
                                    const std::shared_ptr<TransferCache>& transfers,
                                    const ObjectModel& model) {
  run([cache, transfers, &model](const std::function<bool()>& cancelled) {
    const auto page = cache->page(model, cancelled);
    const auto taken = page ? transfers->taker_entry(model, cancelled) : nullptr;
    const auto table = taken ? transfers->table(model, *page, cancelled) : nullptr;
    return table ? kReadList + from_seconds(2e-6 * static_cast<double>(table->doubles().pairs))
                 : Duration{};
  });
}

void ListPreparation::prepare(const Scene& scene) {
  for (const SceneObject& o : scene.objects) {
    const ObjectModel* model = objects_(o.model);
    if (model == nullptr || !prepared_.insert(o.model).second) continue;
    for (const ArmGrasps& arm : arms_)
      run([cache = arm.cache, model](const std::function<bool()>& cancelled) {
        const auto page = cache->page(*model, cancelled);
        return page ? kReadList : Duration{};
      });
    for (const ArmGrasps& arm : arms_) {
      for (const auto& transfers : {arm.transfers, arm.left_transfers})
        if (transfers) prepare_pairs(arm.cache, transfers, *model);
    }
  }
}

}  // namespace handsel::grasp_planner
