// SPDX-License-Identifier: Apache-2.0
#include "common/record/sample_table.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "common/base/errors.hpp"

namespace handsel::idl {

/// A value of the message type; its children are the fields of a structure or the element.
struct SampleTable::Node {
  std::string name;
  Type type;
  std::vector<std::unique_ptr<Node>> children;
  std::size_t longest{};       // length of the sequence or array
  std::size_t column{};        // of a leaf: index into the columns
  std::size_t count_column{};  // of a sequence: index of the column with its lengths
};

/// Reads one sample from its beginning to its end; writes into `columns` unless null.
class SampleTable::Walk {
 public:
  Walk(const std::vector<std::uint8_t>& sample, std::vector<Column>* columns)
      : at_(sample.data()), end_(at_ + sample.size()), columns_(columns) {
    constexpr std::size_t kHeader = 4;
    if (sample.size() < kHeader) throw ConfigError("the sample has no encapsulation header");
    if (sample[0] != 0 || sample[1] > 1)
      throw ConfigError("the sample has the encoding " + std::to_string(sample[0]) + "." +
                        std::to_string(sample[1]) + ", not plain CDR (0.0 or 0.1)");
    swapped_ = (sample[1] == 1) != (std::endian::native == std::endian::little);
    at_ += kHeader;
    begin_ = at_;
  }

  void read(Node& node, std::size_t index) {
    switch (node.type.kind) {
      case Kind::structure:
        for (const auto& child : node.children) read(*child, index);
        return;
      case Kind::sequence:
        read_sequence(node, index);
        return;
      case Kind::array:
        read_elements(node, index, node.type.length);
        return;
      case Kind::text:
        read_text(node, index);
        return;
      default:
        read_numbers(node, index, 1);
    }
  }

 private:
  [[noreturn]] static void fail(const Node& node, const std::string& what) {
    throw ConfigError("field " + node.name + ": " + what);
  }
  const std::uint8_t* take(const Node& node, std::size_t alignment, std::size_t size) {
    const auto offset = static_cast<std::size_t>(at_ - begin_);
    const std::size_t gap = (alignment - offset % alignment) % alignment;
    const auto left = static_cast<std::size_t>(end_ - at_);
    if (gap > left || size > left - gap) fail(node, "the sample ends within it");
    const std::uint8_t* out = at_ + gap;
    at_ = out + size;
    return out;
  }
  std::uint32_t take_length(const Node& node) {
    std::uint32_t out = 0;
    std::memcpy(&out, take(node, sizeof out, sizeof out), sizeof out);
    if (swapped_) out = __builtin_bswap32(out);
    return out;
  }
  void read_sequence(Node& node, std::size_t index) {
    const std::uint32_t length = take_length(node);
    if (node.type.length != 0 && length > node.type.length)
      fail(node, std::to_string(length) + " elements, more than its bound of " +
                     std::to_string(node.type.length));
    // Each element has at least one byte, but that of an empty structure.
    if (length > static_cast<std::size_t>(end_ - at_)) fail(node, "the sample ends within it");
    if (columns_ == nullptr) {
      node.longest = std::max<std::size_t>(node.longest, length);
    } else {
      if (length > node.longest) fail(node, "the sample was not measured");
      std::memcpy((*columns_)[node.count_column].numbers.data() + index * sizeof length, &length,
                  sizeof length);
    }
    read_elements(node, index, length);
  }
  void read_elements(Node& node, std::size_t index, std::size_t length) {
    Node& element = *node.children[0];
    const std::size_t first = index * node.longest;
    if (size_of(element.type.kind) != 0) {
      if (length != 0) read_numbers(element, first, length);
      return;
    }
    for (std::size_t i = 0; i < length; ++i) read(element, first + i);
  }
  void read_numbers(const Node& node, std::size_t index, std::size_t count) {
    const std::size_t size = size_of(node.type.kind);
    const std::uint8_t* from = take(node, size, size * count);
    if (columns_ == nullptr) return;
    std::uint8_t* to = (*columns_)[node.column].numbers.data() + index * size;
    std::memcpy(to, from, size * count);
    if (swapped_)
      for (std::size_t i = 0; i < count; ++i) std::reverse(to + i * size, to + (i + 1) * size);
    if (node.type.kind == Kind::boolean)
      for (std::size_t i = 0; i < count; ++i) to[i] = to[i] != 0;
  }
  void read_text(const Node& node, std::size_t index) {
    const std::uint32_t length = take_length(node);
    const std::uint8_t* from = take(node, 1, length);
    if (length == 0 || from[length - 1] != 0) fail(node, "the text has no end");
    if (columns_ != nullptr)
      (*columns_)[node.column].texts[index].assign(reinterpret_cast<const char*>(from), length - 1);
  }

