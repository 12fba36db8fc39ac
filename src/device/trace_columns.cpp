#include "device/trace_columns.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/lower_case.h"
#include "device/csv.h"

namespace argil::device::internal {
namespace {

const char* const kColumnHelp =
    "the columns are t [s], x y z [m], qx qy qz qw, mode (push, pull, wet, dry or 0 to 3), or name them from "
    "the left by /trace/columns";

bool is_alnum(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0;
}

std::string letters_of(std::string_view text) {
  std::string letters;
  for (const char c : to_lower_case(text))
    if (is_alnum(c)) letters += c;
  return letters;
}

/// Units that may end a name behind a blank or a sign: "x_mm", "Time, s".
bool is_unit_word(std::string_view word) {
  static const std::vector<std::string_view> kWords = {
      "s",         "sec",   "secs", "second", "seconds", "ms",  "us",      "\xC2\xB5s",
      "\xCE\xBCs", "\xB5s", "ns",   "m",      "cm",      "mm",  "um",      "\xC2\xB5m",
      "\xCE\xBCm", "\xB5m", "nm",   "in",     "rad",     "deg", "radians", "degrees"};
  return std::find(kWords.begin(), kWords.end(), to_lower_case(word)) != kWords.end();
}

/// Plain names, in whose presence a column with another name for the same is not used.
const std::map<std::string, Role, std::less<>>& plain_names() {
  static const std::map<std::string, Role, std::less<>> kNames = {
      {"t", kTime}, {"time", kTime}, {"t_s", kTime}, {"time_s", kTime}, {"x", kX},   {"px", kX},
      {"x_m", kX},  {"y", kY},       {"py", kY},     {"y_m", kY},       {"z", kZ},   {"pz", kZ},
      {"z_m", kZ},  {"qx", kQx},     {"qy", kQy},    {"qz", kQz},       {"qw", kQw}, {"mode", kMode}};
  return kNames;
}

/// Before x, y and z angles; before w too a quaternion.
constexpr std::array<std::string_view, 5> kTurnWords = {"r", "rot", "rotation", "euler", "angle"};

std::map<std::string, Role, std::less<>> make_usual_names() {
  std::map<std::string, Role, std::less<>> names = {{"qr", kQw},    {"qi", kQx},  {"qj", kQy},
                                                    {"qk", kQz},    {"qs", kQw},  {"roll", kRx},
                                                    {"pitch", kRy}, {"yaw", kRz}, {"toolmode", kMode}};
  for (const char* name : {"t", "time", "times", "timestamp", "timestamps", "stamp", "elapsed", "elapsedtime",
                           "datetime", "seconds"})
    names[name] = kTime;
  const std::string letters = "xyz";
  for (int i = 0; i < 3; ++i) {
    const std::string axis(1, letters[static_cast<std::size_t>(i)]);
    const auto role = [i](Role first) { return static_cast<Role>(first + i); };
    for (const char* before : {"",
                               "p",
                               "pos",
                               "position",
                               "translation",
                               "tip",
                               "tippos",
                               "tipposition",
                               "device",
                               "devicepos",
                               "deviceposition",
                               "cursor",
                               "cursorpos",
                               "cursorposition",
                               "hand",
                               "handpos",
                               "handposition",
                               "tool",
                               "toolpos",
                               "toolposition",
                               "stylus",
                               "styluspos",
                               "stylusposition",
                               "coord"})
      names[before + axis] = role(kX);
    for (const char* after : {"pos", "position", "coord"}) names[axis + after] = role(kX);
    for (const std::string_view before : kTurnWords) names[std::string(before) + axis] = role(kRx);
  }
  for (int i = 0; i < 4; ++i)
    for (const char* before : {"q", "quat", "quaternion", "orientation", "ori"})
      names[before + std::string(1, "xyzw"[i])] = static_cast<Role>(kQx + i);
  return names;
}

/// Names in small letters and digits alone, and those that ROS's tools write for a pose.
std::optional<Role> find_usual_name(std::string_view base) {
  static const std::map<std::string, Role, std::less<>> kNames = make_usual_names();
  const auto found = kNames.find(base);
  if (found != kNames.end()) return found->second;
  for (const std::string_view part : {"poseposition", "poseorientation", "transformtranslation"}) {
    const std::size_t at = base.rfind(part);
    if (at == std::string_view::npos) continue;
    const auto of_pose = kNames.find(base.substr(at + (part.starts_with("pose") ? 4 : 9)));
    if (of_pose != kNames.end()) return of_pose->second;
  }
  return std::nullopt;
}

/// Number of a quaternion's part whose name does not say which: "q0", "quat_3".
std::optional<int> find_numbered_part(std::string_view base) {
  if (base.empty() || base.back() < '0' || base.back() > '4') return std::nullopt;
  const std::string_view word = base.substr(0, base.size() - 1);
  for (const char* known : {"q", "quat", "quaternion", "orientation", "ori"})
    if (word == known) return base.back() - '0';
  return std::nullopt;
}

std::string quote_all(std::vector<std::string> names) {
  for (std::string& name : names) name = quote(name);
  return join(names);
}

/// The names from the left, without those of a kind that was there before, as a list of JSON.
std::string propose_columns(const std::vector<std::string>& names, const Layout& layout) {
  std::string list;
  std::string left_out;  // since the last that counts
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool counts =
        std::find(layout.column.begin(), layout.column.end(), static_cast<int>(i)) != layout.column.end();
    if (!counts) {
      left_out += (i > 0 ? ", " : "") + std::string("\"-\"");
      continue;
    }
    list += left_out + (i > 0 ? ", " : "") + '"' + std::string(trim(names[i])) + '"';
    left_out.clear();
  }
  return "[" + list + "]";
}

struct Candidate {
  Role role;
  bool is_plain;
};

std::optional<Candidate> find_role(const std::string& name) {
  std::string_view trimmed = name;
  while (!trimmed.empty() && (trimmed.front() == '%' || trimmed.front() == '#'))
    trimmed = trim(trimmed.substr(1));
  const auto plain = plain_names().find(trimmed);
  if (plain != plain_names().end()) return Candidate{plain->second, true};
  const auto usual = find_usual_name(split_name(trimmed).base);
  if (usual) return Candidate{*usual, false};
  return std::nullopt;
}

/// What stands before x, y, z and w of a quaternion: words that without w are those of angles, or nothing
/// where another place is there.
std::set<std::string> find_quaternion_words(const std::vector<std::string>& names) {
  std::set<std::string> bases;
  std::vector<std::string> others;  // than x, y, z, w
  for (const std::string& name : names) {
    const std::string base = split_name(name).base;
    if (base.size() != 1) others.push_back(name);
    bases.insert(base);
  }
  const auto is_known = [&](std::string_view word) {
    if (word.empty()) return names_a_place(others);
    for (const std::string_view before : {"pose", "transform"})
      if (const std::size_t at = word.rfind(before); at != std::string_view::npos)
        word = word.substr(at + before.size());
    return word == "o" || word == "orient" || word == "att" || word == "attitude" ||
           std::find(kTurnWords.begin(), kTurnWords.end(), word) != kTurnWords.end();
  };
  std::set<std::string> words;
  for (const std::string& base : bases) {
    if (!base.ends_with('w')) continue;
    const std::string word = base.substr(0, base.size() - 1);
    if (bases.contains(word + "x") && bases.contains(word + "y") && bases.contains(word + "z") &&
        is_known(word))
      words.insert(word);
  }
  return words;
}

/// Seconds and nanoseconds in two columns are one time, where no plain column of times is there.
void join_nanoseconds(const std::vector<std::string>& names, bool has_plain_time, Layout& layout) {
  if (has_plain_time) return;
  const auto is_pair = [](std::string_view seconds, std::string_view nanoseconds) {
    for (const auto& [whole, rest] : {std::pair<std::string_view, std::string_view>{"secs", "nsecs"},
                                      {"sec", "nsec"},
                                      {"sec", "nanosec"},
                                      {"secs", "nanosecs"},
                                      {"seconds", "nanoseconds"}})
      if (seconds.ends_with(whole) && nanoseconds.ends_with(rest) &&
          seconds.substr(0, seconds.size() - whole.size()) ==
              nanoseconds.substr(0, nanoseconds.size() - rest.size()))
        return true;
    return false;
  };
  std::vector<std::string> letters;
  for (const std::string& name : names) letters.push_back(letters_of(name));
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t k = 0; k < names.size(); ++k) {
      const int seconds = static_cast<int>(i);
      if (i == k || !is_pair(letters[i], letters[k])) continue;
      if (layout.has(kTime) && layout.column[kTime] != seconds) continue;
      layout.column[kTime] = seconds;
      layout.column[kNanoseconds] = static_cast<int>(k);
    }
}

