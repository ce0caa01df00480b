// SPDX-License-Identifier: Apache-2.0
// Samples of one topic as columns of equal length, one a field of the message.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/record/idl_schema.hpp"

namespace handsel::idl {

/// One field over all samples. Sequences are padded to the longest one: floats with NaN, other
/// numbers with 0, texts with "".
struct Column {
  std::string name;         ///< "people.joints.position.x"; "len(people)": lengths of a sequence
  Kind kind{};              ///< of its elements; text: `texts`, else `numbers`
  std::string enumeration;  ///< name of the enumeration; else empty
  std::vector<std::size_t> shape;     ///< samples, then the length of each sequence or array around
  std::vector<std::uint8_t> numbers;  ///< elements in C order, in the machine's byte order
  std::vector<std::string> texts;     ///< elements in C order
};

/// Decodes CDR samples (XCDR1 of final structs) in two passes: measure() every sample, then
/// start_filling(), then fill() the same samples in the same order.
class SampleTable {
 public:
  /// Throws ConfigError when the schema has no such structure. `type`: "handsel::RobotState" or
  /// "RobotState".
  SampleTable(const Schema& schema, const std::string& type);
  ~SampleTable();
  SampleTable(SampleTable&&) noexcept;

  /// Counts the sample and finds the lengths of its sequences. Throws ConfigError naming the field
  /// for bytes that are no such sample.
  void measure(const std::vector<std::uint8_t>& sample);
  /// Sets the shapes of all columns. Throws ConfigError naming the column when the columns need
  /// more than `max_bytes`.
  void start_filling(std::uint64_t max_bytes);
  /// Writes the next sample into the columns. Throws ConfigError as measure().
  void fill(const std::vector<std::uint8_t>& sample);
  /// Returns the number of samples measured.
  std::size_t samples() const;
  /// Returns the columns; to be called once, after all samples are filled.
  std::vector<Column> take_columns();

 private:
  struct Node;
  class Walk;
  static std::unique_ptr<Node> make(const Schema& schema, const Type& type, const std::string& name,
                                    int depth);
  void shape(Node& node, std::vector<std::size_t> around, std::uint64_t& left);
  void add_column(Column column, std::uint64_t& left);
  std::unique_ptr<Node> root_;
  std::size_t measured_{}, filled_{};
  std::vector<Column> columns_;
};

}  // namespace handsel::idl
