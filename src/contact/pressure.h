#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "contact/bounding_tree.h"
#include "contact/contact.h"
#include "contact/passage.h"
#include "contact/tool_solid.h"

namespace argil::contact {

/// What resists a tool, of each triangle of the body's surface.
struct SurfaceStiffness {
  Field per_area;  ///< κ [Pa/m] of a tool that the body yields to
  Field modulus;   ///< E/(1 − ν²) [Pa] of the body under it, for a tool that it does not yield to
  std::vector<char> is_rigid = {};  ///< its corners cannot give way; empty: none of them is such
  Field cell = {};                  ///< edge of a regular tet as large as that under it [m]; empty: not known
  bool are_flat = true;  ///< triangles stay flat as the body gives way, as those of four-node tets do
};

/// The same of one triangle.
struct StiffnessOfTriangle {
  int triangle = -1;
  double per_area = 0.0;
  double modulus = 0.0;
};

/// What of the body's surface a tool touches.
struct Patch {
  double radius = 0.0;   ///< of a disc as large [m]
  double modulus = 0.0;  ///< E* [Pa] of the body under it
  double cell = 0.0;     ///< edge of its cells there [m]; 0: not known
};

/// How the body answers the tool.
enum class Yielding {
  yes,  ///< its shape gives way: κ is a penalty
  no,   ///< it keeps its shape and is felt as an elastic half-space would be
};

/// Contact as pressure over the touched part of a body's surface: p = κ · depth below the tool's surface,
/// toward the outside of the tool. The force follows the patch, not the number of triangles of either.
///
/// Each triangle is split until its pieces are small against the patch; the number of pieces changes by
/// degrees, so that the force has no jump. Triangles that are small themselves press with their corners.
/// Only what faces the tool counts: the far side of a thin part does not. Where the tool's middle passes the
/// surface, what counts is the side that it comes from, until it is out again.
class PressureContact {
 public:
  /// `surface`: 3×m triangles of body vertex numbers, outward. `is_solved_for`: an implicit step finds how
  /// far the body yields to the tool or comes along with it, and lets go what would draw. A point that the
  /// tool touches at either end of its way then has the force of the depth at the end, even below zero.
  PressureContact(const Triangles& surface, int num_vertices, ToolSolid tool, SurfaceStiffness stiffness,
                  bool is_solved_for = false, PenaltyKind penalty = PenaltyKind::continuous);

  /// Makes for a body that is here what the next call would else make first.
  void prepare(const Points& x);
  /// Gives these triangles what is listed, and lists what they had before.
  void exchange(std::span<StiffnessOfTriangle> list);
  SurfaceStiffness& stiffness() { return m_stiffness; }
  /// The next call may start anywhere.
  void forget() {
    m_tree.reset();
    m_ahead.reset();
  }

  /// Of the last contacts.
  Patch find_patch() const;
  /// Of the last contacts, with a surface at x, which press with this force [N] in all: how much deeper the
  /// tool is below flat faces that press with their corners than below these, its mean by the force [m].
  double find_sag(const Points& x, double force);

  /// Of a body whose surface is in the same place: how the tool came through it.
  void go_on_from(const PressureContact& before) { m_passages = before.m_passages; }
  void commit() { m_passages.commit(); }
  void roll_back() {
    m_passages.roll_back();
    forget();
  }
  void serialize(Archive& archive) { m_passages.serialize(archive); }

  /// The body's vertices have gone from x_before to x (3×n) [m], none by more than `motion` along any axis;
  /// without it that is found by looking at all of them. Successive calls must join.
  void advance(const Points& x_before, const Points& x, std::optional<double> motion);

  /// Contacts while the tool goes from pose_t0 to pose_t1 and the body's vertices stay at x.
  /// Depths are means over the way, or with the discrete penalty those at its end; each point of the tool
  /// moves linearly in so many pieces that none is longer than the tool is thick.
  void find_contacts(const Points& x, const Pose& pose_t0, const Pose& pose_t1, Yielding yielding,
                     Contacts& contacts);
  /// What a body that still has its shape will answer to a tool that stands at `pose`, by its modulus and κ;
  /// not a part of the tool's way.
  void find_unpressed(const Points& x, const Pose& pose, Contacts& contacts);

 private:
  static constexpr int kMostPlaces = 17;      // on the tool's way
  static constexpr double kWidestBand = 0.3;  // of the side of a face; see find_band()
  static constexpr double kFull = 0.25;       // cosine beyond which all of a face counts; see facing_share()
  static constexpr double kMargins = 2.0;     // how far points still are near the tool, over m_margin
  static constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  using Piece = std::array<Vec3, 3>;  // barycentric corners of a piece of a triangle
  inline static const Piece kWhole = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};

