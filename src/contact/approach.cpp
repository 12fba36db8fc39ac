#include "contact/approach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>

#include "base/check.h"
#include "contact/nearest.h"

namespace argil::contact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

mesh::Box find_box(const mesh::TriangleMesh& body, std::span<const int> triangles) {
  mesh::Box box;
  for (const int t : triangles)
    for (const int v : body.triangles.col(t)) box.include(Vec3(body.vertices.col(v)));
  return box;
}

/// How far any point of a tool with this reach has moved up to each pose, at most [m].
std::vector<double> sum_motion(std::span<const Pose> poses, double reach) {
  std::vector<double> motion(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Quat& before = poses[i - 1].orientation;
    const Quat& now = poses[i].orientation;
    const double angle = before.coeffs() == now.coeffs() ? 0.0 : before.angularDistance(now);
    motion[i] = motion[i - 1] + (poses[i].position - poses[i - 1].position).norm() + reach * angle;
  }
  return motion;
}

/// Poses from `first` to `last`, none of them nearer than `bound` [m].
struct Stretch {
  double bound;
  std::size_t first, last;
  bool operator<(const Stretch& other) const {  // a queue gives the largest first
    return bound != other.bound ? bound > other.bound : first > other.first;
  }
};

}  // namespace

ApproachFinder::ApproachFinder(const mesh::TriangleMesh& body, ToolSolid tool)
    : m_body(body),
      m_features(body.triangles, body.num_vertices()),
      m_nearest(body.vertices, body.triangles),
      m_surface(mesh::compute_centroids(body.vertices, body.triangles),
                [&](mesh::BoxTree<char>::Node& node, std::span<const int> triangles) {
                  node.box = find_box(body, triangles);
                }),
      m_box(m_surface.node(0).box),
      m_tool(std::move(tool)),
      m_face(m_tool.inner_balls().size(), 0),
      m_tolerance(kTolerance * m_tool.thickness()) {
  ARGIL_ASSERT(body.num_triangles() > 0 && !m_tool.inner_balls().empty());
}

/// Stretches of the way by the least distance that they can have, each halved where its middle was looked at.
Approach ApproachFinder::find(std::span<const Pose> poses, const Vec3& shift, double enough) {
  ARGIL_ASSERT(!poses.empty());
  const std::vector<double> motion = sum_motion(poses, m_tool.reach());
  const std::size_t guess = m_best.pose;
  m_best = {};
  if (guess > 0 && guess < poses.size())
    look({poses[guess].position + shift, poses[guess].orientation}, guess);
  std::priority_queue<Stretch> waiting;
  waiting.push({-kInfinity, 0, poses.size() - 1});
  while (!waiting.empty() && m_best.distance > enough) {
    const Stretch at = waiting.top();
    waiting.pop();
    if (!(at.bound < m_best.distance - m_tolerance)) break;
    const std::size_t middle = at.first + (at.last - at.first) / 2;
    const double bound = look({poses[middle].position + shift, poses[middle].orientation}, middle);
    const auto add = [&](std::size_t first, std::size_t last, double way) {
      const Stretch part{std::max(at.bound, bound - way), first, last};
      if (part.bound < m_best.distance - m_tolerance) waiting.push(part);
    };
    if (middle > at.first) add(at.first, middle - 1, motion[middle] - motion[at.first]);
    if (middle < at.last) add(middle + 1, at.last, motion[at.last] - motion[middle]);
  }
  return m_best;
}

/// No step is longer than the tool still has to go, so that none passes the first place that is as deep.
std::optional<double> ApproachFinder::find_shift(std::span<const Pose> poses, const Vec3& begin,
                                                 const Vec3& direction, double depth, double most) {
  constexpr int kMostSteps = 10000;
  double shift = 0.0;
  for (int step = 0; step < kMostSteps && shift <= most; ++step) {
    const double left = find(poses, begin + shift * direction).distance + depth;
    if (left <= 2.0 * m_tolerance) return shift;
    shift += left;
  }
  return std::nullopt;
}

/// Keeps what is nearer. Returns a distance that the tool is at least away.
double ApproachFinder::look(const Pose& pose, std::size_t number) {
  m_pose = pose;
  m_turn = pose.orientation.toRotationMatrix();
  m_number = number;
  if (m_tool.is_ball()) return look_from_balls(true);
  const double least = look_over_surface();
  // The tool is all on one side of a surface that it does not cross.
  return std::min(least, look_from_balls(least > 0.0));
}

