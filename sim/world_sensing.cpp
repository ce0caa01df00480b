// SPDX-License-Identifier: Apache-2.0
// The observations of people and objects by sensors in the emulated world.
#include <algorithm>

#include "sim/world_parts.hpp"

namespace handsel::sim {

void SimWorld::Impl::sense() {
  bool is_updated = false;
  const auto observe = [&](auto& sensor) {
    if (!sensor.due(now())) return;
    if (!is_updated) update_sight();
    is_updated = true;
    if (const SensorSettings& s = sensor.settings(); !s.link.empty())
      sensor.carry_to(robot->T_world_link(model.link_index(s.link)) * s.T_link_sensor);
    sensor.observe(now(), sight);
  };
  for (HumanSensor& sensor : human_sensors) observe(sensor);
  for (ObjectSensor& sensor : object_sensors) observe(sensor);
}

void SimWorld::Impl::update_sight() {
  sight.people.clear();
  sight.bodies.clear();
  sight.objects.clear();
  for (std::size_t p = 0; p < people->size(); ++p) {
    sight.people.push_back(&people->model(p).body());
    sight.bodies.push_back(people->capsules(p));
  }
  for (const ObjectBody& object : objects)
    sight.objects.push_back(
        {object.start().id, object.start().model_name, object.T_world_object()});
  for (std::size_t i = 0; i < hiding_links.size(); ++i) {
    const LinkCapsule& c = hiding_links[i];
    const Pose& T = robot->T_world_link(c.link);
    sight.robot[i] = {T * c.a, T * c.b, c.radius};
  }
}

void SimWorld::Impl::prepare_sight() {
  const auto hidden = [](const SensorSettings& s) { return s.occlusion; };
  if (std::none_of(setup.human_sensors.begin(), setup.human_sensors.end(), hidden) &&
      std::none_of(setup.object_sensors.begin(), setup.object_sensors.end(), hidden))
    return;
  hiding_links = robot_capsules(model);
  sight.robot.resize(hiding_links.size());
  for (const StartBox& box : setup.boxes) sight.boxes.push_back({box.T_world_box, box.size});
}

void SimWorld::request(const SensorRequest& request) {
  for (HumanSensor& sensor : impl_->human_sensors) sensor.request(impl_->now(), request);
  for (ObjectSensor& sensor : impl_->object_sensors) sensor.request(impl_->now(), request);
}

void SimWorld::human_observations(std::vector<Delivery<HumanObservation>>& out) {
  for (HumanSensor& sensor : impl_->human_sensors) sensor.collect(impl_->now(), out);
  if (impl_->now() < impl_->human_silent_until) out.clear();
}

void SimWorld::object_observations(std::vector<Delivery<ObjectObservation>>& out) {
  for (ObjectSensor& sensor : impl_->object_sensors) sensor.collect(impl_->now(), out);
}

}  // namespace handsel::sim
