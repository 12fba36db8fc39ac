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

/// Calls mark(loading, unloads) of each point, which says whether it has changed the latter. Returns how many
/// have.
template <class Mark>
double mark_points(Body& body, const Part& part, Mark mark) {
  const Elements& elements = body.model.elements;
  const std::ptrdiff_t Q = elements.points_per_tet;
  const ElasticArrays elastic = body.elastic.arrays();
  const auto mark_point = [&](std::ptrdiff_t p) {
    if (elastic.is_known[p / kLanes] == 0) return false;
    char& unloads = body.system.unloads[static_cast<std::size_t>(p)];
    if (!mark(find_loading(body, body.trial.v, p), unloads)) return false;
    body.system.is_tet_changed[static_cast<std::size_t>(p / Q)] = 1;
    return true;
  };
  return part.batches.sum(elements.num_tets(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    std::ptrdiff_t count = 0;
    for (std::ptrdiff_t p = Q * begin; p < Q * end; ++p) count += mark_point(p) ? 1 : 0;
    return count;
  });
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
  mark_points(body, part, [](double loading, char& unloads) {
    const char before = unloads;
    unloads = loading < -kLeast ? 1 : 0;
    return unloads != before;
  });
}

bool find_unloading(Body& body, const Part& part) {
  constexpr int kMostRounds = 4;
  if (!has_flowing_tangents(body) || body.system.unloading_rounds++ == kMostRounds) return false;
  return mark_points(body, part, [](double loading, char& unloads) {
           const bool is_new = unloads == 0 && loading < -kLeast;
           if (is_new) unloads = 1;
           return is_new;
         }) > 0;
}

}  // namespace argil::solid