double ApproachFinder::look_from_balls(bool has_one_side) {
  const SurfaceAt body{m_features, m_body.vertices, m_body.vertices};
  const std::vector<InnerBall>& balls = m_tool.inner_balls();
  double least = kInfinity;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    if (i == 1 && has_one_side && least == kInfinity) break;
    const Vec3 centre = m_pose.position + m_turn * balls[i].centre;
    if (!m_tool.is_ball() && m_box.distance(centre) > 0.0) continue;
    const SurfacePoint nearest = find_nearest(body, m_nearest, centre, m_face[i]);
    m_face[i] = nearest.face;
    const double length = std::sqrt(nearest.squared_distance);
    const double sign = is_behind(body, nearest, centre) ? -1.0 : 1.0;
    if (sign > 0.0 && !m_tool.is_ball()) continue;
    const double distance = sign * length - balls[i].radius;
    least = std::min(least, distance);
    const bool is_on_surface = length <= m_tolerance;
    offer(distance, nearest.point,
          is_on_surface ? Vec3(-compute_face_normal(body, nearest.face).normalized())
                        : Vec3(sign * (nearest.point - centre) / length));
  }
  return least;
}

double ApproachFinder::look_over_surface() {
  m_left_out = kInfinity;
  m_surface.descend_by_distance([this](int index) { return find_least(m_surface.node(index).box); },
                                [this](double bound) { return may_be_nearer(bound); },
                                [this](int index) {
                                  for (const int t : m_surface.triangles_of(m_surface.node(index)))
                                    look_at_triangle(t);
                                },
                                [](int) {});
  return m_best.pose == m_number ? std::min(m_left_out, m_best.distance) : m_left_out;
}

/// Of the tool from anything in a box.
double ApproachFinder::find_least(const mesh::Box& box) {
  const double from_ball = box.distance(m_pose.position + m_turn * m_tool.centre()) - m_tool.radius();
  if (from_ball >= m_best.distance) return from_ball;
  const Vec3 middle = m_turn.transpose() * (0.5 * (box.low + box.high) - m_pose.position);
  return std::max(from_ball,
                  m_tool.find_distance(middle, m_tool_face).distance - 0.5 * (box.high - box.low).norm());
}

/// Halves the triangle until no piece can be nearer. The distance changes by no more than the way, and that
/// of a convex tool by no less than its gradient says.
void ApproachFinder::look_at_triangle(int triangle) {
  constexpr double kFlat = 1.0 / 16.0;  // of a tool that need not be convex, over its thickness
  const auto corner = [&](int k) {
    return Vec3(m_turn.transpose() * (m_body.vertices.col(m_body.triangles(k, triangle)) - m_pose.position));
  };
  m_pieces.assign(1, {corner(0), corner(1), corner(2)});
  while (!m_pieces.empty()) {
    const Piece piece = m_pieces.back();
    m_pieces.pop_back();
    const Vec3 middle = (piece[0] + piece[1] + piece[2]) / 3.0;
    double size = 0.0;
    for (const Vec3& x : piece) size = std::max(size, (x - middle).norm());
    if (!may_be_nearer(m_tool.find_least_distance(middle) - size)) continue;
    const ToolDistance found = offer_from_surface(middle);
    const auto along = [&](const Vec3& x) { return found.outward.dot(x - middle); };
    const Vec3& lowest = *std::min_element(piece.begin(), piece.end(),
                                           [&](const Vec3& a, const Vec3& b) { return along(a) < along(b); });
    double bound = found.distance - size;
    if (m_tool.is_convex() || size < kFlat * m_tool.thickness())
      bound = std::max(bound, found.distance + along(lowest));
    if (!may_be_nearer(bound)) continue;
    offer_from_surface(lowest);
    if (!may_be_nearer(bound)) continue;
    std::size_t longest = 0;
    double length = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      if (const double edge = (piece[(k + 1) % 3] - piece[k]).squaredNorm(); edge > length) {
        length = edge;
        longest = k;
      }
    const Vec3 &a = piece[longest], &b = piece[(longest + 1) % 3], &c = piece[(longest + 2) % 3];
    const Vec3 half = 0.5 * (a + b);
    const bool is_a_first = (a - m_tool.centre()).squaredNorm() < (b - m_tool.centre()).squaredNorm();
    m_pieces.push_back({is_a_first ? b : a, half, c});
    m_pieces.push_back({is_a_first ? a : b, half, c});
  }
}

ToolDistance ApproachFinder::offer_from_surface(const Vec3& in_tool) {
  const ToolDistance found = m_tool.find_distance(in_tool, m_tool_face);
  if (found.distance < m_best.distance)
    offer(found.distance, m_pose.position + m_turn * in_tool, m_turn * found.outward);
  return found;
}

void ApproachFinder::offer(double distance, const Vec3& on_body, const Vec3& to_body) {
  if (distance < m_best.distance) m_best = {distance, on_body, to_body, m_number};
}

bool ApproachFinder::may_be_nearer(double bound) {
  if (bound < m_best.distance - m_tolerance) return true;
  m_left_out = std::min(m_left_out, bound);
  return false;
}

}  // namespace argil::contact
