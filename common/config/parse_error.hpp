// SPDX-License-Identifier: Apache-2.0
// What is wrong with a Protobuf text, as a person can correct it.
#pragma once

#include <string>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/tokenizer.h>

namespace handsel {

/// Keeps the first error of a parser.
class FirstError : public google::protobuf::io::ErrorCollector {
 public:
  /// Called by the parser; `line` and `column` count from 0, line -1: the whole text.
  void AddError(int line, google::protobuf::io::ColumnNumber column,
                const std::string& message) override;
  /// Returns "line:key: sentence", "line:column: sentence" where no key is known, for the text that
  /// was parsed as a message of type `root`. An unknown key is answered with the nearest one.
  std::string explain(const std::string& text, const google::protobuf::Descriptor& root) const;

 private:
  int line_{-1}, column_{0};
  std::string message_;
};

}  // namespace handsel
