#pragma once

// Inside of ContactDetector: shared by contact.cpp (the public face), entries.cpp (detection), press.cpp
// (forces) and touched.cpp (areas). Not for other folders.

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/change_marks.h"
#include "base/parallel.h"
#include "contact/bounding_tree.h"
#include "contact/contact.h"
#include "contact/nearest.h"
#include "contact/penalty.h"
#include "contact/surface_features.h"

namespace argil::contact {

/// An edge of the tool and one of the body that cross: within penetration at t₀ or t₁, or meeting on the way.
struct EdgePair {
  int tool_edge = -1;
  int body_edge = -1;
  bool inside_t0 = false;
  bool inside_t1 = false;
  auto key() const { return std::pair(tool_edge, body_edge); }
};

/// What friction carries of a pair of edges to the next interval.
struct EdgeSpring {
  std::pair<int, int> key;
  Vec3 stretch = Vec3::Zero();
};

/// How a pair in contact moved.
struct PairMotion {
  double stiffness = 0.0;  ///< k [N/m]
  double depth_t0 = 0.0;   ///< [m]; 0: outside
  double depth_t1 = 0.0;
  Vec3 tool_path = Vec3::Zero();  ///< of the tool's point over the interval [m]
  Vec3 body_path = Vec3::Zero();  ///< and of the body's
  double share = 1.0;             ///< of the interval in contact
};

/// A vertex that met a face in this interval.
struct Entry {
  int vertex = -1;
  double time = 0.0;
  int face = -1;
};

/// Vertices of one surface against faces of the other, with what is carried between intervals.
struct VertexSide {
  std::vector<int> face_of_vertex;  ///< face each vertex lies behind; −1: outside
  std::vector<int> inside;          ///< vertices that lie behind a face, increasing
  std::vector<Vec3> stretch;        ///< of each vertex's spring of sticking [m]; of friction alone

  // Of the present interval.
  std::vector<Entry> entries;  ///< by vertex, time, face
  std::vector<int> pressed;    ///< vertices with depth
  std::vector<double> depth;   ///< |∫ nᵀ(p−q) n dt| of each vertex [m]

  explicit VertexSide(int num_vertices)
      : face_of_vertex(static_cast<std::size_t>(num_vertices), -1),
        stretch(static_cast<std::size_t>(num_vertices), Vec3::Zero()),
        depth(static_cast<std::size_t>(num_vertices), 0.0) {}
};

/// Both surfaces at both ends of an interval.
struct Motion {
  const Points& body_t0;
  const Points& body_t1;
  const Points& tool_t0;
  const Points& tool_t1;
};

/// What one thread of a detection works with: trees of its own, for queries fit their boxes, and what it
/// found. Answers of a tree are the same whatever was asked before.
struct Worker {
  BoundingTree body_tree;
  BoundingTree tool_tree;

  // Working arrays; they grow to what a scene needs and stay so.
  std::vector<int> tool_candidates = {};  // faces of the tool near one of the body
  std::vector<int> tool_features = {};    // vertices or edges of these
  ChangeMarks has_edge = {};              // edges of the tool among them
  std::vector<int> near_faces = {};       // tool_candidates of its faces of the body, one after another
  std::vector<int> candidates = {};       // faces that may be near a vertex
  std::vector<NearFace> near = {};        // faces near a vertex, by number
  std::vector<Entry> tool_entries = {}, body_entries = {};
  std::vector<EdgePair> edge_pairs = {};
  std::vector<Vec3> polygon = {}, clip_work = {};
};

/// Faces of the tool near a face of the body: a part of a worker's list.
struct ToolFaces {
  const Worker* worker = nullptr;  ///< none: there are none
  std::size_t begin = 0;
  std::size_t count = 0;

  std::span<const int> list() const {
    return worker ? std::span(worker->near_faces).subspan(begin, count) : std::span<const int>();
  }
};

/// One side of eq. 7 over an interval: whose vertices, whose faces.
struct VertexFaceMotion {
  VertexSide& side;
  const Points& v_t0;
  const Points& v_t1;
  SurfaceAt faces;  ///< at t₁
  bool body_has_face;

  BoundingTree& tree(Worker& worker) const { return body_has_face ? worker.body_tree : worker.tool_tree; }

  Vec3 vertex_at(int v, double t) const {
    return t == 1.0 ? Vec3(v_t1.col(v)) : Vec3(v_t0.col(v) + t * (v_t1.col(v) - v_t0.col(v)));
  }
  PairPath path(int v, int face) const {
    const Eigen::Vector3i f = faces.features.triangles.col(face);
    return {{v_t0.col(v), faces.x_t0.col(f(0)), faces.x_t0.col(f(1)), faces.x_t0.col(f(2))},
            {v_t1.col(v), faces.x_t1.col(f(0)), faces.x_t1.col(f(1)), faces.x_t1.col(f(2))}};
  }
};

/// A vertex that was inside or met a face, and what came of it.
struct VertexTask {
  const VertexFaceMotion* motion = nullptr;
  int vertex = -1;
  int face = -1;  ///< where it was, or through which it came
  bool was_inside = false;
  bool inside = false;  ///< at the end of the interval
  double depth = 0.0;   ///< see VertexSide; 0: no contact
  Contact contact = {};
};

struct ContactDetector::Impl {
  ContactParams params;
  SurfaceFeatures body;
  SurfaceFeatures tool;
  Points tool_rest;  // in the tool frame
  Vec3 tool_centre;  // of a sphere around the tool, in the tool frame
  bool tool_is_convex = true;
  double tool_edge_length = 0.0;   // mean [m]
  double tool_radius = 0.0;        // of that sphere, a little more
  double tool_inner_radius = 0.0;  // of one about the same centre that lies in a convex tool, a little less
  double tool_reach = 0.0;         // largest distance of a vertex from the hand's point
  Points tool_t0, tool_t1;         // in the world; a column more, see set_points
  Vec3 centre_t0, centre_t1;       // of the sphere
  std::optional<Pose> placed;      // where tool_t1 is
  int threads = 1;
  std::vector<Worker> workers;  // made at the first call, where the body's shape is known

