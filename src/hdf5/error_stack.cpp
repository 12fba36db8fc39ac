#include "hdf5/internal.h"

namespace argil::hdf5::internal {
namespace {

herr_t keep_first(unsigned depth, const H5E_error2_t* entry, void* text) {
  if (depth == 0 && entry->desc != nullptr) *static_cast<std::string*>(text) = entry->desc;
  return 0;
}

// The library's file driver writes "…, errno = 13, error message = 'Permission denied', …".
std::string system_words(const std::string& reason) {
  const std::string key = "error message = '";
  const std::size_t begin = reason.find(key);
  if (begin == std::string::npos) return {};
  const std::size_t end = reason.find('\'', begin + key.size());
  return reason.substr(begin + key.size(), end - begin - key.size());
}

}  // namespace

void start_library() {
  // The library's clean-up at exit runs over freed memory when a file could not be closed on a full disk
  // (measured, 1.10.8). Every file here is closed by its owner, so there is nothing left to clean.
  static const bool started = H5dont_atexit() >= 0;
  static_cast<void>(started);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

std::string take_reason() {
  std::string deepest;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &deepest);
  H5Eclear2(H5E_DEFAULT);
  const std::string words = system_words(deepest);
  if (!words.empty()) return words;
  return deepest.empty() ? "no reason given by HDF5" : deepest;
}

}  // namespace argil::hdf5::internal
