// SPDX-License-Identifier: Apache-2.0
// What may be had over HTTP and as an asset: files of the page, of robots, hands and objects, and
// nothing else.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "components/bridge/foxglove.hpp"

namespace handsel::bridge {

class Site {
 public:
  /// [bytes] of an asset sent over WebSocket.
  static constexpr std::uintmax_t kLargestAsset = 32u << 20;

  /// `page`: folder of the built page, empty when there is none; `resources`: the folder that holds
  /// robots/, hands/ and objects/.
  Site(const std::filesystem::path& page, const std::filesystem::path& resources);

  /// Serves a mesh that lies outside the folders under an address of its own; none when the
  /// address is empty.
  void serve(const std::string& address, const std::filesystem::path& file);

  /// The file a path of HTTP names ("/", "/page.js", "/assets/robots/jido/jido.urdf"); nothing when
  /// there is no such file, the path is not canonical, the kind of file is not served or it lies
  /// (through a link) outside its folder.
  std::optional<std::filesystem::path> find(std::string_view target) const;
  /// "package://handsel/robots/jido/jido.urdf", robots and hands only.
  Asset fetch(const std::string& uri) const;
  /// Returns whether the folder of the built page was there at construction.
  bool is_built() const { return !page_.empty(); }

 private:
  std::filesystem::path page_, resources_;
  std::map<std::string, std::filesystem::path, std::less<>> own_;  ///< by their address
};

/// By the file's extension; application/octet-stream when unknown.
const char* content_type(const std::filesystem::path& file);

/// The built page: $HANDSEL_WEB, else `web` beside the executable's folder, else share/handsel/web
/// beside it; empty when none has an index.html.
std::filesystem::path find_web_folder();

}  // namespace handsel::bridge