/// A quaternion whose parts are numbered has its scalar where it is told, or is "Q0 Qx Qy Qz".
void place_numbered_parts(const std::string& file, const std::string& place,
                          const std::vector<std::string>& names, const TraceOptions& options,
                          Layout& layout) {
  std::array<int, 5> numbered;
  numbered.fill(Layout::kAbsent);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (const auto part = find_numbered_part(split_name(names[i]).base))
      numbered[static_cast<std::size_t>(*part)] = static_cast<int>(i);
  const auto put = [&](Role role, int column) {
    layout.column[role] = column;
    layout.unusual.push_back(std::string(name_role(role)) + ": " +
                             quote(names[static_cast<std::size_t>(column)]));
  };
  const bool has_vector = layout.has(kQx) && layout.has(kQy) && layout.has(kQz);
  if (has_vector && !layout.has(kQw) && numbered[0] != Layout::kAbsent) put(kQw, numbered[0]);
  if (layout.has(kQx) || layout.has(kQy) || layout.has(kQz) || layout.has(kQw) || layout.has(kRx)) return;
  const auto found = std::count_if(numbered.begin(), numbered.end(), [](int column) { return column >= 0; });
  if (found == 0) return;
  if (options.quaternion_order == QuaternionOrder::by_name)
    throw InputError(file, place, "the quaternion's columns do not say which is the scalar part",
                     "say it by /trace/quaternion_order: wxyz or xyzw");
  const std::size_t first = numbered[0] == Layout::kAbsent ? 1 : 0;
  if (found != 4 || numbered[first + 3] == Layout::kAbsent)
    throw InputError(file, place, "a quaternion of " + std::to_string(found) + " numbered columns",
                     "name them qx qy qz qw by /trace/columns");
  const std::array<Role, 4> roles = options.quaternion_order == QuaternionOrder::wxyz
                                        ? std::array<Role, 4>{kQw, kQx, kQy, kQz}
                                        : std::array<Role, 4>{kQx, kQy, kQz, kQw};
  for (std::size_t i = 0; i < 4; ++i) put(roles[i], numbered[first + i]);
}

