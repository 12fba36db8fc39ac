// The matrix of a step: each row is gathered from the tets around its node, in the order of their numbers.

#include "solid/matrix.h"

#include <Eigen/LU>

#include <algorithm>

#include "base/parallel.h"
#include "solid/body.h"
#include "solid/element.h"
#include "solid/hencky_lanes.h"
#include "solid/quadratic_lanes.h"

namespace argil::solid {
namespace {

/// λ cᵢ⊗cⱼ + μ cⱼ⊗cᵢ + μ cᵢ·cⱼ 1: the block of an isotropic point with turned gradients c, times `scale`.
Mat3 compute_isotropic_block(const Vec3& ci, const Vec3& cj, double lambda_scaled, double mu_scaled) {
  Mat3 block = (lambda_scaled * ci) * cj.transpose() + (mu_scaled * cj) * ci.transpose();
  block.diagonal().array() += mu_scaled * ci.dot(cj);
  return block;
}

/// The same for any stiffness: R (gᵢ·C·gⱼ) Rᵀ with g in the turned frame.
Mat3 compute_anisotropic_block(const Vec3& gi, const Vec3& gj, const Mat3& R, const Mat6& C) {
  Mat3 block;
  for (int s = 0; s < 3; ++s) {
    const Mat3 dF = Vec3::Unit(s) * gj.transpose();
    block.col(s) = from_mandel(C * to_mandel(0.5 * (dF + dF.transpose()))) * gi;
  }
  return R * block * R.transpose();
}

bool takes_pairs(const Body& body) {
  const bool is_exact = body.prediction.is_static && !body.prediction.is_rough;
  return body.model.keeps_tet_stiffness() && body.materials.is_isotropic() && !is_exact;
}

/// Stiffness of tets that have changed, which all lie in the part, or of all.
void set_pairs(Body& body, const Part& part, bool all) {
  const MatrixShares share = compute_shares(body);
  System& system = body.system;
  const Elements& elements = body.model.elements;
  const bool is_quadratic = elements.nodes_per_tet == 10;
  const bool flows = body.model.params.flows_in_solve && !body.prediction.is_static;
  const TangentArrays points{body.materials.gradient().data(),
                             body.kinematics.frame().data(),
                             body.plastic_strain->data(),
                             body.materials.weight().data(),
                             body.materials.point_lambda().data(),
                             body.materials.point_mu().data(),
                             share.exact,
                             share.kept,
                             is_quadratic ? system.point_pairs.data() : system.pairs.data(),
                             flows ? body.materials.yield().data() : nullptr,
                             system.unloads.data()};
  const auto set = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const auto is_changed = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
      const auto first = system.is_tet_changed.begin() + from, last = system.is_tet_changed.begin() + to;
      return all || std::find(first, last, char{1}) != last;
    };
    const std::ptrdiff_t Q = elements.points_per_tet;
    each_points(elements, begin, end, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
      if (!is_changed(first / Q, last / Q)) return;
      find_law(body.model.params.model).lanes.stiffness(points, first, last);
      if (is_quadratic) set_node_pairs(system.point_pairs.data(), first / Q, last / Q, system.pairs.data());
    });
  };
  if (all)
    OrderedRuns(body.model.threads).each(body.model.elements.num_tets(), set);
  else
    part.batches.each(body.model.elements.num_tets(), set);
}

void assemble_tangents(Body& body) {
  if (!needs_tangents(body) || takes_pairs(body)) return;
  const Strained strained = body.strained();
  System& system = body.system;
  system.tangent.resize(81, body.model.elements.num_points());
  parallel_for(body.model.elements.num_points(), body.model.threads, [&](std::ptrdiff_t p) {
    const int tet = body.model.elements.tet_of_point(static_cast<int>(p));
    const auto compute = system.is_projected ? compute_positive_tangent : compute_tangent;
    Elasticity e = strained.elasticity(tet);
    if (!body.is_newton())
      e.volume_change = 0.0;  // one linearisation leaves out what the nodes' pressure adds
    system.tangent.col(p) =
        compute(strained.law(), body.kinematics.at(static_cast<int>(p)), strained.plastic_strain.col(p), e)
            .reshaped();
  });
}

