#pragma once

#include <string>
#include <string_view>

/// Makes an HDF5 file of a fuzzer's bytes, by the library: any bytes give a file that opens, whose datasets,
/// attributes and links have the names of a trace and whatever types, shapes, layouts and values the bytes
/// say. Bytes of a file itself would find what libhdf5 makes of a damaged file, which is not ours.
///
/// A record is: object, type, layout, rank, a byte a length, number of data bytes, data. Lengths from 200 are
/// powers of two, to 2^55.
void write_hdf5(std::string_view bytes, const std::string& file);