  struct Place {  // of the tool
    Vec3 position;
    Mat3 turn;  ///< from world to tool
  };
  /// Where a point is from the tool along its way.
  struct LeastDistance : ToolDistance {
    const Place* place = nullptr;  ///< where it is nearest
    double along = 0.0;            ///< of a passage: how far ahead of the point that is [m]
  };
  /// How deep a point of the body is below the tool's surface.
  struct PointDepth {
    double mean = 0.0;   ///< of max(0, depth) over the way, or where a step asks for it, at its end [m]
    double begin = 0.0;  ///< at its start, negative outside [m]
    double end = 0.0;    ///< at its end, negative outside [m]
    double share = 0.0;  ///< of the way below the surface; 1 where a step asks for the end
    Vec3 outward = Vec3::Zero();  ///< unit mean of the way out of the tool, weighted by depth
  };
  /// What of a triangle the tool has covered.
  struct Cover {
    double area = 0.0;         ///< [m²]
    double facing_area = 0.0;  ///< of that, what faces the tool
    bool may_touch = false;    ///< a piece lies outside by its corners but may be touched between them
    Cover& operator+=(const Cover& other);
  };
  /// What m_candidates hold: all triangles that such a query meets, and of larger ones these.
  struct Ahead {
    mesh::Box box;
    BoundingTree::Reach reach;
  };
  /// Balls that hold m_candidates, where these were when they were found.
  struct CandidateBalls {
    std::array<std::vector<double>, 3>
        centre;                  ///< [m]; after the last one, as many far away as fill the lanes
    std::vector<double> radius;  ///< [m]
    double motion = 0.0;         ///< of the body since then, along any axis [m]
  };
  struct FacePiece {
    Piece weight;
    std::array<Vec3, 3> x;  ///< of its corners [m]
  };
  struct PlacedPiece {  // of a triangle
    std::array<Vec3, 3> x;
    Vec3 centre;
    double reach = 0.0;  // from the centre to the farthest corner [m]
  };
  /// The same without the way out.
  struct Nearness {
    double distance = 0.0;
    const Place* place = nullptr;
  };
  struct VertexNearness {
    int vertex = -1;
    Nearness nearness;
  };
  /// Vertices of m_candidates.
  struct CandidateVertices {
    std::vector<int> number;
    std::vector<double> placed;  ///< of each: x, y, z and how far it is from a ball along its way [m]
  };
  struct Corner {  // of triangles that press with their corners
    int vertex = -1;
    PointDepth depth;
    double stiffness = 0.0;  // Σ κ·area [N/m]
  };
  struct Face {
    int number = -1;
    bool has_near_corner = true;  // false: none of its corners presses
    double area = 0.0;
    double size = 0.0;  // edge of a regular triangle of this area, or half the longest edge [m]
    Cover whole;        // unsplit
    Cover cover;
    double by_corners = 0.0;  // share of it that presses with its corners
  };
  struct PieceRule {         // how the pieces of a face press
    double share;            // of their area counts
    double own_depth = 1.0;  // share of their own depth, beside one that is linear between the corners
    std::array<PointDepth, 3> corner = {};
  };
  struct PlacedFace : Face {
    std::array<Vec3, 3> x;  // [m]
    Vec3 normal = Vec3::Zero();
    Vec3 at(const Vec3& weight) const { return weight(0) * x[0] + weight(1) * x[1] + weight(2) * x[2]; }
  };

