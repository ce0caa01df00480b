#include "components/grasp_planner/list_preparation.hpp"

namespace handsel::grasp_planner {

ListPreparation::ListPreparation(Bus& bus, ObjectLibrary objects,
                                 std::vector<std::shared_ptr<GraspCache>> caches,
                                 std::shared_ptr<TransferCache> transfers)
    : bus_(bus),
      objects_(std::move(objects)),
      caches_(std::move(caches)),
      transfers_(std::move(transfers)) {}

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

void ListPreparation::prepare(const Scene& scene) {
  for (const SceneObject& o : scene.objects) {
    const ObjectModel* model = objects_(o.model);
    if (model == nullptr || !prepared_.insert(o.model).second) continue;
    for (const auto& each : caches_)
      run([cache = each, model](const std::function<bool()>& cancelled) {
        const auto page = cache->page(*model, cancelled);
        return page ? kReadList : Duration{};
      });
    if (!transfers_) continue;
    run([cache = caches_.front(), transfers = transfers_,
         model](const std::function<bool()>& cancelled) {
      const auto page = cache->page(*model, cancelled);
      const auto taken = page ? transfers->taker_entry(*model, cancelled) : nullptr;
      const auto table = taken ? transfers->table(*model, *page, cancelled) : nullptr;
      return table ? kReadList + from_seconds(2e-6 * static_cast<double>(table->doubles().pairs))
                   : Duration{};
    });
  }
}

}  // namespace handsel::grasp_planner
