// SPDX-License-Identifier: Apache-2.0
// Topics outside the table may be used on a bus too, with a row and a MessageType of their own that
// live as long as the bus runs.
#pragma once

#include <functional>
#include <iterator>

#include "common/topics/topics.hpp"

namespace handsel {

/// Returns whether the row is an element of kTopics, by its address. For any other row the bus does
/// not compare the types, which external writers may not announce.
inline bool in_table(const TopicRow& row) {
  return !std::less<>()(&row, std::begin(kTopics)) && std::less<>()(&row, std::end(kTopics));
}

}  // namespace handsel
