// SPDX-License-Identifier: Apache-2.0
// Stores the durable state in a file in a separate folder. The only part of this component with
// disk access.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "components/supervisor/safety/state_file.hpp"

namespace handsel::supervisor {

/// The file safety_state. A write is atomic: temporary file in the same folder, fsync, rename,
/// fsync of the folder.
class StateStore {
 public:
  explicit StateStore(std::filesystem::path folder);

  /// Returns the stored state, or `fresh` without a file. A folder or file that is unreadable,
  /// damaged or unwritable gives unknown_state(`fresh`.revision), whose reason names the file and
  /// which prevents motion until a person permits it. Stores the result unless unwritable. Does not
  /// throw.
  DurableState restore(const DurableState& fresh, Stamp now) const;
  /// Returns the stored state; unknown_state(`revision`) if unreadable or damaged; nullopt: no
  /// file. Does not write.
  std::optional<DurableState> read(std::uint64_t revision, Stamp now) const;
  /// Returns why the state could not be stored, one sentence that names the file; empty: done.
  /// Blocks until the state is on disk.
  std::string save(const DurableState& state, Stamp now) const;
  /// Removes the file at the regular end of the system. Returns why not, one sentence; empty:
  /// removed.
  std::string forget() const;
  /// Returns the path of the file, which need not exist.
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path folder_, file_;
};

}  // namespace handsel::supervisor
