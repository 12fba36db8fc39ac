#pragma once

#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include "base/types.h"

namespace argil {

/// Named arrays of numbers: a state on its way to or from a file. Whole numbers up to 2⁵³ are exact.
using Snapshot = std::map<std::string, Eigen::MatrixXd>;

/// Writes a state to a snapshot or reads it back. One function that lists the fields serves both ways, so
/// that none can be saved and forgotten on return.
class Archive {
 public:
  /// Fills `snapshot`.
  static Archive make_saving(Snapshot& snapshot) { return Archive(snapshot, false); }
  /// Fills the fields from it; `origin` is what messages call it. Throws IoError for what is not in it or has
  /// another shape.
  static Archive make_restoring(const Snapshot& snapshot, const std::string& origin);

  bool is_restoring() const { return m_is_restoring; }

  /// Where the array is restored, it keeps its shape.
  template <class Derived>
  void array(const std::string& name, Eigen::PlainObjectBase<Derived>& value) {
    if (m_is_restoring)
      value.derived() = find(name, value.rows(), value.cols());
    else
      save(name, value);
  }
  /// Takes the number of columns that was saved, and for a dynamic type of rows.
  template <class Derived>
  void any_size(const std::string& name, Eigen::PlainObjectBase<Derived>& value) {
    if (m_is_restoring)
      value.derived() = find(name, Derived::RowsAtCompileTime, Derived::ColsAtCompileTime);
    else
      save(name, value);
  }
  template <class Number>
  requires(std::is_arithmetic_v<Number> || std::is_enum_v<Number>) void number(const std::string& name,
                                                                               Number& value) {
    value = static_cast<Number>(exchange(name, static_cast<double>(value)));
  }
  void quaternion(const std::string& name, Quat& value) { array(name, value.coeffs()); }
  template <class Number>
  requires(std::is_arithmetic_v<Number>) void list(const std::string& name, std::vector<Number>& values) {
    Field stored(static_cast<Eigen::Index>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i)
      stored(static_cast<Eigen::Index>(i)) = static_cast<double>(values[i]);
    any_size(name, stored);
    values.resize(static_cast<std::size_t>(stored.size()));
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<Number>(stored(static_cast<Eigen::Index>(i)));
  }
  void list(const std::string& name, std::vector<Vec3>& values);

 private:
  Archive(Snapshot& snapshot, bool is_restoring) : m_snapshot(&snapshot), m_is_restoring(is_restoring) {}
  double exchange(const std::string& name, double value);
  template <class Array>
  void save(const std::string& name, const Array& value) {
    (*m_snapshot)[name] = value;
  }
  /// The array of this name; Eigen::Dynamic stands for any number of rows or columns.
  const Eigen::MatrixXd& find(const std::string& name, Eigen::Index rows, Eigen::Index columns) const;

  Snapshot* m_snapshot;
  bool m_is_restoring;
  std::string m_origin;
};

}  // namespace argil
