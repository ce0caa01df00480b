// SPDX-License-Identifier: Apache-2.0
// PLY (Stanford): reads the header, then checks every value of the body once.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>
#include <vector>

#include "common/geometry/mesh_check.hpp"
#include "common/geometry/mesh_text.hpp"

namespace handsel::mesh {
namespace {

namespace fs = std::filesystem;

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Format { text, little_endian, big_endian };

struct Property {
  std::string name;
  Scalar type{};
  std::optional<Scalar> length;  ///< of a list: type of its element count
};

struct Element {
  std::string name;
  std::size_t count{0};
  std::vector<Property> properties;
};

constexpr std::size_t kMaxElements = 16, kMaxProperties = 64;

std::optional<Scalar> scalar_of(std::string_view name) {
  static constexpr std::pair<std::string_view, Scalar> kNames[] = {
      {"char", Scalar::int8},      {"int8", Scalar::int8},       {"uchar", Scalar::uint8},
      {"uint8", Scalar::uint8},    {"short", Scalar::int16},     {"int16", Scalar::int16},
      {"ushort", Scalar::uint16},  {"uint16", Scalar::uint16},   {"int", Scalar::int32},
      {"int32", Scalar::int32},    {"uint", Scalar::uint32},     {"uint32", Scalar::uint32},
      {"float", Scalar::float32},  {"float32", Scalar::float32}, {"double", Scalar::float64},
      {"float64", Scalar::float64}};
  const auto found = std::find_if(std::begin(kNames), std::end(kNames),
                                  [&](const auto& known) { return known.first == name; });
  return found == std::end(kNames) ? std::nullopt : std::optional(found->second);
}

bool is_whole(Scalar type) { return type != Scalar::float32 && type != Scalar::float64; }

class Header {
 public:
  Header(const fs::path& file, const std::string& content)
      : lines_(file, content), size_(content.size()) {
    if (!lines_.next() || lines_.word() != "ply")
      lines_.fail("is no PLY: it must begin with a line ply");
    while (lines_.next()) {
      const std::string_view word = lines_.word();
      if (word == "end_header") {
        finish();
        return;
      }
      if (word == "format") {
        read_format();
      } else if (word == "element") {
        read_element();
      } else if (word == "property") {
        read_property();
      } else if (!word.empty() && word != "comment" && word != "obj_info") {
        lines_.fail(shown(word) + " is no word of a PLY's header");
      }
    }
    lines_.fail("the file ends before end_header");
  }

  const std::vector<Element>& elements() const { return elements_; }
  std::size_t vertices() const { return vertices_; }
  Format format() const { return *format_; }
  Lines& body() { return lines_; }

 private:
  void read_format() {
    const std::string_view word = lines_.word();
    if (word == "ascii") {
      format_ = Format::text;
    } else if (word == "binary_little_endian") {
      format_ = Format::little_endian;
    } else if (word == "binary_big_endian") {
      format_ = Format::big_endian;
    } else {
      lines_.fail("format is " + shown(word) +
                  ", must be ascii, binary_little_endian or binary_big_endian");
    }
  }

  void read_element() {
    Element element;
    element.name = lines_.word();
    const std::string_view word = lines_.word();
    const auto count = whole_of(word);
    if (!count || *count < 0 || static_cast<std::size_t>(*count) > size_)
      lines_.fail("element " + shown(element.name) + " has " + shown(word) +
                  " entries, must be a whole number that fits the file's " + std::to_string(size_) +
                  " bytes");
    element.count = static_cast<std::size_t>(*count);
    for (const Element& other : elements_)
      if (other.name == element.name)
        lines_.fail("element " + shown(element.name) + " is there twice");
    if (elements_.size() == kMaxElements) lines_.fail("more than 16 elements");
    elements_.push_back(element);
  }

  void read_property() {
    if (elements_.empty()) lines_.fail("a property before the first element");
    const auto type = [this](std::string_view word) {
      const auto scalar = scalar_of(word);
      if (!scalar) lines_.fail(shown(word) + " is no type of a property, e.g. float, int, uchar");
      return *scalar;
    };
    Property property;
    std::string_view word = lines_.word();
    if (word == "list") {
      property.length = type(lines_.word());
      if (!is_whole(*property.length)) lines_.fail("the length of a list must be of a whole type");
      word = lines_.word();
    }
    property.type = type(word);
    property.name = lines_.word();
    if (elements_.back().properties.size() == kMaxProperties)
      lines_.fail("more than 64 properties");
    elements_.back().properties.push_back(property);
  }

  void finish() {
    if (!format_) lines_.fail("the header has no format");
    bool faces = false;
    for (const Element& element : elements_) {
      std::set<std::string> known;
      for (const Property& property : element.properties)
        if (!known.insert(property.name).second)
          lines_.fail("element " + element.name + " has property " + property.name + " twice");
      faces |= element.name == "face";
      if (element.name != "vertex") continue;
      vertices_ = element.count;
      for (const char* axis : {"x", "y", "z"})
        if (std::none_of(element.properties.begin(), element.properties.end(),
                         [&](const Property& p) { return p.name == axis && !p.length; }))
          lines_.fail(std::string("element vertex has no property ") + axis);
    }
    if (vertices_ == 0 || vertices_ > kMaxVertices)
      lines_.fail("must have 1 to 1500000 vertices, it has " + std::to_string(vertices_));
    if (!faces) lines_.fail("not a mesh that can be read: it has no element face");
  }

