#pragma once

#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "base/hash.h"
#include "base/types.h"

namespace argil {

/// Named arrays of numbers: a state on its way to or from a file. Whole numbers up to 2⁵³ are exact.
using Snapshot = std::map<std::string, Eigen::MatrixXd>;

/// Writes a state to a snapshot, reads it back, or takes its hash. One function that lists the fields serves
/// all, so that none can be saved and forgotten on return, or left out of the hash.
class Archive {
 public:
  /// Fills `snapshot`.
  static Archive make_saving(Snapshot& snapshot);
  /// Fills the fields from it; `origin` is what messages call it. Throws IoError for what is not in it or has
  /// another shape.
  static Archive make_restoring(const Snapshot& snapshot, const std::string& origin);
  /// The same, but leaves solver history as it is: what only makes a solve shorter (see History).
  static Archive make_restoring_without_history(const Snapshot& snapshot, const std::string& origin);
  /// Adds names, shapes and bits of the fields to `hash`, in the order in which they are listed; also those
  /// of solver history.
  static Archive make_hashing(Sha256& hash);

  bool is_restoring() const { return m_origin.has_value(); }
  bool keeps_history() const { return !m_drops_history; }

  /// As long as this object lives, fields are solver history: other values lead to the same motion, but for
  /// the tolerance of the solves.
  class History {
   public:
    explicit History(Archive& archive) : m_archive(archive) { ++m_archive.m_in_history; }
    ~History() { --m_archive.m_in_history; }
    History(const History&) = delete;
    History& operator=(const History&) = delete;

   private:
    Archive& m_archive;
  };

  /// Where the array is restored, it keeps its shape.
  template <class Derived>
  void array(const std::string& name, Eigen::PlainObjectBase<Derived>& value) {
    if (is_left_out()) return;
    if (is_restoring())
      value.derived() = find(name, value.rows(), value.cols());
    else
      save(name, value.derived());
  }
  /// Takes the number of columns that was saved, and for a dynamic type of rows.
  template <class Derived>
  void any_size(const std::string& name, Eigen::PlainObjectBase<Derived>& value) {
    if (is_left_out()) return;
    if (is_restoring())
      value.derived() = find(name, Derived::RowsAtCompileTime, Derived::ColsAtCompileTime);
    else
      save(name, value.derived());
  }
  template <class Number>
  requires(std::is_arithmetic_v<Number> || std::is_enum_v<Number>) void number(const std::string& name,
                                                                               Number& value) {
    value = static_cast<Number>(pass(name, static_cast<double>(value)));
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
  /// A list of records; `fields(record, field)` calls `field` for each number of a record, always the same
  /// ones in the same order.
  template <class Record, class Fields>
  void records(const std::string& name, std::vector<Record>& list, Fields fields) {
    if (is_left_out()) return;
    Eigen::Index rows = 0;
    Record any{};
    fields(any, [&rows](auto&) { ++rows; });
    Eigen::MatrixXd table(rows, static_cast<Eigen::Index>(list.size()));
    const auto each = [&](auto pass) {
      for (std::size_t i = 0; i < list.size(); ++i) {
        double* stored = table.col(static_cast<Eigen::Index>(i)).data();
        fields(list[i], [&](auto& value) { pass(value, *stored++); });
      }
    };
    if (!is_restoring()) {
      each([](auto& value, double& stored) { stored = static_cast<double>(value); });
      return save(name, table);
    }
    table = find(name, rows, Eigen::Dynamic);
    list.resize(static_cast<std::size_t>(table.cols()));
    each([](auto& value, double& stored) {
      value = static_cast<std::remove_reference_t<decltype(value)>>(stored);
    });
  }

 private:
  Archive() = default;
  bool is_left_out() const { return m_drops_history && m_in_history > 0; }
  double pass(const std::string& name, double value);
  template <class Array>
  void save(const std::string& name, const Array& value) {
    if (m_hash)
      add_to_hash(name, value.rows(), value.cols(), value.data());
    else
      (*m_saved)[name] = value;
  }
  void add_to_hash(const std::string& name, Eigen::Index rows, Eigen::Index columns, const double* values);
  /// The array of this name; Eigen::Dynamic stands for any number of rows or columns.
  const Eigen::MatrixXd& find(const std::string& name, Eigen::Index rows, Eigen::Index columns) const;

  Snapshot* m_saved = nullptr;
  const Snapshot* m_restored = nullptr;
  std::optional<std::string> m_origin;  // of what is restored
  Sha256* m_hash = nullptr;
  bool m_drops_history = false;
  int m_in_history = 0;
};

}  // namespace argil
