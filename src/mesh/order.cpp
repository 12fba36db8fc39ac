#include "mesh/order.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

namespace argil::mesh {

void sort_along_curve(const Points& x, std::vector<int>& list) {
  constexpr int kBits = 20;
  const Vec3 low = x.rowwise().minCoeff();
  const double scale = std::ldexp(1.0, kBits) / std::max((x.colwise() - low).maxCoeff(), 1e-300);
  std::vector<std::pair<std::uint64_t, int>> codes;
  codes.reserve(list.size());
  for (const int n : list) {
    std::uint64_t code = 0;
    for (int k = 0; k < 3; ++k) {
      const auto cell =
          static_cast<std::uint64_t>(std::min((x(k, n) - low(k)) * scale, std::ldexp(1.0, kBits) - 1.0));
      for (int bit = 0; bit < kBits; ++bit) code |= (cell >> bit & 1) << (3 * bit + k);
    }
    codes.emplace_back(code, n);
  }
  std::sort(codes.begin(), codes.end());
  for (std::size_t i = 0; i < codes.size(); ++i) list[i] = codes[i].second;
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

}  // namespace argil::mesh
