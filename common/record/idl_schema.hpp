// SPDX-License-Identifier: Apache-2.0
// Message types from the IDL text that a recording holds, so that a reader needs no compiled types
// and reads recordings of any version. Own method: a parser of the part of OMG IDL 4.2 that idl/
// uses (final structs, enums, sequences, arrays, strings, numbers).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace handsel::idl {

/// Kind of a value on the wire.
enum class Kind {
  boolean,
  uint8,
  int8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
  text,
  enumeration,
  structure,
  sequence,
  array,
};
/// Returns the size of a number, boolean or enumeration on the wire [bytes]; 0 for other kinds.
std::size_t size_of(Kind kind) noexcept;

/// Type of a field.
struct Type {
  Kind kind{Kind::boolean};       ///< of the value
  std::string name;               ///< of a structure or enumeration, without its modules
  std::shared_ptr<Type> element;  ///< of a sequence or array
  std::uint32_t length{};         ///< of an array; bound of a sequence, 0: none
};

/// Named part of a structure.
struct Field {
  std::string name;  ///< as in the IDL
  Type type;         ///< of its value
};

/// All types of one IDL text.
struct Schema {
  std::map<std::string, std::vector<Field>> structures;  ///< fields in the order of the wire
  std::map<std::string, std::vector<std::string>> enumerations;  ///< names of 0, 1, ...

  /// Reads an IDL text. Throws ConfigError "IDL line <n>: ..." for text that is no IDL or beyond
  /// the part above, for a name that is not defined before its use and for one defined twice.
  static Schema parse(std::string_view text);
};

}  // namespace handsel::idl
