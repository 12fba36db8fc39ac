#include "embed/embedding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "base/check.h"
#include "base/error.h"
#include "embed/tet_locator.h"
#include "embed/triangle_tree.h"
#include "mesh/quadratic.h"
#include "mesh/topology.h"

namespace argil::embed {
namespace {

[[noreturn]] void refuse_outside(const mesh::TetMesh& cage, const Points& points,
                                 const std::vector<int>& outside, const std::string& file) {
  const TriangleTree boundary({cage.vertices, mesh::make_topology(cage).boundary});
  double farthest = 0.0;
  double first_distance = 0.0;
  for (const int v : outside) {
    const double distance = boundary.compute_distance(points.col(v), 1e300);
    if (v == outside.front()) first_distance = distance;
    farthest = std::max(farthest, distance);
  }
  std::ostringstream problem;
  problem.precision(4);
  problem << outside.size() << " of " << points.cols() << " vertices lie outside the cage, this one by "
          << first_distance << " m, the farthest by " << farthest << " m";
  throw InputError(file, "vertex " + std::to_string(outside.front()) + " (counted from 0)", problem.str(),
                   "make a cage that encloses the surface with `argil cage`");
}

/// Finds the tet that carries a point, inside or just outside.
class CarrierFinder {
 public:
  CarrierFinder(const mesh::TetMesh& cage, double most_beyond)
      : m_cage(cage), m_locator(cage), m_most_beyond(most_beyond) {}
  TetLocator::Place find(const Vec3& point) {
    const TetLocator::Place place = m_locator.find(point);
    if (place.tet >= 0 || !(m_most_beyond > 0.0)) return place;
    if (!m_boundary) m_boundary.emplace(m_cage);
    return m_boundary->find(point, m_most_beyond, std::numeric_limits<double>::infinity());
  }

 private:
  const mesh::TetMesh& m_cage;
  TetLocator m_locator;
  double m_most_beyond;                    // in longest edges of the tet
  std::optional<BoundaryTets> m_boundary;  // made for the first point outside
};

}  // namespace

bool can_embed(const mesh::TetMesh& cage, const Points& points, double most_beyond) {
  CarrierFinder carriers(cage, most_beyond);
  for (const auto& x : points.colwise())
    if (carriers.find(x).tet < 0) return false;
  return true;
}

Embedding make_embedding(const mesh::TetMesh& cage, const Points& points, const std::string& file,
                         double most_beyond) {
  CarrierFinder carriers(cage, most_beyond);
  Embedding embedding;
  embedding.tet.resize(static_cast<std::size_t>(points.cols()));
  embedding.weights.resize(4, points.cols());
  std::vector<int> outside;
  for (int v = 0; v < static_cast<int>(points.cols()); ++v) {
    if (!points.col(v).allFinite())
      throw InputError(file, "vertex " + std::to_string(v) + " (counted from 0)",
                       "a coordinate is not a finite number", "repair the surface file");
    const TetLocator::Place place = carriers.find(points.col(v));
    embedding.tet[static_cast<std::size_t>(v)] = place.tet;
    embedding.weights.col(v) = place.weights;
    if (place.tet < 0) outside.push_back(v);
  }
  if (!outside.empty()) refuse_outside(cage, points, outside, file);
  return embedding;
}

void interpolate_positions(const Embedding& embedding, const Eigen::MatrixXi& nodes, const Points& x,
                           Points& out) {
  out.setZero(3, embedding.num_points());
  const bool is_quadratic = nodes.rows() == 10;
  Eigen::Matrix<double, 10, 1> shape;
  for (int i = 0; i < embedding.num_points(); ++i) {
    const auto node = nodes.col(embedding.tet[static_cast<std::size_t>(i)]);
    if (is_quadratic)
      shape = mesh::compute_quadratic_shape(embedding.weights.col(i));
    else
      shape.head<4>() = embedding.weights.col(i);
    for (Eigen::Index k = 0; k < node.size(); ++k) out.col(i) += shape(k) * x.col(node(k));
  }
}

void interpolate_tet_field(const Embedding& embedding, const Field& per_tet, Field& out) {
  out.resize(embedding.num_points());
  for (int i = 0; i < embedding.num_points(); ++i)
    out(i) = per_tet(embedding.tet[static_cast<std::size_t>(i)]);
}

void compute_region_of_influence(const Points& x, const Vec3& centre, double radius, Field& out) {
  ARGIL_ASSERT(radius > 0.0, radius);
  out.resize(x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    out(i) = std::max(0.0, 1.0 - (x.col(i) - centre).norm() / radius);
}

}  // namespace argil::embed
