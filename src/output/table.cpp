#include "output/table.h"

#include "base/error.h"

namespace argil::output {

using hdf5::Element;
using schema::Column;

namespace {

std::size_t element_size(Element element) {
  switch (element) {
    case Element::real64:
    case Element::int64:
      return 8;
    case Element::int32:
      return 4;
    case Element::uint8:
      return 1;
    case Element::text:
      break;
  }
  ARGIL_ASSERT(false, "text in a series");
  return 0;
}

hdf5::Shape row_shape(const Column& column) {
  return column.width == 1 ? hdf5::Shape{} : hdf5::Shape{column.width};
}

void append(hdf5::Dataset& dataset, Element element, const std::byte* bytes, std::uint64_t rows) {
  switch (element) {
    case Element::real64:
      return dataset.append(reinterpret_cast<const double*>(bytes), rows);
    case Element::int64:
      return dataset.append(reinterpret_cast<const std::int64_t*>(bytes), rows);
    case Element::int32:
      return dataset.append(reinterpret_cast<const std::int32_t*>(bytes), rows);
    case Element::uint8:
      return dataset.append(reinterpret_cast<const std::uint8_t*>(bytes), rows);
    case Element::text:
      break;
  }
}

}  // namespace

void Table::add(const Column& column, hdf5::Dataset dataset) {
  Series series{&column, std::move(dataset), {}};
  series.buffer.reserve(m_chunk_rows * column.width * element_size(column.element));
  m_series.push_back(std::move(series));
}

Table Table::create(const hdf5::Group& group, std::span<const Column> columns, std::uint64_t chunk_rows) {
  Table table;
  table.m_chunk_rows = chunk_rows;
  for (const Column& column : columns)
    table.add(column,
              group.create_series(column.name, column.element, row_shape(column), chunk_rows, column.label));
  return table;
}

Table Table::reopen(const hdf5::Group& group, std::span<const Column> columns, std::uint64_t chunk_rows,
                    std::uint64_t rows) {
  Table table;
  table.m_chunk_rows = chunk_rows;
  for (const Column& column : columns) {
    hdf5::Dataset dataset = group.open_dataset(column.name);
    if (dataset.element() != column.element)
      throw IoError(group.file(), dataset.path() + " has another type than this program writes");
    dataset.truncate(rows);
    table.add(column, std::move(dataset));
  }
  return table;
}

bool Table::end_row() {
  ARGIL_ASSERT(m_next == m_series.size(), m_next);
  m_next = 0;
  return ++m_rows >= m_chunk_rows;
}

void Table::write() {
  for (Series& series : m_series) {
    append(series.dataset, series.column->element, series.buffer.data(), m_rows);
    series.buffer.clear();
  }
  m_rows = 0;
}

void Table::show() {
  write();
  for (Series& series : m_series) series.dataset.flush();
}

}  // namespace argil::output
