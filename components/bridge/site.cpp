// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/site.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <map>
#include <vector>

namespace handsel::bridge {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kAssets = "/assets/";
constexpr std::string_view kPackage = "package://handsel/";
constexpr std::size_t kMaxPath = 512;

const std::map<std::string, const char*> kTypes{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".mjs", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".json", "application/json"},
    {".map", "application/json"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".jpg", "image/jpeg"},
    {".ico", "image/x-icon"},
    {".woff2", "font/woff2"},
    {".wasm", "application/wasm"},
    {".txt", "text/plain; charset=utf-8"},
    {".urdf", "application/xml"},
    {".srdf", "application/xml"},
    {".dae", "model/vnd.collada+xml"},
    {".stl", "model/stl"},
    {".obj", "model/obj"},
    {".mtl", "model/mtl"},
    {".glb", "model/gltf-binary"},
};
constexpr std::array<std::string_view, 9> kAssetKinds{".urdf", ".srdf", ".stl", ".obj", ".mtl",
                                                      ".dae",  ".glb",  ".png", ".jpg"};

std::string extension_of(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// Returns whether a path is relative and of plain names only, so that it stays inside its folder.
bool canonical(std::string_view path) {
  if (path.empty() || path.size() > kMaxPath) return false;
  bool begins = true;
  for (const char c : path) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '_' || c == '-';
    if (!plain && (begins || (c != '.' && c != '/'))) return false;
    begins = c == '/';
  }
  return !begins;
}

std::optional<fs::path> file_in(const fs::path& folder, std::string_view path) {
  if (folder.empty() || !canonical(path)) return std::nullopt;
  std::error_code error;
  const fs::path file = fs::canonical(folder / path, error);
  if (error || !fs::is_regular_file(file, error)) return std::nullopt;
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return end == folder.end() ? std::optional(file) : std::nullopt;
}

std::optional<fs::path> asset(const fs::path& resources, std::string_view path, bool with_objects) {
  const std::string_view kind = path.substr(0, path.find('/'));
  if (kind != "robots" && kind != "hands" && !(with_objects && kind == "objects"))
    return std::nullopt;
  if (path.size() == kind.size() || resources.empty()) return std::nullopt;
  auto file = file_in(resources / kind, path.substr(kind.size() + 1));
  if (!file ||
      std::find(kAssetKinds.begin(), kAssetKinds.end(), extension_of(*file)) == kAssetKinds.end())
    return std::nullopt;
  return file;
}

fs::path canonical_or_empty(const fs::path& folder) {
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);
  return error ? fs::path() : real;
}

}  // namespace

Site::Site(const fs::path& page, const fs::path& resources)
    : page_(page.empty() ? fs::path() : canonical_or_empty(page)),
      resources_(canonical_or_empty(resources)) {}

void Site::serve(const std::string& address, const fs::path& file) {
  const std::string kind = extension_of(file);
  if (address.empty()) return;
  if (std::find(kAssetKinds.begin(), kAssetKinds.end(), kind) != kAssetKinds.end())
    own_.emplace(address, file);
}

std::optional<fs::path> Site::find(std::string_view target) const {
  if (const auto own = own_.find(target); own != own_.end()) return own->second;
  if (target.starts_with(kAssets)) return asset(resources_, target.substr(kAssets.size()), true);
  if (target == "/") target = "/index.html";
  return target.starts_with('/') ? file_in(page_, target.substr(1)) : std::nullopt;
}

Asset Site::fetch(const std::string& uri) const {
  const std::string_view text = uri;
  if (!text.starts_with(kPackage))
    return {nullptr,
            "an asset's address begins with " + std::string(kPackage) + "robots/ or hands/"};
  const auto file = asset(resources_, text.substr(kPackage.size()), false);
  if (!file) return {nullptr, "there is no such asset"};
  std::error_code error;
  const std::uintmax_t size = fs::file_size(*file, error);
  if (error || size > kLargestAsset)
    return {nullptr, "the asset is larger than " + std::to_string(kLargestAsset >> 20) + " MiB"};
  auto bytes = std::make_shared<std::vector<std::uint8_t>>(size);
  std::ifstream in(*file, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes->data()), static_cast<std::streamsize>(size));
  if (!in) return {nullptr, "the asset cannot be read"};
  return {std::move(bytes), {}};
}

const char* content_type(const fs::path& file) {
  const auto known = kTypes.find(extension_of(file));
  return known == kTypes.end() ? "application/octet-stream" : known->second;
}

fs::path find_web_folder() {
  std::vector<fs::path> folders;
  if (const char* named = std::getenv("HANDSEL_WEB"); named && *named) {
    folders.emplace_back(named);
  } else {
    std::error_code error;
    const fs::path root = fs::read_symlink("/proc/self/exe", error).parent_path().parent_path();
    folders = {root / "web", root / "share/handsel/web"};
  }
  for (const fs::path& folder : folders) {
    std::error_code error;
    if (fs::is_regular_file(folder / "index.html", error)) return folder;
  }
  return {};
}

}  // namespace handsel::bridge
