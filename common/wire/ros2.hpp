// SPDX-License-Identifier: Apache-2.0
// Conversion of messages of ROS 2 to and from the IDL structs of idl/ros2, validated like those of
// the table. Their strings and lists have no bounds on the wire; here they have.
#pragma once

#include <memory>
#include <string>

#include "common/messages/ros2.hpp"
#include "common/wire/message_type.hpp"

namespace handsel {

/// Longest names and lists taken; what is longer is malformed.
inline constexpr std::size_t kRosText = 256, kRosJoints = 128, kRosPoints = 1024,
                             kRosTransforms = 512;

/// How a topic of ROS is written or read. The profiles that ROS knows: `sensor` (best effort, keep
/// last: its sensor data; a reader of that kind receives from reliable writers too), `goal`
/// (reliable, volatile, keep last: its default) and `state` (reliable, transient local: latched). M
/// is a message of common/messages/ros2.hpp; `name` as in ROS: "joint_states" is "rt/joint_states"
/// on the wire. The type must outlive the bus.
template <class M>
std::unique_ptr<MessageType> ros2_type(const std::string& name, Profile profile);

template <>
std::unique_ptr<MessageType> ros2_type<ros2::JointState>(const std::string& name, Profile profile);
template <>
std::unique_ptr<MessageType> ros2_type<ros2::JointTrajectory>(const std::string& name,
                                                              Profile profile);
template <>
std::unique_ptr<MessageType> ros2_type<ros2::Transforms>(const std::string& name, Profile profile);
template <>
std::unique_ptr<MessageType> ros2_type<ros2::Ids>(const std::string& name, Profile profile);
template <>
std::unique_ptr<MessageType> ros2_type<ros2::Text>(const std::string& name, Profile profile);

}  // namespace handsel
