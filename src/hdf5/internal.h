#pragma once

// Shared by the sources of this folder only.

#include <hdf5.h>

#include <string>

#include "hdf5/file.h"

namespace argil::hdf5::internal {

static_assert(sizeof(hid_t) == sizeof(Id));

/// Before anything else: keeps the library from printing, its reasons go into our messages, and from cleaning
/// up at exit.
void start_library();

/// The deepest reason on the library's error stack, with the system's words when there are any; clears the
/// stack.
std::string take_reason();

/// Native memory type of an element; not for text.
hid_t memory_type(Element element);
/// Type in the file: little-endian whatever the machine.
hid_t file_type(Element element);
/// Element of an HDF5 type; throws IoError naming `where` when the project has none for it.
Element element_of_type(hid_t type, const std::string& file, const std::string& where);

inline constexpr const char* kBusy =
    "another process has this file open (a run that writes it, or a reader); wait for it or choose another "
    "name";

/// Lets a file that is opened with `access` change by whole flushes, with `file`'s journal beside it.
bool use_commit_driver(hid_t access, const std::string& file);

inline Handle dataspace(hid_t id) {
  return {id, [](Id i) -> int { return H5Sclose(i); }};
}
inline Handle datatype(hid_t id) {
  return {id, [](Id i) -> int { return H5Tclose(i); }};
}
inline Handle property(hid_t id) {
  return {id, [](Id i) -> int { return H5Pclose(i); }};
}
inline Handle attribute(hid_t id) {
  return {id, [](Id i) -> int { return H5Aclose(i); }};
}
inline Handle dataset(hid_t id) {
  return {id, [](Id i) -> int { return H5Dclose(i); }};
}
inline Handle group(hid_t id) {
  return {id, [](Id i) -> int { return H5Gclose(i); }};
}

/// Fixed-length UTF-8 string type that holds `text`, padded with zeros.
Handle text_type(const std::string& text);
/// Reads one string of fixed or variable length: `read(type, buffer)` fills it. Empty result on failure sets
/// `ok`.
template <class Read>
std::string read_string_with(hid_t stored, Read read, bool& ok) {
  if (H5Tis_variable_str(stored) > 0) {
    const Handle type = datatype(H5Tcopy(H5T_C_S1));
    H5Tset_size(type.id(), H5T_VARIABLE);
    H5Tset_cset(type.id(), H5Tget_cset(stored));
    char* words = nullptr;
    ok = read(type.id(), static_cast<void*>(&words)) >= 0;
    std::string text = ok && words != nullptr ? words : "";
    if (words != nullptr) H5free_memory(words);
    return text;
  }
  std::string text(H5Tget_size(stored), '\0');
  ok = read(stored, static_cast<void*>(text.data())) >= 0;
  const std::size_t end = text.find('\0');
  if (end != std::string::npos) text.resize(end);
  return text;
}

}  // namespace argil::hdf5::internal