/// Angles are read where their order is given; they then stand above a quaternion.
void choose_orientation(const std::string& file, const std::string& place, const TraceOptions& options,
                        Layout& layout) {
  const bool reads_angles = options.angle_order != AngleOrder::none;
  if (reads_angles && !(layout.has(kRx) && layout.has(kRy) && layout.has(kRz)))
    throw InputError(file, place,
                     "/trace/angle_order is given, but not all of the columns rx, ry, rz are there",
                     "they are also called roll, pitch, yaw; or name them by /trace/columns");
  for (const Role role :
       reads_angles ? std::array<Role, 4>{kQx, kQy, kQz, kQw} : std::array<Role, 4>{kRx, kRy, kRz, kRz})
    layout.column[role] = Layout::kAbsent;
}

int find_button(const std::string& file, const std::string& place, const std::vector<std::string>& names,
                const TraceOptions& options) {
  if (options.button_column.empty()) return Layout::kAbsent;
  if (options.button_mode == ButtonMode::none)
    throw InputError(file, "",
                     "a button is asked for by /trace/button/column, but /trace/button/mode is none",
                     "say by it what the tool does while the button is pressed: push, pull, wet or dry");
  for (std::size_t i = 0; i < names.size(); ++i)
    if (trim(names[i]) == trim(options.button_column)) return static_cast<int>(i);
  throw InputError(file, place, "no column " + quote(options.button_column) + " among " + quote_all(names),
                   "correct /trace/button/column");
}

/// The columns that are left over, with the key by which some could be read.
void list_ignored(const std::vector<std::string>& names, bool are_from_user, Layout& layout) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int column = static_cast<int>(i);
    if (names[i] == "-" || (names[i].empty() && are_from_user) || column == layout.button ||
        std::find(layout.column.begin(), layout.column.end(), column) != layout.column.end())
      continue;
    layout.ignored.push_back(names[i].empty() ? "column " + std::to_string(column + 1) + " (without a name)"
                                              : names[i]);
  }
}

void list_unusual(const std::vector<std::string>& names, const std::array<bool, kNumRoles>& by_plain_name,
                  Layout& layout) {
  for (int role = 0; role < kNumRoles; ++role) {
    if (layout.column[role] == Layout::kAbsent || role == kDate) continue;
    const std::string& name = names[static_cast<std::size_t>(layout.column[role])];
    layout.unit[role] = split_name(name).unit;
    if (!by_plain_name[role])
      layout.unusual.push_back(std::string(name_role(static_cast<Role>(role))) + ": " + quote(name));
  }
}

}  // namespace

