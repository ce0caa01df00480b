#include "components/grasp_planner/list_preparation.hpp"

namespace handsel::grasp_planner {

ListPreparation::ListPreparation(Bus& bus, ObjectLibrary objects,
                                 std::vector<std::shared_ptr<GraspBook>> books,
                                 std::shared_ptr<TransferBook> transfers)
    : bus_(bus),
      objects_(std::move(objects)),
      books_(std::move(books)),
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
    for (const auto& each : books_)
      run([book = each, model](const std::function<bool()>& cancelled) {
        const auto page = book->page(*model, cancelled);
        return page ? kReadList : Duration{};
      });
    if (!transfers_) continue;
    run([book = books_.front(), transfers = transfers_,
         model](const std::function<bool()>& cancelled) {
      const auto page = book->page(*model, cancelled);
      const auto taken = page ? transfers->taker_page(*model, cancelled) : nullptr;
      const auto table = taken ? transfers->table(*model, *page, cancelled) : nullptr;
      return table ? kReadList + from_seconds(2e-6 * static_cast<double>(table->doubles().pairs))
                   : Duration{};
    });
  }
}

}  // namespace handsel::grasp_planner