/// Rows of tets that have changed, which all lie in the part. Takes note of the changes.
void mark_rows(Body& body, const Part& part, bool all) {
  System& system = body.system;
  if (all) {
    std::fill(system.is_row_stale.begin(), system.is_row_stale.end(), char{1});
    std::fill(system.is_tet_changed.begin(), system.is_tet_changed.end(), char{0});
    return;
  }
  const Elements& elements = body.model.elements;
  part.batches.each_in_order(elements.num_tets(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t t = begin; t < end; ++t) {  // tets share rows
      if (!system.is_tet_changed[static_cast<std::size_t>(t)]) continue;
      system.is_tet_changed[static_cast<std::size_t>(t)] = 0;
      for (const int node : elements.nodes.col(t))
        if (const int row = body.model.row_of_node[static_cast<std::size_t>(node)]; row >= 0)
          system.is_row_stale[static_cast<std::size_t>(row)] = 1;
    }
  });
}

/// Adds the blocks of point p's corner i to a row: `blocks` are their places.
template <int N>
void add_point(const Body& body, const MatrixShares& share, const Elasticity& e, Eigen::Index p, int i,
               const int* blocks, linear::BlockMatrix& matrix) {
  const Eigen::Matrix<double, 3, N> gradient = find_node_gradients<N>(body.materials.gradient(), p);
  const double weight = body.materials.weight()(p);
  if (share.kept != 0.0 && !e.C) {
    const Eigen::Matrix<double, 3, N> turned = find_node_gradients<N>(body.kinematics.turned_gradient(), p);
    const Vec3 ci = turned.col(i);
    const double lambda = share.kept * weight * e.lambda;
    const double mu = share.kept * weight * e.mu;
    for (int j = 0; j < N; ++j)
      if (blocks[j] >= 0) matrix.block(blocks[j]) += compute_isotropic_block(ci, turned.col(j), lambda, mu);
  } else if (share.kept != 0.0) {
    const Mat3 R = kept_rotation(body, static_cast<int>(p));
    for (int j = 0; j < N; ++j)
      if (blocks[j] >= 0)
        matrix.block(blocks[j]) +=
            share.kept * weight * compute_anisotropic_block(gradient.col(i), gradient.col(j), R, *e.C);
  }
  if (share.exact == 0.0) return;
  const Mat9 A = share.exact * weight * body.system.tangent.col(p).reshaped(9, 9);
  for (int j = 0; j < N; ++j)
    if (blocks[j] >= 0) matrix.block(blocks[j]) += compute_tangent_block(gradient.col(i), A, gradient.col(j));
}

void clear_row(std::size_t row, linear::BlockMatrix& matrix) {
  const Eigen::Index first = matrix.row_begin[row];
  matrix.values.middleCols(3 * first, 3 * (matrix.row_begin[row + 1] - first)).setZero();
}

template <int N>
void gather_row(Body& body, int row, const MatrixShares& share) {
  const Strained strained = body.strained();
  const Elements& elements = body.model.elements;
  linear::BlockMatrix& matrix = body.system.matrix;
  const int Q = elements.points_per_tet;
  const auto r = static_cast<std::size_t>(row);
  clear_row(r, matrix);
  const auto node = static_cast<std::size_t>(body.model.node_of_row[r]);
  for (int c = elements.node_begin[node]; c < elements.node_begin[node + 1]; ++c) {
    const int corner = elements.node_corners[static_cast<std::size_t>(c)];
    const Eigen::Index t = corner / N;
    const int* blocks = &body.system.block_of_corner_pair[static_cast<std::size_t>(N * corner)];
    const Elasticity e = strained.elasticity(static_cast<int>(t));
    for (Eigen::Index p = Q * t; p < Q * (t + 1); ++p)
      add_point<N>(body, share, e, p, corner % N, blocks, matrix);
  }
}

/// Of a row that is too long for set_row_of_pairs.
template <int N>
void gather_pairs(Body& body, int row) {
  const Elements& elements = body.model.elements;
  linear::BlockMatrix& matrix = body.system.matrix;
  const auto r = static_cast<std::size_t>(row);
  clear_row(r, matrix);
  const auto node = static_cast<std::size_t>(body.model.node_of_row[r]);
  for (int c = elements.node_begin[node]; c < elements.node_begin[node + 1]; ++c) {
    const int corner = elements.node_corners[static_cast<std::size_t>(c)];
    const int i = corner % N;
    for (int j = 0; j < N; ++j) {
      if (j == i) continue;
      const Eigen::Index pair = N * (N - 1) / 2 * static_cast<Eigen::Index>(corner / N) + find_pair<N>(i, j);
      const Mat3 stored = body.system.pairs.col(pair).reshaped(3, 3);
      const Mat3 block = i < j ? stored : Mat3(stored.transpose());
      const int place = body.system.block_of_corner_pair[static_cast<std::size_t>(N * corner + j)];
      if (place >= 0) matrix.block(place) += block;
      matrix.block(matrix.diagonal[r]) -= block;
    }
  }
}

