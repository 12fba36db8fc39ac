#include "contact/pressure.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/check.h"
#include "base/lanes.h"
#include "contact/triangle_pieces.h"

namespace argil::contact {
namespace {

// Where the body cannot give way:
constexpr double kFinerOnRigid = 2.0;  // points along a line, over those where it can
constexpr int kMostHalvings = 4;       // of pieces on which the way out of the tool turns,
constexpr double kTurned = 0.9;        // whose cosine to that at the middle is less

/// The largest |b − a| of the numbers at both.
ARGIL_EVERY_PROCESSOR double find_largest_change(const double* a, const double* b, std::ptrdiff_t count) {
  constexpr int kChains = 4;
  Lanes largest[kChains] = {};
  std::ptrdiff_t i = 0;
  for (; i + kChains * kLanes <= count; i += kChains * kLanes)
    for (int c = 0; c < kChains; ++c) {
      Lanes from, to;
      read(a + i + kLanes * c, from);
      read(b + i + kLanes * c, to);
      const Lanes change = to - from;
      const Lanes size = change > 0.0 ? change : -change;
      largest[c] = size > largest[c] ? size : largest[c];
    }
  double most = 0.0;
  for (; i < count; ++i) most = std::max(most, std::abs(b[i] - a[i]));
  for (const Lanes& chain : largest)
    for (int k = 0; k < kLanes; ++k) most = std::max(most, chain[k]);
  return most;
}

}  // namespace

PressureContact::PressureContact(const Triangles& surface, int num_vertices, ToolSolid tool,
                                 SurfaceStiffness stiffness, bool is_solved_for, PenaltyKind penalty)
    : m_surface(surface),
      m_tool(std::move(tool)),
      m_stiffness(std::move(stiffness)),
      m_is_solved_for(is_solved_for),
      m_penalty(penalty),
      m_passages(m_tool.inner_balls().size(), surface.cols()),
      m_corner_of_vertex(static_cast<std::size_t>(num_vertices), -1),
      m_place_of_vertex(m_corner_of_vertex) {
  ARGIL_ASSERT(m_stiffness.per_area.size() == surface.cols(), m_stiffness.per_area.size());
  m_places.reserve(kMostPlaces);
  m_candidates.reserve(static_cast<std::size_t>(surface.cols()));
  m_reached.reserve(m_candidates.capacity());
  m_faces.reserve(m_candidates.capacity());
  for (std::vector<double>& of_axis : m_balls.centre) of_axis.reserve(m_candidates.capacity() + kLanes);
  m_balls.radius.reserve(m_candidates.capacity() + kLanes);
  m_is_candidate.resize(m_candidates.capacity() / 64 + 1);
  m_candidate_corners.reserve(m_candidates.capacity());
  m_vertices.number.reserve(m_corner_of_vertex.size());
  m_vertices.placed.reserve(4 * m_corner_of_vertex.size());
  m_corners.reserve(m_corner_of_vertex.size());
  m_nearness.reserve(m_corner_of_vertex.size());
}

void PressureContact::prepare(const Points& x) {
  m_tree.emplace(x, m_surface);
  m_ahead.reset();
  m_motion = 0.0;
}

void PressureContact::exchange(std::span<StiffnessOfTriangle> list) {
  for (StiffnessOfTriangle& of : list) {
    std::swap(of.per_area, m_stiffness.per_area(of.triangle));
    std::swap(of.modulus, m_stiffness.modulus(of.triangle));
  }
}

void PressureContact::add_contact(const std::array<int, 3>& vertex, int triangle, const Vec3& weight,
                                  const PointDepth& depth, double stiffness, const Vec3& point,
                                  Contacts& out) const {
  const bool touches = depth.mean > 0.0 || depth.begin > 0.0;
  if (!(stiffness > 0.0) || (!touches && !(finds_near() && is_near(depth)))) return;
  Contact& c = (touches ? out.contacts : out.near).emplace_back();
  c.vertex = vertex;
  c.weight = {weight(0), weight(1), weight(2)};
  c.triangle = triangle;
  c.normal = depth.outward;
  c.force = stiffness * (touches ? depth.mean : depth.end) * depth.outward;
  c.stiffness = touches ? stiffness * depth.share : stiffness;
  c.end_force = stiffness * std::max(0.0, depth.end);
  c.end_stiffness = depth.end > 0.0 ? stiffness : 0.0;
  c.passes = depth.end <= 0.0;
  c.spring = stiffness;
  c.begin_force = stiffness * std::max(0.0, depth.begin);
  c.point = point;
}

void PressureContact::press_corners(const PlacedFace& face, double share) {
  for (std::size_t k = 0; k < 3; ++k) {
    const int vertex = m_surface(static_cast<Eigen::Index>(k), face.number);
    int& place = m_corner_of_vertex[static_cast<std::size_t>(vertex)];
    if (place < 0) {
      place = static_cast<int>(m_corners.size());
      m_corners.push_back({vertex, find_depth(face.x[k])});
    }
    Corner& corner = m_corners[static_cast<std::size_t>(place)];
    const PointDepth& depth = corner.depth;
    if (!(depth.mean > 0.0 || depth.begin > 0.0 || is_near(depth))) continue;
    const double area = share * face.area / 3.0 * facing_share(corner.depth.outward, face.normal);
    corner.stiffness += area * stiffness_of(face);
  }
}

PressureContact::FacePiece PressureContact::take_whole(const PlacedFace& face) {
  return {kWhole, face.x};
}

std::array<PressureContact::FacePiece, 4> PressureContact::quarter_piece(const PlacedFace& face,
                                                                         const FacePiece& piece) {
  const std::array<Piece, 4> parts = quarter(piece.weight);
  const std::array<Vec3, 3>& corner = piece.x;
  const std::array<Vec3, 3> middle = {face.at(parts[3][0]), face.at(parts[3][1]), face.at(parts[3][2])};
  return {{{parts[0], {corner[0], middle[0], middle[2]}},
           {parts[1], {middle[0], corner[1], middle[1]}},
           {parts[2], {middle[2], middle[1], corner[2]}},
           {parts[3], middle}}};
}

/// How far the corners of a piece are from its middle [m].
double PressureContact::find_reach(const FacePiece& piece, const Vec3& middle) {
  double squares = 0.0;
  for (const Vec3& corner : piece.x) squares = std::max(squares, (corner - middle).squaredNorm());
  return std::sqrt(squares);
}

/// Does the way out of the tool change its direction on a piece that it covers? From one side of a sharp tip
/// to the other it jumps, where the tip is deepest.
bool PressureContact::turns(const FacePiece& piece, const Vec3& centre) {
  const LeastDistance middle = find_least_distance(centre, kAnywhere);
  const double reach = find_reach(piece, centre);
  if (middle.distance >= reach) return false;
  return std::any_of(piece.x.begin(), piece.x.end(), [&](const Vec3& corner) {
    const LeastDistance found = find_least_distance(corner, kAnywhere);
    return found.distance < reach && found.outward.dot(middle.outward) < kTurned;
  });
}

/// Of the first pieces of a face that stays flat, beside which corners press. It takes pieces of a ball's
/// depth as soon as they count at all, however small their part, and its corners come off it. So a part of
/// them that grows from nothing would jump, the more the stiffer κ. What grows is how far they are below the
/// plane of the corners' depths: κ has no say in it.
PressureContact::PieceRule PressureContact::make_first_rule(const Face& face, double share,
                                                            double own_depth) const {
  PieceRule rule{share, own_depth};
  for (std::size_t k = 0; k < 3; ++k) {
    const int vertex = m_surface(static_cast<Eigen::Index>(k), face.number);
    const int place = m_corner_of_vertex[static_cast<std::size_t>(vertex)];
    rule.corner[k] = m_corners[static_cast<std::size_t>(place)].depth;
  }
  return rule;
}

void PressureContact::lower(const PieceRule& rule, const Vec3& weight, PointDepth& depth) {
  double begin = 0.0, end = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    begin += weight(static_cast<Eigen::Index>(k)) * rule.corner[k].begin;
    end += weight(static_cast<Eigen::Index>(k)) * rule.corner[k].end;
  }
  depth.begin = begin + rule.own_depth * (depth.begin - begin);
  depth.end = end + rule.own_depth * (depth.end - end);
  const bool touches = depth.begin > 0.0 || depth.end > 0.0;
  depth.mean = touches ? depth.end : 0.0;
  depth.share = touches ? 1.0 : 0.0;
}

