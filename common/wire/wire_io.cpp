// SPDX-License-Identifier: Apache-2.0
#include "common/wire/wire_io.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/wire/wire_text.hpp"

namespace handsel {

using detail::append_json_text;
using detail::number_text;
using detail::valid_prefix;

WireIo WireIo::to_wire(const char* message, Stamp now, std::string& why) {
  WireIo io(Mode::to_wire);
  io.message_ = message;
  io.now_ = now;
  io.text_ = &why;
  return io;
}

WireIo WireIo::from_wire(const char* message, std::string& why, LeftOutElements* left_out) {
  WireIo io(Mode::from_wire);
  io.left_out_ = left_out;
  io.message_ = message;
  io.text_ = &why;
  return io;
}

WireIo WireIo::json(std::string& out) {
  WireIo io(Mode::json);
  io.text_ = &out;
  return io;
}

WireIo WireIo::leaves(const std::function<void(const WireLeaf&)>& visit) {
  WireIo io(Mode::leaves);
  io.visit_ = &visit;
  return io;
}

WireIo WireIo::fill(bool full) {
  WireIo io(Mode::fill);
  io.full_ = full;
  return io;
}

void WireIo::begin() {
  if (mode_ == Mode::json) *text_ += '{';
}
void WireIo::end() {
  if (mode_ == Mode::json) *text_ += '}';
}

std::string WireIo::path(const char* field) const {
  std::string out = message_;
  const auto add = [&out](const char* name, int index) {
    if (name) {
      if (!out.empty()) out += '.';
      out += name;
    }
    if (index >= 0) out += '[' + std::to_string(index) + ']';
  };
  for (int i = 0; i < depth_; ++i) {
    const bool leaf_of_list =
        i + 1 == depth_ && stack_[i].index >= 0 && field && stack_[i].field == field;
    add(stack_[i].field, stack_[i].index);
    if (leaf_of_list) return out;
  }
  add(field, -1);
  return out;
}

void WireIo::fail(const char* field, const std::string& sentence) {
  if (failed_) return;
  failed_ = true;
  *text_ = path(field) + ' ' + sentence;
}

void WireIo::leave_out(int depth) {
  failed_ = false;
  depth_ = depth;
  if (left_out_ != nullptr && left_out_->count++ == 0) left_out_->why = *text_;
  text_->clear();
}

void WireIo::check(bool holds, const char* field, const char* sentence) {
  if (converting() && !holds) fail(field, sentence);
}

bool WireIo::fits(const char* field, std::size_t size, std::size_t bound) {
  if (size <= bound) return true;
  fail(field, "has " + std::to_string(size) + " elements, at most " + std::to_string(bound) +
                  " are allowed");
  return false;
}

bool WireIo::in_range(const char* field, double value, Range range) {
  if (value >= range.low && value <= range.high && !(range.open_low && value == range.low))
    return true;
  fail(field, "is " + number_text(value) + ", must be a number from " + number_text(range.low) +
                  (range.open_low ? " (excluded)" : "") + " to " + number_text(range.high));
  return false;
}

void WireIo::leaf(const char* field, WireLeaf::Kind kind, void* value, std::size_t size) {
  (*visit_)(WireLeaf{kind, value, size, this, field});
}

std::string WireLeaf::path() const { return visitor->path(field); }

void WireIo::at(int index) { stack_[depth_ - 1].index = index; }

void WireIo::open(const char* field) {
  if (mode_ == Mode::json) {
    json_key(field);
    *text_ += '{';
    first_ = true;
  }
  stack_[depth_++] = {field, -1};
}

void WireIo::close() {
  --depth_;
  if (mode_ == Mode::json) {
    *text_ += '}';
    first_ = false;
  }
}

void WireIo::begin_json_list(const char* field) {
  if (mode_ != Mode::json) return;
  json_key(field);
  *text_ += '[';
  first_ = true;
}

void WireIo::close_list() {
  --depth_;
  if (mode_ == Mode::json) {
    *text_ += ']';
    first_ = false;
  }
}

void WireIo::separator() {
  if (!first_) *text_ += ',';
  first_ = false;
}

void WireIo::json_key(const char* field) {
  separator();
  const bool element = depth_ > 0 && stack_[depth_ - 1].index >= 0;
  if (!element && field) {
    append_json_text(*text_, field);
    *text_ += ':';
  }
}

void WireIo::json_number(double value) {
  if (std::isfinite(value))
    *text_ += number_text(value);
  else
    *text_ += "null";
}

void WireIo::stamp(Stamp& m, std::int64_t& w) {
  if (failed_) return;
  switch (mode_) {
    case Mode::to_wire:
      w = m == 0 ? now_ : m;
      if (w < 0) fail("stamp", "is " + std::to_string(w) + ", must not be negative");
      break;
    case Mode::from_wire:
      m = w;
      if (w < 0) fail("stamp", "is " + std::to_string(w) + ", must not be negative");
      break;
    case Mode::json:
      json_key("stamp");
      *text_ += std::to_string(m);
      break;
    case Mode::leaves:
      leaf("stamp", WireLeaf::Kind::integer, &w, sizeof w);
      break;
    case Mode::fill:
      w = 1;
  }
}

void WireIo::number(const char* field, double& m, double& w, Range range) {
  if (failed_) return;
  switch (mode_) {
    case Mode::to_wire:
      if (in_range(field, m, range)) w = m;
      break;
    case Mode::from_wire:
      if (in_range(field, w, range)) m = w;
      break;
    case Mode::json:
      json_key(field);
      json_number(m);
      break;
    case Mode::leaves:
      leaf(field, WireLeaf::Kind::number, &w, sizeof w);
      break;
    case Mode::fill:
      w = range.low <= 0.25 && 0.25 <= range.high ? 0.25 : (range.low + range.high) / 2;
  }
}

void WireIo::horizon(const char* field, double& m, double& w, double low) {
  const Range range{low, kHorizon};
  if (mode_ == Mode::to_wire) {
    double bounded = m > kHorizon ? kHorizon : m;
    number(field, bounded, w, range);
  } else {
    number(field, m, w, range);
    if (mode_ == Mode::from_wire && m == kHorizon) m = std::numeric_limits<double>::infinity();
  }
}

void WireIo::integer(const char* field, std::uint64_t& m, std::uint64_t& w) {
  if (failed_) return;
  switch (mode_) {
    case Mode::to_wire:
      w = m;
      break;
    case Mode::from_wire:
      m = w;
      break;
    case Mode::json:
      json_key(field);
      *text_ += std::to_string(m);
      break;
    case Mode::leaves:
      leaf(field, WireLeaf::Kind::integer, &w, sizeof w);
      break;
    case Mode::fill:
      w = 1;
  }
}

void WireIo::integer(const char* field, std::uint32_t& m, std::uint32_t& w, std::uint32_t low,
                     std::uint32_t high) {
  if (failed_) return;
  if (mode_ == Mode::json) {
    json_key(field);
    *text_ += std::to_string(m);
    return;
  }
  if (mode_ == Mode::leaves) return leaf(field, WireLeaf::Kind::integer, &w, sizeof w);
  if (mode_ == Mode::fill) {
    w = 1;
    return;
  }
  const std::uint32_t value = mode_ == Mode::to_wire ? m : w;
  if (value < low || value > high)
    return fail(field, "is " + std::to_string(value) + ", must be from " + std::to_string(low) +
                           " to " + std::to_string(high));
  (mode_ == Mode::to_wire ? w : m) = value;
}

void WireIo::flag(const char* field, bool& m, bool& w) {
  if (failed_) return;
  switch (mode_) {
    case Mode::to_wire:
      w = m;
      break;
    case Mode::from_wire: {
      std::uint8_t raw;
      std::memcpy(&raw, &w, 1);
      if (raw > 1) return fail(field, "is neither true nor false");
      m = raw == 1;
      break;
    }
    case Mode::json:
      json_key(field);
      *text_ += m ? "true" : "false";
      break;
    case Mode::leaves:
      leaf(field, WireLeaf::Kind::flag, &w, sizeof w);
      break;
    case Mode::fill:
      w = true;
  }
}

void WireIo::choice_field(const char* field, std::uint32_t& m, std::uint32_t& w, void* at,
                          std::span<const char* const> names) {
  if (failed_) return;
  if (mode_ == Mode::leaves) return leaf(field, WireLeaf::Kind::choice, at, sizeof w);
  if (mode_ == Mode::fill) {
    w = 0;
    return;
  }
  if (mode_ == Mode::json) {
    json_key(field);
    if (m < names.size())
      append_json_text(*text_, names[m]);
    else
      *text_ += "null";
    return;
  }
  const std::uint32_t value = mode_ == Mode::to_wire ? m : w;
  if (value >= names.size())
    return fail(field, "is the unknown choice " + std::to_string(value) +
                           ", the last known one is " + std::to_string(names.size() - 1) + " (" +
                           names.back() + ')');
  (mode_ == Mode::to_wire ? w : m) = value;
}

void WireIo::text_field(const char* field, std::string& m, char* w, std::size_t bound, Text kind) {
  if (failed_) return;
  if (mode_ == Mode::json) {
    json_key(field);
    append_json_text(*text_, std::string_view(m).substr(0, valid_prefix(m)));
    return;
  }
  if (mode_ == Mode::leaves) return leaf(field, WireLeaf::Kind::text, w, bound + 1);
  if (mode_ == Mode::fill) {
    const std::size_t n = full_ ? bound : 1;
    std::memset(w, 'x', n);
    w[n] = '\0';
    return;
  }
  std::string_view value;
  if (mode_ == Mode::to_wire) {
    value = m;
    if (kind == Text::sentence) {
      if (value.size() > bound) value = value.substr(0, bound);
      value = value.substr(0, valid_prefix(value));
    }
  } else {
    value = std::string_view(w, strnlen(w, bound + 1));
  }
  if (value.size() > bound)
    return fail(field, "is longer than " + std::to_string(bound) + " bytes");
  if (kind == Text::name && value.empty()) return fail(field, "is empty, a name is needed");
  if (valid_prefix(value) != value.size())
    return fail(field, "holds bytes that are not text (UTF-8 without control characters)");
  if (mode_ == Mode::to_wire) {
    std::memcpy(w, value.data(), value.size());
    w[value.size()] = '\0';
  } else {
    m.assign(value);
  }
}

void WireIo::numbers(const char* field, Vector& m, double* w, std::size_t length, std::size_t bound,
                     Range range) {
  if (failed_) return;
  if (mode_ == Mode::json) {
    begin_json_list(field);
    for (Eigen::Index i = 0; i < m.size(); ++i) {
      separator();
      json_number(m[i]);
    }
    *text_ += ']';
    first_ = false;
    return;
  }
  if (!fits(field, length, bound)) return;
  stack_[depth_++] = {field, -1};
  if (mode_ == Mode::from_wire) m.resize(static_cast<Eigen::Index>(length));
  for (std::size_t i = 0; i < length && !failed_; ++i) {
    at(static_cast<int>(i));
    double& value = wire_only() ? w[i] : m[static_cast<Eigen::Index>(i)];
    number(field, value, w[i], range);
  }
  --depth_;
}

void WireIo::octets(const char* field, std::vector<std::uint8_t>& m, std::uint8_t* w,
                    std::size_t length, std::size_t bound, std::uint8_t high) {
  if (failed_) return;
  if (mode_ == Mode::json) {
    begin_json_list(field);
    for (const std::uint8_t value : m) {
      separator();
      *text_ += std::to_string(value);
    }
    *text_ += ']';
    first_ = false;
    return;
  }
  if (mode_ == Mode::leaves) {
    stack_[depth_++] = {field, -1};
    for (std::size_t i = 0; i < length; ++i) {
      at(static_cast<int>(i));
      leaf(nullptr, WireLeaf::Kind::integer, w + i, 1);
    }
    --depth_;
    return;
  }
  if (mode_ == Mode::fill) {
    std::memset(w, 1, length);
    return;
  }
  if (!fits(field, length, bound)) return;
  if (mode_ == Mode::from_wire)
    m.assign(w, w + length);
  else
    std::copy(m.begin(), m.end(), w);
  if (high < 255 && std::any_of(m.begin(), m.end(), [high](std::uint8_t v) { return v > high; }))
    fail(field, "holds a value above " + std::to_string(high));
}

}  // namespace handsel
