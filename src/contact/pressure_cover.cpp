// Which of the body's triangles the tool is near, and how much of each it covers.

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "base/lanes.h"
#include "contact/pressure.h"
#include "contact/triangle_pieces.h"

namespace argil::contact {
namespace {

constexpr double kLeastRadius = 0.25;   // of that of the covered area
constexpr double kFarthestNear = 0.25;  // of the tool's radius
constexpr int kMostLevels = 14;         // of splitting a triangle in four
constexpr double kMostPieces = 2.6e5;   // of all triangles near the tool
// From the ball that holds what the tool sweeps, a face is near whose middle is as far as its corners and its
// band, over the sum of the sides of its box: a corner is at most 2/3 of the longest edge away, a band is
// kWidestBand of twice that.
constexpr double kPerSide = 1.07;
const Vec3 kMiddle = find_centre({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()});  // weights

/// Mean over the corners of how near each is to the tool: 1 inside, 0 farther than `band`.
double compute_share_within(const std::array<double, 3>& distance, double band) {
  double sum = 0.0;
  for (const double d : distance) sum += std::clamp(1.0 - d / band, 0.0, 1.0);
  return sum / 3.0;
}

}  // namespace

/// Of the body, what the ball around the tool comes near; of a body that is solved for, also what it may come
/// near as it follows the tool: by what both have moved since the last call.
void PressureContact::find_faces(const Points& x) {
  m_margin = finds_near() ? std::min(m_way + m_motion, kFarthestNear * m_tool.radius()) : 0.0;
  mesh::Box box;
  for (const Place& place : m_places) {
    const Vec3 centre = place.position + place.turn.transpose() * m_tool.centre();
    box.include(centre);
    if (!m_passage) continue;
    box.include(centre - m_passage->length * m_passage->inward);
    box.include(centre + m_passage->retreat * m_passage->inward);
  }
  const double radius = 0.5 * (box.high - box.low).norm() + m_tool.radius() + m_margin;
  const mesh::Box query = box.grown(m_tool.radius() + m_margin);
  const Vec3 centre = 0.5 * (box.low + box.high);
  find_candidates(query, {centre, radius, kPerSide}, x);
  m_faces.clear();
  find_reached(centre, radius);
  if (goes_in_lanes()) return find_ball_faces(query, x);
  for (const int place : m_reached) {
    PlacedFace face;
    face.number = m_candidates[static_cast<std::size_t>(place)];
    if (find_face(query, x, face)) m_faces.push_back(face);
  }
  for (const VertexNearness& known : m_nearness)
    m_place_of_vertex[static_cast<std::size_t>(known.vertex)] = -1;
  m_nearness.clear();
}

/// By how much nearer to the ball a triangle may count after a motion along any axis [m]: its box comes
/// nearer, and the sum of that one's sides grows.
double PressureContact::find_nearing(double motion) {
  return (std::numbers::sqrt3 + 6.0 * kPerSide) * motion;
}

/// Of the surface at x, triangles whose boxes meet the query, and some others. They are found for some calls
/// ahead: for queries that are larger, which hold the next ones as long as tool and body have hardly moved.
void PressureContact::find_candidates(const mesh::Box& query, const BoundingTree::Reach& reach,
                                      const Points& x) {
  // What has moved so far that too many count as reached [of the tool's radius].
  constexpr double kStale = 0.02;
  if (m_ahead) {
    const double needed = (reach.centre - m_ahead->reach.centre).norm() + reach.radius;
    const bool holds = (m_ahead->box.low.array() <= query.low.array()).all() &&
                       (m_ahead->box.high.array() >= query.high.array()).all() &&
                       needed <= m_ahead->reach.radius;
    if (holds && m_balls.motion > kStale * m_tool.radius()) keep_balls(x);
    if (holds) return;
  }
  constexpr double kCalls = 8.0;     // for so many, if they go on like this,
  constexpr double kFarthest = 0.1;  // but no farther ahead than this part of the tool's radius
  const double ahead = std::min(kCalls * (m_way + find_nearing(m_motion)), kFarthest * m_tool.radius());
  m_ahead = {query.grown(ahead), {reach.centre, reach.radius + ahead, reach.per_side}};
  m_candidates.clear();
  m_tree->find_overlaps(m_ahead->box, m_ahead->reach, x, m_candidates);
  sort_candidates();
  keep_balls(x);
  number_vertices();
}

/// By number, each once as they are.
void PressureContact::sort_candidates() {
  constexpr std::size_t kBits = 64;
  for (const int number : m_candidates)
    m_is_candidate[static_cast<std::size_t>(number) / kBits] |= std::uint64_t{1}
                                                                << (static_cast<unsigned>(number) % kBits);
  m_candidates.clear();
  for (std::size_t word = 0; word < m_is_candidate.size(); ++word)
    for (std::uint64_t& bits = m_is_candidate[word]; bits != 0; bits &= bits - 1)
      m_candidates.push_back(static_cast<int>(kBits * word) + std::countr_zero(bits));
}

void PressureContact::number_vertices() {
  m_vertices.number.clear();
  m_candidate_corners.clear();
  for (const int number : m_candidates) {
    std::array<int, 3>& corners = m_candidate_corners.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const int vertex = m_surface(static_cast<Eigen::Index>(k), number);
      int& place = m_place_of_vertex[static_cast<std::size_t>(vertex)];
      if (place < 0) {
        place = static_cast<int>(m_vertices.number.size());
        m_vertices.number.push_back(vertex);
      }
      corners[k] = place;
    }
  }
  for (const int vertex : m_vertices.number) m_place_of_vertex[static_cast<std::size_t>(vertex)] = -1;
}

