#include "solid/unloading.h"

#include <cmath>

#include <Eigen/LU>

#include "base/mandel.h"
#include "solid/hencky_lanes.h"

namespace argil::solid {
namespace {

/// Of the elastic strain along n, that the step takes back of what is at its yield [of the yield].
constexpr double kLeast = 0.01;

bool has_flowing_tangents(const Body& body) {
  return body.model.params.flows_in_solve && !body.elastic.is_empty() && body.materials.is_isotropic();
}

/// n : dε over the yield, of a point at it; 0 below.
double find_loading(const Body& body, const Points& v, Eigen::Index p) {
  const Vec6 n = find_flow_direction(body, p);
  if (n.isZero(0.0)) return 0.0;
  const Elements& elements = body.model.elements;
  const auto point = static_cast<int>(p);
  const Mat3 H = elements.nodes_per_tet == 4
                     ? find_gradient<4>(elements, body.materials.gradient(), v, point)
                     : find_gradient<10>(elements, body.materials.gradient(), v, point);
  const Mat3 stretch = Mat3::Identity() + from_mandel(body.kinematics.strain().col(p));
  const Mat3 rate = body.kinematics.rotation().middleCols<3>(3 * p).transpose() * H * stretch.inverse();
  return body.prediction.tau * n.dot(to_mandel(0.5 * (rate + rate.transpose()))) / body.materials.yield()(p);
}

/// Calls mark(point, loading) of each point whose elastic strain is known, in runs that threads share, and
/// sums up what it returns.
template <class Mark>
double sum_of_points(Body& body, const Part& part, Mark mark) {
  const Elements& elements = body.model.elements;
  const std::ptrdiff_t Q = elements.points_per_tet;
  const ElasticArrays elastic = body.elastic.arrays();
  return part.batches.sum(elements.num_tets(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    double sum = 0.0;
    for (std::ptrdiff_t p = Q * begin; p < Q * end; ++p)
      if (elastic.is_known[p / kLanes] != 0) sum += mark(p, find_loading(body, body.trial.v, p));
    return sum;
  });
}

void set_unloads(Body& body, std::ptrdiff_t point, bool unloads) {
  const int Q = body.model.elements.points_per_tet;
  body.system.unloads[static_cast<std::size_t>(point)] = unloads ? 1 : 0;
  body.system.is_tet_changed[static_cast<std::size_t>(point / Q)] = 1;
}

bool unloads(const Body& body, std::ptrdiff_t point) {
  return body.system.unloads[static_cast<std::size_t>(point)] != 0;
}

/// Σ ‖fᵢ‖² over the corners [N²], fᵢ = V 2μ (n : dε) n ∇Nᵢ, of a point whose elastic resistance along n was
/// left out.
double find_missing_force(const Body& body, std::ptrdiff_t p, double loading) {
  const Mat3 n = from_mandel(find_flow_direction(body, p));
  const double stress = 2.0 * body.materials.point_mu()(p) * loading * body.materials.yield()(p);
  double sum = 0.0;
  for (int corner = 0; corner < 4; ++corner)
    sum += (n * body.materials.gradient().col(4 * p + corner)).squaredNorm();
  return std::pow(body.materials.weight()(p) * stress, 2) * sum;
}

}  // namespace

Vec6 find_flow_direction(const Body& body, Eigen::Index point) {
  const ElasticArrays elastic = body.elastic.arrays();
  if (!elastic.strain || elastic.is_known[point / kLanes] == 0) return Vec6::Zero();
  const double* of_point = elastic.strain + 6 * point;
  Vec6 n;
  n << of_point[0], of_point[1], of_point[2], kSqrt2 * of_point[3], kSqrt2 * of_point[4],
      kSqrt2 * of_point[5];
  n.head<3>().array() -= n.head<3>().mean();
  const double norm = n.norm();
  if (!(norm > 0.0 && norm >= kAtYield * body.materials.yield()(point))) return Vec6::Zero();
  return n / norm;
}

void begin_unloading(Body& body, const Part& part) {
  body.system.unloading_rounds = 0;
  if (!has_flowing_tangents(body)) return;
  sum_of_points(body, part, [&](std::ptrdiff_t p, double loading) {
    if (unloads(body, p) != (loading < -kLeast)) set_unloads(body, p, loading < -kLeast);
    return 0.0;
  });
}

bool find_unloading(Body& body, const Part& part, double enough) {
  constexpr int kMostRounds = 4;
  if (!has_flowing_tangents(body) || body.system.unloading_rounds++ == kMostRounds) return false;
  const auto is_new = [&](std::ptrdiff_t p, double loading) {
    return loading < -kLeast && !unloads(body, p);
  };
  const double left =
      body.prediction.tau * std::sqrt(sum_of_points(body, part, [&](std::ptrdiff_t p, double loading) {
        return is_new(p, loading) ? find_missing_force(body, p, loading) : 0.0;
      }));
  if (left <= enough) return false;
  sum_of_points(body, part, [&](std::ptrdiff_t p, double loading) {
    if (is_new(p, loading)) set_unloads(body, p, true);
    return 0.0;
  });
  return true;
}

}  // namespace argil::solid
