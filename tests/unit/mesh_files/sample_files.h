#pragma once

// One body of two tets in every format, with what real files mix into it: a surface triangle, labels with
// gaps, data that are not wanted.

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "support/two_tets.h"

namespace argil::test {

/// Appends the bytes of `value`, last first when `is_big` (on the little-endian machines that we run on).
template <class T>
void append_bytes(std::string& text, T value, bool is_big = false) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) text += bytes[is_big ? sizeof(T) - 1 - i : i];
}

struct SampleFile {
  std::string name;  ///< with its ending
  std::string content;
  std::string beside;  ///< name of a second file that it needs; empty: none
  std::string beside_content;
};

/// make_two_tets() in every tetrahedral format and encoding.
std::vector<SampleFile> make_tet_samples();

/// A tetrahedron's surface, vertices (0,0,0) (1,0,0) (0,1,0) (0,0,1), triangles 021 013 032 123 in that
/// order, in every surface format and encoding.
std::vector<SampleFile> make_surface_samples();

/// Binary pieces that several tests take apart.
std::string make_gmsh_22_binary();
std::string make_gmsh_41_binary();
std::string make_vtk_binary();
std::string make_stl_binary();
std::string make_ply_binary(bool is_big);

}  // namespace argil::test