  Lines lines_;
  std::size_t size_;
  std::optional<Format> format_;
  std::vector<Element> elements_;
  std::size_t vertices_{0};
};

class Body {
 public:
  Body(const fs::path& file, Header& header)
      : file_(file), header_(header), lines_(header.body()), bytes_(header.body().rest()) {}

  void check() {
    for (const Element& element : header_.elements())
      for (entry_ = 0; entry_ < element.count; ++entry_) check_entry(element);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    if (header_.format() == Format::text) lines_.fail(what);
    throw ConfigError(file_.string() + ": " + what);
  }

  void check_entry(const Element& element) {
    if (header_.format() == Format::text && !lines_.next())
      fail("the file ends at entry " + std::to_string(entry_) + " of the " +
           std::to_string(element.count) + " of element " + element.name);
    std::size_t corners = 0;
    for (const Property& property : element.properties) {
      std::size_t values = 1;
      if (property.length) {
        const double length = number(*property.length, element);
        if (!(length >= 0) || length > kMaxVertices)
          fail("a list of " + element.name + " has a length that cannot be");
        values = static_cast<std::size_t>(length);
        check_length(element, property, values, corners);
      }
      for (std::size_t i = 0; i < values; ++i)
        check_value(element, property, number(property.type, element));
    }
  }

  void check_length(const Element& element, const Property& property, std::size_t values,
                    std::size_t& corners) {
    if (element.name != "face") return;
    if (is_index(property)) {
      corners = values;
      if (values > kMaxFaceVertices)
        fail("face " + std::to_string(entry_ + 1) + " has more than 1000 vertices");
      triangles_ += values > 2 ? values - 2 : 0;
      if (triangles_ > kMaxTriangles)
        throw ConfigError(file_.string() + ": more than 500000 triangles, the maximum of a mesh");
    } else if (values > 2 * corners) {
      fail("face " + std::to_string(entry_ + 1) + " has a list " + property.name +
           " longer than its vertices allow");
    }
  }

  static bool is_index(const Property& property) {
    return property.length &&
           (property.name == "vertex_indices" || property.name == "vertex_index");
  }

  void check_value(const Element& element, const Property& property, double value) const {
    const double count = static_cast<double>(header_.vertices());
    if (element.name == "face" && is_index(property) && !(value >= 0 && value < count))
      fail("face " + std::to_string(entry_ + 1) + " has vertex " +
           std::to_string(std::llround(value)) + ", out of range: the file has " +
           std::to_string(header_.vertices()) + ", counted from 0");
    if (element.name == "tristrips" && !(value >= -1 && value < count))
      fail("a triangle strip has a vertex out of range");
  }

  double number(Scalar type, const Element& element) {
    const double value =
        header_.format() == Format::text ? text_number(element) : binary_number(type, element);
    if (!std::isfinite(value) || std::abs(value) > 4.3e9)
      fail("entry " + std::to_string(entry_ + 1) + " of element " + element.name +
           " has a number that is not finite or too large");
    return value;
  }

  double text_number(const Element& element) const {
    return lines_.coordinate(("a value of element " + element.name).c_str());
  }

  template <class Value>
  double taken(const Element& element) {
    if (bytes_.size() < sizeof(Value))
      fail("the file ends at entry " + std::to_string(entry_) + " of the " +
           std::to_string(element.count) + " of element " + element.name);
    char raw[sizeof(Value)];
    std::memcpy(raw, bytes_.data(), sizeof raw);
    bytes_.remove_prefix(sizeof raw);
    if ((header_.format() == Format::big_endian) != (std::endian::native == std::endian::big))
      std::reverse(std::begin(raw), std::end(raw));
    Value value;
    std::memcpy(&value, raw, sizeof value);
    return static_cast<double>(value);
  }

  double binary_number(Scalar type, const Element& element) {
    switch (type) {
      case Scalar::int8:
        return taken<std::int8_t>(element);
      case Scalar::uint8:
        return taken<std::uint8_t>(element);
      case Scalar::int16:
        return taken<std::int16_t>(element);
      case Scalar::uint16:
        return taken<std::uint16_t>(element);
      case Scalar::int32:
        return taken<std::int32_t>(element);
      case Scalar::uint32:
        return taken<std::uint32_t>(element);
      case Scalar::float32:
        return taken<float>(element);
      case Scalar::float64:
        return taken<double>(element);
    }
    return 0;
  }

  const fs::path& file_;
  Header& header_;
  Lines& lines_;
  std::string_view bytes_;
  std::size_t entry_{0}, triangles_{0};
};

}  // namespace

void check_ply(const fs::path& file, const std::string& content) {
  Header header(file, content);
  Body(file, header).check();
}

}  // namespace handsel::mesh
