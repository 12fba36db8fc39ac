#pragma once

// Bodies and motions for the detector's tests.

#include <cmath>
#include <utility>
#include <vector>

#include "contact/contact.h"
#include "contact/tool_shape.h"

namespace argil::contact::test {

inline constexpr double kR = 0.008;  ///< radius of the sphere that is the tool [m]
inline constexpr double kK = 100.0;  ///< stiffness of a pair [N/m]

/// Closed slab: n×n squares of two triangles each on top, whose height over (x, y) is `height`, and the same
/// flat at z = −thickness. Top vertices first, row by row.
template <class Height>
mesh::TriangleMesh make_slab(int n, double size, double thickness, Height height) {
  const int k = n + 1;
  mesh::TriangleMesh mesh;
  mesh.vertices.resize(3, 2 * k * k);
  for (int j = 0; j < k; ++j)
    for (int i = 0; i < k; ++i) {
      const double x = size * (double(i) / n - 0.5);
      const double y = size * (double(j) / n - 0.5);
      mesh.vertices.col(j * k + i) << x, y, height(x, y);
      mesh.vertices.col(k * k + j * k + i) << x, y, -thickness;
    }
  std::vector<Eigen::Vector3i> list;
  const int low = k * k;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * k + i;
      const int b = a + 1;
      const int c = a + k + 1;
      const int d = a + k;
      if ((i + j) % 2 != 0)
        list.insert(list.end(), {{a, b, c}, {a, c, d}});
      else
        list.insert(list.end(), {{a, b, d}, {b, c, d}});
      list.insert(list.end(), {{low + a, low + c, low + b}, {low + a, low + d, low + c}});
    }
  for (int i = 0; i < n; ++i)
    for (const auto& [a, b] : {std::pair{i, i + 1}, std::pair{n * k + i + 1, n * k + i},
                               std::pair{(i + 1) * k, i * k}, std::pair{i * k + n, (i + 1) * k + n}})
      list.insert(list.end(), {{a, low + a, low + b}, {a, low + b, b}});
  mesh.triangles.resize(3, static_cast<Eigen::Index>(list.size()));
  for (std::size_t t = 0; t < list.size(); ++t) mesh.triangles.col(static_cast<Eigen::Index>(t)) = list[t];
  return mesh;
}

inline mesh::TriangleMesh make_flat_slab(int n = 20, double size = 0.1, double thickness = 0.02) {
  return make_slab(n, size, thickness, [](double, double) { return 0.0; });
}

/// Both in one, the second moved by `by`.
inline mesh::TriangleMesh make_pair(const mesh::TriangleMesh& a, const mesh::TriangleMesh& b,
                                    const Vec3& by) {
  mesh::TriangleMesh both;
  both.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  both.vertices << a.vertices, b.vertices.colwise() + by;
  both.triangles.resize(3, a.triangles.cols() + b.triangles.cols());
  both.triangles << a.triangles, b.triangles.array() + a.num_vertices();
  return both;
}

/// A detector with a body at rest and a tool that is led from place to place.
struct Scene {
  mesh::TriangleMesh body;
  ContactDetector detector;
  Pose pose;
  Contacts contacts;

  Scene(const mesh::TriangleMesh& b, const mesh::TriangleMesh& tool, const Vec3& start, double k = kK)
      : body(b), detector(b.triangles, b.num_vertices(), tool, {k, k}) {
    pose.position = start;
  }
  const Contacts& move(const Vec3& position) { return lead(Pose{position, pose.orientation}); }
  const Contacts& lead(const Pose& next) {
    detector.find_contacts(body.vertices, body.vertices, pose, next, contacts);
    pose = next;
    return contacts;
  }
  const Vec3& force() const { return contacts.force_on_tool; }
};

/// Σ of the forces on the body's vertices, and of their moments about `about`.
inline std::pair<Vec3, Vec3> sum_body_forces(const Contacts& contacts, const Points& x, const Vec3& about) {
  Vec3 force = Vec3::Zero();
  Vec3 moment = Vec3::Zero();
  for (const Contact& c : contacts.contacts)
    for (std::size_t i = 0; i < 3 && c.vertex[i] >= 0; ++i) {
      force += c.weight[i] * c.force;
      moment += (Vec3(x.col(c.vertex[i])) - about).cross(c.weight[i] * c.force);
    }
  return {force, moment};
}

}  // namespace argil::contact::test
