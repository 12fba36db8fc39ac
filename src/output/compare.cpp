#include "output/compare.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "output/result_reader.h"

namespace argil::output {
namespace {

constexpr const char* kAttribute = " attribute ";  // between an object's path and its attribute's name
constexpr const char* kStateHash = "state_hash";

using hdf5::Dataset;
using hdf5::Element;
using hdf5::Group;
using hdf5::Object;
using hdf5::Shape;

// Does `text` fit `pattern`, where * stands for any text, also none? What an earlier * stands for need never
// be looked at again once the text up to the next * was found: the first place leaves the most behind it.
bool fits(std::string_view pattern, std::string_view text) {
  std::size_t p = 0, t = 0;
  std::optional<std::size_t> star;  // place of the last * met
  std::size_t star_end = 0;         // where the text it stands for ends
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_end = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p, ++t;
    } else if (star) {
      p = *star + 1;
      t = ++star_end;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

bool loosens(const Tolerance& tolerance) {
  return tolerance.relative > 0.0 || tolerance.absolute > 0.0 || tolerance.of_largest > 0.0;
}

/// Calls `visit(path, is_group)` for all that lies below a group; groups with several names once.
template <class Visit>
void for_paths(const Group& group, std::set<std::pair<std::uint64_t, std::uint64_t>>& visited,
               const Visit& visit) {
  if (!visited.insert(group.find_identity()).second) return;
  for (const std::string& name : group.names()) {
    const std::string path = (group.path() == "/" ? "/" : group.path() + "/") + name;
    const bool is_group = group.is_group(name);
    visit(path, is_group);
    if (is_group) for_paths(group.open_group(name), visited, visit);
  }
}

/// A rule that fits nothing is a slip of the pen, and what it should have loosened or left out is not.
void require_use_of_rules(const ResultReader& a, const ResultReader& b, const CompareOptions& options) {
  if (options.tolerances.empty() && options.ignore.empty()) return;
  std::vector<bool> is_used(options.tolerances.size(), false);
  std::vector<bool> is_ignore_used(options.ignore.size(), false);
  for (const ResultReader* reader : {&a, &b}) {
    std::set<std::pair<std::uint64_t, std::uint64_t>> visited;
    for_paths(reader->root(), visited, [&](const std::string& path, bool is_group) {
      for (std::size_t i = 0; i < is_used.size() && !is_group; ++i)
        is_used[i] = is_used[i] || fits(options.tolerances[i].dataset, path);
      for (std::size_t i = 0; i < is_ignore_used.size(); ++i)
        is_ignore_used[i] = is_ignore_used[i] || fits(options.ignore[i], path);
    });
  }
  const auto refuse = [&](const std::string& place, const std::string& pattern, const char* what) {
    throw InputError(options.file, place,
                     "\"" + pattern + "\" fits no " + what + " of " + a.file() + " or " + b.file(),
                     "correct it or leave it out; argil compare names paths as /frames/000003/position");
  };
  for (std::size_t i = 0; i < is_used.size(); ++i)
    if (!is_used[i])
      refuse("/tolerances/" + std::to_string(i) + "/dataset", options.tolerances[i].dataset, "dataset");
  for (std::size_t i = 0; i < is_ignore_used.size(); ++i)
    if (!is_ignore_used[i] && options.ignore[i].find(kAttribute) == std::string::npos)
      refuse("/ignore/" + std::to_string(i), options.ignore[i], "dataset or group");
}

std::string print(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

std::string print(std::int64_t value) {
  return std::to_string(value);
}

std::string print(const std::string& text) {
  return "'" + text + "'";
}

std::string print(const Shape& shape) {
  std::string text = "(";
  for (const std::uint64_t length : shape) text += (text.size() > 1 ? ", " : "") + std::to_string(length);
  return text + ")";
}

// What a comparison of two arrays of numbers found.
struct ValueDifference {
  std::uint64_t count = 0;
  std::uint64_t first = 0;  // index of the first
  double largest = 0.0;     // |a − b|, NaN when one is
};

double find_distance(double a, double b) {
  return std::abs(a - b);
}

// Of integers that a double cannot tell apart, too: not 0 unless they are equal.
double find_distance(std::int64_t a, std::int64_t b) {
  const auto [low, high] = std::minmax(a, b);
  return static_cast<double>(static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low));
}

bool is_same(double a, double b, const Tolerance* tolerance) {
  if (tolerance == nullptr)
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) && !std::isnan(a);
  if (a == b) return true;  // also equal infinities
  return std::isfinite(a) && std::isfinite(b) &&
         find_distance(a, b) <= tolerance->absolute + tolerance->relative * std::abs(a);
}

bool is_same(std::int64_t a, std::int64_t b, const Tolerance* tolerance) {
  return a == b || (tolerance != nullptr &&
                    find_distance(a, b) <=
                        tolerance->absolute + tolerance->relative * std::abs(static_cast<double>(a)));
}

bool is_same(const std::string& a, const std::string& b, const Tolerance*) {
  return a == b;
}

template <class T>
ValueDifference compare_values(const std::vector<T>& a, const std::vector<T>& b, std::size_t count,
                               const Tolerance* tolerance) {
  ValueDifference found;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_same(a[i], b[i], tolerance)) continue;
    if (found.count++ == 0) found.first = i;
    const double error = find_distance(a[i], b[i]);
    if (!(error <= found.largest) && !std::isnan(found.largest)) found.largest = error;
  }
  return found;
}

