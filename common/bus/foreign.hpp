// Topics that others define travel on a bus too, with a row and a MessageType of their own that
// live as long as the bus runs.
#pragma once

#include <functional>
#include <iterator>

#include "common/topics/topics.hpp"

namespace handsel {

/// Is the row one of the table's own? Of the others no equality of types is asked for: their
/// writers may not even tell theirs.
inline bool in_table(const TopicRow& row) { return !std::less<>()(&row, std::begin(kTopics)) && std::less<>()(&row, std::end(kTopics)); }

}  // namespace handsel
