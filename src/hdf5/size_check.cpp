// What a dataset or an attribute declares is believed only as far as the file can hold it.

#include <algorithm>

#include "base/error.h"
#include "hdf5/internal.h"

namespace argil::hdf5 {

using namespace internal;  // NOLINT: the folder's own helpers

namespace {

/// One dataset at most, in the file and in memory, where a number takes 8 bytes: 49 hours of forces at 1 kHz.
constexpr std::uint64_t kMaxBytes = std::uint64_t{4} << 30;
/// Deflate makes at most 1032 bytes of one (zlib, technical details); other filters make fewer.
constexpr std::uint64_t kMaxExpansion = 1032;
/// Rows that were declared and never stored read as zeros; so many bytes of them are let pass.
constexpr std::uint64_t kUnstoredBytes = std::uint64_t{1} << 20;

std::uint64_t multiply_bounded(std::uint64_t a, std::uint64_t b) {
  std::uint64_t product = 0;
  return __builtin_mul_overflow(a, b, &product) ? UINT64_MAX : product;
}

std::uint64_t find_file_bytes(Id object) {
  const Handle file(H5Iget_file_id(object), [](Id i) -> int { return H5Fclose(i); });
  hsize_t bytes = 0;
  return H5Fget_filesize(file.id(), &bytes) < 0 ? 0 : bytes;
}

/// Throws where `shape` elements of `bytes_each` cannot come out of `stored` bytes. Returns their number.
std::uint64_t check_extent(const std::string& file, const std::string& object, const Shape& shape,
                           std::uint64_t bytes_each, std::uint64_t stored) {
  const bool is_empty = std::find(shape.begin(), shape.end(), 0U) != shape.end();
  std::uint64_t count = is_empty ? 0 : 1;
  for (const std::uint64_t length : shape) count = multiply_bounded(count, length);
  const std::string declares = object + " declares " +
                               (count == UINT64_MAX ? "2^64 or more" : std::to_string(count)) +
                               " values of " + std::to_string(bytes_each) + " bytes";
  if (multiply_bounded(count, std::max<std::uint64_t>(bytes_each, 8)) > kMaxBytes)
    throw IoError(file, declares + ", and argil reads at most " + std::to_string(kMaxBytes) +
                            " bytes of one; if the file is not damaged, divide it");
  if (multiply_bounded(count, bytes_each) > std::max(stored, kUnstoredBytes))
    throw IoError(file, declares + ", and the file holds at most " + std::to_string(stored) +
                            " bytes of them; it is damaged, write it again");
  return count;
}

/// Bytes that can come out of what a dataset stores.
std::uint64_t find_stored_bytes(Id id, Id creation) {
  const bool is_filtered = H5Pget_layout(creation) == H5D_CHUNKED && H5Pget_nfilters(creation) > 0;
  const std::uint64_t stored = std::min<std::uint64_t>(H5Dget_storage_size(id), find_file_bytes(id));
  H5Eclear2(H5E_DEFAULT);
  return multiply_bounded(stored, is_filtered ? kMaxExpansion : 1);
}

using Name = ssize_t (*)(hid_t, size_t, char*, size_t);

std::string read_name(Name read, Id creation, std::size_t place) {
  const ssize_t length = read(creation, place, nullptr, 0);
  std::string name(static_cast<std::size_t>(std::max<ssize_t>(length, 0)) + 1, '\0');
  read(creation, place, name.data(), name.size());
  name.pop_back();
  return name;
}

/// Of the dataset that a view shows. Other files are not opened, and a view of views could be one of itself.
std::uint64_t find_viewed_bytes(const Object& view, Id creation) {
  std::size_t count = 0;
  const bool is_one = H5Pget_virtual_count(creation, &count) >= 0 && count == 1 &&
                      read_name(H5Pget_virtual_filename, creation, 0) == ".";
  if (!is_one)
    throw IoError(view.file(), view.path() +
                                   " is put together from several datasets or from another file's, " +
                                   "which argil does not read; copy it into one (h5repack)");
  const std::string source = read_name(H5Pget_virtual_dsetname, creation, 0);
  const Handle opened = dataset(H5Dopen2(view.id(), source.c_str(), H5P_DEFAULT));
  H5Eclear2(H5E_DEFAULT);
  const Handle of_source = property(opened.id() < 0 ? H5I_INVALID_HID : H5Dget_create_plist(opened.id()));
  if (opened.id() < 0 || H5Pget_layout(of_source.id()) != H5D_CHUNKED)
    throw IoError(view.file(), view.path() + " shows " + source +
                                   ", which is not there or is no array of chunks; " +
                                   "the file is damaged, write it again");
  return find_stored_bytes(opened.id(), of_source.id());
}

}  // namespace

Shape internal::read_shape(Id space) {
  if (H5Sget_simple_extent_type(space) == H5S_NULL) return {0};
  const int rank = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> lengths(static_cast<std::size_t>(std::max(rank, 0)));
  if (rank > 0) H5Sget_simple_extent_dims(space, lengths.data(), nullptr);
  return {lengths.begin(), lengths.end()};
}

std::uint64_t internal::count_stored_values(const Object& dataset) {
  const Id id = dataset.id();
  const Handle type = datatype(H5Dget_type(id));
  const Handle creation = property(H5Dget_create_plist(id));
  const std::uint64_t stored = H5Pget_layout(creation.id()) == H5D_VIRTUAL
                                   ? find_viewed_bytes(dataset, creation.id())
                                   : find_stored_bytes(id, creation.id());
  const Handle space = dataspace(H5Dget_space(id));
  return check_extent(dataset.file(), dataset.path(), read_shape(space.id()), H5Tget_size(type.id()), stored);
}

std::uint64_t internal::count_stored_values(const Object& object, const std::string& attribute, Id opened) {
  const Handle type = datatype(H5Aget_type(opened));
  const Handle space = dataspace(H5Aget_space(opened));
  return check_extent(object.file(), "attribute " + attribute + " of " + object.path(),
                      read_shape(space.id()), H5Tget_size(type.id()), find_file_bytes(opened));
}

}  // namespace argil::hdf5
