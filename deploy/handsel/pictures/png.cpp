// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/pictures/png.hpp"

#include <algorithm>
#include <cmath>

namespace handsel {
namespace {

void put32(std::string& out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift & 0xff);
}

std::uint32_t crc(const std::string& bytes) {
  std::uint32_t sum = 0xffffffff;
  for (const char byte : bytes) {
    sum ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) sum = sum & 1 ? 0xedb88320 ^ sum >> 1 : sum >> 1;
  }
  return ~sum;
}

void chunk(std::string& out, const std::string& kind, const std::string& data) {
  put32(out, static_cast<std::uint32_t>(data.size()));
  out += kind + data;
  put32(out, crc(kind + data));
}

/// Returns a zlib stream of stored blocks.
std::string stored(const std::string& data) {
  constexpr std::size_t kMaxBlock = 65535;
  std::string out = "\x78\x01";
  for (std::size_t from = 0; from < data.size(); from += kMaxBlock) {
    const std::size_t size = std::min(kMaxBlock, data.size() - from);
    out += static_cast<char>(from + size == data.size());
    for (const std::size_t word : {size, ~size}) {
      out += static_cast<char>(word & 0xff);
      out += static_cast<char>(word >> 8 & 0xff);
    }
    out += data.substr(from, size);
  }
  std::uint32_t a = 1, b = 0;
  for (const char byte : data) {
    a = (a + static_cast<std::uint8_t>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  put32(out, b << 16 | a);
  return out;
}

}  // namespace

void Picture::line(double x0, double y0, double x1, double y1, int thickness, Colour colour) {
  const int steps = std::max(1, static_cast<int>(std::ceil(2 * std::hypot(x1 - x0, y1 - y0))));
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const int x = static_cast<int>(std::lround(x0 + t * (x1 - x0))),
              y = static_cast<int>(std::lround(y0 + t * (y1 - y0)));
    for (int dx = -(thickness / 2); dx < (thickness + 1) / 2; ++dx)
      for (int dy = -(thickness / 2); dy < (thickness + 1) / 2; ++dy) dot(x + dx, y + dy, colour);
  }
}

std::string Picture::png() const {
  std::string header, rows;
  put32(header, static_cast<std::uint32_t>(width_));
  put32(header, static_cast<std::uint32_t>(height_));
  header += {8, 2, 0, 0, 0};  // eight bits, RGB
  for (int y = 0; y < height_; ++y) {
    rows += '\0';
    for (int x = 0; x < width_; ++x)
      for (const std::uint8_t part : at(x, y)) rows += static_cast<char>(part);
  }
  std::string out = "\x89PNG\r\n\x1a\n";
  chunk(out, "IHDR", header);
  chunk(out, "IDAT", stored(rows));
  chunk(out, "IEND", "");
  return out;
}

}  // namespace handsel
