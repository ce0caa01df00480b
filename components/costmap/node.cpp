#include "components/costmap/node.hpp"

#include "common/config/costmap.pb.h"
#include "common/config/resources.hpp"

namespace handsel::costmap {
namespace {

constexpr Duration kStale = std::chrono::seconds(1);

config::CostmapSettings load(const NodeContext& context) {
  config::CostmapSettings s;
  load_text_proto(context.settings / "costmap.txtpb", s);
  for (double positive : {s.period(), s.resolution(), s.reach(), s.moved(), s.turned(), s.repeat(), s.cell_time()})
    if (!(positive > 0)) throw ConfigError("costmap.txtpb: every setting but clearance must be > 0");
  if (s.clearance() < 0) throw ConfigError("costmap.txtpb: clearance must be >= 0");
  if (s.reach() / s.resolution() > 49)
    throw ConfigError("costmap.txtpb: reach / resolution must be at most 49, else the map outgrows its message");
  return s;
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      repeat_(from_seconds(load(context).repeat())),
      cell_time_(load(context).cell_time()),
      maker_({load(context).resolution(), load(context).reach(), load(context).clearance()}),
      watch_(load(context).moved(), load(context).turned()),
      map_out_(bus.advertise<Costmap>()) {
  bus.subscribe<Scene>([this](const Scene& scene, const Receipt&) { scene_ = scene; });
  bus.subscribe<HumanState>([this](const HumanState& people, const Receipt&) { people_ = people; });
  bus.every(from_seconds(load(context).period()), [this](TimePoint now) { step(now); });
}

void Node::step(TimePoint now) {
  const bool current = scene_ && bus_.lag<Scene>() < kStale && bus_.lag<HumanState>() < kStale;
  bus_.set_degraded(current ? "" : "no current Scene or HumanState: no cost map");
  if (!current || making_) return;
  const Person* person = nearest_person(people_, scene_->T_world_base.translation());
  if (person == nullptr) {
    map_ = {};
    return;
  }
  if (watch_.changed(*person, scene_->boxes)) {
    make(now, *person);
  } else if (!map_.values.empty() && now - sent_ >= repeat_) {
    map_.stamp = {};
    map_out_->publish(map_);
    sent_ = now;
  }
}

void Node::make(TimePoint now, const Person& person) {
  struct Work {
    Person person;
    std::vector<SceneBox> boxes;
    Costmap map;
  };
  auto work = std::make_shared<Work>(Work{person, scene_->boxes, {}});
  making_ = true;
  sent_ = now;
  bus_.run_job(
      [this, work](const CancelToken&) {
        work->map = maker_.make(work->person, work->boxes);
        return from_seconds(cell_time_ * static_cast<double>(work->map.values.size()));
      },
      [this, work] {
        making_ = false;
        map_ = std::move(work->map);
        map_.revision = ++revision_;
        map_out_->publish(map_);
      });
}

}  // namespace handsel::costmap
