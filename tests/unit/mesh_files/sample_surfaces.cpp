#include <array>

#include "sample_files.h"

namespace argil::test {
namespace {

constexpr std::array<std::array<double, 3>, 4> kVertices = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr std::array<std::array<int, 3>, 4> kTriangles = {{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};

constexpr const char* kObj = R"(# a tetrahedron
mtllib none.mtl
v 0 0 0
v 1.0 0 0 1.0
vt 0.5 0.5
vn 0 0 1
v 0 1 0 0.5 0.5 0.5
v 0 0 \
  1
usemtl none
f 1 3 2
f 1/1 2/1 4/1 # textured
f 1//1 4//1 3//1
f -3/1/1 -2/1/1 -1/1/1
)";

std::string make_stl_ascii() {
  std::string text = "solid a tetrahedron\n";
  for (const auto& triangle : kTriangles) {
    text += "  facet normal nan nan nan\n    outer loop\n";
    for (const int v : triangle) {
      text += "      vertex";
      for (const double c : kVertices[static_cast<std::size_t>(v)]) text += c > 0.0 ? " 1.0e0" : " -0.0";
      text += "\n";
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid a tetrahedron\n";
}

constexpr const char* kPlyAscii = R"(ply
format ascii 1.0
comment a tetrahedron
element vertex 4
property float nx
property double x
property double y
property double z
element face 4
property uchar red
property list uchar int vertex_indices
element edge 1
property int vertex1
end_header
9 0 0 0
9 1 0 0
9 0 1 0
9 0 0 1
255 3 0 2 1
255 3 0 1 3
255 3 0 3 2
255 3 1 2 3
0
)";

}  // namespace

std::string make_stl_binary() {
  std::string text = "solid, yet binary";
  text.resize(80, ' ');
  append_bytes(text, std::uint32_t{4});
  for (const auto& triangle : kTriangles) {
    for (int c = 0; c < 3; ++c) append_bytes(text, 0.0F);
    for (const int v : triangle)
      for (const double c : kVertices[static_cast<std::size_t>(v)]) append_bytes(text, static_cast<float>(c));
    append_bytes(text, std::uint16_t{0});
  }
  return text;
}

std::string make_ply_binary(bool is_big) {
  std::string text =
      std::string("ply\nformat binary_") + (is_big ? "big" : "little") +
      "_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nelement face 4\nproperty list uchar ushort vertex_index\nend_header\n";
  for (std::size_t v = 0; v < 4; ++v) {
    for (const double c : kVertices[v]) append_bytes(text, static_cast<float>(c), is_big);
    text += '\x0a';  // a colour that looks like a line break
  }
  for (const auto& triangle : kTriangles) {
    text += '\x03';
    for (const int v : triangle) append_bytes(text, static_cast<std::uint16_t>(v), is_big);
  }
  return text;
}

std::vector<SampleFile> make_surface_samples() {
  return {
      {"text.obj", kObj, "", ""},
      {"text.stl", make_stl_ascii(), "", ""},
      {"binary.stl", make_stl_binary(), "", ""},
      {"text.ply", kPlyAscii, "", ""},
      {"little.ply", make_ply_binary(false), "", ""},
      {"big.PLY", make_ply_binary(true), "", ""},
      {"text.off", "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n", "", ""}};
}

}  // namespace argil::test