/// Each piece of `level` presses with its centre; on rigid faces those that the tool's edges cross are split
/// on.
PressureContact::Cover PressureContact::press_pieces(const PlacedFace& face, const FacePiece& piece,
                                                     int level, const PieceRule& rule, Contacts& out) {
  const Vec3 centre = find_centre(piece.weight);
  const Vec3 x = face.at(centre);
  const auto press_parts = [&] {
    Cover sum;
    for (const FacePiece& part : quarter_piece(face, piece))
      sum += press_pieces(face, part, level - 1, rule, out);
    return sum;
  };
  if (level > 0) {
    const double reach = find_reach(piece, x);
    const double distance = find_nearness(x, reach + m_margin).distance;
    if (distance >= reach + m_margin) return {};
    // What the tool may only come near is seen no finer than the patch that it would make there.
    if (distance < reach || reach > std::sqrt(m_tool.radius() * m_margin) / 6.0) return press_parts();
  }
  if (level <= 0 && level > -kMostHalvings && is_rigid(face) && turns(piece, x)) return press_parts();
  const bool yields = m_yielding == Yielding::yes;
  PointDepth depth = yields ? find_depth(x) : find_held_depth(x, face.normal);
  if (rule.own_depth < 1.0) lower(rule, centre, depth);
  if (depth.mean > 0.0 || depth.begin > 0.0 || finds_near()) {
    const Vec3 a = piece.x[1] - piece.x[0];
    const Vec3 b = piece.x[2] - piece.x[0];
    const double area = rule.share * 0.5 * a.cross(b).norm() * facing_share(depth.outward, face.normal);
    const Eigen::Vector3i v = m_surface.col(face.number);
    add_contact({v(0), v(1), v(2)}, face.number, centre, depth, area * stiffness_of(face), x, out);
  }
  // Where κ hangs on the patch's area, once finer than the pressure.
  return m_needs_cover ? measure_cover(face, piece.weight, yields ? 0 : 1) : Cover{};
}