void PressureContact::keep_balls(const Points& x) {
  m_balls.motion = 0.0;
  for (std::vector<double>& of_axis : m_balls.centre) of_axis.clear();
  m_balls.radius.clear();
  for (const int number : m_candidates) {
    const Eigen::Vector3i vertex = m_surface.col(number);
    const std::array<Vec3, 3> corners = {x.col(vertex(0)), x.col(vertex(1)), x.col(vertex(2))};
    const PlacedPiece whole = place_piece(corners, find_centre(corners));
    for (std::size_t k = 0; k < 3; ++k)
      m_balls.centre[k].push_back(whole.centre(static_cast<Eigen::Index>(k)));
    m_balls.radius.push_back(whole.reach);
  }
  constexpr double kNowhere = 1e150;  // [m]
  while (m_balls.radius.size() % kLanes != 0) {
    for (std::vector<double>& of_axis : m_balls.centre) of_axis.push_back(kNowhere);
    m_balls.radius.push_back(0.0);
  }
}

/// Of the candidates, those that find_face() may find near a tool in this ball: eight at a time, by where
/// they were when they were found. A passage reaches beyond the ball; there it is all of them.
ARGIL_EVERY_PROCESSOR void PressureContact::find_reached(const Vec3& centre, double radius) {
  m_reached.clear();
  // As far as a middle may have come since then, and a corner from it.
  const double moved = (1.0 + 1e-9) * std::numbers::sqrt3 * m_balls.motion;
  const double widest = has_band() ? 2.0 * kWidestBand : 0.0;
  for (std::size_t begin = 0; begin < m_candidates.size(); begin += kLanes) {
    Lanes x, y, z, reach;
    read(m_balls.centre[0].data() + begin, x);
    read(m_balls.centre[1].data() + begin, y);
    read(m_balls.centre[2].data() + begin, z);
    read(m_balls.radius.data() + begin, reach);
    x -= centre(0);
    y -= centre(1);
    z -= centre(2);
    reach += 2.0 * moved;
    const Lanes band = widest * reach;
    const Lanes most = (1.0 + 1e-9) * ((radius + moved) + reach + band);
    const Lanes is_far = x * x + y * y + z * z < most * most ? Lanes{} : Lanes{} + 1.0;
    const std::size_t count = std::min<std::size_t>(kLanes, m_candidates.size() - begin);
    for (std::size_t k = 0; k < count; ++k)
      if (m_passage || is_far[k] == 0.0) m_reached.push_back(static_cast<int>(begin + k));
  }
}