/// Gathers the rows that need it: all of them, or, where a matrix of kept rotations stays the same but for a
/// few tets, the rows of those tets and the rows that contacts were added to.
void assemble_rows(Body& body, const Part& part) {
  const Elements& elements = body.model.elements;
  System& system = body.system;
  linear::BlockMatrix& matrix = system.matrix;
  const MatrixShares share = compute_shares(body);
  const bool has_pairs = takes_pairs(body);
  const bool keeps_rest = (elements.nodes_per_tet == 4 || has_pairs) &&
                          !system.has_nodal_blocks(body.materials) && share == system.stored_shares &&
                          (share.exact == 0.0 || has_pairs);
  if (has_pairs) set_pairs(body, part, !keeps_rest);
  mark_rows(body, part, !keeps_rest);
  system.stored_shares = share;
  const bool is_simple = has_isotropic_tets(body.model, body.materials) && share.exact == 0.0;
  const RowArrays rows{body.kinematics.turned_gradient().data(),
                       body.materials.weight().data(),
                       body.materials.point_lambda().data(),
                       body.materials.point_mu().data(),
                       share.kept,
                       elements.node_corners.data(),
                       system.block_of_corner_pair.data(),
                       matrix.values.data()};
  const PairArrays pair_rows{system.pairs.data(), rows.corners, rows.block_of_pair, rows.values};
  const auto assemble_row = [&](std::ptrdiff_t row) {
    const auto r = static_cast<std::size_t>(row);
    if (!system.is_row_stale[r]) return 0;
    system.is_row_stale[r] = 0;
    const auto node = static_cast<std::size_t>(body.model.node_of_row[r]);
    const int begin = matrix.row_begin[r];
    const int num_blocks = matrix.row_begin[r + 1] - begin;
    const bool is_quadratic = elements.nodes_per_tet == 10;
    const bool is_short = num_blocks <= (is_quadratic ? kLongestQuadraticRow : kLongestRow);
    if (has_pairs && is_short)
      (is_quadratic ? set_row_of_quadratic_pairs : set_row_of_pairs)(
          pair_rows, elements.node_begin[node], elements.node_begin[node + 1], begin, num_blocks);
    else if (has_pairs)
      (is_quadratic ? gather_pairs<10> : gather_pairs<4>)(body, static_cast<int>(row));
    else if (is_simple && is_short)
      set_isotropic_row(rows, elements.node_begin[node], elements.node_begin[node + 1], begin, num_blocks);
    else if (elements.nodes_per_tet == 4)
      gather_row<4>(body, static_cast<int>(row), share);
    else
      gather_row<10>(body, static_cast<int>(row), share);
    ++matrix.revision[r];
    matrix.block(matrix.diagonal[r]).diagonal().array() +=
        share.mass * body.materials.mass()(static_cast<Eigen::Index>(node));
    return 1;
  };
  body.history.counters.assembled_rows += static_cast<int>(
      part.near_rows.sum(body.model.num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        int assembled = 0;
        for (std::ptrdiff_t row = begin; row < end; ++row) assembled += assemble_row(row);
        return assembled;
      }));
}

void add_nodal_stiffness(Body& body, const Eigen::Matrix3Xd& gradient, double scale) {
  if (scale == 0.0) return;
  NodalVolume& nodal = *body.materials.nodal();
  nodal.collect_gradients(gradient);
  if (body.system.nodal_product)
    body.system.nodal_product->update(scale);
  else if (body.model.has_only_diagonal())
    nodal.add_diagonal(scale, body.system.matrix);
  else
    nodal.add_stiffness(scale, body.system.matrix);
}

/// What each tet makes of its gradients ∇N at rest.
template <class Turn>
const Eigen::Matrix3Xd& turn_gradients(Body& body, Turn turn_of_tet) {
  Eigen::Matrix3Xd& gradient = body.scratch.nodal.gradient;
  gradient.resize(3, body.materials.gradient().cols());
  parallel_for(body.model.elements.num_tets(), body.model.threads, [&](std::ptrdiff_t t) {
    gradient.middleCols<4>(4 * t) =
        turn_of_tet(static_cast<int>(t)) * body.materials.gradient().middleCols<4>(4 * t);
  });
  return gradient;
}

