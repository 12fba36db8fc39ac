#include "run/mesh_size.h"

#include <cmath>
#include <cstdio>
#include <optional>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "contact/tool_shape.h"
#include "mesh_files/readers.h"
#include "output/text.h"

namespace argil::run {
namespace {

mesh::Box box_of(const Points& points) {
  return {points.rowwise().minCoeff(), points.rowwise().maxCoeff()};
}

// A body that a hand models. Sizes beyond are those of another unit.
constexpr double kLargestBody = 5.0;    // [m]
constexpr double kSmallestBody = 1e-3;  // [m]

std::optional<double> find_unit(const std::string& word) {
  for (const auto& [name, metres] : {std::pair{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"um", 1e-6}})
    if (word == name) return metres;
  std::istringstream text(word);
  double value = 0.0;
  if (text >> value && text.eof() && std::isfinite(value) && value > 0.0) return value;
  return std::nullopt;
}

}  // namespace

void say(const std::string& subject, const std::string& text) {
  std::printf("%s: %s\n", subject.c_str(), text.c_str());
}

double size_of(const mesh::Box& box) {
  return (box.high - box.low).norm();
}

mesh::Box read_box(const std::string& file) {
  if (!mesh_files::is_surface(file)) return box_of(mesh_files::read_tet_mesh(file).vertices);
  const mesh::TriangleMesh surface = mesh_files::read_triangle_mesh(file);
  mesh::Box box;
  for (const int v : surface.triangles.reshaped()) box.include(surface.vertices.col(v));
  return box;
}

std::string find_hole(const std::string& file) {
  if (!mesh_files::is_surface(file)) return "";
  try {
    contact::require_closed_surface(mesh_files::read_triangle_mesh(file), "");
  } catch (const InputError& error) {
    const std::string words = error.what();
    return words.substr(0, words.find(';'));
  }
  return "";
}

double choose_scale(const std::string& file, const std::string& given, const mesh::Box& box) {
  if (!given.empty()) {
    if (const auto unit = find_unit(given)) return *unit;
    throw InputError("--mesh-unit", given, "is no unit of length",
                     "give m, cm, mm, um, or the metres in one unit of the file");
  }
  const double size = size_of(box);
  if (!(size > kLargestBody)) return 1.0;
  for (const auto& [name, metres] : {std::pair{"mm", 1e-3}, {"um", 1e-6}})
    if (size * metres <= kLargestBody && size * metres >= kSmallestBody) {
      say(file, "taken in " + std::string(name) + ": in metres the body would be " + output::rounded(size) +
                    " m wide; --mesh-unit says it otherwise");
      return metres;
    }
  return 1.0;
}

}  // namespace argil::run
