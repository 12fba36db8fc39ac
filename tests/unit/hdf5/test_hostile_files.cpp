// Files that declare more than they hold, that are damaged or that contain themselves are refused with a
// word. They are made with the HDF5 library itself.
#include <gtest/gtest.h>
#include <hdf5.h>

#include "base/error.h"
#include "hdf5/file.h"
#include "support/temp_folder.h"

namespace argil::hdf5 {
namespace {

using test::TempFolder;

/// A file with one dataset /d of chunks of 1024 rows, of which the first `written` hold numbers.
std::string make_declaring(const std::string& name, const Shape& shape, hsize_t written) {
  const std::vector<hsize_t> lengths(shape.begin(), shape.end());
  const std::vector<hsize_t> limits(shape.size(), H5S_UNLIMITED);
  std::vector<hsize_t> chunk(shape.size(), 1);
  chunk[0] = 1024;
  const hid_t file = H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
  std::vector<hsize_t> begin = lengths;
  begin[0] = written;
  const hid_t small = H5Screate_simple(static_cast<int>(begin.size()), begin.data(), limits.data());
  const hid_t dataset = H5Dcreate2(file, "d", H5T_IEEE_F64LE, small, H5P_DEFAULT, creation, H5P_DEFAULT);
  const std::vector<double> values(written, 1.0);
  if (written > 0) H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dset_extent(dataset, lengths.data());
  H5Sclose(small);
  H5Dclose(dataset);
  H5Pclose(creation);
  H5Fclose(file);
  return name;
}

std::vector<double> read(const std::string& file) {
  return File::open_for_reading(file).root().open_dataset("d").read<double>();
}

TEST(HostileFile, ADatasetOfMoreThanTheFileHoldsIsRefused) {
  const TempFolder folder;
  const std::string name = folder / "f.h5";
  ARGIL_EXPECT_THROW_WITH(read(make_declaring(name, {1000000000000}, 0)), IoError,
                          name +
                              ": /d declares 1000000000000 values of 8 bytes, and argil reads at most "
                              "4294967296 bytes of one; if the file is not damaged, divide it");
  ARGIL_EXPECT_THROW_WITH(
      read(make_declaring(name, {200000}, 5000)), IoError,
      "/d declares 200000 values of 8 bytes, and the file holds at most 40960 bytes of them");
  // 2^62 · 4 · 8 bytes are 0 in 64 bits.
  ARGIL_EXPECT_THROW_WITH(read(make_declaring(name, {std::uint64_t{1} << 62, 4}, 0)), IoError,
                          "/d declares 2^64 or more values");
}

/// /d, of `count` numbers, shows /`source` of `file` (".": its own); /chunks has a chunk of eight numbers.
std::string make_view(const std::string& name, const char* file_of_source, const char* source,
                      hsize_t count) {
  const hid_t file = H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t eight = 8;
  const hid_t chunks = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(chunks, 1, &eight);
  const hid_t small = H5Screate_simple(1, &eight, nullptr);
  const hid_t stored = H5Dcreate2(file, "chunks", H5T_IEEE_F64LE, small, H5P_DEFAULT, chunks, H5P_DEFAULT);
  const std::vector<double> values(8, 2.0);
  H5Dwrite(stored, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  H5Pset_virtual(creation, space, file_of_source, source, space);
  H5Dclose(H5Dcreate2(file, "d", H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
  for (const hid_t list : {chunks, creation}) H5Pclose(list);
  for (const hid_t each : {small, space}) H5Sclose(each);
  H5Dclose(stored);
  H5Fclose(file);
  return name;
}

TEST(HostileFile, AViewShowsChunksOfItsOwnFileAndNoMoreThanTheyHold) {
  const TempFolder folder;
  const std::string name = folder / "f.h5", other = folder / "other.h5";
  make_view(other, ".", "/chunks", 8);
  EXPECT_EQ(read(make_view(name, ".", "/chunks", 8)), std::vector<double>(8, 2.0));
  ARGIL_EXPECT_THROW_WITH(
      read(make_view(name, ".", "/chunks", 200000)), IoError,
      "/d declares 200000 values of 8 bytes, and the file holds at most 64 bytes of them");
  ARGIL_EXPECT_THROW_WITH(read(make_view(name, other.c_str(), "/chunks", 8)), IoError,
                          "/d is put together from several datasets or from another file's");
  ARGIL_EXPECT_THROW_WITH(read(make_view(name, ".", "/d", 8)), IoError, "/d shows /d, which is not there or");
  ARGIL_EXPECT_THROW_WITH(read(make_view(name, ".", "/none", 8)), IoError, "/d shows /none, which is not");
}

TEST(HostileFile, RowsThatWereNeverWrittenReadAsZerosWhereTheyAreFew) {
  const TempFolder folder;
  const std::vector<double> values = read(make_declaring(folder / "f.h5", {131072}, 1024));
  ASSERT_EQ(values.size(), 131072U);
  EXPECT_EQ(values[1023], 1.0);
  EXPECT_EQ(values[1024], 0.0);
}

TEST(HostileFile, WhatCompressesWellIsNotTakenForHostile) {
  const TempFolder folder;
  const File file = File::create(folder / "f.h5");
  const std::vector<double> zeros(4000000, 0.0);
  file.root().write_array("d", zeros.data(), {4000000}, true, {"1", "zeros"});
  EXPECT_EQ(file.root().open_dataset("d").read<double>(), zeros);
}

TEST(HostileFile, AGroupThatContainsItselfEnds) {
  const TempFolder folder;
  const std::string name = folder / "f.h5";
  const hid_t file = H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_hard(group, ".", group, "again", H5P_DEFAULT, H5P_DEFAULT);
  H5Gclose(group);
  H5Fclose(file);
  const File opened = File::open_for_reading(name);
  Group inner = opened.root().open_group("g");
  EXPECT_EQ(opened.root().open_group("/").path(), "/");
  EXPECT_EQ(inner.find_identity(), inner.open_group("again").find_identity());
  EXPECT_NE(inner.find_identity(), opened.root().find_identity());
  const auto descend = [&] {
    for (int i = 0; i < 100; ++i) inner = inner.open_group("again");
  };
  ARGIL_EXPECT_THROW_WITH(descend(), IoError, "is a group nested in more than 32 others");
}

TEST(HostileFile, AttributesOfSeveralTextsAreNotOneText) {
  const TempFolder folder;
  const std::string name = folder / "f.h5";
  const hid_t file = H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t two = 2;
  const hid_t space = H5Screate_simple(1, &two, nullptr);
  for (const bool is_variable : {false, true}) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, is_variable ? H5T_VARIABLE : 1);
    const hid_t attribute =
        H5Acreate2(file, is_variable ? "variable" : "fixed", type, space, H5P_DEFAULT, H5P_DEFAULT);
    const char* words[] = {"N", "m"};
    H5Awrite(attribute, type, is_variable ? static_cast<const void*>(words) : "Nm");
    H5Aclose(attribute);
    H5Tclose(type);
  }
  H5Sclose(space);
  H5Fclose(file);
  const Group root = File::open_for_reading(name).root();
  for (const char* attribute : {"fixed", "variable"}) {
    EXPECT_EQ(root.read_texts(attribute), (std::vector<std::string>{"N", "m"}));
    ARGIL_EXPECT_THROW_WITH(root.read_text(attribute), IoError, "is not one text");
  }
}

// What a disk turned to zeros is found by the checksum that each chunk carries.
TEST(HostileFile, AChunkWithAWrongByteDoesNotRead) {
  const TempFolder folder;
  const std::string name = folder / "f.h5";
  std::vector<double> values(8192);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 1.0 + 0x1p-40 * static_cast<double>(i * i);
  for (const bool is_series : {true, false}) {
    {
      const File file = File::create(name);
      if (is_series)
        file.root().create_series("d", Element::real64, {}, 1024, {"1", "d"}).append(values.data(), 8192);
      else
        file.root().write_array("d", values.data(), {8192}, true, {"1", "d"});
    }
    EXPECT_EQ(read(name), values);
    std::string bytes = TempFolder::read(name);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    folder.write("f.h5", bytes);
    ARGIL_EXPECT_THROW_WITH(read(name), IoError, "cannot read /d");
  }
}

}  // namespace
}  // namespace argil::hdf5
