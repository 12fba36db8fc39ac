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
  const bool is_filtered = H5Pget_layout(creation.id()) == H5D_CHUNKED && H5Pget_nfilters(creation.id()) > 0;
  const std::uint64_t stored = std::min<std::uint64_t>(H5Dget_storage_size(id), find_file_bytes(id));
  H5Eclear2(H5E_DEFAULT);
  const Handle space = dataspace(H5Dget_space(id));
  return check_extent(dataset.file(), dataset.path(), read_shape(space.id()), H5Tget_size(type.id()),
                      multiply_bounded(stored, is_filtered ? kMaxExpansion : 1));
}

std::uint64_t internal::count_stored_values(const Object& object, const std::string& attribute, Id opened) {
  const Handle type = datatype(H5Aget_type(opened));
  const Handle space = dataspace(H5Aget_space(opened));
  return check_extent(object.file(), "attribute " + attribute + " of " + object.path(),
                      read_shape(space.id()), H5Tget_size(type.id()), find_file_bytes(opened));
}

}  // namespace argil::hdf5
