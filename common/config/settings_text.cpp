// SPDX-License-Identifier: Apache-2.0
#include "common/config/settings_text.hpp"

#include "common/base/errors.hpp"

namespace handsel {

void SettingsText::load(const std::filesystem::path& file, google::protobuf::Message& out) {
  load_text_proto(file, out, tree_);
  root_ = TextPlace(file.string(), &tree_, out.GetDescriptor());
}

void SettingsText::refuse(const std::string& key, const std::string& sentence) const {
  throw ConfigError(root_.of(key) + ": " + sentence);
}

}  // namespace handsel
