#pragma once

// Inside of ContactDetector: shared by contact.cpp (forces) and entries.cpp (detection). Not for other
// folders.

#include <array>
#include <utility>
#include <vector>

#include "contact/bounding_tree.h"
#include "contact/contact.h"
#include "contact/penalty.h"
#include "contact/surface_features.h"

namespace argil::contact {

/// An edge pair in penetration, and on which side it came in.
struct EdgePair {
  int tool_edge = -1;
  int body_edge = -1;
  double orientation = 0.0;  ///< of the pair's normal; 0: not inside yet, found at the entry
  auto key() const { return std::pair(tool_edge, body_edge); }
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
  std::vector<double>
      depth;  ///< of each vertex behind its face's plane at the end of the interval [m]; 0 outside
  std::vector<int> inside;       ///< vertices that lie behind a face, increasing
  std::vector<int> inside_next;  ///< working array
  std::vector<Entry> entries;    ///< of this interval, by vertex, time, face
};

/// Both surfaces at both ends of an interval.
struct Motion {
  const Points& body_t0;
  const Points& body_t1;
  const Points& tool_t0;
  const Points& tool_t1;
};

struct ContactDetector::Impl {
  ContactParams params;
  SurfaceFeatures body;
  SurfaceFeatures tool;
  Points tool_rest;                         // in the tool frame
  Points tool_vertex_area;                  // vector area of each tool vertex in the tool frame [m²]
  Points tool_t0, tool_t1;                  // in the world
  std::unique_ptr<BoundingTree> body_tree;  // made at the first call, where the body's shape is known
  BoundingTree tool_tree;

  VertexSide tool_vertices;                           // tool vertices behind body faces
  VertexSide body_vertices;                           // body vertices behind tool faces
  std::vector<EdgePair> edge_pairs, edge_pairs_next;  // by key

  // Working arrays; they grow to what a scene needs and stay so.
  std::vector<int> body_candidates, tool_candidates;
  std::vector<EdgePair> edge_entries;
  Field touched_area;  // of each body triangle [m²]; zero between intervals
  std::vector<int> touched;

  Impl(const Triangles& surface, int num_body_vertices, const mesh::TriangleMesh& tool_mesh,
       const ContactParams& p);

  void place_tool(const Pose& pose, Points& out) const;

  // entries.cpp
  void find_entries(const Motion& motion);
  void test_triangles(int body_face, int tool_face, const Motion& motion);

  // contact.cpp
  void press_tool_vertices(const Motion& motion, Contacts& out);
  void press_body_vertices(const Motion& motion, Contacts& out);
  void press_edges(const Motion& motion, Contacts& out);
  double compute_uncovered_share(const EdgePair& pair, double depth) const;
  void measure_touched(const Motion& motion, const Pose& pose_t1, Contacts& out);
};

/// Path of vertex `v` of one surface and face `f` of another.
inline PairPath make_vertex_face_path(const Points& v_t0, const Points& v_t1, int v, const Points& f_t0,
                                      const Points& f_t1, const Eigen::Vector3i& f) {
  return {{v_t0.col(v), f_t0.col(f(0)), f_t0.col(f(1)), f_t0.col(f(2))},
          {v_t1.col(v), f_t1.col(f(0)), f_t1.col(f(1)), f_t1.col(f(2))}};
}

/// Path of edge `a` (tool) and edge `b` (body).
inline PairPath make_edge_path(const Motion& m, const Eigen::Vector2i& a, const Eigen::Vector2i& b) {
  return {{m.tool_t0.col(a(0)), m.tool_t0.col(a(1)), m.body_t0.col(b(0)), m.body_t0.col(b(1))},
          {m.tool_t1.col(a(0)), m.tool_t1.col(a(1)), m.body_t1.col(b(0)), m.body_t1.col(b(1))}};
}

/// Normal of a triangle times twice its area.
inline Vec3 compute_face_normal(const Points& x, const Triangles& triangles, int f) {
  const Vec3 a = x.col(triangles(0, f));
  return (Vec3(x.col(triangles(1, f))) - a).cross(Vec3(x.col(triangles(2, f))) - a);
}

/// Outward direction at an edge: sum of its triangles' normals.
inline Vec3 compute_edge_normal(const Points& x, const SurfaceFeatures& features, int e) {
  return compute_face_normal(x, features.triangles, features.edge_triangles(0, e)) +
         compute_face_normal(x, features.triangles, features.edge_triangles(1, e));
}

}  // namespace argil::contact