bool PressureContact::is_rigid(const Face& face) const {
  return !m_stiffness.is_rigid.empty() && m_stiffness.is_rigid[static_cast<std::size_t>(face.number)] != 0;
}

/// With pieces of about the size `spacing`: between two numbers of halvings, a mean of both, so that the
/// force has no jump as the patch grows. Where the body yields, faces that small press with their corners: as
/// nodes do that a tool moves. Where no node can give way, nothing evens out what the points miss.
void PressureContact::press_face(Face& face, double spacing, const Points& x, Contacts& out) {
  if (is_rigid(face)) spacing /= kFinerOnRigid;
  if (face.size <= spacing && m_yielding == Yielding::yes) {
    face.cover = face.whole;
    face.by_corners = 1.0;
    if (face.has_near_corner) press_corners(place_face(face, x), 1.0);
    return;
  }
  const PlacedFace placed = place_face(face, x);
  const double levels = std::clamp(std::log2(face.size / spacing), 0.0, static_cast<double>(m_most_levels));
  const int level = static_cast<int>(levels);
  // In which part of a halving one number of them gives way to the next: where the body yields, the force
  // hangs on it most.
  const double passage = m_yielding == Yielding::yes ? 1.0 : 0.4;
  const double share = std::clamp((levels - level - 0.5) / passage + 0.5, 0.0, 1.0);
  // Beside corners the first pieces soon bear most: what they bear is no more than corners would, and comes
  // up to what pieces do.
  const bool is_first = level == 0 && finds_near() && m_stiffness.are_flat && !is_rigid(face);
  const double by_finer = is_first ? 1.0 - (1.0 - share) * (1.0 - share) * (1.0 - share) : share;
  face.cover = {};
  face.by_corners = 0.0;
  for (int i = 0; i < 2; ++i) {
    const double part = i == 0 ? 1.0 - by_finer : by_finer;
    if (!(part > 0.0)) continue;
    Cover cover;
    if (level + i == 0 && m_yielding == Yielding::yes) {
      cover = face.whole;
      face.by_corners = 1.0 - share;
      press_corners(placed, part);
    } else {
      const PieceRule rule = is_first ? make_first_rule(face, part, share) : PieceRule{part};
      cover = press_pieces(placed, take_whole(placed), level + i, rule, out);
    }
    cover.area *= part;
    cover.facing_area *= part;
    face.cover += cover;
  }
}

void PressureContact::press_all_corners(const Points& x, Contacts& out) {
  for (const Corner& corner : m_corners) {
    m_corner_of_vertex[static_cast<std::size_t>(corner.vertex)] = -1;
    add_contact({corner.vertex, -1, -1}, -1, Vec3::UnitX(), corner.depth, corner.stiffness,
                x.col(corner.vertex), out);
  }
  m_corners.clear();
}

double PressureContact::stiffness_of(const Face& face) const {
  return m_yielding == Yielding::yes ? m_stiffness.per_area(face.number) : 1.0;
}

Patch PressureContact::find_patch() const {
  constexpr double kUncovered = 1e-6;  // weight of a face none of whose corners is near
  double area = 0.0;
  double modulus = 0.0;
  double cell = 0.0;
  for (const Face& face : m_faces) {
    const double weight = face.whole.facing_area + kUncovered * face.area;
    area += weight;
    modulus += weight * m_stiffness.modulus(face.number);
    if (m_stiffness.cell.size() > 0) cell += weight * m_stiffness.cell(face.number);
  }
  if (!(area > 0.0)) return {m_patch_radius};
  return {m_patch_radius, modulus / area, cell / area};
}

