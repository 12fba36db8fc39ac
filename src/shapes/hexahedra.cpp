#include "shapes/hexahedra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/check.h"

namespace argil::shapes {
namespace {

// Corners of the six faces, counter-clockwise from outside.
constexpr std::array<std::array<int, 4>, 6> kFaces = {
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

struct Face {
  std::array<int, 4> key;     // sorted vertex numbers
  std::array<int, 4> corner;  // in order, seen from outside `hex`
  int hex;
};

// Faces sorted so that the two hexahedra at a face are neighbours in the list, the lower one first.
std::vector<Face> list_faces(const HexMesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(static_cast<std::size_t>(6 * mesh.hexahedra.cols()));
  for (int hex = 0; hex < static_cast<int>(mesh.hexahedra.cols()); ++hex)
    for (const std::array<int, 4>& local : kFaces) {
      Face face{};
      for (std::size_t i = 0; i < 4; ++i) face.corner[i] = mesh.hexahedra(local[i], hex);
      face.key = face.corner;
      std::sort(face.key.begin(), face.key.end());
      face.hex = hex;
      faces.push_back(face);
    }
  std::sort(faces.begin(), faces.end(),
            [](const Face& a, const Face& b) { return a.key != b.key ? a.key < b.key : a.hex < b.hex; });
  return faces;
}

// The two triangles of a boundary face; the diagonal leaves its lowest vertex.
std::array<std::array<int, 3>, 2> halve(const Face& face) {
  const auto lowest = std::min_element(face.corner.begin(), face.corner.end()) - face.corner.begin();
  const auto at = [&face, lowest](std::ptrdiff_t i) {
    return face.corner[static_cast<std::size_t>((lowest + i) % 4)];
  };
  return {{{at(0), at(1), at(2)}, {at(0), at(2), at(3)}}};
}

template <class Inner, class Boundary>
void visit_faces(const HexMesh& mesh, Inner inner, Boundary boundary) {
  const std::vector<Face> faces = list_faces(mesh);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (i + 1 < faces.size() && faces[i].key == faces[i + 1].key) {
      inner(faces[i], faces[i + 1].hex);
      ++i;
    } else {
      boundary(faces[i]);
    }
  }
}

}  // namespace

HexMesh make_box_hexahedra(const Vec3& size, const Eigen::Vector3i& counts) {
  ARGIL_ASSERT(counts.minCoeff() >= 1);
  const int nx = counts(0);
  const int ny = counts(1);
  const int nz = counts(2);
  HexMesh mesh;
  mesh.vertices.resize(3, (nx + 1) * (ny + 1) * (nz + 1));
  mesh.hexahedra.resize(8, nx * ny * nz);
  const auto vertex = [nx, ny](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i)
        mesh.vertices.col(vertex(i, j, k)) =
            Vec3(size(0) * (i - 0.5 * nx) / nx, size(1) * (j - 0.5 * ny) / ny, size(2) * k / nz);
  int hex = 0;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        mesh.hexahedra.col(hex++) << vertex(i, j, k), vertex(i + 1, j, k), vertex(i + 1, j + 1, k),
            vertex(i, j + 1, k), vertex(i, j, k + 1), vertex(i + 1, j, k + 1), vertex(i + 1, j + 1, k + 1),
            vertex(i, j + 1, k + 1);
  return mesh;
}

namespace {

// A disc of unit radius in quadrilaterals, extruded by the caller.
struct Disc {
  std::vector<Eigen::Vector2d> points;
  std::vector<std::array<int, 4>> cells;  // counter-clockwise
};

// The core's sides bulge by this much of the way to an arc, which opens its corners beyond a right angle.
constexpr double kBulge = 0.35;
constexpr double kCoreHalfSide = 0.4;  // of the radius: core cells and ring cells come out alike

Disc make_disc(int core, int rings) {
  Disc disc;
  const auto core_vertex = [core](int i, int j) { return i + (core + 1) * j; };
  for (int j = 0; j <= core; ++j)
    for (int i = 0; i <= core; ++i) {
      const Eigen::Vector2d uv(2.0 * i / core - 1.0, 2.0 * j / core - 1.0);
      const double ring = uv.cwiseAbs().maxCoeff();  // concentric squares bulge by their size
      const Eigen::Vector2d arc = ring > 0.0 ? Eigen::Vector2d(std::sqrt(2.0) * ring * uv.normalized()) : uv;
      const double bulge = kBulge * ring;
      disc.points.push_back(kCoreHalfSide * ((1.0 - bulge) * uv + bulge * arc));
    }
  for (int j = 0; j < core; ++j)
    for (int i = 0; i < core; ++i)
      disc.cells.push_back(
          {core_vertex(i, j), core_vertex(i + 1, j), core_vertex(i + 1, j + 1), core_vertex(i, j + 1)});
  // Round the core counter-clockwise from its corner (0, 0).
  std::vector<int> inner;
  for (int i = 0; i < core; ++i) inner.push_back(core_vertex(i, 0));
  for (int j = 0; j < core; ++j) inner.push_back(core_vertex(core, j));
  for (int i = core; i > 0; --i) inner.push_back(core_vertex(i, core));
  for (int j = core; j > 0; --j) inner.push_back(core_vertex(0, j));
  const std::vector<int> first = inner;
  const double pi = std::acos(-1.0);
  for (int ring = 1; ring <= rings; ++ring) {
    std::vector<int> outer;
    const double w = static_cast<double>(ring) / rings;
    for (std::size_t i = 0; i < inner.size(); ++i) {
      const double angle = pi * (-0.75 + 0.5 * static_cast<double>(i) / core);
      const Eigen::Vector2d rim(std::cos(angle), std::sin(angle));
      outer.push_back(static_cast<int>(disc.points.size()));
      disc.points.push_back((1.0 - w) * disc.points[static_cast<std::size_t>(first[i])] + w * rim);
    }
    for (std::size_t i = 0; i < inner.size(); ++i) {
      const std::size_t next = (i + 1) % inner.size();
      disc.cells.push_back({inner[i], outer[i], outer[next], inner[next]});
    }
    inner = std::move(outer);
  }
  return disc;
}

}  // namespace

HexMesh make_cylinder_hexahedra(double radius, double height, const CylinderCounts& counts) {
  ARGIL_ASSERT(counts.core >= 1 && counts.rings >= 1 && counts.layers >= 1);
  const Disc disc = make_disc(counts.core, counts.rings);
  const int num_points = static_cast<int>(disc.points.size());
  HexMesh mesh;
  mesh.vertices.resize(3, num_points * (counts.layers + 1));
  mesh.hexahedra.resize(8, counts.num_cells());
  for (int k = 0; k <= counts.layers; ++k)
    for (int i = 0; i < num_points; ++i)
      mesh.vertices.col(k * num_points + i) << radius * disc.points[static_cast<std::size_t>(i)],
          height * k / counts.layers;
  int hex = 0;
  for (int k = 0; k < counts.layers; ++k)
    for (const std::array<int, 4>& cell : disc.cells) {
      for (int i = 0; i < 4; ++i) {
        mesh.hexahedra(i, hex) = k * num_points + cell[static_cast<std::size_t>(i)];
        mesh.hexahedra(i + 4, hex) = (k + 1) * num_points + cell[static_cast<std::size_t>(i)];
      }
      ++hex;
    }
  return mesh;
}

mesh::TetMesh split_hexahedra(const HexMesh& mesh) {
  const int num_corners = static_cast<int>(mesh.vertices.cols());
  const int num_hexahedra = static_cast<int>(mesh.hexahedra.cols());
  mesh::TetMesh result;
  result.vertices.resize(3, num_corners + num_hexahedra);
  result.vertices.leftCols(num_corners) = mesh.vertices;
  for (int hex = 0; hex < num_hexahedra; ++hex) {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < 8; ++i) sum += mesh.vertices.col(mesh.hexahedra(i, hex));
    result.vertices.col(num_corners + hex) = sum / 8.0;
  }
  std::vector<std::array<int, 4>> tets;
  tets.reserve(static_cast<std::size_t>(12 * num_hexahedra));
  visit_faces(
      mesh,
      [&tets, num_corners](const Face& face, int other) {
        for (std::size_t i = 0; i < 4; ++i)
          tets.push_back(
              {face.corner[i], face.corner[(i + 1) % 4], num_corners + face.hex, num_corners + other});
      },
      [&tets, num_corners](const Face& face) {
        for (const std::array<int, 3>& half : halve(face))
          tets.push_back({half[0], half[2], half[1], num_corners + face.hex});
      });
  result.tets.resize(4, static_cast<Eigen::Index>(tets.size()));
  for (std::size_t i = 0; i < tets.size(); ++i)
    result.tets.col(static_cast<Eigen::Index>(i)) = Eigen::Vector4i(tets[i].data());
  return result;
}

mesh::TriangleMesh extract_boundary(const HexMesh& mesh) {
  std::vector<std::array<int, 3>> triangles;
  visit_faces(
      mesh, [](const Face&, int) {},
      [&triangles](const Face& face) {
        for (const std::array<int, 3>& half : halve(face)) triangles.push_back(half);
      });
  std::vector<int> number(static_cast<std::size_t>(mesh.vertices.cols()), -1);
  mesh::TriangleMesh result;
  result.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  result.vertices.resize(3, mesh.vertices.cols());
  int num_used = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      int& n = number[static_cast<std::size_t>(triangles[t][i])];
      if (n < 0) {
        n = num_used++;
        result.vertices.col(n) = mesh.vertices.col(triangles[t][i]);
      }
      result.triangles(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(t)) = n;
    }
  result.vertices.conservativeResize(3, num_used);
  return result;
}

}  // namespace argil::shapes
