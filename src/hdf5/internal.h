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

/// Of the same kind, width, sign and byte order; texts of any length are alike.
bool is_same_type(hid_t a, hid_t b);

/// Lengths of a dataspace; one without values has {0}.
Shape read_shape(Id space);

/// Number of values that a dataset, or an opened attribute of an object, declares. To be called before any is
/// read: throws IoError where they are more than the file can hold, or than argil reads at once.
std::uint64_t count_stored_values(const Object& dataset);
std::uint64_t count_stored_values(const Object& object, const std::string& attribute, Id opened);

/// Properties of a new dataset, without times.
Handle creation_properties();
/// Chunks are compressed (deflate's level; 0: not), and each carries a checksum by which a damaged one does
/// not read. `place`: in the file. In a shared one a reader may meet a chunk half written: there they have no
/// checksum.
void add_filters(Id properties, Id place, unsigned deflate_level);
void write_label(Dataset& made, const Label& label);
/// Path of `name` in the group at `folder`.
std::string join(const std::string& folder, const std::string& name);

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
/// Reads `count` strings of fixed or variable length: `read(type, buffer)` fills a buffer. Clears `ok` on
/// failure.
template <class Read>
std::vector<std::string> read_strings_with(hid_t stored, std::size_t count, Read read, bool& ok) {
  std::vector<std::string> texts;
  if (H5Tis_variable_str(stored) > 0) {
    const Handle type = datatype(H5Tcopy(H5T_C_S1));
    H5Tset_size(type.id(), H5T_VARIABLE);
    H5Tset_cset(type.id(), H5Tget_cset(stored));
    std::vector<char*> words(count, nullptr);
    ok = read(type.id(), static_cast<void*>(words.data())) >= 0;
    for (char* word : words) {
      texts.emplace_back(ok && word != nullptr ? word : "");
      if (word != nullptr) H5free_memory(word);
    }
    return texts;
  }
  const std::size_t size = H5Tget_size(stored);
  std::string characters(count * size, '\0');
  ok = read(stored, static_cast<void*>(characters.data())) >= 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string padded = characters.substr(i * size, size);
    texts.push_back(padded.substr(0, padded.find('\0')));
  }
  return texts;
}

}  // namespace argil::hdf5::internal
