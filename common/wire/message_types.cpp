// SPDX-License-Identifier: Apache-2.0
#include "common/wire/message_type.hpp"

#include <stdexcept>

namespace handsel {

const MessageType& message_type(std::size_t index) {
  using Get = const MessageType& (*)();
#define HANDSEL_ROW(type, topic, ...) &message_type<type>,
  static constexpr Get kTypes[] = {HANDSEL_TOPICS(HANDSEL_ROW)};
#undef HANDSEL_ROW
  if (index >= std::size(kTypes))
    throw std::out_of_range("message_type: index beyond the table of topics");
  return kTypes[index]();
}

const MessageType* find_message_type(std::string_view type_or_topic) {
  const TopicRow* row = find_topic(type_or_topic);
  return row ? &message_type(static_cast<std::size_t>(row - kTopics)) : nullptr;
}

}  // namespace handsel
