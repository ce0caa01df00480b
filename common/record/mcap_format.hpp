// SPDX-License-Identifier: Apache-2.0
// Numbers and layout of MCAP that writer and reader share.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace handsel::mcap {

static_assert(std::endian::native == std::endian::little,
              "the file is little-endian, and so must be the machine");

inline constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

enum class Op : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0b,
  metadata = 0x0c,
  metadata_index = 0x0d,
  summary_offset = 0x0e,
  data_end = 0x0f,
};

/// Appends the bytes of a number, little-endian.
template <class Number>
void append(std::string& out, Number value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

/// With its length in front.
inline void append_text(std::string& out, std::string_view text) {
  append(out, static_cast<std::uint32_t>(text.size()));
  out.append(text);
}

/// Appends a record: opcode, length of the content as 64-bit number, content.
inline void append_record(std::string& out, Op op, std::string_view content) {
  append(out, op);
  append(out, static_cast<std::uint64_t>(content.size()));
  out.append(content);
}

/// CRC-32 of zlib and Ethernet.
std::uint32_t crc32(std::string_view bytes);

}  // namespace handsel::mcap
