// SPDX-License-Identifier: Apache-2.0
// Default values of settings that a file leaves out.
#pragma once

#include <string>

#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>

namespace handsel {

/// Gives each field that the text leaves out its default value of the schema, also inside the
/// messages that the text has; fields without a default stay as they are. `places` says what the
/// text of `file` has. Throws ConfigError "file:line:key: must be given ..." for a missing required
/// field, or message with one that is not `optional`; line: of the message that lacks it.
void take_defaults(google::protobuf::Message& message,
                   const google::protobuf::TextFormat::ParseInfoTree& places,
                   const std::string& file);

}  // namespace handsel
