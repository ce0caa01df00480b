// SPDX-License-Identifier: Apache-2.0
// A settings file that has been read: where each value stands.
#pragma once

#include <filesystem>
#include <string>

#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>

#include "common/config/located.hpp"

namespace handsel {

/// The text of one settings file.
class SettingsText {
 public:
  /// Reads a file with load_text_proto(). Throws MissingError, ConfigError "file:line:key: ...".
  void load(const std::filesystem::path& file, google::protobuf::Message& out);
  /// Returns the place of the whole text; valid as long as this object.
  const TextPlace& root() const { return root_; }
  /// Throws ConfigError "file:line:key: sentence" for a key of the outermost level.
  [[noreturn]] void refuse(const std::string& key, const std::string& sentence) const;

 private:
  google::protobuf::TextFormat::ParseInfoTree tree_;
  TextPlace root_;
};

}  // namespace handsel
