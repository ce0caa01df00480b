// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/safety/state_store.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace handsel::supervisor {
namespace {

constexpr std::size_t kMaxBytes = 1 << 20;  // max size of a file; a full state has 40 kB

/// A file descriptor that closes itself.
class File {
 public:
  File(const std::filesystem::path& path, int flags)
      : fd_(open(path.c_str(), flags | O_CLOEXEC, 0600)) {}
  ~File() {
    if (fd_ >= 0) close(fd_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int fd() const { return fd_; }
  bool good() const { return fd_ >= 0; }

 private:
  int fd_;
};

std::string failure(const std::filesystem::path& file, const char* what) {
  return file.string() + " cannot be " + what + ": " + std::strerror(errno);
}

bool write_all(int fd, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = write(fd, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

bool read_all(int fd, std::string& text) {
  char part[4096];
  while (text.size() <= kMaxBytes) {
    const ssize_t n = read(fd, part, sizeof part);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    if (n == 0) return true;
    text.append(part, static_cast<std::size_t>(n));
  }
  errno = EFBIG;
  return false;
}

}  // namespace

StateStore::StateStore(std::filesystem::path folder)
    : folder_(std::move(folder)), file_(folder_ / "safety_state") {}

std::string StateStore::save(const DurableState& state, Stamp now) const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) return folder_.string() + " cannot be made: " + error.message();
  const std::filesystem::path temporary = folder_ / "safety_state.new";
  {
    const File out(temporary, O_WRONLY | O_CREAT | O_TRUNC);
    if (!out.good() || !write_all(out.fd(), write_state(state, now)) || fsync(out.fd()) != 0)
      return failure(temporary, "written");
  }
  if (std::rename(temporary.c_str(), file_.c_str()) != 0) return failure(file_, "replaced");
  const File folder(folder_, O_RDONLY | O_DIRECTORY);
  if (!folder.good() || fsync(folder.fd()) != 0) return failure(folder_, "written");
  return {};
}

std::optional<DurableState> StateStore::read(std::uint64_t revision, Stamp now) const {
  std::string text;
  {
    const File in(file_, O_RDONLY);
    if (!in.good() && errno == ENOENT) return std::nullopt;
    if (!in.good() || !read_all(in.fd(), text))
      return unknown_state(revision, failure(file_, "read"));
  }
  auto state = read_state(text, now);
  if (const auto* damage = std::get_if<StateDamage>(&state))
    return unknown_state(revision, file_.string() + " is damaged: " + damage->reason);
  return std::get<DurableState>(std::move(state));
}

DurableState StateStore::restore(const DurableState& fresh, Stamp now) const {
  DurableState state = read(fresh.safety.revision, now).value_or(fresh);
  // Checks at start that the state can be written.
  if (const std::string why = save(state, now); !why.empty()) {
    std::vector<Person> lost = std::move(state.safety.lost);
    state = unknown_state(std::max(fresh.safety.revision, state.safety.revision + 1), why);
    state.safety.lost = std::move(lost);
  }
  return state;
}

std::string StateStore::forget() const {
  if (unlink(file_.c_str()) != 0 && errno != ENOENT) return failure(file_, "removed");
  return {};
}

}  // namespace handsel::supervisor