class Comparison {
 public:
  Comparison(const ResultReader& a, const ResultReader& b, const CompareOptions& options)
      : m_options(options), m_file_a(a.file()), m_file_b(b.file()) {
    for (const char* path : {"/timing", "/checkpoint", "/packed"}) m_options.ignore.emplace_back(path);
    compare_groups(a.root(), b.root(), std::nullopt);
    std::stable_sort(
        m_report.differences.begin(), m_report.differences.end(),
        [](const Difference& x, const Difference& y) { return x.tick < y.tick; });  // no tick first
  }
  CompareReport take_report() { return std::move(m_report); }

 private:
  void add(const std::string& object, const std::string& what, std::optional<Tick> tick,
           std::uint64_t count = 1) {
    m_report.differences.push_back({object, what, tick, count});
  }

  bool is_ignored(const std::string& path) const {
    return std::any_of(m_options.ignore.begin(), m_options.ignore.end(),
                       [&](const std::string& pattern) { return fits(pattern, path); });
  }

  const Tolerance* find_rule(const std::string& path) const {
    const auto found =
        std::find_if(m_options.tolerances.begin(), m_options.tolerances.end(),
                     [&](const Tolerance& tolerance) { return fits(tolerance.dataset, path); });
    return found == m_options.tolerances.end() ? nullptr : &*found;
  }