  const std::uint8_t *at_, *end_, *begin_{};
  bool swapped_{};
  std::vector<Column>* columns_;
};

std::unique_ptr<SampleTable::Node> SampleTable::make(const Schema& schema, const Type& type,
                                                     const std::string& name, int depth) {
  constexpr int kMaxDepth = 32;
  if (depth > kMaxDepth) throw ConfigError("field " + name + ": types are nested too deep");
  auto node = std::make_unique<Node>();
  node->name = name;
  node->type = type;
  if (type.kind == Kind::structure) {
    for (const Field& field : schema.structures.at(type.name))
      node->children.push_back(
          make(schema, field.type, name.empty() ? field.name : name + "." + field.name, depth + 1));
  } else if (type.element) {
    node->children.push_back(make(schema, *type.element, name, depth + 1));
    if (type.kind == Kind::array) node->longest = type.length;
  }
  return node;
}

SampleTable::SampleTable(const Schema& schema, const std::string& type) {
  const std::string name = type.substr(type.rfind(':') + 1);
  if (!schema.structures.contains(name)) throw ConfigError("the IDL has no struct " + type);
  root_ = make(schema, {Kind::structure, name, nullptr, 0}, "", 0);
}
SampleTable::~SampleTable() = default;
SampleTable::SampleTable(SampleTable&&) noexcept = default;

void SampleTable::measure(const std::vector<std::uint8_t>& sample) {
  Walk(sample, nullptr).read(*root_, 0);
  ++measured_;
}

void SampleTable::add_column(Column column, std::uint64_t& left) {
  const std::size_t size = column.kind == Kind::text ? sizeof(std::string) : size_of(column.kind);
  std::uint64_t count = 1;
  for (const std::size_t length : column.shape) {
    if (length != 0 && count > left / size / length)
      throw ConfigError("column " + column.name + " needs too much memory; select fewer topics");
    count *= length;
  }
  left -= count * size;
  if (column.kind == Kind::text) {
    column.texts.resize(count);
  } else {
    column.numbers.resize(count * size);
    const auto fill_with = [&](auto value) {
      for (std::uint64_t i = 0; i < count; ++i)
        std::memcpy(column.numbers.data() + i * sizeof value, &value, sizeof value);
    };
    if (column.kind == Kind::float64) fill_with(std::numeric_limits<double>::quiet_NaN());
    if (column.kind == Kind::float32) fill_with(std::numeric_limits<float>::quiet_NaN());
  }
  columns_.push_back(std::move(column));
}

void SampleTable::shape(Node& node, std::vector<std::size_t> around, std::uint64_t& left) {
  if (node.type.kind == Kind::sequence) {
    node.count_column = columns_.size();
    std::string name = node.name;  // "a[]" is a sequence in the sequence a
    const auto taken = [&](const Column& column) { return column.name == "len(" + name + ")"; };
    while (std::any_of(columns_.begin(), columns_.end(), taken)) name += "[]";
    name = "len(" + name + ")";
    add_column({name, Kind::uint32, {}, around, {}, {}}, left);
  }
  if (node.type.element) around.push_back(node.longest);
  for (const auto& child : node.children) shape(*child, around, left);
  if (!node.children.empty() || node.type.kind == Kind::structure) return;
  node.column = columns_.size();
  add_column({node.name, node.type.kind, node.type.name, std::move(around), {}, {}}, left);
}

void SampleTable::start_filling(std::uint64_t max_bytes) {
  columns_.clear();
  filled_ = 0;
  std::uint64_t left = max_bytes;
  shape(*root_, {measured_}, left);
}

void SampleTable::fill(const std::vector<std::uint8_t>& sample) {
  if (filled_ >= measured_) throw ConfigError("the sample was not measured");
  Walk(sample, &columns_).read(*root_, filled_);
  ++filled_;
}

std::size_t SampleTable::samples() const { return measured_; }

std::vector<Column> SampleTable::take_columns() { return std::move(columns_); }

}  // namespace handsel::idl
