// SPDX-License-Identifier: Apache-2.0
// XML of descriptions.
#pragma once

#include <tinyxml2.h>

#include <filesystem>
#include <string>

#include "common/base/errors.hpp"

namespace handsel {

/// Parses `text`, the content of `file`, into `xml`. Throws ConfigError "file:line: ..." when the
/// text is no XML or nested too deep.
inline void parse_xml(tinyxml2::XMLDocument& xml, const std::filesystem::path& file,
                      const std::string& text) {
  if (xml.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS) return;
  const bool deep = xml.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
  throw ConfigError(file.string() + ":" + std::to_string(xml.ErrorLineNum()) +
                    (deep ? ": elements are nested too deep" : ": not well-formed XML"));
}

}  // namespace handsel
