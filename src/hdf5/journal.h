#pragma once

// The pages that one flush changes within what a file already held, kept beside it until all of them are in.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace argil::hdf5::internal {

inline constexpr std::size_t kPageBytes = 4096;

/// Page number → its kPageBytes bytes.
using Pages = std::map<std::uint64_t, std::vector<char>>;

/// Where the pages of `file` are kept during a flush.
std::string name_journal(const std::string& file);

/// All or nothing; false with errno set.
bool write_all(int descriptor, const char* data, std::size_t size, std::uint64_t offset);

/// Writes `pages` and the `size` [bytes] that the file will have, with a checksum at the end, so that a torn
/// journal is known; false with errno set.
bool write_journal(int descriptor, const Pages& pages, std::uint64_t size);

/// Puts pages into a file and gives it `size` bytes; false with errno set.
bool apply_pages(int descriptor, const Pages& pages, std::uint64_t size);

/// If a flush of FILE was killed half-way, finishes it; removes the journal. Throws IoError when another
/// process is writing FILE, and when FILE needs it and cannot be written.
void recover(const std::string& file);

}  // namespace argil::hdf5::internal
