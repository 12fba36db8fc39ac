#include "solid/recovered_error.h"

#include <algorithm>
#include <cmath>

#include "base/mandel.h"
#include "base/parallel.h"

namespace argil::solid {
namespace {

constexpr int kCorners = 4;

double trace(const Vec6& a) {
  return a.head<3>().sum();
}

double norm_of_deviator(const Vec6& a) {
  return std::sqrt(std::max(0.0, a.squaredNorm() - trace(a) * trace(a) / 3.0));
}

}  // namespace

double RecoveredError::Secant::square(const Vec6& a) const {
  const double t = trace(a);
  return bulk * t * t + shape * (a.squaredNorm() - t * t / 3.0);
}

RecoveredError::Secant RecoveredError::find_secant(const Strained& body, Eigen::Index tet,
                                                   const Vec6& strain) const {
  const Eigen::Index Q = body.model.elements.points_per_tet;
  const Elasticity e = body.materials.elasticity(static_cast<int>(tet));
  const double shape = body.materials.shape_stiffness(static_cast<int>(tet));
  const double bulk = e.C ? e.C->topLeftCorner<3, 3>().sum() / 9.0 : e.lambda + shape / 3.0;
  double elastic = 0.0;  // ‖dev ε_e‖, mean of the points
  for (Eigen::Index p = Q * tet; p < Q * (tet + 1); ++p) {
    const double norm = norm_of_deviator(body.kinematics.strain().col(p) - body.plastic_strain.col(p));
    elastic += m_is_bounded ? std::min(norm, body.materials.yield()(p)) : norm;
  }
  elastic /= static_cast<double>(Q);
  const double total = norm_of_deviator(strain);
  const double share = elastic < total ? elastic / total : 1.0;
  return {bulk, share * shape, share};
}

RecoveredError::RecoveredError(const Model& model, bool flows)
    : m_is_bounded(flows && find_law(model.params.model).plastic_split == PlasticSplit::logarithmic),
      m_reference(TensorField::Zero(6, model.elements.num_points())),
      m_strain(6, model.elements.num_points()),
      m_mean(6, model.elements.num_nodes()),
      m_volume(model.elements.num_tets()),
      m_of_batch(static_cast<std::size_t>((model.elements.num_tets() + kLanes - 1) / kLanes)) {}

/// R ε Rᵀ of its points.
void RecoveredError::set_strains(const Strained& body, Eigen::Index tet) {
  const Eigen::Index Q = body.model.elements.points_per_tet;
  m_volume(tet) = body.materials.weight().segment(Q * tet, Q).sum();
  for (Eigen::Index p = Q * tet; p < Q * (tet + 1); ++p) {
    const Mat3 R = body.kinematics.rotation().middleCols<3>(3 * p);
    const Mat3 strain = from_mandel(body.kinematics.strain().col(p) - m_reference.col(p));
    m_strain.col(p) = to_mandel(R * strain * R.transpose());
  }
}

/// Where a tet has four points its strain is linear, and known at its corners from theirs.
Vec6 RecoveredError::at_corner(const Elements& elements, Eigen::Index tet, int corner) const {
  if (elements.points_per_tet == 1) return m_strain.col(tet);
  const double slope = std::sqrt(5.0);  // 1/(a − b) of the points' barycentric coordinates a and b
  const double near = 0.25 * (1.0 - 1.0 / slope);
  const auto points = m_strain.middleCols<kCorners>(kCorners * tet);
  return slope * (points.col(corner) - near * points.rowwise().sum());
}

void RecoveredError::average(const Strained& body, std::ptrdiff_t node) {
  const Elements& elements = body.model.elements;
  Vec6 sum = Vec6::Zero();
  double volume = 0.0;
  for (int c = elements.node_begin[static_cast<std::size_t>(node)];
       c < elements.node_begin[static_cast<std::size_t>(node) + 1]; ++c) {
    const int corner = elements.node_corners[static_cast<std::size_t>(c)];
    const int tet = corner / elements.nodes_per_tet;
    if (corner % elements.nodes_per_tet >= kCorners) return;  // of the middle of an edge: not asked for
    sum += m_volume(tet) * at_corner(elements, tet, corner % elements.nodes_per_tet);
    volume += m_volume(tet);
  }
  if (volume > 0.0) m_mean.col(node) = sum / volume;
}

/// ∫ d:C:d of a linear d is V/20 (s:C:s + Σ dᵢ:C:dᵢ) with its corners' dᵢ and s = Σ dᵢ.
void RecoveredError::add_tet(const Strained& body, Eigen::Index tet, MeshError& sum) const {
  const Elements& elements = body.model.elements;
  const Eigen::Index Q = elements.points_per_tet;
  const Vec6 strain = m_strain.middleCols(Q * tet, Q).rowwise().mean();
  const Secant C = find_secant(body, tet, strain);
  Vec6 all = Vec6::Zero();
  double squares = 0.0;
  for (int i = 0; i < kCorners; ++i) {
    const Vec6 d = m_mean.col(elements.nodes(i, tet)) - at_corner(elements, tet, i);
    all += d;
    squares += C.square(d);
  }
  sum.error += m_volume(tet) / 20.0 * (squares + C.square(all));
  for (Eigen::Index p = Q * tet; p < Q * (tet + 1); ++p) {
    const Vec6 at_point = m_strain.col(p);
    const double weight = body.materials.weight()(p);
    const double volume_part = C.bulk * trace(at_point) * trace(at_point);
    const double shape_part = C.square(at_point) - volume_part;
    sum.stress += weight * (volume_part + shape_part);
    sum.work += weight * (0.5 * volume_part + (1.0 - 0.5 * C.elastic_share) * shape_part);
  }
  if (!body.materials.nodal() || body.volume.mean.size() == 0) return;
  const double shared =
      m_volume(tet) * body.materials.excess_bulk()(tet) * body.volume.mean(tet) * body.volume.mean(tet);
  sum.stress += shared;
  sum.work += 0.5 * shared;
}

MeshError RecoveredError::find(const Strained& body) {
  const int threads = body.model.threads;
  const Eigen::Index num_tets = m_volume.size();
  const auto each_batch = [&](auto use) {
    parallel_for(static_cast<std::ptrdiff_t>(m_of_batch.size()), threads, [&](std::ptrdiff_t batch) {
      use(batch, batch * kLanes, std::min<Eigen::Index>((batch + 1) * kLanes, num_tets));
    });
  };
  each_batch([&](std::ptrdiff_t, Eigen::Index begin, Eigen::Index end) {
    for (Eigen::Index t = begin; t < end; ++t) set_strains(body, t);
  });
  parallel_for(m_mean.cols(), threads, [&](std::ptrdiff_t node) { average(body, node); });
  each_batch([&](std::ptrdiff_t batch, Eigen::Index begin, Eigen::Index end) {
    MeshError sum;
    for (Eigen::Index t = begin; t < end; ++t) add_tet(body, t, sum);
    m_of_batch[static_cast<std::size_t>(batch)] = sum;
  });
  MeshError total;
  for (const MeshError& of_batch : m_of_batch) {
    total.error += of_batch.error;
    total.stress += of_batch.stress;
    total.work += of_batch.work;
  }
  return total;
}

}  // namespace argil::solid
