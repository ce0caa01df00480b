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
  Picture(int width, int height, Colour fill) : width_(width), height_(height), points_(static_cast<std::size_t>(width * height), fill) {}
  int width() const { return width_; }
  int height() const { return height_; }
  /// Outside the picture nothing happens. x to the right, y down.
  void dot(int x, int y, Colour colour) {
    if (x >= 0 && y >= 0 && x < width_ && y < height_) points_[static_cast<std::size_t>(y * width_ + x)] = colour;
  }
  void line(double x0, double y0, double x1, double y1, int thickness, Colour colour);
  std::string png() const;

 private:
  int width_, height_;
  std::vector<Colour> points_;
};

}  // namespace handsel
