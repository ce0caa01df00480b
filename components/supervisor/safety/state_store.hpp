// Keeps the durable state in a file of its own folder. The only part of this component that touches
// the disk.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "components/supervisor/safety/state_file.hpp"

namespace handsel::supervisor {

/// The file safety_state. A write replaces it whole or not at all: temporary file in the same
/// folder, fsync, rename, fsync of the folder.
class StateStore {
 public:
  explicit StateStore(std::filesystem::path folder);

  /// Returns what is stored, or `fresh` when there is no file yet. A folder or file that cannot be
  /// read, is damaged or cannot be written gives unknown_state(`fresh`.revision), whose reason
  /// names the file: nothing may move until a person says so. What it returns is stored, except in
  /// that last case. Throws nothing.
  DurableState restore(const DurableState& fresh, Stamp now) const;
  /// Returns what is stored, unknown_state(`revision`) when it cannot be read or is damaged;
  /// nothing: there is no file. Writes nothing.
  std::optional<DurableState> read(std::uint64_t revision, Stamp now) const;
  /// Returns why the state could not be stored, one sentence that names the file; empty: done.
  /// Blocks until it is on the disk.
  std::string save(const DurableState& state, Stamp now) const;
  /// Removes the file: the system has ended in order. Returns why not, one sentence; empty: there
  /// is none any more.
  std::string forget() const;
  /// Path of the file, which need not exist.
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path folder_, file_;
};

}  // namespace handsel::supervisor
