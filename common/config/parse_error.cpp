// SPDX-License-Identifier: Apache-2.0
#include "common/config/parse_error.hpp"

#include <algorithm>
#include <regex>
#include <vector>

#include "common/config/nearest_name.hpp"
#include "common/config/text_check.hpp"

namespace handsel {
namespace {

constexpr std::size_t kMaxKey = 60;             // max length of a key in messages [bytes]
constexpr std::size_t kMaxSentence = 300;       // max length of a sentence [bytes]
constexpr int kMaxLinesBack = 100;              // max lines searched for the key of a wrong value
constexpr std::size_t kMaxSearchLength = 1000;  // max length searched for that key [bytes]

std::string nearest_key(const std::string& key, const google::protobuf::Descriptor& type) {
  std::string nearest;
  std::size_t min_distance = std::string::npos;
  for (int i = 0; i < type.field_count(); ++i) {
    const std::size_t distance = edit_distance(key, type.field(i)->name());
    if (distance >= min_distance) continue;
    min_distance = distance;
    nearest = type.field(i)->name();
  }
  return nearest;
}

std::string line_of(const std::string& text, int line) {
  std::size_t begin = 0;
  for (int i = 0; i < line && begin != std::string::npos; ++i) {
    begin = text.find('\n', begin);
    if (begin != std::string::npos) ++begin;
  }
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find('\n', begin) - begin);
}

/// Returns the key of a wrong value; empty if unknown.
std::string key_before(const std::string& line, std::size_t column) {
  const std::size_t end = std::min(column, line.size());
  const std::size_t begin = end > kMaxSearchLength ? end - kMaxSearchLength : 0;
  static const std::regex last_key(R"(([A-Za-z_]\w*)\s*:?[^A-Za-z_]*$)");
  std::smatch match;
  const std::string before = line.substr(begin, end - begin);
  if (!std::regex_search(before, match, last_key)) return {};
  return match[1];
}

/// Returns the line of the last occurrence of a key up to a line: the parser reports some wrong
/// values at the word after them.
int line_of_key(const std::string& text, const std::string& key, int line) {
  const std::regex word("\\b" + key + "\\b");
  for (int i = line; i >= 0 && i > line - kMaxLinesBack; --i)
    if (std::regex_search(line_of(text, i).substr(0, kMaxSearchLength), word)) return i;
  return line;
}

/// Returns the word in quotation marks after `before`; empty if there is none.
std::string quoted(const std::string& message, const std::string& before) {
  const std::size_t at = message.find(before + "\"");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + before.size() + 1;
  return message.substr(begin, message.find('"', begin) - begin);
}

}  // namespace

void FirstError::AddError(int line, google::protobuf::io::ColumnNumber column,
                          const std::string& message) {
  if (!message_.empty()) return;
  line_ = line;
  column_ = column;
  message_ = message;
}

std::string FirstError::explain(const std::string& text,
                                const google::protobuf::Descriptor& root) const {
  const std::string sentence = printable(message_, kMaxSentence);
  if (line_ < 0) return " " + sentence;
  const std::string line = std::to_string(line_ + 1) + ":";
  if (const std::string key = quoted(message_, "has no field named "); !key.empty()) {
    const std::string shown = printable(key, kMaxKey);
    const auto* type =
        root.file()->pool()->FindMessageTypeByName(quoted(message_, "Message type "));
    if (type == nullptr || type->field_count() == 0) return line + shown + ": is no key here";
    return line + shown + ": is no key of " + type->name() + "; the nearest is \"" +
           nearest_key(shown, *type) + "\"";
  }
  std::string key = quoted(message_, "field ");
  if (std::regex_match(key, std::regex("\\w+")))
    return std::to_string(line_of_key(text, key, line_) + 1) + ":" + printable(key, kMaxKey) +
           ": " + sentence;
  if (key.empty()) key = key_before(line_of(text, line_), static_cast<std::size_t>(column_));
  if (key.empty()) return line + std::to_string(column_ + 1) + ": " + sentence;
  return line + printable(key, kMaxKey) + ": " + sentence;
}

}  // namespace handsel