  void press(const Points& x, const Pose& pose_t0, const Pose& pose_t1, Yielding yielding,
             Contacts& contacts);
  // pressure_cover.cpp
  void find_faces(const Points& x);
  void find_candidates(const mesh::Box& query, const BoundingTree::Reach& reach, const Points& x);
  void sort_candidates();
  void keep_balls(const Points& x);
  void find_reached(const Vec3& centre, double radius);
  static double find_nearing(double motion);
  void number_vertices();
  bool find_face(const mesh::Box& query, const Points& x, PlacedFace& face);
  PlacedFace place_face(const Face& face, const Points& x) const;
  Nearness find_vertex_nearness(int vertex, const Vec3& x);
  bool has_band() const { return m_yielding == Yielding::yes && !m_passage; }
  static PlacedPiece place_piece(const std::array<Vec3, 3>& x, const Vec3& centre);
  template <class FindCorner>
  Cover cover_piece(const PlacedFace& face, const PlacedPiece& piece, double area, const LeastDistance& found,
                    double band, FindCorner find_corner);
  double find_patch_radius(const Points& x);
  double find_radius_at_end(const Points& x) const;
  void limit_levels(int pass);
  double find_band(const Face& face, int level) const;
  double find_band_of_side(double side) const;
  Cover measure_cover(const PlacedFace& face, const Piece& piece, int level, double band = 0.0);
  Cover measure_cover(const Face& face, int level, const Points& x) {
    return level == 0 ? face.whole
                      : measure_cover(place_face(face, x), kWhole, level, find_band(face, level));
  }
  // pressure_lanes.cpp
  bool goes_in_lanes() const { return m_tool.is_ball() && has_band() && m_places.size() <= 2; }
  void find_ball_faces(const mesh::Box& query, const Points& x);
  void measure_vertices(const Points& x);
  // pressure_depth.cpp
  void place_tool(const Pose& pose_t0, const Pose& pose_t1);
  ToolDistance find_distance(const Vec3& p, const Place& place, double far = kAnywhere);
  LeastDistance find_least_distance(const Vec3& p, double reach);
  Nearness find_nearness(const Vec3& p, double reach);
  Nearness find_ball_nearness(const Vec3& p, double reach) const;
  double find_ball_distance(const Vec3& p, const Place& place) const {
    return (p - place.position).norm() - m_tool.radius();
  }
  const Place* find_near_place(const Vec3& p) const;
  int count_steps(double nearer) const;
  LeastDistance find_passage_distance(const Vec3& p, double reach);
  double find_way_out(const Vec3& p, const Vec3& direction, const Place& place);
  PointDepth find_depth(const Vec3& p);
  PointDepth find_held_depth(const Vec3& p, const Vec3& normal);
  PointDepth find_passage_depth(const Vec3& p);
  double find_held_facing(const Vec3& p, const Vec3& normal, const Place& place);
  // pressure.cpp
  bool is_rigid(const Face& face) const;
  static FacePiece take_whole(const PlacedFace& face);
  static std::array<FacePiece, 4> quarter_piece(const PlacedFace& face, const FacePiece& piece);
  static double find_reach(const FacePiece& piece, const Vec3& middle);
  bool turns(const FacePiece& piece, const Vec3& centre);
  void press_face(Face& face, double spacing, const Points& x, Contacts& out);
  void press_corners(const PlacedFace& face, double share);
  Cover press_pieces(const PlacedFace& face, const FacePiece& piece, int level, const PieceRule& rule,
                     Contacts& out);
  PieceRule make_first_rule(const Face& face, double share, double own_depth) const;
  /// To a mean of its own depth and of the one that is linear between the corners.
  static void lower(const PieceRule& rule, const Vec3& weight, PointDepth& depth);
  void add_contact(const std::array<int, 3>& vertex, int triangle, const Vec3& weight,
                   const PointDepth& depth, double stiffness, const Vec3& point, Contacts& out) const;
  void press_all_corners(const Points& x, Contacts& out);
  double stiffness_of(const Face& face) const;
  bool finds_near() const { return m_is_solved_for && m_yielding == Yielding::yes && !m_passage; }
  /// Of a point that the tool does not touch: may the body come to the tool there in a step?
  bool is_near(const PointDepth& depth) const { return depth.end > -kMargins * m_margin; }
  double find_held_stiffness(bool will_yield) const;
  void hold_shape(bool will_yield, Contacts& out) const;
  static double facing_share(const Vec3& outward, const Vec3& normal);

  Triangles m_surface;
  ToolSolid m_tool;
  SurfaceStiffness m_stiffness;
  bool m_is_solved_for;
  PenaltyKind m_penalty;
  std::optional<BoundingTree> m_tree;
  double m_motion = 0.0;                      // of the body before the present call, along any axis [m]
  std::vector<int> m_candidates;              // triangles that may be near the tool for some calls, by number
  std::optional<Ahead> m_ahead;               // none: they have to be found anew
  std::vector<std::uint64_t> m_is_candidate;  // a bit of each triangle, while they are put in order
  CandidateBalls m_balls;
  CandidateVertices m_vertices;
  std::vector<std::array<int, 3>> m_candidate_corners;  // places in m_vertices, for each candidate
  Passage m_passages;
  // Of the present call.
  std::vector<Place> m_places;                 // along the tool's way, the end last
  double m_way = 0.0;                          // no point of the tool moves farther [m]
  std::optional<Passage::Interval> m_passage;  // then m_places is one place
  Vec3 m_step = Vec3::Zero();                  // of the tool's origin [m]
  Mat3 m_turn = Mat3::Identity();              // from the tool's end back to its start
  Yielding m_yielding = Yielding::yes;
  bool m_needs_cover = false;
  int m_most_levels = 0;           // of splitting a triangle in four
  std::size_t m_num_measured = 0;  // pieces, in the present pass over all faces
  double m_margin = 0.0;           // how far from the tool points are near it [m]
  double m_patch_radius = 0.0;     // [m]; 0: nothing is touched
  std::vector<int> m_reached;      // places in m_candidates of those that may be near it
  std::vector<Face> m_faces;       // near the tool's way, by number
  std::vector<Corner> m_corners;
  std::vector<int> m_corner_of_vertex;     // place in m_corners; −1: none
  std::vector<VertexNearness> m_nearness;  // of vertices of m_candidates
  std::vector<int> m_place_of_vertex;      // in m_nearness; −1: none
  int m_guess = 0;                         // face of the tool near the last point
};

}  // namespace argil::contact
