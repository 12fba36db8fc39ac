#include "study/displacement_field.h"

#include <Eigen/QR>

#include <algorithm>
#include <utility>
#include <vector>

namespace argil::study {
namespace {

constexpr int kNumQuadratic = 9;      // x y z xx yy zz yz xz xy: a quadratic less its value at the vertex
constexpr int kNumAffine = 3;         // the first of them
constexpr double kLeastPivot = 1e-3;  // relative, of coordinates in [−1, 1]: below, the vertices do not
                                      // tell the terms apart
using Terms = Eigen::Matrix<double, kNumQuadratic, 1>;
using Rings = std::vector<std::vector<int>>;

/// Vertices that share a tet with each, without itself, increasing.
Rings find_neighbours(Eigen::Index num_vertices, const Tets& tets) {
  Rings neighbours(static_cast<std::size_t>(num_vertices));
  for (Eigen::Index t = 0; t < tets.cols(); ++t)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        if (i != j) neighbours[static_cast<std::size_t>(tets(i, t))].push_back(tets(j, t));
  for (std::vector<int>& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

/// Adds the neighbours of all in `patch` but `center`; false when there are none.
bool grow(std::vector<int>& patch, int center, const Rings& neighbours) {
  const std::size_t before = patch.size();
  std::vector<int> wider = patch;
  for (const int v : patch) {
    const std::vector<int>& more = neighbours[static_cast<std::size_t>(v)];
    wider.insert(wider.end(), more.begin(), more.end());
  }
  std::sort(wider.begin(), wider.end());
  wider.erase(std::unique(wider.begin(), wider.end()), wider.end());
  wider.erase(std::remove(wider.begin(), wider.end(), center), wider.end());
  patch = std::move(wider);
  return patch.size() > before;
}

/// Weights (3×k) of the differences u_w − u_v of a patch in the gradient at v, by least squares over the
/// first `num_terms`; empty when the patch does not determine them.
Eigen::Matrix3Xd fit_gradient(const Points& rest, int v, const std::vector<int>& patch, int num_terms) {
  const auto count = static_cast<Eigen::Index>(patch.size());
  double reach = 0.0;
  for (const int w : patch) reach = std::max(reach, (rest.col(w) - rest.col(v)).norm());
  Eigen::MatrixXd terms(count, num_terms);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Vec3 x = (rest.col(patch[static_cast<std::size_t>(k)]) - rest.col(v)) / reach;
    Terms all;
    all << x, x.cwiseAbs2(), x.y() * x.z(), x.x() * x.z(), x.x() * x.y();
    terms.row(k) = all.head(num_terms).transpose();
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(kLeastPivot);
  qr.compute(terms);
  if (qr.rank() < num_terms) return {};
  return qr.solve(Eigen::MatrixXd::Identity(count, count)).topRows(3) / reach;
}

Eigen::SparseMatrix<double> make_differences(const Points& rest, const Tets& tets) {
  const Rings neighbours = find_neighbours(rest.cols(), tets);
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < static_cast<int>(rest.cols()); ++v) {
    std::vector<int> patch = neighbours[static_cast<std::size_t>(v)];
    if (patch.empty()) continue;  // of no tet
    Eigen::Matrix3Xd weights = fit_gradient(rest, v, patch, kNumQuadratic);
    while (weights.cols() == 0 && grow(patch, v, neighbours))
      weights = fit_gradient(rest, v, patch, kNumQuadratic);
    if (weights.cols() == 0) weights = fit_gradient(rest, v, patch, kNumAffine);
    for (Eigen::Index k = 0; k < weights.cols(); ++k)
      for (int axis = 0; axis < 3; ++axis) {
        entries.emplace_back(patch[static_cast<std::size_t>(k)], 3 * v + axis, weights(axis, k));
        entries.emplace_back(v, 3 * v + axis, -weights(axis, k));
      }
  }
  Eigen::SparseMatrix<double> matrix(rest.cols(), 3 * rest.cols());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

DisplacementField::DisplacementField(const Points& rest, const Tets& tets, solid::ElementKind element)
    : m_rest(rest), m_tets(tets), m_is_quadratic(element == solid::ElementKind::p2) {
  if (m_is_quadratic) m_differences = make_differences(rest, tets);
}

void DisplacementField::set(Points displacement) {
  m_displacement = std::move(displacement);
  if (m_is_quadratic) m_gradient = m_displacement * m_differences;
}

// With u(Xᵢ) = u + ∇u·dᵢ + ½ dᵢᵀH dᵢ and ∇u(Xᵢ) = ∇u + H dᵢ, where dᵢ = Xᵢ − x and Σ λᵢ dᵢ = 0:
// Σ λᵢ [u(Xᵢ) − ½ ∇u(Xᵢ)·dᵢ] = u.
Vec3 DisplacementField::find(int tet, const Vec4& weights) const {
  Vec3 x = Vec3::Zero();
  for (int i = 0; i < 4; ++i) x += weights(i) * m_rest.col(m_tets(i, tet));
  Vec3 u = Vec3::Zero();
  for (int i = 0; i < 4; ++i) {
    const int v = m_tets(i, tet);
    u += weights(i) * m_displacement.col(v);
    if (m_is_quadratic) u -= 0.5 * weights(i) * (m_gradient.middleCols<3>(3 * v) * (m_rest.col(v) - x));
  }
  return u;
}

}  // namespace argil::study
