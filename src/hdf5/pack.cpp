// Rows that differ little, and arrays that are views of them.

#include <algorithm>

#include "base/error.h"
#include "hdf5/internal.h"

namespace argil::hdf5 {

using namespace internal;  // NOLINT: the folder's own helpers

namespace {

// Neighbouring rows share what did not change: level 6 makes them a seventh smaller than level 1 (measured).
constexpr unsigned kPackedDeflateLevel = 6;
// Deflate finds what repeats within 32 kB of one byte's plane: here, a row's part in all rows of a chunk.
constexpr std::uint64_t kPackedChunkBytes = std::uint64_t{384} << 10;

std::vector<hsize_t> with_first(std::uint64_t first, const Shape& rest) {
  std::vector<hsize_t> lengths(rest.begin(), rest.end());
  lengths.insert(lengths.begin(), first);
  return lengths;
}

}  // namespace

void Group::copy_from(const Group& other, const std::string& name) const {
  if (H5Ocopy(other.id(), name.c_str(), id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT) < 0)
    fail("cannot copy", name);
}

Dataset Group::create_packed(const std::string& name, const Shape& row, std::uint64_t chunk_rows,
                             const Label& label) const {
  const std::vector<hsize_t> lengths = with_first(0, row);
  std::vector<hsize_t> limits = lengths;
  limits[0] = H5S_UNLIMITED;
  std::vector<hsize_t> chunk = with_first(chunk_rows, row);
  const std::uint64_t bytes_each = compute_count(row) / row.at(0) * sizeof(double);
  chunk[1] = std::clamp<std::uint64_t>(kPackedChunkBytes / (chunk_rows * bytes_each), 1, row[0]);
  const int rank = static_cast<int>(lengths.size());
  const Handle space = dataspace(H5Screate_simple(rank, lengths.data(), limits.data()));
  const Handle properties = creation_properties();
  H5Pset_chunk(properties.id(), rank, chunk.data());
  add_filters(properties.id(), id(), kPackedDeflateLevel);
  Handle made = dataset(H5Dcreate2(id(), name.c_str(), file_type(Element::real64), space.id(), H5P_DEFAULT,
                                   properties.id(), H5P_DEFAULT));
  if (made.id() < 0) fail("cannot create", name);
  Dataset packed(std::move(made), m_file, join(m_path, name));
  write_label(packed, label);
  return packed;
}

void Group::create_view(const std::string& name, const Dataset& of, std::uint64_t row,
                        const Label& label) const {
  const Shape whole = of.shape();
  const Shape shape(whole.begin() + 1, whole.end());
  const std::vector<hsize_t> all(whole.begin(), whole.end());
  const std::vector<hsize_t> lengths(shape.begin(), shape.end());
  const std::vector<hsize_t> block = with_first(1, shape);
  std::vector<hsize_t> start(all.size(), 0);
  start[0] = row;
  const Handle source = dataspace(H5Screate_simple(static_cast<int>(all.size()), all.data(), nullptr));
  const Handle space = dataspace(H5Screate_simple(static_cast<int>(lengths.size()), lengths.data(), nullptr));
  const Handle properties = creation_properties();
  Handle made;
  if (H5Sselect_hyperslab(source.id(), H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr) >= 0 &&
      H5Pset_virtual(properties.id(), space.id(), ".", of.path().c_str(), source.id()) >= 0)
    made = dataset(H5Dcreate2(id(), name.c_str(), file_type(of.element()), space.id(), H5P_DEFAULT,
                              properties.id(), H5P_DEFAULT));
  if (made.id() < 0) fail("cannot create", name);
  Dataset view(std::move(made), m_file, join(m_path, name));
  write_label(view, label);
}

bool Dataset::is_view() const {
  const Handle creation = property(H5Dget_create_plist(id()));
  return H5Pget_layout(creation.id()) == H5D_VIRTUAL;
}

}  // namespace argil::hdf5
