// SPDX-License-Identifier: Apache-2.0
// Topic entities of a participant, made when they are first needed.
#pragma once

#include <map>
#include <string>

#include <dds/dds.h>

#include "common/topics/topics.hpp"
#include "common/wire/message_type.hpp"

namespace handsel {

/// Returns the entity. Throws MissingError naming `what` when it is an error code.
dds_entity_t valid_entity(dds_entity_t entity, const std::string& what);

/// The entities are deleted together with their participant.
class TopicEntities {
 public:
  /// `participant` must outlive this and be set before the first topic is needed.
  explicit TopicEntities(const dds_entity_t& participant) : participant_(participant) {}

  /// Returns the one entity of the topic. Throws MissingError when it cannot be made.
  dds_entity_t of(const MessageType& type);
  /// Returns another entity of the topic, for a filter of its own. Throws MissingError.
  dds_entity_t make(const MessageType& type) const;

 private:
  const dds_entity_t& participant_;
  dds_entity_t entities_[std::size(kTopics)]{};
  std::map<const MessageType*, dds_entity_t> foreign_;
};

}  // namespace handsel
