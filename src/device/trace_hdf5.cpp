#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "device/trace_raw.h"
#include "device/trace_units.h"
#include "hdf5/file.h"

namespace argil::device::internal {
namespace {

using hdf5::Dataset;
using hdf5::Group;

// Where the arrays of a trace are: at the root of a trace file, in /haptic of a result file.
struct Names {
  std::string folder;
  const char* position;
  const char* orientation;
};

// Rows of `width` numbers; nothing else will do.
std::vector<double> read_rows(const Group& group, const std::string& name, std::uint64_t rows,
                              std::uint64_t width) {
  const Dataset dataset = group.open_dataset(name);
  const hdf5::Shape wanted = width == 1 ? hdf5::Shape{rows} : hdf5::Shape{rows, width};
  if (dataset.shape() != wanted)
    throw InputError(
        group.file(), dataset.path(),
        "does not have the shape " + std::to_string(rows) + (width == 1 ? "" : " × " + std::to_string(width)),
        "one row a sample, as many as in time");
  return dataset.read<double>();
}

/// By the key, else by the dataset's attribute. Nothing where neither says one.
std::optional<double> choose_unit(const Dataset& data, bool has_key, double of_key,
                                  std::optional<double> (*find_unit)(std::string_view), const char* remedy) {
  if (has_key) return of_key;
  if (!data.has_attribute("units")) return std::nullopt;
  const std::string units = data.read_text("units");
  const auto found = find_unit(units);
  if (!found) throw InputError(data.file(), data.path() + " units", "'" + units + "'", remedy);
  return found;
}

void choose_units(const Dataset& time, const Dataset& position, const TraceOptions& options, RawTrace& raw) {
  const bool has_length = !raw.is_in_world && options.length_unit != LengthUnit::automatic;
  const auto metres = choose_unit(position, has_length, has_length ? metres_per(options.length_unit) : 1.0,
                                  find_length_unit, "use m, cm, mm or um");
  raw.metres_per_unit = metres.value_or(1.0);
  raw.is_length_given = metres.has_value();
  const bool has_time = !raw.is_in_world && options.time_unit != TimeUnit::automatic;
  const auto second = choose_unit(time, has_time, has_time ? per_second(options.time_unit) : 1.0,
                                  find_time_unit, "use s, ms, us or ns");
  raw.is_time_given = second.has_value();
  if (second.value_or(1.0) != 1.0)
    for (double& t : raw.time) t /= *second;
}

std::vector<double> read_numbers(const Group& root, const std::string& name, std::size_t count) {
  std::vector<double> values = root.read_reals(name);
  bool good = values.size() == count;
  for (const double value : values) good = good && std::isfinite(value);
  if (!good)
    throw InputError(root.file(), "attribute " + name,
                     "does not hold " + std::to_string(count) + " finite numbers", "see the trace format");
  return values;
}

void read_transform(const Group& root, RawTrace& raw) {
  if (root.has_attribute("device")) raw.device = root.read_text("device");
  if (root.has_attribute("device_to_world_scale")) {
    raw.device_to_world.scale = read_numbers(root, "device_to_world_scale", 1)[0];
    if (!(raw.device_to_world.scale > 0.0))
      throw InputError(root.file(), "attribute device_to_world_scale",
                       std::to_string(raw.device_to_world.scale), "give a positive scale");
  }
  if (root.has_attribute("device_to_world_rotation_xyzw")) {
    const std::vector<double> q = read_numbers(root, "device_to_world_rotation_xyzw", 4);
    const Quat rotation(q[3], q[0], q[1], q[2]);
    constexpr double kMaxUnitError = 1e-3;
    if (!(std::abs(rotation.norm() - 1.0) <= kMaxUnitError))
      throw InputError(root.file(), "attribute device_to_world_rotation_xyzw", "is not of unit length",
                       "give x y z w with norm 1");
    raw.device_to_world.rotation = make_unit(rotation);
  }
  if (root.has_attribute("device_to_world_translation_m")) {
    const std::vector<double> v = read_numbers(root, "device_to_world_translation_m", 3);
    raw.device_to_world.translation = Vec3(v[0], v[1], v[2]);
  }
}

}  // namespace

RawTrace read_hdf5(const std::string& file, const TraceOptions& options) {
  if (!options.columns.empty())
    throw InputError(file, "", "columns are named for an HDF5 trace",
                     "columns name the columns of CSV files only");
  if (!options.button_column.empty())
    throw InputError(file, "", "/trace/button/column is given for an HDF5 trace",
                     "it names a column of CSV files only");
  const hdf5::File opened = hdf5::File::open_for_reading(file);
  const Group root = opened.root();
  const bool is_result = root.has("haptic");
  const Names names = is_result ? Names{"haptic", "tool_position", "tool_orientation"}
                                : Names{"/", "position", "orientation"};
  const Group group = root.open_group(names.folder);
  if (!group.has("time") || !group.has(names.position))
    throw InputError(file, group.path(), std::string("has no time and ") + names.position,
                     "a trace has /time, /position, /orientation, /mode; a result file has them in /haptic");
  RawTrace raw;
  raw.is_in_world = is_result;
  if (!is_result) read_transform(root, raw);
  raw.time = group.open_dataset("time").read<double>();
  const std::uint64_t rows = raw.time.size();
  choose_units(group.open_dataset("time"), group.open_dataset(names.position), options, raw);
  const std::vector<double> position = read_rows(group, names.position, rows, 3);
  for (std::size_t i = 0; i < rows; ++i) raw.position.emplace_back(Eigen::Map<const Vec3>(&position[3 * i]));
  if (group.has(names.orientation)) {
    const std::vector<double> orientation = read_rows(group, names.orientation, rows, 4);
    for (std::size_t i = 0; i < rows; ++i)
      raw.orientation.emplace_back(Eigen::Map<const Vec4>(&orientation[4 * i]));
  }
  if (group.has("mode")) {
    for (const double mode : read_rows(group, "mode", rows, 1)) {
      if (!(mode >= 0 && mode < kNumToolModes)) {
        char number[32];
        std::snprintf(number, sizeof number, "mode %g", mode);
        throw InputError(file, group.path() + " mode, row " + std::to_string(raw.mode.size()), number,
                         "0 push, 1 pull, 2 wet, 3 dry");
      }
      raw.mode.push_back(static_cast<ToolMode>(static_cast<int>(mode)));
    }
  }
  return raw;
}

}  // namespace argil::device::internal
