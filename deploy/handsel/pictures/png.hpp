// SPDX-License-Identifier: Apache-2.0
// Pictures of coloured points as PNG, uncompressed.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace handsel {

using Colour = std::array<std::uint8_t, 3>;  ///< red, green, blue

class Picture {
 public:
  Picture(int width, int height, Colour fill)
      : width_(width),
        height_(height),
        points_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}
  int width() const { return width_; }    ///< [px]
  int height() const { return height_; }  ///< [px]
  /// Outside the picture nothing happens. x to the right, y down.
  void dot(int x, int y, Colour colour) {
    if (x >= 0 && y >= 0 && x < width_ && y < height_) points_[index(x, y)] = colour;
  }
  /// Returns the colour of a point; x and y must be inside the picture.
  Colour at(int x, int y) const { return points_[index(x, y)]; }
  /// Draws a line of `thickness` [px]; what lies outside the picture is left out.
  void line(double x0, double y0, double x1, double y1, int thickness, Colour colour);
  /// Returns the bytes of a PNG file: 8 bits a colour, stored without compression.
  std::string png() const;

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  int width_, height_;
  std::vector<Colour> points_;
};

}  // namespace handsel
