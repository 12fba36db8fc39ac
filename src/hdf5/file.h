#pragma once

// The project's only door to the HDF5 C library. Its headers stay behind this one; what a file contains is
// the business of output/ and device/. Every function throws IoError (file, object, the library's reason with
// errno), where another process stands in the way a BusyError.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"

namespace argil::hdf5 {

/// Another process has the file open and this one must not: nothing is wrong with its content.
class BusyError : public IoError {
 public:
  explicit BusyError(const std::string& file);
};

/// hid_t of HDF5 1.10 and later.
using Id = std::int64_t;

/// Owns one HDF5 identifier and closes it.
class Handle {
 public:
  using Close = int (*)(Id);
  Handle() = default;
  Handle(Id id, Close close) : m_id(id), m_close(close) {}
  Handle(Handle&& other) noexcept;
  Handle& operator=(Handle&& other) noexcept;
  ~Handle() { reset(); }
  Id id() const { return m_id; }
  /// Closes now; negative when the library could not (unwritten data). A closed handle gives 0.
  int reset();

 private:
  Id m_id = -1;
  Close m_close = nullptr;
};

/// Element types the project stores.
enum class Element : std::uint8_t { real64, int32, int64, uint8, text };

template <class T>
constexpr Element element_of();
template <>
constexpr Element element_of<double>() {
  return Element::real64;
}
template <>
constexpr Element element_of<std::int32_t>() {
  return Element::int32;
}
template <>
constexpr Element element_of<std::int64_t>() {
  return Element::int64;
}
template <>
constexpr Element element_of<std::uint8_t>() {
  return Element::uint8;
}

using Shape = std::vector<std::uint64_t>;  ///< row-major; empty: a single value

/// Number of elements of an array of this shape.
std::uint64_t compute_count(const Shape& shape);

/// What a reader needs to understand a dataset without this program.
struct Label {
  const char* units;  ///< SI unit, "1" for a pure number, "-" for text
  const char* about;  ///< meaning in one sentence
};

/// Group or dataset: what can carry attributes.
class Object {
 public:
  Object(Handle handle, std::string file, std::string path);
  Id id() const { return m_handle.id(); }
  const std::string& file() const { return m_file; }
  const std::string& path() const { return m_path; }  ///< from the root, "/haptic/force"

  void write_attribute(const std::string& name, const std::string& text);
  void write_attribute(const std::string& name, const char* text) {
    write_attribute(name, std::string(text));
  }
  void write_attribute(const std::string& name, double value);
  void write_attribute(const std::string& name, std::int64_t value);
  bool has_attribute(const std::string& name) const;
  /// Number of its file and its place there: the same for every name that an object has.
  std::pair<std::uint64_t, std::uint64_t> find_identity() const;
  std::vector<std::string> attribute_names() const;  ///< sorted
  Element attribute_element(const std::string& name) const;
  /// Are both stored in the same type: kind, width, sign, byte order? Texts of any length are one type.
  bool has_same_attribute_type(const Object& other, const std::string& name) const;
  std::string read_text(const std::string& name) const;
  std::vector<std::string> read_texts(const std::string& name) const;      ///< of any shape, flattened
  double read_real(const std::string& name) const;                         ///< any number type
  std::int64_t read_integer(const std::string& name) const;                ///< any integer type
  std::vector<double> read_reals(const std::string& name) const;           ///< of any shape, flattened
  std::vector<std::int64_t> read_integers(const std::string& name) const;  ///< of any shape, flattened

 protected:
  [[noreturn]] void fail(const std::string& action, const std::string& object) const;
  Handle m_handle;
  std::string m_file;
  std::string m_path;

 private:
  template <class T>
  std::vector<T> read_values(const std::string& attribute) const;
  template <class T>
  T read_value(const std::string& attribute) const;
};

/// Array in a file.
class Dataset : public Object {
 public:
  using Object::Object;
  Shape shape() const;
  Element element() const;
  /// As for attributes.
  bool has_same_type(const Dataset& other) const;
  /// Is it put together from others of its file?
  bool is_view() const;
  /// Adds `rows` rows at the end of the first dimension; `data` holds them row by row. Extendible datasets
  /// only.
  template <class T>
  void append(const T* data, std::uint64_t rows) {
    append_raw(data, element_of<T>(), rows);
  }
  /// Shows what was appended to those who read a shared file.
  void flush();
  /// Keeps the first `rows` rows.
  void truncate(std::uint64_t rows);
  /// The whole array, row by row, converted to T by the library (integers to real and back). An array that
  /// declares more than the file can hold, or more than 4 GiB, is refused before memory is taken for it.
  template <class T>
  std::vector<T> read() const {
    std::vector<T> values(count_values());
    read_raw(values.data(), element_of<T>());
    return values;
  }
  std::string read_string() const;  ///< of a text dataset that holds one string