  VertexSide tool_vertices;  // tool vertices behind body faces
  VertexSide body_vertices;  // body vertices behind tool faces

  ContactState committed;

  // Working arrays; they grow to what a scene needs and stay so.
  std::vector<int> body_candidates;
  std::vector<ToolFaces> near_faces;  // of each face of the body
  std::vector<VertexTask> tasks;
  std::vector<EdgePair> edge_pairs;                         // of the present interval, by key
  std::vector<EdgeSpring> edge_springs, edge_springs_next;  // by key
  std::vector<double> areas;                                // of the body candidates inside the tool [m²]
  double seconds = 0.0;                                     // length of the interval

  Impl(const Triangles& surface, int num_body_vertices, const mesh::TriangleMesh& tool_mesh,
       const ContactParams& p);

  /// For a start of the body at x and of the tool in tool_t0.
  void make_workers(const Points& x);
  /// visit(worker, i) for i = 0 … count−1, in any order and at the same time; a worker is on one thread.
  /// Neighbours go to different workers: work is where the tool is.
  template <class Visit>
  void each_item(std::size_t count, Visit visit) {
    constexpr std::size_t kLeast = 8;  // items that are worth a thread
    const std::size_t used = std::clamp<std::size_t>(count / kLeast, 1, workers.size());
    const auto run = [&](std::ptrdiff_t worker) {
      const auto first = static_cast<std::size_t>(worker);
      for (std::size_t i = first; i < count; i += used) visit(workers[first], i);
    };
    parallel_for(static_cast<std::ptrdiff_t>(used), used > 1 ? threads : 1, run);
  }

  void copy_state(ContactState& out) const;
  void place_tool(const Pose& pose, Points& out) const;
  void place_tool(const Pose& pose_t0, const Pose& pose_t1);
  mesh::Box tool_bounds() const;
  VertexFaceMotion tool_vertex_motion(const Motion& m) {
    return {tool_vertices, m.tool_t0, m.tool_t1, {body, m.body_t0, m.body_t1, 1.0}, true};
  }
  VertexFaceMotion body_vertex_motion(const Motion& m) {
    return {body_vertices, m.body_t0, m.body_t1, {tool, m.tool_t0, m.tool_t1, 1.0}, false};
  }

  // entries.cpp
  void find_entries(const Motion& motion, const mesh::Box& tool_bounds);
  void test_face(int body_face, double reach, const Motion& motion, Worker& worker);
  void test_vertices(int body_face, const Motion& motion, Worker& worker);
  void collect_tool_edges(std::array<int, 2> body_faces, Worker& worker) const;
  void test_edges(int body_face, double reach, const Motion& motion, Worker& worker);

  // press.cpp
  void press_vertices(const Motion& motion, Contacts& out);
  void add_tasks(const VertexFaceMotion& m);
  void resolve(VertexTask& task, Worker& worker) const;
  void press_edges(const Motion& m, Contacts& out);
  double compute_uncovered_share(const EdgePair& pair, double depth) const;
  bool is_edge_pair_inside(const EdgePair& pair, const Motion& m, double t);

  // resist.cpp
  bool resists() const { return params.damping > 0.0 || params.friction > 0.0; }
  void resist(const PairMotion& motion, Vec3& stretch, Contact& c) const;
  void resist_vertex(const VertexFaceMotion& m, int v, const PairPath& path, const Penalty& penalty,
                     bool was_inside, bool inside, Contact& c) const;
  void resist_edges(const EdgePair& pair, const PairPath& path, const Penalty& penalty, double share,
                    Contact& c);

  // touched.cpp
  void measure_touched(const Motion& m, Contacts& out);
  double compute_overlap(int body_face, const Motion& m, Worker& worker) const;
};

/// Path of edge `a` (tool) and edge `b` (body).
inline PairPath make_edge_path(const Motion& m, const Eigen::Vector2i& a, const Eigen::Vector2i& b) {
  return {{m.tool_t0.col(a(0)), m.tool_t0.col(a(1)), m.body_t0.col(b(0)), m.body_t0.col(b(1))},
          {m.tool_t1.col(a(0)), m.tool_t1.col(a(1)), m.body_t1.col(b(0)), m.body_t1.col(b(1))}};
}

}  // namespace argil::contact
