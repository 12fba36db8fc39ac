#pragma once

#include <span>
#include <vector>

#include "base/check.h"
#include "output/schema.h"

namespace argil::output {

/// Group of series of equal length, filled row by row and written by whole chunks. Rows are put in the order
/// of the columns; no allocation between two writes.
class Table {
 public:
  /// Makes the datasets of `columns` in `group`.
  static Table create(const hdf5::Group& group, std::span<const schema::Column> columns,
                      std::uint64_t chunk_rows);
  /// Goes on with existing ones, cut to `rows` rows.
  static Table reopen(const hdf5::Group& group, std::span<const schema::Column> columns,
                      std::uint64_t chunk_rows, std::uint64_t rows);

  template <class T>
  void put(const T* values, unsigned width) {
    Series& series = m_series[m_next++];
    ARGIL_ASSERT(series.column->element == hdf5::element_of<T>() && series.column->width == width,
                 series.column->name);
    const std::span<const std::byte> bytes = std::as_bytes(std::span(values, width));
    series.buffer.insert(series.buffer.end(), bytes.begin(), bytes.end());
  }
  template <class T>
  void put(T value) {
    put(&value, 1);
  }
  /// Ends a row; true when a chunk is full and must be written.
  bool end_row();
  /// Writes the rows in memory.
  void write();
  /// And shows them to those who read a shared file.
  void show();

 private:
  struct Series {
    const schema::Column* column;
    hdf5::Dataset dataset;
    std::vector<std::byte> buffer;
  };
  std::vector<Series> m_series;
  std::size_t m_next = 0;  ///< column that the next put() fills
  std::uint64_t m_rows = 0;
  std::uint64_t m_chunk_rows = 0;
  void add(const schema::Column& column, hdf5::Dataset dataset);
};

}  // namespace argil::output