 private:
  std::uint64_t count_values() const;
  void append_raw(const void* data, Element element, std::uint64_t rows);
  void read_raw(void* data, Element element) const;
};

/// Folder in a file.
class Group : public Object {
 public:
  using Object::Object;
  bool has(const std::string& name) const;
  bool is_group(const std::string& name) const;
  std::vector<std::string> names() const;  ///< of groups and datasets, sorted
  Group create_group(const std::string& name) const;
  Group open_group(const std::string& name) const;
  Dataset open_dataset(const std::string& name) const;
  void remove(const std::string& name) const;
  /// Dataset that grows by whole chunks of `chunk_rows` rows; `row` is the shape of one row (empty: a
  /// number). Chunks are compressed, but not in a shared file.
  Dataset create_series(const std::string& name, Element element, const Shape& row, std::uint64_t chunk_rows,
                        const Label& label) const;
  /// Gives the dataset at `path`, from the root, a second name here.
  void link_dataset(const std::string& name, const std::string& path) const;
  /// Copies the dataset or group `name` of another group, also of another file, to the same name here.
  void copy_from(const Group& other, const std::string& name) const;
  /// Dataset that grows by rows of shape `row`, of which neighbours differ little: its chunks hold
  /// `chunk_rows` rows of a part of them, compressed harder than those of a series.
  Dataset create_packed(const std::string& name, const Shape& row, std::uint64_t chunk_rows,
                        const Label& label) const;
  /// Makes an array that is row `row` of another dataset of this file: a view, which takes no room of its
  /// own.
  void create_view(const std::string& name, const Dataset& of, std::uint64_t row, const Label& label) const;
  /// Array of fixed shape; `compress` stores it shuffled and deflated where is_compressed().
  template <class T>
  void write_array(const std::string& name, const T* data, const Shape& shape, bool compress,
                   const Label& label) const {
    write_raw(name, data, element_of<T>(), shape, compress, label);
  }
  /// Is an array of this shape large enough to be compressed?
  template <class T>
  static bool is_compressed(const Shape& shape) {
    return is_large(compute_count(shape) * sizeof(T));
  }
  void write_string(const std::string& name, const std::string& text, const Label& label) const;
  /// A text a row, UTF-8 of any length; without a byte of value zero, which ends a text.
  void write_texts(const std::string& name, const std::vector<std::string>& texts, const Label& label) const;

 private:
  static bool is_large(std::uint64_t bytes);
  void write_raw(const std::string& name, const void* data, Element element, const Shape& shape,
                 bool compress, const Label& label) const;
};

/// An open file. One process writes a file; others are refused while it does.
class File {
 public:
  /// Makes a new file, replacing one that no other process is writing. Object times are off, formats as old
  /// as the content allows. It appears under its name at the first flush() and changes by whole flushes: a
  /// writer killed at any moment leaves the file of its last one (opening it may have to finish that).
  static File create(const std::string& name);
  /// Makes a new file that others may read while it grows (single writer, multiple readers): after
  /// let_others_read() only its series grow, and flush() of a dataset shows what was appended. Formats of
  /// HDF5 1.10. A writer that is killed leaves it marked as open (h5clear -s).
  static File create_shared(const std::string& name);
  void let_others_read();
  static File open_for_reading(const std::string& name);
  static File open_for_writing(const std::string& name);  ///< existing file, exclusive
  File(File&&) noexcept = default;
  File& operator=(File&&) noexcept = default;
  ~File();

  Group root() const;
  void flush();
  /// Flushes and waits until the file's bytes are on the disk.
  void sync();
  /// Closes and reports what could not be written; the destructor closes without a word.
  void close();
  const std::string& name() const { return m_name; }

 private:
  File(Handle handle, std::string name) : m_handle(static_cast<Handle&&>(handle)), m_name(std::move(name)) {}
  Handle m_handle;
  std::string m_name;
  std::string m_renamed_to;  // at the first flush of a new file
};

/// True when the file begins as HDF5 files do; false when it cannot be read.
bool is_hdf5(const std::string& file);

}  // namespace argil::hdf5
