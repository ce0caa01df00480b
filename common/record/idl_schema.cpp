// SPDX-License-Identifier: Apache-2.0
#include "common/record/idl_schema.hpp"

#include <cctype>

#include "common/base/errors.hpp"

namespace handsel::idl {
namespace {

const std::map<std::string, Kind, std::less<>> kNumbers{{"boolean", Kind::boolean},
                                                        {"octet", Kind::uint8},
                                                        {"char", Kind::uint8},
                                                        {"uint8", Kind::uint8},
                                                        {"int8", Kind::int8},
                                                        {"int16", Kind::int16},
                                                        {"short", Kind::int16},
                                                        {"uint16", Kind::uint16},
                                                        {"unsigned short", Kind::uint16},
                                                        {"int32", Kind::int32},
                                                        {"long", Kind::int32},
                                                        {"uint32", Kind::uint32},
                                                        {"unsigned long", Kind::uint32},
                                                        {"int64", Kind::int64},
                                                        {"long long", Kind::int64},
                                                        {"uint64", Kind::uint64},
                                                        {"unsigned long long", Kind::uint64},
                                                        {"float", Kind::float32},
                                                        {"double", Kind::float64}};
constexpr int kMaxDepth = 8;  // of sequences in sequences

/// Splits an IDL text into words and signs and reads the definitions.
class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) { advance(); }

  Schema read() {
    while (!word_.empty()) read_definition();
    return std::move(schema_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw ConfigError("IDL line " + std::to_string(line_) + ": " + what);
  }

  static bool is_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

  void skip_space() {
    while (at_ < text_.size()) {
      const std::string_view rest = text_.substr(at_);
      if (rest.starts_with("//") || rest.starts_with('#')) {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (rest.starts_with("/*")) {
        const std::size_t end = std::min(text_.find("*/", at_ + 2), text_.size() - 2);
        for (; at_ < end + 2; ++at_) line_ += text_[at_] == '\n';
      } else if (std::isspace(static_cast<unsigned char>(text_[at_]))) {
        line_ += text_[at_++] == '\n';
      } else {
        return;
      }
    }
  }
  /// Reads the next word or sign into word_, which is empty at the end.
  void advance() {
    skip_space();
    std::size_t end = at_;
    while (end < text_.size() && is_name(text_[end])) ++end;
    if (end == at_ && end < text_.size()) ++end;
    word_ = text_.substr(at_, end - at_);
    at_ = end;
  }
  bool take(std::string_view expected) {
    if (word_ != expected) return false;
    advance();
    return true;
  }
  void expect(std::string_view expected) {
    if (!take(expected))
      fail("\"" + std::string(expected) + "\" expected, found \"" + std::string(word_) + "\"");
  }
  std::string take_name() {
    if (word_.empty() || !is_name(word_[0]) || std::isdigit(static_cast<unsigned char>(word_[0])))
      fail("a name expected, found \"" + std::string(word_) + "\"");
    std::string out(word_);
    advance();
    return out;
  }
  std::uint32_t take_number() {
    std::uint64_t out = 0;
    if (word_.empty() || word_.size() > 9) fail("a number of at most 9 digits expected");
    for (const char c : word_) {
      if (!std::isdigit(static_cast<unsigned char>(c))) fail("a number expected");
      out = out * 10 + static_cast<std::uint64_t>(c - '0');
    }
    advance();
    return static_cast<std::uint32_t>(out);
  }

  void read_definition() {
    if (take("module")) {
      take_name();
      expect("{");
      while (word_ != "}" && !word_.empty()) read_definition();
      expect("}");
      expect(";");
    } else if (take("enum")) {
      read_enumeration();
    } else if (take("@")) {
      const std::string annotation = take_name();
      if (annotation != "final" && annotation != "nested" && annotation != "topic")
        fail("annotation @" + annotation + " is not supported");
    } else if (take("struct")) {
      read_structure();
    } else {
      fail("module, enum or struct expected, found \"" + std::string(word_) + "\"");
    }
  }
  void read_enumeration() {
    const std::string name = new_name();
    std::vector<std::string> values;
    expect("{");
    do values.push_back(take_name());
    while (take(","));
    expect("}");
    expect(";");
    schema_.enumerations[name] = std::move(values);
  }
  void read_structure() {
    const std::string name = new_name();
    std::vector<Field> fields;
    expect("{");
    while (!take("}")) {
      while (take("@")) {
        if (const std::string annotation = take_name(); annotation != "key")
          fail("annotation @" + annotation + " is not supported");
      }
      const Type type = read_type(0);
      do fields.push_back(read_declarator(type));
      while (take(","));
      expect(";");
    }
    expect(";");
    schema_.structures[name] = std::move(fields);
  }
  std::string new_name() {
    std::string name = take_name();
    if (schema_.structures.contains(name) || schema_.enumerations.contains(name))
      fail(name + " is defined twice");
    return name;
  }
  Field read_declarator(Type type) {
    Field field{take_name(), std::move(type)};
    std::vector<std::uint32_t> lengths;
    while (take("[")) {
      lengths.push_back(take_number());
      if (lengths.back() == 0) fail("an array has at least one element");
      expect("]");
    }
    for (auto length = lengths.rbegin(); length != lengths.rend(); ++length)
      field.type = {Kind::array, {}, std::make_shared<Type>(field.type), *length};
    return field;
  }
  Type read_type(int depth) {
    if (depth > kMaxDepth) fail("sequences are nested too deep");
    if (take("sequence")) {
      expect("<");
      Type out{Kind::sequence, {}, std::make_shared<Type>(read_type(depth + 1)), 0};
      if (take(",")) out.length = take_number();
      expect(">");
      return out;
    }
    std::string name = take_name();
    if (name == "string") {
      if (take("<")) {
        take_number();
        expect(">");
      }
      return {Kind::text, {}, nullptr, 0};
    }
    if (name == "unsigned" || name == "long") {
      while (word_ == "long" || word_ == "short") name += " " + take_name();
    }
    if (const auto number = kNumbers.find(name); number != kNumbers.end())
      return {number->second, {}, nullptr, 0};
    while (take(":")) {  // the modules of a name
      expect(":");
      name = take_name();
    }
    if (schema_.structures.contains(name)) return {Kind::structure, name, nullptr, 0};
    if (schema_.enumerations.contains(name)) return {Kind::enumeration, name, nullptr, 0};
    fail("no type " + name + " is defined before its use");
  }

  std::string_view text_, word_;
  std::size_t at_{};
  int line_{1};
  Schema schema_;
};

}  // namespace

std::size_t size_of(Kind kind) noexcept {
  switch (kind) {
    case Kind::boolean:
    case Kind::uint8:
    case Kind::int8:
      return 1;
    case Kind::int16:
    case Kind::uint16:
      return 2;
    case Kind::int32:
    case Kind::uint32:
    case Kind::float32:
    case Kind::enumeration:
      return 4;
    case Kind::int64:
    case Kind::uint64:
    case Kind::float64:
      return 8;
    default:
      return 0;
  }
}

Schema Schema::parse(std::string_view text) { return Parser(text).read(); }

}  // namespace handsel::idl
