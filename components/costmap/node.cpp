// SPDX-License-Identifier: Apache-2.0
#include "components/costmap/node.hpp"

#include "common/config/settings/costmap.hpp"
#include "common/config/settings_text.hpp"
#include "common/cost/cost_settings.hpp"
#include "common/model/platform.hpp"

namespace handsel::costmap {
namespace {

constexpr Duration kMaxAge = std::chrono::seconds(1);  // max age of the people

settings::CostmapSettings load(const NodeContext& context) {
  SettingsText text;
  const auto s = settings::read_costmap_settings(context.settings / "costmap.txtpb", &text);
  if (s.reach / s.resolution > 49)
    text.refuse("reach",
                "reach / resolution must be at most 49, else the map outgrows its message");
  if (s.max_period < s.period)
    text.refuse("max_period",
                "must be from period to 0.4, readers leave out layers older than a second");
  return s;
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      robot_(context.robot),
      repeat_(from_seconds(load(context).repeat)),
      cell_time_(load(context).cell_time),
      maker_({load(context).resolution, load(context).reach, load(context).clearance,
              load_cost_settings(context.settings)}),
      watch_(load(context).moved, load(context).turned),
      advised_period_(load(context).period, load(context).max_period, load(context).period),
      map_out_(bus.advertise<Costmap>()) {
  bus.subscribe<Scene>([this](const Scene& scene, const Receipt&) { scene_ = scene; });
  bus.subscribe<HumanState>([this](const HumanState& people, const Receipt&) { people_ = people; });
  bus.subscribe<AttentionAdvice>([this](const AttentionAdvice& advice, const Receipt& r) {
    advised_period_.advise(advice.cost_map_period, r.arrival);
  });
  bus.every(from_seconds(load(context).period), [this](TimePoint now) { step(now); });
}

/// Returns the position of the robot, world [m].
Vector3 Node::p_world_robot() const {
  const Pose T = robot_ != nullptr ? T_world_platform(*robot_, *scene_) : scene_->T_world_base;
  return T.translation();
}

void Node::step(TimePoint now) {
  const bool current = scene_ && bus_.lag<Scene>() < kMaxAge && bus_.lag<HumanState>() < kMaxAge;
  bus_.set_degraded(current ? "" : "no current Scene or HumanState: no cost map");
  if (!current || making_ || !advised_period_.due(now)) return;
  advised_period_.done(now);
  const Person* person = nearest_person(people_, p_world_robot());
  if (person == nullptr) {
    made_ = nullptr;
  } else if (watch_.changed(*person, scene_->boxes) || made_ == nullptr) {
    make(*person);
  } else {
    publish(now);
  }
}

void Node::make(const Person& person) {
  struct Work {
    Person person;
    std::vector<SceneBox> boxes;
    const Layers* layers{};
  };
  auto work = std::make_shared<Work>(Work{person, scene_->boxes});
  making_ = true;
  bus_.run_job(
      [this, work](const CancelToken&) {
        work->layers = &maker_.make(work->person, work->boxes);
        return from_seconds(cell_time_ * static_cast<double>(work->layers->front().values.size()));
      },
      [this, work] {
        making_ = false;
        made_ = work->layers;
        ++revision_;
        publish(bus_.now());
      });
}

/// Publishes each layer that has changed or was last sent longer than the repeat period ago.
void Node::publish(TimePoint now) {
  if (made_ == nullptr) return;
  for (std::size_t i = 0; i < made_->size(); ++i) {
    const Costmap& layer = (*made_)[i];
    Sent& sent = sent_[i];
    const bool same = layer.person == sent.map.person && layer.origin == sent.map.origin &&
                      layer.values == sent.map.values;
    if (same && now - sent.time < repeat_) continue;
    if (!same) {
      sent.map = layer;
      sent.map.revision = revision_;
    }
    sent.time = now;
    map_out_->publish(sent.map);
  }
}

}  // namespace handsel::costmap