  // May a dataset directly in the group differ? Then what is a hash of it and more says nothing.
  bool is_loosened(const Group& group) const {
    if (m_options.tolerances.empty() || !group.has_attribute(kStateHash)) return false;
    const std::vector<std::string> names = group.names();
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      const Tolerance* rule = find_rule(group.path() + "/" + name);
      return rule != nullptr && loosens(*rule);
    });
  }

  // With what a share of the largest value comes to counted in.
  template <class T>
  std::optional<Tolerance> find_tolerance(const std::string& path, const std::vector<T>& values) const {
    const Tolerance* rule = find_rule(path);
    if (rule == nullptr) return std::nullopt;
    double largest = 0.0;
    for (const T value : values) largest = std::max(largest, std::abs(static_cast<double>(value)));
    Tolerance tolerance = *rule;
    if (std::isfinite(largest)) tolerance.absolute += tolerance.of_largest * largest;
    return tolerance;
  }

  // Names that both have; those that one has alone are differences.
  std::vector<std::string> common(const std::vector<std::string>& a, const std::vector<std::string>& b,
                                  const std::string& prefix, std::optional<Tick> tick) {
    std::vector<std::string> all;
    std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
    std::vector<std::string> both;
    for (const std::string& name : all) {
      const bool in_a = std::binary_search(a.begin(), a.end(), name);
      const bool in_b = std::binary_search(b.begin(), b.end(), name);
      if (in_a && in_b)
        both.push_back(name);
      else if (!is_ignored(prefix + name))
        add(prefix + name, "is missing in " + (in_a ? m_file_b : m_file_a), tick);
    }
    return both;
  }

  void compare_attributes(const Object& a, const Object& b, std::optional<Tick> tick,
                          bool without_hash = false) {
    const std::string prefix = a.path() + kAttribute;
    for (const std::string& name : common(a.attribute_names(), b.attribute_names(), prefix, tick)) {
      if ((name == kStateHash && without_hash) || is_ignored(prefix + name)) continue;
      ++m_report.num_compared;
      m_report.num_hashes += name == kStateHash;
      const Element element = a.attribute_element(name);
      if (!a.has_same_attribute_type(b, name))
        add(prefix + name, "has another type", tick);
      else if (element == Element::text)
        compare_attribute(prefix + name, a.read_texts(name), b.read_texts(name), tick);
      else if (element == Element::real64)
        compare_attribute(prefix + name, a.read_reals(name), b.read_reals(name), tick);
      else
        compare_attribute(prefix + name, a.read_integers(name), b.read_integers(name), tick);
    }
  }

  template <class T>
  void compare_attribute(const std::string& object, const std::vector<T>& a, const std::vector<T>& b,
                         std::optional<Tick> tick) {
    bool is_equal = a.size() == b.size();
    for (std::size_t i = 0; is_equal && i < a.size(); ++i) is_equal = is_same(a[i], b[i], nullptr);
    if (is_equal) return;
    const bool is_one = a.size() == 1 && b.size() == 1;
    add(object, is_one ? "is " + print(a[0]) + " and " + print(b[0]) : std::string("differs"), tick);
  }

  template <class T>
  void compare_numbers(const Dataset& a, const Dataset& b, std::uint64_t count, std::uint64_t row_width,
                       const std::vector<std::int64_t>& ticks, std::optional<Tick> tick) {
    const std::vector<T> values_a = a.read<T>();
    const std::vector<T> values_b = b.read<T>();
    const std::optional<Tolerance> tolerance = find_tolerance(a.path(), values_a);
    const ValueDifference found =
        compare_values(values_a, values_b, count, tolerance ? &*tolerance : nullptr);
    if (found.count == 0) return;
    const std::uint64_t row = found.first / row_width;
    std::string what = std::to_string(found.count) + " of " + std::to_string(count) +
                       " values differ, first in row " + std::to_string(row);
    if (row_width > 1) what += ", component " + std::to_string(found.first % row_width);
    what += ": " + print(values_a[found.first]) + " and " + print(values_b[found.first]) +
            "; largest difference " + print(found.largest);
    if (row < ticks.size()) tick = ticks[row];
    add(a.path(), what, tick, found.count);
  }

  // `ticks`: tick of each row, empty when rows are not points in time.
  void compare_datasets(const Dataset& a, const Dataset& b, const std::vector<std::int64_t>& ticks,
                        std::optional<Tick> tick) {
    ++m_report.num_compared;
    compare_attributes(a, b, tick);
    const Shape shape_a = a.shape();
    const Shape shape_b = b.shape();
    const Element element = a.element();
    if (!a.has_same_type(b)) return add(a.path(), "has another type", tick);
    if (element == Element::text) {
      if (a.read_string() != b.read_string()) add(a.path(), "the texts differ", tick);
      return;
    }
    std::uint64_t count = hdf5::compute_count(shape_a);
    std::uint64_t row_width = shape_a.empty() || shape_a[0] == 0 ? 1 : count / shape_a[0];
    if (shape_a != shape_b) {
      const bool rows_only = !shape_a.empty() && shape_a.size() == shape_b.size() &&
                             std::equal(shape_a.begin() + 1, shape_a.end(), shape_b.begin() + 1);
      const std::uint64_t rows = rows_only ? std::min(shape_a[0], shape_b[0]) : 0;
      const std::optional<Tick> end = rows_only && rows < ticks.size() ? ticks[rows] : tick;
      add(a.path(), "shape " + print(shape_a) + " and " + print(shape_b), end);
      if (ticks.empty() || rows == 0) return;
      row_width = hdf5::compute_count(shape_a) / shape_a[0];
      count = rows * row_width;
    }
    if (element == Element::real64)
      compare_numbers<double>(a, b, count, row_width, ticks, tick);
    else
      compare_numbers<std::int64_t>(a, b, count, row_width, ticks, tick);
  }

  void compare_groups(const Group& a, const Group& b, std::optional<Tick> tick) {
    if (!m_visited.insert({a.find_identity(), b.find_identity()}).second) return;  // by another of its names
    if (a.has_attribute("tick")) tick = a.read_integer("tick");
    compare_attributes(a, b, tick, is_loosened(a));
    std::vector<std::int64_t> ticks;  // of the longer file, so that missing rows have a tick, too
    for (const Group* group : {&a, &b})
      if (group->has("tick")) {
        std::vector<std::int64_t> other = group->open_dataset("tick").read<std::int64_t>();
        if (other.size() > ticks.size()) ticks = std::move(other);
      }
    const std::string prefix = a.path() == "/" ? "/" : a.path() + "/";
    for (const std::string& name : common(a.names(), b.names(), prefix, tick)) {
      if (is_ignored(prefix + name)) continue;
      if (a.is_group(name) != b.is_group(name))
        add(prefix + name, "is a group in one file and a dataset in the other", tick);
      else if (a.is_group(name))
        compare_groups(a.open_group(name), b.open_group(name), tick);
      else
        compare_datasets(a.open_dataset(name), b.open_dataset(name), ticks, tick);
    }
  }

  CompareOptions m_options;
  std::string m_file_a;
  std::string m_file_b;
  CompareReport m_report;
  using Identity = std::pair<std::uint64_t, std::uint64_t>;
  std::set<std::pair<Identity, Identity>> m_visited;  // pairs of groups
};

}  // namespace