/// Measures a face. False where the tool is not near it.
bool PressureContact::find_face(const mesh::Box& query, const Points& x, PlacedFace& face) {
  const Eigen::Vector3i vertex = m_surface.col(face.number);
  for (Eigen::Index k = 0; k < 3; ++k) face.x[static_cast<std::size_t>(k)] = x.col(vertex(k));
  const PlacedPiece whole = place_piece(face.x, face.at(kMiddle));
  // No edge is longer than twice the way to the farthest corner, and no band wider than this of it.
  const double widest = has_band() ? kWidestBand * 2.0 * whole.reach : 0.0;
  const double most = whole.reach + std::max(widest, m_margin);
  const LeastDistance found = find_least_distance(whole.centre, most);
  if (found.distance >= most) return false;
  mesh::Box box;
  for (const Vec3& corner : face.x) box.include(corner);
  if (!box.overlaps(query)) return false;
  const Vec3 a = face.x[1] - face.x[0];
  const Vec3 b = face.x[2] - face.x[0];
  const Vec3 normal = a.cross(b);
  face.area = 0.5 * normal.norm();
  if (!(face.area > 0.0)) return false;
  face.normal = normal / (2.0 * face.area);
  if (m_passage && facing_share(m_passage->inward, face.normal) == 0.0) return false;
  const double longest = std::sqrt(std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()}));
  face.size = std::max(0.5 * longest, std::sqrt(4.0 / std::numbers::sqrt3 * face.area));
  const double band = has_band() ? find_band_of_side(face.size) : 0.0;
  if (found.distance < whole.reach + band)
    face.whole = cover_piece(face, whole, face.area, found, band, [&](std::size_t k) {
      return find_vertex_nearness(vertex(static_cast<Eigen::Index>(k)), face.x[k]);
    });
  const bool is_within_margin = m_margin > 0.0 && found.distance < whole.reach + m_margin;
  return face.whole.area > 0.0 || face.whole.may_touch || is_within_margin;
}

PressureContact::PlacedFace PressureContact::place_face(const Face& face, const Points& x) const {
  PlacedFace placed{face, {}, {}};
  for (std::size_t k = 0; k < 3; ++k)
    placed.x[k] = x.col(m_surface(static_cast<Eigen::Index>(k), face.number));
  const Vec3 normal = (placed.x[1] - placed.x[0]).cross(placed.x[2] - placed.x[0]);
  placed.normal = normal / (2.0 * face.area);
  return placed;
}

/// The same for all faces of a vertex.
PressureContact::Nearness PressureContact::find_vertex_nearness(int vertex, const Vec3& x) {
  int& place = m_place_of_vertex[static_cast<std::size_t>(vertex)];
  if (place < 0) {
    place = static_cast<int>(m_nearness.size());
    m_nearness.push_back({vertex, find_nearness(x, kAnywhere)});
  }
  return m_nearness[static_cast<std::size_t>(place)].nearness;
}

PressureContact::PlacedPiece PressureContact::place_piece(const std::array<Vec3, 3>& x, const Vec3& centre) {
  double squared_reach = 0.0;
  for (const Vec3& corner : x) squared_reach = std::max(squared_reach, (corner - centre).squaredNorm());
  return {x, centre, std::sqrt(squared_reach)};
}

PressureContact::Cover& PressureContact::Cover::operator+=(const Cover& other) {
  area += other.area;
  facing_area += other.facing_area;
  may_touch = may_touch || other.may_touch;
  return *this;
}

/// How far from the tool the corners of a face's pieces of `level` still count in part as covered [m]: three
/// times as far as those of a regular triangle are whose middle touches a ball like the tool. So about the
/// same area is covered whether corners or points between them hold the face up, and it changes by degrees as
/// the tool slides.
double PressureContact::find_band(const Face& face, int level) const {
  return has_band() ? find_band_of_side(std::ldexp(face.size, -level)) : 0.0;
}

double PressureContact::find_band_of_side(double side) const {
  return std::min(0.5 * side * side / m_tool.radius(), kWidestBand * side);
}

/// Of a piece of a triangle, the distance taken as linear on its pieces of `level`. As the distance changes
/// by no more than the point moves, a piece whose centre is farther than its corners is wholly on one side.
/// With a `band`, of a face whose corners count by how near they are.
PressureContact::Cover PressureContact::measure_cover(const PlacedFace& face, const Piece& piece, int level,
                                                      double band) {
  ++m_num_measured;
  const PlacedPiece placed =
      place_piece({face.at(piece[0]), face.at(piece[1]), face.at(piece[2])}, face.at(find_centre(piece)));
  const LeastDistance found = find_least_distance(placed.centre, placed.reach + band);
  if (found.distance >= placed.reach + band) return {};
  if (level > 0 && found.distance > -placed.reach) {
    Cover sum;
    for (const Piece& part : quarter(piece)) sum += measure_cover(face, part, level - 1, band);
    return sum;
  }
  const double area = 0.5 * (placed.x[1] - placed.x[0]).cross(placed.x[2] - placed.x[0]).norm();
  return cover_piece(face, placed, area, found, band,
                     [&](std::size_t k) { return find_nearness(placed.x[k], kAnywhere); });
}

