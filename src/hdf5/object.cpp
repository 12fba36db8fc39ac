#include <algorithm>
#include <utility>

#include "base/error.h"
#include "hdf5/internal.h"

namespace argil::hdf5 {

using namespace internal;  // NOLINT: the folder's own helpers

Handle::Handle(Handle&& other) noexcept
    : m_id(std::exchange(other.m_id, -1)), m_close(std::exchange(other.m_close, nullptr)) {}

Handle& Handle::operator=(Handle&& other) noexcept {
  if (this != &other) {
    reset();
    m_id = std::exchange(other.m_id, -1);
    m_close = std::exchange(other.m_close, nullptr);
  }
  return *this;
}

int Handle::reset() {
  if (m_id < 0 || m_close == nullptr) return 0;
  return m_close(std::exchange(m_id, -1));
}

std::uint64_t compute_count(const Shape& shape) {
  std::uint64_t count = 1;
  for (const std::uint64_t length : shape) count *= length;
  return count;
}

Object::Object(Handle handle, std::string file, std::string path)
    : m_handle(std::move(handle)), m_file(std::move(file)), m_path(std::move(path)) {}

void Object::fail(const std::string& action, const std::string& object) const {
  const std::string where = object.empty() ? m_path : (m_path == "/" ? "" : m_path) + "/" + object;
  throw IoError(m_file, action + " " + where + ": " + take_reason());
}

namespace {

Handle open_attribute(const Object& object, const std::string& name) {
  const hid_t id = H5Aopen(object.id(), name.c_str(), H5P_DEFAULT);
  if (id < 0)
    throw IoError(object.file(),
                  "cannot read attribute " + name + " of " + object.path() + ": " + take_reason());
  return attribute(id);
}

void replace_attribute(const Object& object, const std::string& name, hid_t type, hid_t memory,
                       const void* value) {
  const Handle space = dataspace(H5Screate(H5S_SCALAR));
  bool ok = H5Aexists(object.id(), name.c_str()) <= 0 || H5Adelete(object.id(), name.c_str()) >= 0;
  if (ok) {
    const Handle made =
        attribute(H5Acreate2(object.id(), name.c_str(), type, space.id(), H5P_DEFAULT, H5P_DEFAULT));
    ok = made.id() >= 0 && H5Awrite(made.id(), memory, value) >= 0;
  }
  if (!ok)
    throw IoError(object.file(),
                  "cannot write attribute " + name + " of " + object.path() + ": " + take_reason());
}

}  // namespace

Handle internal::text_type(const std::string& text) {
  Handle type = datatype(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.id(), std::max<std::size_t>(text.size(), 1));
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

void Object::write_attribute(const std::string& name, const std::string& text) {
  const Handle type = text_type(text);
  replace_attribute(*this, name, type.id(), type.id(), text.c_str());
}

void Object::write_attribute(const std::string& name, double value) {
  replace_attribute(*this, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

void Object::write_attribute(const std::string& name, std::int64_t value) {
  replace_attribute(*this, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}

bool Object::has_attribute(const std::string& name) const {
  return H5Aexists(id(), name.c_str()) > 0;
}

std::pair<std::uint64_t, std::uint64_t> Object::find_identity() const {
  H5O_info_t info;
  if (H5Oget_info2(id(), &info, H5O_INFO_BASIC) < 0) fail("cannot find", "");
  return {info.fileno, info.addr};
}

std::vector<std::string> Object::attribute_names() const {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  if (H5Aiterate2(id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names) < 0)
    fail("cannot list attributes of", "");
  std::sort(names.begin(), names.end());
  return names;
}

Element Object::attribute_element(const std::string& name) const {
  const Handle opened = open_attribute(*this, name);
  const Handle type = datatype(H5Aget_type(opened.id()));
  return element_of_type(type.id(), m_file, "attribute " + name + " of " + m_path);
}

bool Object::has_same_attribute_type(const Object& other, const std::string& name) const {
  const Handle opened = open_attribute(*this, name);
  const Handle opened_other = open_attribute(other, name);
  const Handle a = datatype(H5Aget_type(opened.id()));
  const Handle b = datatype(H5Aget_type(opened_other.id()));
  return is_same_type(a.id(), b.id());
}

std::vector<std::string> Object::read_texts(const std::string& name) const {
  const Handle opened = open_attribute(*this, name);
  const Handle type = datatype(H5Aget_type(opened.id()));
  if (H5Tget_class(type.id()) != H5T_STRING)
    throw IoError(m_file, "attribute " + name + " of " + m_path + " is not text");
  bool ok = false;
  std::vector<std::string> texts = read_strings_with(
      type.id(), count_stored_values(*this, name, opened.id()),
      [&](hid_t t, void* buffer) { return H5Aread(opened.id(), t, buffer); }, ok);
  if (!ok) fail("cannot read attribute " + name + " of", "");
  return texts;
}

std::string Object::read_text(const std::string& name) const {
  const std::vector<std::string> texts = read_texts(name);
  if (texts.size() != 1) throw IoError(m_file, "attribute " + name + " of " + m_path + " is not one text");
  return texts[0];
}

template <class T>
std::vector<T> Object::read_values(const std::string& name) const {
  const Handle opened = open_attribute(*this, name);
  std::vector<T> values(count_stored_values(*this, name, opened.id()));
  if (H5Aread(opened.id(), memory_type(element_of<T>()), values.data()) < 0)
    fail("cannot read attribute " + name + " of", "");
  return values;
}

template <class T>
T Object::read_value(const std::string& name) const {
  const std::vector<T> values = read_values<T>(name);
  if (values.size() != 1) throw IoError(m_file, "attribute " + name + " of " + m_path + " is not one number");
  return values[0];
}

std::vector<double> Object::read_reals(const std::string& name) const {
  return read_values<double>(name);
}

std::vector<std::int64_t> Object::read_integers(const std::string& name) const {
  return read_values<std::int64_t>(name);
}

double Object::read_real(const std::string& name) const {
  return read_value<double>(name);
}

std::int64_t Object::read_integer(const std::string& name) const {
  return read_value<std::int64_t>(name);
}

}  // namespace argil::hdf5