/// κ [Pa/m] of a tool under which the body keeps its shape. Hertz: a ball that is d deep in a half-space is
/// pressed out by 4/3 E* √R d^{3/2}; as it lies in a plane that does not yield, its patch has the radius
/// a = √(2Rd) and ∫ depth dA = π R d². So κ = 4√2/(3π) E*/a = 0.600 E*/a; Sneddon's cone wants 0.608 and a
/// flat punch 0.637. Of a body that will yield, that is in series with its own κ.
double PressureContact::find_held_stiffness(bool will_yield) const {
  double area = 0.0;
  double modulus = 0.0;
  double penalty = 0.0;
  for (const Face& face : m_faces) {
    area += face.cover.facing_area;
    modulus += face.cover.facing_area * m_stiffness.modulus(face.number);
    penalty += face.cover.facing_area * m_stiffness.per_area(face.number);
  }
  if (!(area > 0.0)) return 0.0;
  const double radius = std::sqrt(area / std::numbers::pi);
  const double held = 4.0 * std::numbers::sqrt2 / (3.0 * std::numbers::pi) * (modulus / area) / radius;
  return will_yield ? 1.0 / (1.0 / held + area / penalty) : held;
}

/// Contacts were found with κ = 1.
void PressureContact::hold_shape(bool will_yield, Contacts& out) const {
  const double held = find_held_stiffness(will_yield);
  for (Contact& c : out.contacts) {
    c.force *= held;
    c.end_force *= held;
    c.stiffness = 0.0;
    c.end_stiffness *= held;
  }
}

void PressureContact::advance(const Points& x_before, const Points& x, std::optional<double> motion) {
  if (!m_tree) prepare(x_before);
  m_motion = motion ? *motion : find_largest_change(x_before.data(), x.data(), x.size());
  m_tree->advance(m_motion);
  m_balls.motion += m_motion;
  if (!m_ahead) return;
  m_ahead->box = m_ahead->box.grown(-m_motion);
  m_ahead->reach.radius -= find_nearing(m_motion);
}

void PressureContact::find_contacts(const Points& x, const Pose& pose_t0, const Pose& pose_t1,
                                    Yielding yielding, Contacts& contacts) {
  if (!m_tree) prepare(x);
  m_passage = m_passages.find(m_tool.inner_balls(), pose_t0, pose_t1, {x, m_surface, *m_tree});
  // A tool that passes the surface is met on its way in any case.
  const bool at_end = m_penalty == PenaltyKind::discrete && !m_passage;
  press(x, at_end ? pose_t1 : pose_t0, pose_t1, yielding, contacts);
  if (yielding == Yielding::no) hold_shape(false, contacts);
  contacts.sum_reactions(pose_t1.position);
}

void PressureContact::find_unpressed(const Points& x, const Pose& pose, Contacts& contacts) {
  if (!m_tree) prepare(x);
  m_passage.reset();
  press(x, pose, pose, Yielding::no, contacts);
  hold_shape(true, contacts);
  contacts.sum_reactions(pose.position);
}

/// Of the patch as large as it is at one time, from one that the tool's way draws out along the surface: of a
/// disc of radius r, by w, to π r² + 2 r w.
double PressureContact::find_radius_at_end(const Points& x) const {
  if (m_places.size() < 2) return m_patch_radius;
  const Vec3 path = m_places.back().position - m_places.front().position;
  Vec3 normal = Vec3::Zero();
  for (const Face& face : m_faces)
    if (face.whole.facing_area > 0.0) normal += face.whole.facing_area * place_face(face, x).normal;
  const double length = normal.norm();
  if (!(length > 0.0)) return m_patch_radius;
  const double way = path.cross(normal / length).norm() / std::numbers::pi;
  return std::hypot(way, m_patch_radius) - way;
}

void PressureContact::press(const Points& x, const Pose& pose_t0, const Pose& pose_t1, Yielding yielding,
                            Contacts& contacts) {
  contacts.clear();
  m_yielding = yielding;
  m_patch_radius = 0.0;
  m_needs_cover = yielding == Yielding::no || contacts.with_touched;
  place_tool(pose_t0, pose_t1);
  find_faces(x);
  if (m_faces.empty()) return;
  // Of clay that yields, the force is the clay's, and the points only share it out; where it keeps its shape
  // they are all that counts.
  const double points_per_radius = yielding == Yielding::yes ? 3.0 : 4.0;
  m_patch_radius = find_patch_radius(x);
  if (finds_near() && m_patch_radius > 0.0) m_patch_radius = find_radius_at_end(x);
  const double radius = m_patch_radius > 0.0 ? m_patch_radius : std::sqrt(m_tool.radius() * m_margin);
  if (radius == 0.0) return;
  for (Face& face : m_faces) press_face(face, radius / points_per_radius, x, contacts);
  press_all_corners(x, contacts);
  for (const Face& face : m_faces) {
    if (!contacts.with_touched || !(face.cover.area > 0.0)) continue;
    contacts.touched_triangle.push_back(face.number);
    contacts.touched_area.push_back(face.cover.area);
  }
}

}  // namespace argil::contact