void update_nodal_stiffness(Body& body) {
  const MatrixShares share = compute_shares(body);
  if (share.kept != 0.0 && takes_pairs(body))
    add_nodal_stiffness(body, turn_gradients(body, [&](int tet) { return kept_rotation(body, tet); }),
                        share.kept);
  else
    add_nodal_stiffness(body, body.kinematics.turned_gradient(), share.kept);
  if (share.exact == 0.0) return;
  const Strained strained = body.strained();
  add_nodal_stiffness(body, turn_gradients(body, [&](int tet) { return strained.volume_gradient(tet); }),
                      share.exact);
}

void add_contacts(Body& body, std::span<const PointStiffness> contacts) {
  linear::BlockMatrix& matrix = body.system.matrix;
  const double scale = find_contact_scale(body);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const PointStiffness& contact = contacts[c];
    if (!body.contacts.is_acting(contact.group)) continue;
    const Mat3 block = contact.friction > 0.0
                           ? Mat3(scale * body.step_contacts(contacts).stiffness(c, body.contacts))
                           : Mat3(scale * contact.stiffness * contact.normal * contact.normal.transpose());
    for (std::size_t i = 0; i < contact.count(); ++i)
      for (std::size_t j = 0; j < contact.count(); ++j) {
        const int row = body.model.row_of_node[static_cast<std::size_t>(contact.vertex[i])];
        const int column = body.model.row_of_node[static_cast<std::size_t>(contact.vertex[j])];
        if (row < 0 || column < 0) continue;
        const int place = linear::find_block(matrix, row, column);
        if (place < 0) continue;
        matrix.block(place) += contact.weight[i] * contact.weight[j] * block;
        body.system.is_row_stale[static_cast<std::size_t>(row)] = 1;
        ++matrix.revision[static_cast<std::size_t>(row)];
      }
  }
}

/// Held components leave the system: their rows and columns become those of a diagonal matrix.
void mask_rows(const Model& model, linear::BlockMatrix& matrix) {
  for (const int row : model.held_rows) {
    const auto r = static_cast<std::size_t>(row);
    const auto held = model.constraints.support.col(model.node_of_row[r]).array() >= 0;
    for (int b = matrix.row_begin[r]; b < matrix.row_begin[r + 1]; ++b) {
      const int column = matrix.column[static_cast<std::size_t>(b)];
      const int transposed = linear::find_block(matrix, column, row);
      for (int k = 0; k < 3; ++k) {
        if (!held(k)) continue;
        const double diagonal = matrix.block(b)(k, k);
        matrix.block(b).row(k).setZero();
        matrix.block(transposed).col(k).setZero();
        if (column == row) matrix.block(b)(k, k) = diagonal;
      }
    }
  }
}

}  // namespace

bool needs_tangents(const Body& body) {
  const SolidParams& params = body.model.params;
  const ElasticLaw& law = find_law(params.model);
  if (!law.is_quadratic) return true;
  return !law.is_linear && (body.prediction.is_static || params.iteration == Iteration::newton);
}

MatrixShares compute_shares(const Body& body) {
  const bool is_exact = needs_tangents(body);
  if (body.prediction.is_static) return is_exact ? MatrixShares{0.0, 0.0, 1.0} : MatrixShares{0.0, 1.0, 0.0};
  const double tau = body.prediction.tau;
  const double elastic = tau * tau;
  const double viscous = tau * body.model.params.rayleigh_stiffness;
  const double mass = 1.0 + tau * body.model.params.rayleigh_mass;
  return is_exact ? MatrixShares{mass, viscous, elastic} : MatrixShares{mass, elastic + viscous, 0.0};
}

double find_contact_share(const Body& body) {
  const bool is_mean = !body.prediction.is_static && body.model.params.integrator == Integrator::newmark;
  return is_mean ? 2.0 : 1.0;
}

double find_contact_scale(const Body& body) {
  return find_contact_share(body) * body.prediction.tau * body.prediction.tau;
}

Mat3 kept_rotation(const Body& body, int point) {
  const Eigen::Matrix3Xd& kept = body.prediction.kept_rotation;
  const Eigen::Matrix3Xd& R = kept.size() > 0 ? kept : body.kinematics.rotation();
  return R.middleCols<3>(3 * static_cast<Eigen::Index>(point));
}

void assemble_matrix(Body& body, const Part& part, std::span<const PointStiffness> contacts) {
  assemble_tangents(body);
  assemble_rows(body, part);
  if (body.materials.nodal()) update_nodal_stiffness(body);
  if (body.model.params.implicit_contact) add_contacts(body, contacts);
  mask_rows(body.model, body.system.matrix);
}

}  // namespace argil::solid
