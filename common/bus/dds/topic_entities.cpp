// SPDX-License-Identifier: Apache-2.0
#include "common/bus/dds/topic_entities.hpp"

#include "common/base/errors.hpp"
#include "common/bus/dds/qos.hpp"
#include "common/bus/foreign.hpp"

namespace handsel {

dds_entity_t valid_entity(dds_entity_t entity, const std::string& what) {
  if (entity < 0) throw MissingError("DDS: " + what + ": " + dds_strretcode(-entity));
  return entity;
}

dds_entity_t TopicEntities::make(const MessageType& type) const {
  const Qos qos = topic_qos(type.row());
  return valid_entity(
      dds_create_topic(participant_, static_cast<const dds_topic_descriptor_t*>(type.descriptor()),
                       type.row().topic, qos.get(), nullptr),
      std::string("topic ") + type.row().topic);
}

dds_entity_t TopicEntities::of(const MessageType& type) {
  dds_entity_t& entity = in_table(type.row()) ? entities_[&type.row() - kTopics] : foreign_[&type];
  if (entity == 0) entity = make(type);
  return entity;
}

}  // namespace handsel
