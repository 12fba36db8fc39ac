#include "scenario/sweep_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/rng.h"
#include "scenario/json_reader.h"

namespace argil::scenario {
namespace {

using PointList = std::vector<std::vector<Setting>>;

constexpr std::size_t kMostPoints = 1000000;
constexpr std::size_t kMostSettings = 4000000;  // of all points: some 0.5 GB

std::size_t count_settings(const PointList& points) {
  std::size_t count = 0;
  for (const auto& settings : points) count += settings.size();
  return count;
}

void check_settings(std::size_t count, const JsonReader& reader, const std::string& key) {
  if (count > kMostSettings)
    reader.refuse(key, "makes " + std::to_string(count) + " settings, more than four million",
                  "take fewer values, or put what does not vary into the scenario");
}

/// Every point of `a` with every point of `b`.
PointList combine(const PointList& a, const PointList& b, const JsonReader& reader, const std::string& key) {
  if (b.empty() || a.size() > kMostPoints / b.size())
    reader.refuse(key, "makes more than a million points, or none", "take fewer values");
  check_settings(b.size() * count_settings(a) + a.size() * count_settings(b), reader, key);
  PointList product;
  product.reserve(a.size() * b.size());
  for (const auto& left : a)
    for (const auto& right : b) {
      product.push_back(left);
      product.back().insert(product.back().end(), right.begin(), right.end());
    }
  return product;
}

PointList read_grid(const JsonReader& reader, const Json& axes) {
  PointList points = {{}};
  for (const auto& [pointer, values] : reader.axes("grid", axes).items()) {
    PointList axis;
    for (const Json& value : values) axis.push_back({{pointer, value.dump()}});
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
  const auto count =
      static_cast<std::size_t>(reader.number("count", 1.0, 1.0, static_cast<double>(kMostPoints)));
  const auto seed = static_cast<std::uint64_t>(reader.number("seed", 0.0, 0.0, 0x1p53));
  const Json& axes = reader.axes("axes", reader.get("axes", "{\"/json/pointer\": [low, high], …}"));
  reader.finish();
  check_settings(count * axes.size(), reader, "axes");
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
  point.index =
      static_cast<std::int64_t>(reader.number("index", -1.0, 0.0, static_cast<double>(kMostPoints)));
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

std::string print_point(const SweepPoint& point) {
  Json settings = Json::object();
  for (const Setting& setting : point.settings) settings[setting.pointer] = Json::parse(setting.value);
  return Json(
             {{"index", point.index}, {"id", point.id}, {"scenario", point.scenario}, {"settings", settings}})
             .dump() +
         "\n";
}

std::vector<SweepPoint> load_points(const std::string& file) {
  constexpr std::size_t kLongestLine = 1 << 20;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw IoError(file, std::string("cannot be read: ") + std::strerror(errno));
  std::vector<SweepPoint> points;
  std::string line;
  while (std::getline(stream, line)) {
    if (line.size() > kLongestLine || points.size() >= kMostPoints)
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
