#include "scenario/sweep_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "base/rng.h"
#include "scenario/json_reader.h"

namespace argil::scenario {
namespace {

using PointList = std::vector<std::vector<Setting>>;

constexpr std::int64_t kMostPoints = 1000000;

std::size_t count_bytes(const PointList& points) {
  std::size_t bytes = 0;
  for (const auto& settings : points)
    for (const Setting& setting : settings)
      bytes += JsonReader::count_bytes(setting.pointer, setting.value.size());
  return bytes;
}

/// Refuses a point that sets a key of the scenario twice, or an object and what is in it.
void check_apart(const std::vector<Setting>& settings, const JsonReader& reader, const std::string& key) {
  std::vector<std::string> folders;
  for (const Setting& setting : settings) folders.push_back(setting.pointer + "/");
  std::sort(folders.begin(), folders.end());  // what is in an object follows it
  for (std::size_t i = 1; i < folders.size(); ++i)
    if (folders[i].starts_with(folders[i - 1])) {
      const auto name = [](const std::string& folder) { return folder.substr(0, folder.size() - 1); };
      reader.refuse(key,
                    folders[i] == folders[i - 1] ? name(folders[i]) + " is set twice in one point"
                                                 : name(folders[i]) + " is set in one point with " +
                                                       name(folders[i - 1]) + ", which it is part of",
                    "set it in one place");
    }
}

/// Every point of `a` with every point of `b`.
PointList combine(const PointList& a, const PointList& b, const JsonReader& reader, const std::string& key) {
  if (b.empty() || a.size() > static_cast<std::size_t>(kMostPoints) / b.size())
    reader.refuse(key, "makes more than a million points, or none", "take fewer values");
  reader.check_bytes(key, b.size() * count_bytes(a) + a.size() * count_bytes(b));
  PointList product;
  product.reserve(a.size() * b.size());
  for (const auto& left : a)
    for (const auto& right : b) {
      product.push_back(left);
      product.back().insert(product.back().end(), right.begin(), right.end());
      check_apart(product.back(), reader, key);
    }
  return product;
}

PointList read_grid(const JsonReader& reader, const Json& axes) {
  PointList points = {{}};
  for (const auto& [pointer, values] : reader.axes("grid", axes).items()) {
    PointList axis;
    std::set<Json> seen;
    for (const Json& value : values) {
      if (!seen.insert(value).second)
        reader.refuse("grid", pointer + " has " + value.dump() + " twice", "give each value once");
      axis.push_back({{pointer, value.dump()}});
    }
    points = combine(points, axis, reader, "grid");
  }
  return points;
}

PointList read_list(const JsonReader& reader, const Json& list) {
  if (!list.is_array() || list.empty())
    reader.refuse("list", "is not a list of objects", "give [{\"/json/pointer\": value, …}, …]");
  PointList points;
  for (const Json& entry : list) {
    if (!entry.is_object())
      reader.refuse("list", entry.dump() + " is not an object", "give {\"/json/pointer\": value}");
    points.emplace_back();
    for (const auto& [pointer, value] : entry.items()) {
      reader.check_pointer("list", pointer);
      points.back().push_back({pointer, value.dump()});
    }
  }
  return points;
}

/// Digits of i in this base, mirrored at the point [Halton1960].
double find_radical_inverse(std::uint64_t i, std::uint64_t base) {
  double value = 0.0;
  for (double place = 1.0 / static_cast<double>(base); i > 0; i /= base, place /= static_cast<double>(base))
    value += static_cast<double>(i % base) * place;
  return value;
}

std::uint64_t find_next_prime(std::uint64_t n) {
  for (;; ++n) {
    bool is_prime = n > 1;
    for (std::uint64_t d = 2; d * d <= n; ++d) is_prime = is_prime && n % d != 0;
    if (is_prime) return n;
  }
}

/// Sequences of all axes are shifted by a random number each, so that a seed gives another set.
PointList read_sample(const Json& json, const std::string& file) {
  JsonReader reader(json, file, "/sample");
  const std::string method = reader.text("method", "\"random\" or \"halton\"");
  if (method != "random" && method != "halton")
    reader.refuse("method", "\"" + method + "\" is unknown", "give random or halton");
  const auto count = static_cast<std::size_t>(reader.whole_number("count", 1, kMostPoints));
  const auto seed = static_cast<std::uint64_t>(reader.whole_number("seed", 0, std::int64_t{1} << 53, 0));
  const Json& axes = reader.axes("axes", reader.get("axes", "{\"/json/pointer\": [low, high], …}"));
  reader.finish();
  constexpr std::size_t kNumber = 24;  // characters of a double
  std::size_t bytes = 0;
  for (const auto& [pointer, range] : axes.items())
    bytes += count * JsonReader::count_bytes(pointer, kNumber);
  reader.check_bytes("axes", bytes);
  PointList points(count);
  std::uint64_t base = 1;
  for (const auto& [pointer, range] : axes.items()) {
    if (range.size() != 2 || !range[0].is_number() || !range[1].is_number() || !(range[0] < range[1]))
      reader.refuse("axes", pointer + " has no range", "give [low, high], low below high");
    const double low = range[0].get<double>();
    const double width = range[1].get<double>() - low;
    Rng rng(seed, pointer);
    const double shift = rng.uniform();
    base = find_next_prime(base + 1);
    for (std::size_t i = 0; i < count; ++i) {
      double share = method == "random" ? rng.uniform() : find_radical_inverse(i + 1, base) + shift;
      if (share >= 1.0) share -= 1.0;
      points[i].push_back({pointer, Json(low + share * width).dump()});
    }
  }
  return points;
}

SweepPoint read_point(const std::string& line, const std::string& file, std::size_t number) {
  const Json json = parse_json(line, file + ", line " + std::to_string(number));
  JsonReader reader(json, file + ", line " + std::to_string(number), "");
  SweepPoint point;
  point.index = reader.whole_number("index", 0, kMostPoints);
  point.id = reader.text("id", "the run's hash");
  point.scenario = reader.text("scenario", "the base scenario");
  point.settings = reader.settings("settings");
  reader.finish();
  if (point.index != static_cast<std::int64_t>(number) - 1)
    reader.refuse("index", std::to_string(point.index) + " is not the line's number from 0",
                  "expand the sweep again");
  return point;
}

}  // namespace

Sweep load_sweep(const std::string& file) {
  const Json json = read_json(file);
  JsonReader reader(json, file, "");
  Sweep sweep;
  sweep.file = file;
  const std::string base = reader.text("scenario", "the file of the base scenario");
  sweep.scenario = (std::filesystem::path(file).parent_path() / base).lexically_normal().string();
  reader.find("about");
  sweep.points = {{}};
  if (const Json* axes = reader.find("grid"))
    sweep.points = combine(sweep.points, read_grid(reader, *axes), reader, "grid");
  if (const Json* axes = reader.find("zip"))
    sweep.points = combine(sweep.points, reader.zip("zip", *axes), reader, "zip");
  if (const Json* list = reader.find("list"))
    sweep.points = combine(sweep.points, read_list(reader, *list), reader, "list");
  if (const Json* sample = reader.find("sample"))
    sweep.points = combine(sweep.points, read_sample(*sample, file), reader, "sample");
  reader.finish();
  return sweep;
}

std::variant<std::string, double> parse_value(const Setting& setting) {
  constexpr double kWhole = 0x1p53;  // up to here each integer is a double
  const Json json = Json::parse(setting.value);
  if (json.is_number_float() || (json.is_number() && std::abs(json.get<double>()) <= kWhole))
    return json.get<double>();
  return json.is_string() ? json.get<std::string>() : json.dump();
}

std::string print_point(const SweepPoint& point) {
  Json settings = Json::object();
  for (const Setting& setting : point.settings) settings[setting.pointer] = Json::parse(setting.value);
  return Json(
             {{"index", point.index}, {"id", point.id}, {"scenario", point.scenario}, {"settings", settings}})
             .dump() +
         "\n";
}

std::vector<SweepPoint> load_points(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw IoError(file, std::string("cannot be read: ") + std::strerror(errno));
  std::vector<SweepPoint> points;
  std::string line;
  while (std::getline(stream, line)) {
    if (line.size() > kLongestPoint || std::ssize(points) >= kMostPoints)
      throw InputError(file, "line " + std::to_string(points.size() + 1),
                       "is longer than 1 MiB or past a million points",
                       "give a file that argil sweep expand wrote");
    points.push_back(read_point(line, file, points.size() + 1));
  }
  if (points.empty())
    throw InputError(file, "", "has no points", "give a file that argil sweep expand wrote");
  return points;
}

}  // namespace argil::scenario
