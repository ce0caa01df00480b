// Protobuf text whose values are checked after it was read, with the position of each value in the
// file.
#pragma once

#include <filesystem>
#include <string>

#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>

#include "common/base/errors.hpp"

namespace handsel {

/// A message in a text, or one inside it; lives as long as the tree it came from.
class TextPlace {
 public:
  TextPlace() = default;
  TextPlace(std::string file, const google::protobuf::TextFormat::ParseInfoTree* tree,
            const google::protobuf::Descriptor* type)
      : file_(std::move(file)), tree_(tree), type_(type) {}
  /// The index-th message of a field of this one.
  TextPlace inside(const std::string& field, int index = 0) const;
  /// "file:line:field", of the index-th value of a repeated one; "file:field" where the line is not
  /// known.
  std::string of(const std::string& field, int index = 0) const;

 private:
  std::string file_;
  const google::protobuf::TextFormat::ParseInfoTree* tree_{nullptr};
  const google::protobuf::Descriptor* type_{nullptr};
};

/// Strict, as load_text_proto(); `name` stands for the file in errors.
void parse_text_proto(const std::string& text, const std::string& name,
                      google::protobuf::Message& out,
                      google::protobuf::TextFormat::ParseInfoTree& places);
/// Loads a file as load_text_proto() of resources.hpp does and writes the position of every value
/// to `places`. Throws MissingError, ConfigError.
void load_text_proto(const std::filesystem::path& file, google::protobuf::Message& out,
                     google::protobuf::TextFormat::ParseInfoTree& places);

}  // namespace handsel
