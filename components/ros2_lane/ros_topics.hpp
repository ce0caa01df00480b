// SPDX-License-Identifier: Apache-2.0
// Topics of ROS on a Bus.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/wire/ros2.hpp"

namespace handsel::ros2_lane {

/// Reads and writes topics by the names and types that ROS has on the wire. Must outlive what it
/// returns.
class RosTopics {
 public:
  explicit RosTopics(Bus& bus) : bus_(bus) {}

  /// Calls `on_sample` with each sample of a topic; an empty name reads nothing.
  template <class M>
  void read(const std::string& name, Profile profile,
            std::function<void(const M&, const Receipt&)> on_sample) {
    if (name.empty()) return;
    const auto on_any = [f = std::move(on_sample)](const void* m, const Receipt& r) {
      f(*static_cast<const M*>(m), r);
    };
    bus_.subscribe_any(type<M>(name, profile), on_any, {});
  }
  /// Returns the writer of a topic.
  template <class M>
  std::unique_ptr<Publisher<M>> write(const std::string& name, Profile profile) {
    return std::make_unique<Publisher<M>>(bus_.advertise_any(type<M>(name, profile), 0));
  }

 private:
  template <class M>
  const MessageType& type(const std::string& name, Profile profile) {
    types_.push_back(ros2_type<M>(name, profile));
    return *types_.back();
  }

  Bus& bus_;
  std::vector<std::unique_ptr<MessageType>> types_;
};

}  // namespace handsel::ros2_lane
