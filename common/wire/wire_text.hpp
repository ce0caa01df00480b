// SPDX-License-Identifier: Apache-2.0
// Text of messages: numbers, valid UTF-8 and strings of JSON. Private to common/wire.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace handsel::detail {

/// Returns the shortest text that reads back as `value`; "nan", "inf" or "-inf" where it is not
/// finite.
std::string number_text(double value);
/// Returns the length of the valid UTF-8 prefix without control characters (tab and line feed
/// allowed) [bytes].
std::size_t valid_prefix(std::string_view s);
/// Appends `s` to `out` as a JSON string in quotes.
void append_json_text(std::string& out, std::string_view s);

}  // namespace handsel::detail
