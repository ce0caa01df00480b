// SPDX-License-Identifier: Apache-2.0
#include "common/model/description/robot_text.hpp"

#include "common/config/described.hpp"
#include "common/config/resources.hpp"

namespace handsel {
namespace fs = std::filesystem;
namespace {

constexpr int kMaxExtensions = 8;  // max depth of descriptions that extend one another

/// Makes the paths of a description absolute, so that they stay valid from another folder.
void make_absolute(config::RobotDescription& text, const fs::path& file) {
  const auto absolute = [&](const std::string& path) {
    return path.empty() ? path : fs::absolute(described_path(file, path)).string();
  };
  text.set_urdf(absolute(text.urdf()));
  text.set_srdf(absolute(text.srdf()));
  text.set_hand(described_name(file, text.hand()));
  for (std::string& folder : *text.mutable_packages()) folder = absolute(folder);
  for (config::OtherArm& other : *text.mutable_other_arms())
    other.set_hand(described_name(file, other.hand()));
}

config::RobotDescription read(const fs::path& file, int extended) {
  config::RobotDescription text;
  load_text_proto(file, text);
  if (text.extends().empty()) return text;
  if (extended == kMaxExtensions)
    throw ConfigError(locate(file, "extends") + ": extends: more than " +
                      std::to_string(kMaxExtensions) +
                      " descriptions extend one another; they must not form a circle");
  const fs::path base = described_path(file, text.extends());
  if (!fs::exists(base))
    throw MissingError(locate(file, "extends") + ": extends: no file " + base.string());
  config::RobotDescription joined = read(base, extended + 1);
  make_absolute(joined, base);
  joined.MergeFrom(text);
  return joined;
}

}  // namespace

config::RobotDescription read_robot_text(const fs::path& description) {
  return read(description, 0);
}

}  // namespace handsel