CompareReport compare_results(const std::string& file_a, const std::string& file_b,
                              const CompareOptions& options) {
  for (const Tolerance& tolerance : options.tolerances)
    if (!(tolerance.relative >= 0.0 && tolerance.absolute >= 0.0 && tolerance.of_largest >= 0.0))
      throw InputError("", tolerance.dataset,
                       "tolerances " + print(tolerance.relative) + " relative, " + print(tolerance.absolute) +
                           " absolute, " + print(tolerance.of_largest) + " of the largest",
                       "give numbers that are not negative");
  const ResultReader a(file_a);
  const ResultReader b(file_b);
  require_use_of_rules(a, b, options);
  return Comparison(a, b, options).take_report();
}

namespace {

bool is_of_hash(const std::string& object) {
  for (const char* name : {kStateHash, "sha256", "run_id"})
    if (object.find(name) != std::string::npos) return true;
  return false;
}

}  // namespace

std::string to_string(const CompareReport& report, bool verbose) {
  constexpr std::size_t kFew = 8;
  if (report.is_equal())
    return "equal: " + std::to_string(report.num_compared) + " datasets and attributes, " +
           std::to_string(report.num_hashes) + " hashes of the state among them\n";
  std::ostringstream text;
  const auto rank = [](const Difference& difference) {  // a hash only tells that there is more
    return (difference.tick.has_value() ? 0 : 1) + (is_of_hash(difference.object) ? 2 : 0);
  };
  const Difference& first =
      *std::min_element(report.differences.begin(), report.differences.end(),
                        [&](const Difference& x, const Difference& y) { return rank(x) < rank(y); });
  text << "different: first ";
  if (first.tick) text << "at tick " << *first.tick << " ";
  text << "in " << first.object << "; " << report.differences.size() << " of " << report.num_compared
       << " datasets and attributes differ\n";
  std::size_t said = 0;
  for (const Difference& difference : report.differences) {
    if (!verbose && (said == kFew || is_of_hash(difference.object))) continue;
    ++said;
    text << "  ";
    if (difference.tick) text << "tick " << *difference.tick << "  ";
    text << difference.object << ": " << difference.what << '\n';
  }
  if (said < report.differences.size())
    text << "  " << report.differences.size() - said << (said > 0 ? " more" : "")
         << ", hashes among them, by --verbose\n";
  return text.str();
}

}  // namespace argil::output
