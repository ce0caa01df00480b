// SPDX-License-Identifier: Apache-2.0
#include "common/model/description/mesh_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"

namespace handsel {
namespace fs = std::filesystem;
namespace {

/// Returns package folders: those of the description, of ROS_PACKAGE_PATH, and the share folders of
/// AMENT_PREFIX_PATH.
std::vector<fs::path> package_folders(const std::vector<fs::path>& described) {
  std::vector<fs::path> folders = described;
  for (const auto& [variable, below] :
       {std::pair("ROS_PACKAGE_PATH", ""), std::pair("AMENT_PREFIX_PATH", "share")}) {
    const char* value = std::getenv(variable);
    std::istringstream entries(value != nullptr ? value : "");
    for (std::string entry; std::getline(entries, entry, ':');)
      if (!entry.empty()) folders.push_back(fs::path(entry) / below);
  }
  return folders;
}

}  // namespace

fs::path find_mesh(const fs::path& urdf, const std::string& uri,
                   const std::vector<fs::path>& packages) {
  constexpr std::size_t kMaxUri = 1024;  // [bytes]
  if (uri.size() > kMaxUri)
    throw ConfigError(urdf.string() + ": the name of a mesh has " + std::to_string(uri.size()) +
                      " bytes, must have at most 1024");
  std::vector<fs::path> tails;
  std::error_code error;
  const auto scheme = uri.find("://");
  if (scheme == std::string::npos) {
    tails = {uri};
  } else if (uri.starts_with("file://")) {
    tails = {uri.substr(7)};
  } else {
    const std::string rest = uri.substr(scheme + 3);
    tails = {rest, rest.substr(std::min(rest.find('/') + 1, rest.size()))};
  }
  for (fs::path folder = fs::absolute(urdf).parent_path();; folder = folder.parent_path()) {
    for (const auto& tail : tails)
      if (fs::is_regular_file(folder / tail, error)) return fs::weakly_canonical(folder / tail);
    if (folder == folder.parent_path()) break;
  }
  for (const auto& folder : package_folders(packages))
    for (const auto& tail : tails)
      if (fs::is_regular_file(folder / tail, error)) return fs::weakly_canonical(folder / tail);
  throw MissingError(locate(urdf, uri) + ": mesh " + uri +
                     " is neither in the folder of the URDF, nor above it, nor in a package");
}

}  // namespace handsel
