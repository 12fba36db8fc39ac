#include "hdf5/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "base/error.h"
#include "hdf5/internal.h"

namespace argil::hdf5::internal {
namespace {

constexpr std::uint64_t kMagic = 0x316c6e726a677261;  // "argjrnl1"

/// FNV-1a over 64-bit words.
std::uint64_t compute_checksum(const std::string& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (std::size_t i = 0; i + 8 <= bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, 8);
    hash = (hash ^ word) * 0x100000001b3;
  }
  return hash;
}

void put(std::string& bytes, std::uint64_t number) {
  char word[8];
  std::memcpy(word, &number, 8);
  bytes.append(word, 8);
}

std::uint64_t take(const std::string& bytes, std::size_t place) {
  std::uint64_t number = 0;
  std::memcpy(&number, bytes.data() + place, 8);
  return number;
}

struct Journal {
  Pages pages;
  std::uint64_t size = 0;  // of the file with them
};

/// Nothing when the journal is torn: then its flush has not touched the file yet.
std::optional<Journal> read_journal(const std::string& journal) {
  std::ifstream stream(journal, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  const std::string bytes = text.str();
  constexpr std::size_t kHead = 24;
  constexpr std::size_t kRecord = 8 + kPageBytes;
  if (bytes.size() < kHead + 8 || take(bytes, 0) != kMagic) return std::nullopt;
  const std::uint64_t count = take(bytes, 8);
  const std::size_t end = bytes.size() - 8;
  if (count > bytes.size() / kRecord || kHead + count * kRecord != end) return std::nullopt;
  if (compute_checksum(bytes.substr(0, end)) != take(bytes, end)) return std::nullopt;
  Journal read;
  read.size = take(bytes, 16);
  for (std::size_t at = kHead; at < end; at += kRecord)
    read.pages[take(bytes, at)].assign(bytes.data() + at + 8, bytes.data() + at + kRecord);
  return read;
}

}  // namespace

std::string name_journal(const std::string& file) {
  return file + ".journal";
}

bool write_all(int descriptor, const char* data, std::size_t size, std::uint64_t offset) {
  while (size > 0) {
    const ssize_t written = pwrite(descriptor, data, size, static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = ENOSPC;
    if (written <= 0) return false;
    data += written;
    size -= static_cast<std::size_t>(written);
    offset += static_cast<std::uint64_t>(written);
  }
  return true;
}

bool write_journal(int descriptor, const Pages& pages, std::uint64_t size) {
  std::string bytes;
  bytes.reserve(32 + pages.size() * (8 + kPageBytes));
  put(bytes, kMagic);
  put(bytes, pages.size());
  put(bytes, size);
  for (const auto& [number, page] : pages) {
    put(bytes, number);
    bytes.append(page.data(), kPageBytes);
  }
  put(bytes, compute_checksum(bytes));
  return write_all(descriptor, bytes.data(), bytes.size(), 0);
}

bool apply_pages(int descriptor, const Pages& pages, std::uint64_t size) {
  for (const auto& [number, page] : pages) {
    const std::uint64_t begin = number * kPageBytes;
    if (begin >= size) continue;
    if (!write_all(descriptor, page.data(), std::min<std::uint64_t>(kPageBytes, size - begin), begin))
      return false;
  }
  return ftruncate(descriptor, static_cast<off_t>(size)) == 0;
}

void recover(const std::string& file) {
  std::error_code ignored;
  const std::filesystem::path real = std::filesystem::weakly_canonical(file, ignored);
  const std::string journal = name_journal(ignored ? file : real.string());
  if (!std::filesystem::exists(journal, ignored)) return;
  const std::optional<Journal> left = read_journal(journal);
  const int descriptor = open(file.c_str(), (left ? O_RDWR : O_RDONLY) | O_CLOEXEC);
  if (descriptor < 0) {
    if (!left || errno == ENOENT) return;
    throw IoError(file, "was killed in the middle of a write, which must be finished first: " +
                            std::string(std::strerror(errno)));
  }
  bool is_busy = false;
  std::string problem;
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    is_busy = true;
  else if (left && !apply_pages(descriptor, left->pages, left->size))
    problem = std::string("cannot finish a write in which it was killed: ") + std::strerror(errno);
  else
    unlink(journal.c_str());  // may fail in a read-only folder: the next reader comes to the same
  ::close(descriptor);
  if (is_busy) throw BusyError(file);
  if (!problem.empty()) throw IoError(file, problem);
}

}  // namespace argil::hdf5::internal
