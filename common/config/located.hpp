// SPDX-License-Identifier: Apache-2.0
// Protobuf text whose values are checked after it was read, with the position of each value in the
// file.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>

#include "common/base/errors.hpp"

namespace handsel {

/// "file:line" or "--set key=value" by the path of a setting: "view.ceiling", "walls[1].offset".
using SettingSources = std::map<std::string, std::string>;

/// A message in a text, or one inside it; lives as long as the tree it came from.
class TextPlace {
 public:
  TextPlace() = default;
  /// `type` is that of the outermost message of a file.
  TextPlace(std::string file, const google::protobuf::TextFormat::ParseInfoTree* tree,
            const google::protobuf::Descriptor* type);
  /// The index-th message of a field of this one.
  TextPlace inside(const std::string& field, int index = 0) const;
  /// "file:line:field", of the index-th value of a repeated one; "file:field" where the line is not
  /// known. Of a setting that an overlay gives: the overlay's.
  std::string of(const std::string& field, int index = 0) const;

 private:
  std::string file_;
  const google::protobuf::TextFormat::ParseInfoTree* tree_{nullptr};
  const google::protobuf::Descriptor* type_{nullptr};
  std::shared_ptr<const SettingSources> overlaid_;  ///< of settings that overlays give, by path
  std::string path_;                                ///< of this message: "behaviours[2]"
};

/// Reads a text as load_text_proto() does, without default values and overlays. Throws ConfigError.
void parse_strict(const std::string& text, const std::string& name, google::protobuf::Message& out,
                  google::protobuf::TextFormat::ParseInfoTree& places);
/// Reads a text as load_text_proto() does, with default values, without overlays; `name` stands for
/// the file in errors. Throws ConfigError.
void parse_text_proto(const std::string& text, const std::string& name,
                      google::protobuf::Message& out,
                      google::protobuf::TextFormat::ParseInfoTree& places);
/// Loads a file as load_text_proto() of resources.hpp does and writes the position of every value
/// to `places`. Throws MissingError, ConfigError.
void load_text_proto(const std::filesystem::path& file, google::protobuf::Message& out,
                     google::protobuf::TextFormat::ParseInfoTree& places);

}  // namespace handsel
