// SPDX-License-Identifier: Apache-2.0
// Checks of every value in a Protobuf text, whatever message the text holds.
#pragma once

#include <string>

#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>

namespace handsel {

/// Throws ConfigError "file:line:key: ..." for the first number that is not finite or not in its
/// range, for text that is not UTF-8 or longer than 4096 bytes, and for a map key that is there
/// twice. `places` says where each value stands in `file`.
void check_text(const google::protobuf::Message& message,
                const google::protobuf::TextFormat::ParseInfoTree& places, const std::string& file);

/// Returns `text` cut to `max_bytes`, with a question mark for each byte that is not printable
/// ASCII: file content for one line of an error.
std::string printable(const std::string& text, std::size_t max_bytes);

}  // namespace handsel