/// Of a piece of this area whose middle is `found` from the tool, and corner k find_corner(k).
template <class FindCorner>
PressureContact::Cover PressureContact::cover_piece(const PlacedFace& face, const PlacedPiece& piece,
                                                    double area, const LeastDistance& found, double band,
                                                    FindCorner find_corner) {
  Nearness deepest{found.distance, found.place};
  const Vec3* at = &piece.centre;
  double share = 1.0;
  if (found.distance > -piece.reach) {
    std::array<double, 3> distance;
    for (std::size_t k = 0; k < 3; ++k) {
      const Nearness corner = find_corner(k);
      distance[k] = corner.distance;
      if (!(corner.distance < deepest.distance) || found.distance < 0.0) continue;
      deepest = corner;
      at = &piece.x[k];
    }
    share = band > 0.0 ? compute_share_within(distance, band) : compute_negative_share(distance);
  }
  area *= share;
  double facing = facing_share(found.outward, face.normal);
  if (m_yielding == Yielding::no && !m_passage && facing < 1.0 && deepest.distance < 0.0)
    facing = std::max(facing, find_held_facing(*at, face.normal, *deepest.place));
  return {area, area * facing, share == 0.0};
}

/// A tool that lies along the surface touches little of what is near at first. After a pass over all faces
/// with pieces of this level, each further one takes four times as many pieces at most.
void PressureContact::limit_levels(int pass) {
  const auto count = [](std::size_t pieces) {
    return static_cast<int>(std::max(0.0, 0.5 * std::log2(kMostPieces / static_cast<double>(pieces))));
  };
  m_most_levels = std::min(kMostLevels, std::max(count(m_faces.size()), pass + count(m_num_measured)));
}

/// Radius of a disc as large as the patch, 0 where nothing is touched [m]: the one that is found with pieces
/// of just that size. Between two halvings of the pieces it is interpolated, so that it has no jump.
double PressureContact::find_patch_radius(const Points& x) {
  double spacing = 0.0;
  for (const Face& face : m_faces) spacing = std::max(spacing, face.size);
  double coarser = 0.0;  // the radius with pieces twice as large
  m_most_levels = kMostLevels;
  for (int pass = 0; pass <= m_most_levels; ++pass, spacing *= 0.5) {
    Cover patch;
    m_num_measured = m_faces.size();
    for (const Face& face : m_faces) {
      const double levels = face.size > spacing ? std::ceil(std::log2(face.size / spacing) - 1e-9) : 0.0;
      patch += measure_cover(face, static_cast<int>(levels), x);
    }
    limit_levels(pass);
    if (patch.facing_area == 0.0 && !patch.may_touch) return 0.0;
    // As large as this part of all that is covered, however little of it faces the tool.
    const double least = kLeastRadius * std::sqrt(patch.area / std::numbers::pi);
    const double radius = std::max(least, std::sqrt(patch.facing_area / std::numbers::pi));
    if (spacing <= radius) {
      if (coarser == 0.0) return radius;
      const double above = std::log2(2.0 * spacing / coarser);
      const double part = above / (above + std::log2(radius / spacing));
      return std::pow(coarser, 1.0 - part) * std::pow(radius, part);
    }
    coarser = radius;
  }
  return 2.0 * spacing;  // smaller than can be told: as small as a piece
}

/// Three places within a face, whose mean is exact for what grows with the square of the way: a ball's depth
/// below a flat face is less at its corners than between them. A face that is not pressed as a whole does not
/// tell: a rim may cross it.
double PressureContact::find_sag(const Points& x, double force) {
  if (m_passage || m_places.empty() || !(force > 0.0)) return 0.0;
  const Place& end = m_places.back();
  double sum = 0.0;
  for (const Face& each : m_faces) {
    if (!(each.by_corners > 0.0) || !each.has_near_corner) continue;
    const PlacedFace face = place_face(each, x);
    double at_corners = 0.0, between = 0.0, facing = 0.0;
    bool presses = true;
    for (const Vec3& corner : face.x) {
      const double depth = -find_distance(corner, end, kAnywhere).distance;
      presses = presses && depth > 0.0;
      at_corners += depth;
    }
    if (!presses) continue;
    for (Eigen::Index k = 0; k < 3; ++k) {
      Vec3 weight = Vec3::Constant(1.0 / 6.0);
      weight(k) = 2.0 / 3.0;
      const ToolDistance found = find_distance(face.at(weight), end, kAnywhere);
      between -= found.distance;
      facing += facing_share(found.outward, face.normal) / 3.0;
    }
    const double of_face = face.by_corners * face.area / 3.0 * stiffness_of(face) * at_corners * facing;
    sum += of_face * (between - at_corners) / 3.0;
  }
  return sum / force;
}

}  // namespace argil::contact
