#pragma once

// What the names of a recording's columns say: which quantity, in which unit.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "device/trace.h"

namespace argil::device::internal {

/// kDate: of times of day. kNanoseconds: beside whole seconds.
enum Role : int {
  kTime,
  kX,
  kY,
  kZ,
  kQx,
  kQy,
  kQz,
  kQw,
  kRx,
  kRy,
  kRz,
  kMode,
  kDate,
  kNanoseconds,
  kNumRoles
};

/// A column's name without its unit, in small letters and digits alone: "Pos_X [mm]" is "posx" in "mm".
struct ColumnName {
  std::string base;
  std::string unit;  ///< as written; empty: not said
};
ColumnName split_name(std::string_view name);

/// Where each quantity of a trace stands among a file's columns.
struct Layout {
  static constexpr int kAbsent = -1;
  std::array<int, kNumRoles> column;        ///< of each role, from 0; kAbsent
  std::array<std::string, kNumRoles> unit;  ///< of each role as its column's name says
  std::vector<std::string> ignored;         ///< names of columns that are not used
  std::vector<std::string> unusual;         ///< "x: 'Pos_X [mm]'" of each name that is no plain one
  std::string date_name;                    ///< of the column of dates
  int button = kAbsent;
  bool has(Role role) const { return column[role] != kAbsent; }
};

/// Finds them by the columns' names; "" and "-" are no column. Throws InputError (`file`, `place`) for names
/// that leave open what is meant: no x y z, two of one kind, part of a quaternion, one that does not say
/// which number is the scalar, angles that are asked for and not there, a button's column that is not there.
Layout find_layout(const std::string& file, const std::string& place, const std::vector<std::string>& names,
                   const TraceOptions& options);

/// The first column of each role by its name; kAbsent.
std::array<int, kNumRoles> find_columns(const std::vector<std::string>& names);

/// Do they name x, y and z?
bool names_a_place(const std::vector<std::string>& names);

/// How an ignored column can be read; empty: not at all.
std::string_view find_remedy(const std::string& name);

/// "t" to "mode".
std::string_view name_role(Role role);

}  // namespace argil::device::internal
