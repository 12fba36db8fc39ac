#include "mesh/order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

namespace argil::mesh {

namespace {

constexpr int kBits = 20;  // of a coordinate

/// Place of a cell of the cube of 2^kBits cells a side along the curve [Skilling2004]: undo the turns and
/// mirrors of each level's octants from the coarsest on, then read the bits as a Gray code.
std::uint64_t find_place(std::array<std::uint32_t, 3> cell) {
  for (std::uint32_t side = 1U << (kBits - 1); side > 1; side >>= 1) {
    const std::uint32_t below = side - 1;
    for (std::uint32_t& axis : cell) {
      if (axis & side) {
        cell[0] ^= below;
      } else {
        const std::uint32_t exchanged = (cell[0] ^ axis) & below;
        cell[0] ^= exchanged;
        axis ^= exchanged;
      }
    }
  }
  cell[1] ^= cell[0];
  cell[2] ^= cell[1];
  std::uint32_t turned = 0;
  for (std::uint32_t side = 1U << (kBits - 1); side > 1; side >>= 1)
    if (cell[2] & side) turned ^= side - 1;
  std::uint64_t place = 0;
  for (int bit = kBits - 1; bit >= 0; --bit)
    for (const std::uint32_t axis : cell) place = place << 1 | ((axis ^ turned) >> bit & 1);
  return place;
}

}  // namespace

void sort_along_curve(const Points& x, std::vector<int>& list) {
  const Vec3 low = x.rowwise().minCoeff();
  const double scale = std::ldexp(1.0, kBits) / std::max((x.colwise() - low).maxCoeff(), 1e-300);
  std::vector<std::pair<std::uint64_t, int>> places;
  places.reserve(list.size());
  for (const int n : list) {
    std::array<std::uint32_t, 3> cell;
    for (int k = 0; k < 3; ++k)
      cell[static_cast<std::size_t>(k)] =
          static_cast<std::uint32_t>(std::min((x(k, n) - low(k)) * scale, std::ldexp(1.0, kBits) - 1.0));
    places.emplace_back(find_place(cell), n);
  }
  std::sort(places.begin(), places.end());
  for (std::size_t i = 0; i < places.size(); ++i) list[i] = places[i].second;
}

void sort_tets(TetMesh& mesh) {
  Points centre(3, mesh.num_tets());
  for (Eigen::Index t = 0; t < centre.cols(); ++t) {
    const auto v = mesh.tets.col(t);
    centre.col(t) = 0.25 * (mesh.vertices.col(v(0)) + mesh.vertices.col(v(1)) + mesh.vertices.col(v(2)) +
                            mesh.vertices.col(v(3)));
  }
  std::vector<int> order(static_cast<std::size_t>(mesh.num_tets()));
  std::iota(order.begin(), order.end(), 0);
  sort_along_curve(centre, order);
  mesh.tets = Tets(mesh.tets(Eigen::all, order));
  for (auto& [name, field] : mesh.cell_fields) field = Field(field(order));
  for (int& t : order) t = mesh.number(t);
  mesh.numbers = std::move(order);
}

std::vector<int> sort_vertices(TetMesh& mesh) {
  std::vector<int> order(static_cast<std::size_t>(mesh.num_vertices()));
  std::iota(order.begin(), order.end(), 0);
  sort_along_curve(mesh.vertices, order);
  std::vector<int> number(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    number[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  mesh.vertices = Points(mesh.vertices(Eigen::all, order));
  for (int& v : mesh.tets.reshaped()) v = number[static_cast<std::size_t>(v)];
  return number;
}

}  // namespace argil::mesh