ColumnName split_name(std::string_view name) {
  ColumnName found;
  name = trim(name);
  if (name.ends_with(']') || name.ends_with(')')) {
    const std::size_t open = name.rfind(name.back() == ']' ? '[' : '(');
    if (open != std::string_view::npos) {
      found.unit = trim(name.substr(open + 1, name.size() - open - 2));
      name = name.substr(0, open);
    }
  } else {
    const std::size_t sign = name.find_last_of("_/, .-");
    if (sign != std::string_view::npos && sign > 0 && is_unit_word(name.substr(sign + 1))) {
      found.unit = name.substr(sign + 1);
      name = name.substr(0, sign);
    }
  }
  found.base = letters_of(name);
  return found;
}

std::string_view name_role(Role role) {
  static constexpr std::array<std::string_view, kNumRoles> kNames = {
      "t", "x", "y", "z", "qx", "qy", "qz", "qw", "rx", "ry", "rz", "mode", "date", "nanoseconds"};
  return kNames[static_cast<std::size_t>(role)];
}

std::array<int, kNumRoles> find_columns(const std::vector<std::string>& names) {
  std::array<int, kNumRoles> columns;
  columns.fill(Layout::kAbsent);
  for (std::size_t i = names.size(); i-- > 0;)
    if (const auto found = find_role(names[i])) columns[found->role] = static_cast<int>(i);
  return columns;
}

bool names_a_place(const std::vector<std::string>& names) {
  const std::array<int, kNumRoles> columns = find_columns(names);
  return columns[kX] >= 0 && columns[kY] >= 0 && columns[kZ] >= 0;
}

std::string_view find_remedy(const std::string& name) {
  const std::string base = split_name(name).base;
  if (base.find("button") != std::string::npos || base.find("btn") != std::string::npos)
    return "a button is read where /trace/button/column names it";
  const auto found = find_role(name);
  if (found && found->role >= kRx && found->role <= kRz)
    return "angles are read where /trace/angle_order gives their order";
  return {};
}

Layout find_layout(const std::string& file, const std::string& place, const std::vector<std::string>& names,
                   const TraceOptions& options) {
  Layout layout;
  layout.column.fill(Layout::kAbsent);
  std::array<bool, kNumRoles> by_plain_name{};
  const std::set<std::string> quaternions = find_quaternion_words(names);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty() || names[i] == "-") continue;
    const std::string base = split_name(names[i]).base;
    const std::size_t part = base.empty() ? std::string::npos : std::string_view("xyzw").find(base.back());
    auto found = find_role(names[i]);
    if (part != std::string::npos && quaternions.contains(base.substr(0, base.size() - 1)))
      found = Candidate{static_cast<Role>(kQx + part), false};
    if (base == "date" && layout.column[kDate] == Layout::kAbsent) {
      layout.column[kDate] = static_cast<int>(i);
      layout.date_name = names[i];
    }
    if (!found) continue;
    int& slot = layout.column[found->role];
    bool& is_plain = by_plain_name[found->role];
    if (slot != Layout::kAbsent && found->is_plain == is_plain)
      throw InputError(
          file, place,
          "two columns for " + quote(names[i]) + ": it and " + quote(names[static_cast<std::size_t>(slot)]),
          "name from the left those that count by /trace/columns, for instance " +
              propose_columns(names, layout));
    if (slot != Layout::kAbsent && is_plain) continue;  // the plain name is meant
    slot = static_cast<int>(i);
    is_plain = found->is_plain;
  }
  if (!layout.has(kX) || !layout.has(kY) || !layout.has(kZ))
    throw InputError(file, place, "no columns x, y, z among " + quote_all(names), kColumnHelp);
  join_nanoseconds(names, by_plain_name[kTime], layout);
  if (!layout.has(kTime)) layout.column[kDate] = Layout::kAbsent;
  choose_orientation(file, place, options, layout);
  list_unusual(names, by_plain_name, layout);
  place_numbered_parts(file, place, names, options, layout);
  const int parts = layout.has(kQx) + layout.has(kQy) + layout.has(kQz) + layout.has(kQw);
  if (parts != 0 && parts != 4)
    throw InputError(file, place, "some but not all of the columns qx, qy, qz, qw", kColumnHelp);
  layout.button = find_button(file, place, names, options);
  if (layout.button == layout.column[kMode]) layout.column[kMode] = Layout::kAbsent;
  list_ignored(names, !options.columns.empty(), layout);
  return layout;
}

}  // namespace argil::device::internal
