// SPDX-License-Identifier: Apache-2.0
// The disabled pairs of a user's SRDF, by name: names unknown to the URDF are no error here.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace handsel {

/// A pair of links that an SRDF disables.
struct SrdfPair {
  std::string a, b;    ///< links
  std::string reason;  ///< as written
};

/// Returns the pairs of an SRDF in the order of the file. Throws ConfigError when the file is no
/// SRDF, MissingError when it is not there.
std::vector<SrdfPair> read_srdf_pairs(const std::filesystem::path& srdf);

/// Returns the names of links in the pairs.
std::set<std::string> links_of(const std::vector<SrdfPair>& pairs);

/// Writes an SRDF of a robot with these pairs. Throws ConfigError when the file cannot be written.
void write_srdf(const std::filesystem::path& file, const std::string& robot,
                const std::string& comment, const std::vector<SrdfPair>& pairs);

}  // namespace handsel
