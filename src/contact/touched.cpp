// Touched area: the part of each body triangle that lies inside the tool at the end of the interval.

#include <algorithm>
#include <array>
#include <cmath>

#include "contact/detector.h"
#include "contact/triangle_pieces.h"

namespace argil::contact {
namespace {

/// For tools of any shape: by quartering the triangle.
struct Measure {
  SurfaceAt tool;
  BoundingTree& tree;
  int guess = 0;  ///< tool face near the last point that was asked for

  double find_distance(const Vec3& p) { return find_signed_distance(tool, tree, p, guess); }

  /// Share of a triangle inside the tool. The distance to a surface changes by no more than the point moves,
  /// so a triangle whose centre is farther than its corners is wholly on one side; others are quartered, and
  /// on the last level the distance is taken as linear between the corners.
  double compute_share(const std::array<Vec3, 3>& x, int level) {
    const Vec3 centre = (x[0] + x[1] + x[2]) / 3.0;
    const double reach = std::sqrt(std::max(
        {(x[0] - centre).squaredNorm(), (x[1] - centre).squaredNorm(), (x[2] - centre).squaredNorm()}));
    const double d = find_distance(centre);
    if (d >= reach) return 0.0;
    if (d <= -reach) return 1.0;
    if (level == 0)
      return compute_negative_share({find_distance(x[0]), find_distance(x[1]), find_distance(x[2])});
    double sum = 0.0;
    for (const std::array<Vec3, 3>& part : quarter(x)) sum += compute_share(part, level - 1);
    return 0.25 * sum;
  }
};

/// Keeps of a polygon what lies behind a plane.
void clip(std::vector<Vec3>& polygon, std::vector<Vec3>& work, const Vec3& normal, const Vec3& on_plane) {
  bool is_cut = false;
  for (const Vec3& p : polygon) is_cut = is_cut || normal.dot(p - on_plane) > 0.0;
  if (!is_cut) return;
  work.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& p = polygon[i];
    const Vec3& q = polygon[(i + 1) % polygon.size()];
    const double dp = normal.dot(p - on_plane);
    const double dq = normal.dot(q - on_plane);
    if (dp <= 0.0) work.push_back(p);
    if ((dp <= 0.0) != (dq <= 0.0)) work.push_back(p + dp / (dp - dq) * (q - p));
  }
  std::swap(polygon, work);
}

double compute_area(const std::vector<Vec3>& polygon) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
  return 0.5 * sum.norm();
}

}  // namespace

/// Area of a body's triangle inside the tool at the end of the interval [m²]. A convex tool cuts a convex
/// polygon out of the triangle, and only faces that meet the triangle bound it: from a common point, every
/// way out of the tool within the triangle leads through one of them. Cutting by their planes is therefore
/// exact when there is a common point, which the polygon's centre then is, and else the centre tells.
double ContactDetector::Impl::compute_overlap(int body_face, const Motion& m, Worker& worker) const {
  const Eigen::Vector3i corner = body.triangles.col(body_face);
  const std::array<Vec3, 3> x = {m.body_t1.col(corner(0)), m.body_t1.col(corner(1)),
                                 m.body_t1.col(corner(2))};
  mesh::Box box;
  for (const Vec3& p : x) box.include(p);
  if (!box.overlaps(worker.tool_tree.bounds())) return 0.0;
  if (compute_nearest_on_triangle(centre_t1, x[0], x[1], x[2]).squared_distance > tool_radius * tool_radius)
    return 0.0;
  const SurfaceAt at{tool, m.tool_t0, m.tool_t1};
  if (!tool_is_convex) {
    const double longest = std::sqrt(
        std::max({(x[1] - x[0]).squaredNorm(), (x[2] - x[1]).squaredNorm(), (x[0] - x[2]).squaredNorm()}));
    constexpr int kMaxLevel = 5;
    int level = 0;  // fine enough to see the tool's own facets
    for (double size = longest; level < kMaxLevel && size > tool_edge_length; size *= 0.5) ++level;
    Measure measure{at, worker.tool_tree};
    return measure.compute_share(x, level) * 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
  }
  const auto is_surely_inside = [&](const Vec3& p) {
    return (p - centre_t1).squaredNorm() < tool_inner_radius * tool_inner_radius;
  };
  std::vector<Vec3>& polygon = worker.polygon;
  polygon.assign(x.begin(), x.end());
  if (std::all_of(x.begin(), x.end(), is_surely_inside)) return compute_area(polygon);
  worker.tool_candidates.clear();
  worker.tool_tree.find_overlaps(box, at.x_t0, at.x_t1, worker.tool_candidates);
  for (const int face : worker.tool_candidates)
    clip(polygon, worker.clip_work, compute_face_normal(at, face), at.corner(face, 0));
  if (polygon.size() < 3) return 0.0;
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : polygon) centre += p / static_cast<double>(polygon.size());
  if (is_surely_inside(centre)) return compute_area(polygon);
  const int guess = worker.tool_candidates.empty() ? 0 : worker.tool_candidates.front();
  return is_inside(at, worker.tool_tree, centre, guess) ? compute_area(polygon) : 0.0;
}

void ContactDetector::Impl::measure_touched(const Motion& m, Contacts& out) {
  if (!out.with_touched) return;
  if (out.contacts.empty() && tool_vertices.inside.empty() && body_vertices.inside.empty()) return;
  std::sort(body_candidates.begin(), body_candidates.end());
  areas.resize(body_candidates.size());
  each_item(areas.size(), [&](Worker& worker, std::size_t i) {
    areas[i] = compute_overlap(body_candidates[i], m, worker);
  });
  for (std::size_t i = 0; i < areas.size(); ++i) {
    if (!(areas[i] > 0.0)) continue;
    out.touched_triangle.push_back(body_candidates[i]);
    out.touched_area.push_back(areas[i]);
  }
}

}  // namespace argil::contact
