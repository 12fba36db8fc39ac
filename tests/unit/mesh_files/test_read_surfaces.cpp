// Surface formats: each reads a tetrahedron's surface known beforehand and refuses what it must.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/rng.h"
#include "mesh_files/readers.h"
#include "sample_files.h"
#include "support/surface_report.h"
#include "support/temp_folder.h"
#include "support/utf16.h"

namespace argil::mesh_files {
namespace {

using test::SampleFile;

mesh::TriangleMesh read_text(const test::TempFolder& folder, const std::string& name,
                             const std::string& content) {
  return read_triangle_mesh(folder.write(name, content));
}

// Corners by place, because STL numbers vertices as they appear.
void expect_tetrahedron(const mesh::TriangleMesh& mesh, const std::string& about) {
  ASSERT_EQ(mesh.num_vertices(), 4) << about;
  ASSERT_EQ(mesh.num_triangles(), 4) << about;
  const Points x = (Points(3, 4) << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1).finished();
  const Triangles expected = (Triangles(3, 4) << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3).finished();
  for (int t = 0; t < 4; ++t)
    for (int c = 0; c < 3; ++c)
      EXPECT_TRUE(mesh.vertices.col(mesh.triangles(c, t)) == x.col(expected(c, t)))
          << about << " triangle " << t << " corner " << c;
}

TEST(ReadSurfaces, EveryFormatAndEncodingGivesTheSameSurface) {
  const test::TempFolder folder;
  for (const SampleFile& sample : test::make_surface_samples()) {
    const mesh::TriangleMesh mesh = read_text(folder, sample.name, sample.content);
    expect_tetrahedron(mesh, sample.name);
    EXPECT_TRUE(test::compute_surface_report(mesh).is_closed()) << sample.name;
  }
}

TEST(ReadSurfaces, ScaleMultipliesCoordinates) {
  const test::TempFolder folder;
  for (const SampleFile& sample : test::make_surface_samples())
    EXPECT_EQ(read_triangle_mesh(folder.write(sample.name, sample.content), 0.01).vertices.maxCoeff(), 0.01);
}

TEST(ReadSurfaces, PolygonsAreFannedAroundTheirFirstCorner) {
  const test::TempFolder folder;
  const std::string points = "0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\n";
  const mesh::TriangleMesh obj = read_text(folder, "p.obj", "v " + points + "f 1 2 3 4 5\n");
  const Triangles expected = (Triangles(3, 3) << 0, 0, 0, 1, 2, 3, 2, 3, 4).finished();
  EXPECT_TRUE(obj.triangles == expected) << obj.triangles;
  const mesh::TriangleMesh ply =
      read_text(folder, "p.ply",
                "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                "property float z\nelement face 1\nproperty list int int vertex_indices\n"
                "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 3 2 1 0\n");
  EXPECT_TRUE(ply.triangles == (Triangles(3, 2) << 3, 3, 2, 1, 1, 0).finished()) << ply.triangles;
}

TEST(ReadSurfaces, VerticesOfNoTriangleAreLeftOutAndTold) {
  const test::TempFolder folder;
  FileVertices vertices;
  const std::string obj = folder.write(
      "p.obj",
      "v 9 9 9\nv 0 0 0\nv 8 8 8\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 7 7 7\nf 2 5 4\nf 2 4 6\nf 2 6 5\nf 4 5 6\n");
  const mesh::TriangleMesh mesh = read_triangle_mesh(obj, 1.0, &vertices);
  ASSERT_EQ(mesh.num_vertices(), 4);
  EXPECT_TRUE(mesh.vertices == (Points(3, 4) << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1).finished());
  EXPECT_TRUE(mesh.triangles == (Triangles(3, 4) << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3).finished());
  EXPECT_EQ(vertices.num_left_out(), 3);
  EXPECT_EQ(vertices.kept, (std::vector<int>{1, 3, 4, 5}));
  EXPECT_EQ(vertices.describe("p", "triangle").substr(0, 45),
            "p: 3 of 7 vertices belong to no triangle and ");
}

TEST(ReadSurfaces, AnObjFaceMayStandBeforeItsVertices) {
  const test::TempFolder folder;
  EXPECT_EQ(read_text(folder, "p.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").num_triangles(), 1);
}

TEST(ReadSurfaces, KeywordsOfAnObjMayBeInEitherCase) {
  const test::TempFolder folder;
  EXPECT_EQ(read_text(folder, "p.obj", "V 0 0 0\nv 1 0 0\nV 0 1 0\nVN 0 0 1\nF 1 2 3\n").num_triangles(), 1);
}

TEST(ReadSurfaces, StlMergesEqualCornersOnly) {
  const test::TempFolder folder;
  const std::string facet = "facet normal 0 0 1\nouter loop\n";
  const std::string end = "endloop\nendfacet\n";
  const auto read = [&](const std::string& third) {
    return read_text(folder, "p.stl",
                     "solid\n" + facet + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n" + end + facet +
                         "vertex 1 0 0\nvertex 1 1 0\nvertex " + third + "\n" + end + "endsolid\n");
  };
  EXPECT_EQ(read("-0 1 -0.0").num_vertices(), 4);               // −0 is 0
  EXPECT_EQ(read("1e-300 1 0").num_vertices(), 5);              // near is not equal
  EXPECT_EQ(read("0 1.0000000000000002 0").num_vertices(), 5);  // one unit in the last place
}

// The marks of editors on Windows must not hide the first word, wherever a file is text.
TEST(ReadSurfaces, AByteOrderMarkAndUtf16AreNoPartOfTheText) {
  const test::TempFolder folder;
  for (const SampleFile& sample : test::make_surface_samples()) {
    if (sample.content.find('\0') != std::string::npos) continue;  // binary
    expect_tetrahedron(read_text(folder, sample.name, "\xEF\xBB\xBF" + sample.content), sample.name);
    const std::string little = "\xFF\xFE" + test::to_utf16(sample.content, false);
    const std::string big = "\xFE\xFF" + test::to_utf16(sample.content, true);
    expect_tetrahedron(read_text(folder, sample.name, little), sample.name);
    expect_tetrahedron(read_text(folder, sample.name, big), sample.name);
  }
}

TEST(ReadSurfaces, ABinaryStlMayBeginWithTheBytesOfAMark) {
  const test::TempFolder folder;
  for (const char* mark : {"\xEF\xBB\xBF", "\xFF\xFE", "\xFE\xFF"}) {
    std::string content = test::make_stl_binary();
    content.replace(0, std::string(mark).size(), mark);
    expect_tetrahedron(read_text(folder, "p.stl", content), mark);
  }
}

// As on Macs before 2001.
TEST(ReadSurfaces, LinesMayEndWithCarriageReturnsAlone) {
  const test::TempFolder folder;
  for (SampleFile sample : test::make_surface_samples()) {
    if (sample.content.find('\0') != std::string::npos) continue;  // binary
    std::replace(sample.content.begin(), sample.content.end(), '\n', '\r');
    expect_tetrahedron(read_text(folder, sample.name, sample.content), sample.name);
  }
}

TEST(RefuseSurfaces, Utf16WithoutAMarkIsNamed) {
  const test::TempFolder folder;
  for (const SampleFile& sample : test::make_surface_samples()) {
    if (sample.content.find('\0') != std::string::npos) continue;  // binary
    const std::string little = test::to_utf16(sample.content, false);
    const std::string big = test::to_utf16(sample.content, true);
    for (const std::string& wide : {little, big, "\xFF\xFE" + little.substr(0, little.size() - 1)})
      ARGIL_EXPECT_THROW_WITH(
          read_text(folder, sample.name, wide), InputError,
          sample.name + ": is text in UTF-16, without a byte order mark or cut; save it as UTF-8");
  }
}

TEST(ReadSurfaces, KeywordsOfAnAsciiStlMayBeInEitherCase) {
  const test::TempFolder folder;
  const std::string content = test::make_surface_samples()[1].content;
  std::string upper = content;
  for (char& c : upper)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  expect_tetrahedron(read_text(folder, "p.stl", upper), "upper");
  std::string mixed = content;
  for (std::size_t i = 0; i + 1 < mixed.size(); ++i)
    if (mixed[i] == ' ' || mixed[i] == '\n') mixed[i + 1] = upper[i + 1];
  expect_tetrahedron(read_text(folder, "p.stl", mixed), "mixed");
}

TEST(ReadSurfaces, TheNameOfASolidMayHoldAnyWord) {
  const test::TempFolder folder;
  const std::string content = test::make_surface_samples()[1].content;
  for (const std::string name : {"facet normal", "endsolid solid", "vertex 1 2 3"}) {
    std::string named = "solid " + name + content.substr(content.find('\n'));
    named.resize(named.rfind("endsolid"));
    expect_tetrahedron(read_text(folder, "p.stl", named + "endsolid " + name + "\n"), name);
  }
}

// A header of 80 bytes that begins as a text does; a zero in a text that does not.
TEST(ReadSurfaces, ABinaryStlIsKnownByItsZeros) {
  const test::TempFolder folder;
  ARGIL_EXPECT_THROW_WITH(read_text(folder, "p.stl", "solid " + test::make_stl_binary().substr(6) + "x"),
                          InputError, "4 triangles take 200 bytes, but 201 follow");
  std::string text = test::make_surface_samples()[1].content;
  text.insert(7, 1, '\0');
  expect_tetrahedron(read_text(folder, "p.stl", text), "a zero in the name");
}

TEST(ReadSurfaces, WhatNothingUsesMayBeNotFinite) {
  const test::TempFolder folder;
  FileVertices told;
  const mesh::TriangleMesh obj = read_triangle_mesh(
      folder.write("p.obj", "v 0 0 0\nv nan -inf 1.#QNAN # none\nv 1 0 0\nv 0 1 0\nf 1 3 4\n"), 1.0, &told);
  EXPECT_TRUE(obj.vertices == (Points(3, 3) << 0, 1, 0, 0, 0, 1, 0, 0, 0).finished());
  EXPECT_EQ(told.kept, (std::vector<int>{0, 2, 3}));
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty list uchar float w\nelement face 1\nproperty float quality\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0 nan 1 -nan\n1 0 0 -nan(ind) 0\n0 1 0 1.#IND 2 inf inf\n-inf nan 0 0 0\nnan 3 0 1 2\n";
  EXPECT_TRUE(read_text(folder, "p.ply", ply).vertices == obj.vertices);
  EXPECT_TRUE(
      read_text(folder, "p.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n1.#QNAN 0 inf\n3 0 1 2\n").vertices ==
      obj.vertices);
  std::string binary = test::make_ply_binary(false);
  const std::string red = "property uchar red\n";
  binary.replace(binary.find(red), red.size(), "property float nx\n");
  for (std::size_t v = 0, at = binary.find("end_header\n") + 11 + 12; v < 4; ++v, at += 16) {
    std::string nan;
    test::append_bytes(nan, std::numeric_limits<float>::quiet_NaN());
    binary.replace(at, 1, nan);
  }
  expect_tetrahedron(read_text(folder, "p.ply", binary), "binary");
}

TEST(ReadSurfaces, OffIsReadInItsUsualForms) {
  const test::TempFolder folder;
  const std::string counts = "4 4 6\n";
  const std::string bare = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const std::string rich =
      "0 0 0  1 0 0 0.5 0.5 0.5 1\n\n1 0 0  1 0 0 0 0 0 1 # second\n0 1 0  0 1 0 0 0 0 1\n0 0 1  0 0 1 0 0 0 "
      "1\n"
      "3 0 2 1  255 0 0\n3 0 1 3  0.1 0.2 0.3 1\n# between\n3 0 3 2\n3 1 2 3  7\n";
  for (const std::string& text :
       {"OFF\n" + counts + bare, "OFF " + counts + bare, "OFF" + counts + bare, counts + bare,
        "# made\n#by hand\n\nNCOFF # all\n" + counts + rich, "OFF\r\n" + counts + bare})
    expect_tetrahedron(read_text(folder, "p.off", text), text);
  EXPECT_EQ(read_text(folder, "p.off", "OFF\n4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n").num_triangles(),
            2);
}

TEST(ReadSurfaces, SeveralSolidsOfAnStlAreOneSurface) {
  const test::TempFolder folder;
  const std::string content = test::make_surface_samples()[1].content;
  const mesh::TriangleMesh mesh = read_text(folder, "two.stl", content + content);
  EXPECT_EQ(mesh.num_triangles(), 8);
  EXPECT_EQ(mesh.num_vertices(), 4);
}

struct Refusal {
  const char* name;
  std::string content;
  const char* words;
};

TEST(RefuseSurfaces, EveryFormatSaysWhere) {
  const std::string v3 = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n";
  const std::string ply_face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string ply_z = ply + "property float z\n" + ply_face + "0 0 0\n1 0 0\n0 1 0\n";
  const std::vector<Refusal> refusals = {
      {"a.obj", v3 + "f 1 2\n", "a.obj: line 4: a face of 2 vertices; a face has at least 3"},
      {"a.obj", v3 + "f 1 2 4\n", "line 4: a face names vertex 4; vertices run from 1 to 3"},
      {"a.obj", v3 + "f 1 2 0\n", "line 4: a face names vertex 0; OBJ counts vertices from 1"},
      {"a.obj", v3 + "f 1 2 -4\n", "line 4: a face names vertex -4 of the 3 so far"},
      {"a.obj", v3 + "f 1 2 x/1\n", "line 4: a face's vertex number is \"x\""},
      {"a.obj", v3 + "f 1 2 /1\n", "line 4: a face's vertex number is \"\""},
      {"a.obj", v3 + "v 0 0\nf 1 2 3\n", "line 4: a vertex of 2 coordinates"},
      {"a.obj", v3 + "v 0 0 nan\nf 1 2 4\n", "a.obj: line 4: vertex 4: z is nan; give a finite number"},
      {"a.obj", v3 + "v 0 0 1.#INF\nf 1 2 4\n", "line 4: vertex 4: z is inf; give a finite number"},
      {"a.obj", v3 + "v 0 0 none\nf 1 2 3\n", "line 4: a vertex coordinate is \"none\", not a number"},
      {"a.obj", "v 0 0 0\rv 1 0 0\nv 0 1 0\nf 1 2 3\n",
       "line 1: a carriage return stands within the line; save it with one kind of line end"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 -inf\n0 1 0\n3 0 1 2\n", "line 4: vertex 1: z is -inf"},
      {"a.obj", v3, "holds no faces"},
      {"a.stl", "solid\nendsolid\n", "holds no faces"},
      {"a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf\n",
       "line 4: a corner's coordinate is \"inf\""},
      {"a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n",
       "line 5: \"endloop\" where vertex was expected"},
      {"a.stl", "solid\nhello\n", "line 2: \"hello\" where facet or endsolid was expected"},
      {"a.stl", "solid\n", "the file ends where endsolid was expected"},
      {"a.stl", test::make_stl_binary() + "x", "4 triangles take 200 bytes, but 201 follow"},
      {"a.stl", std::string(80, ' ') + "\xff\xff\xff" + '\0',
       "byte 80: the number of triangles is 16777215, more than"},
      {"a.stl", std::string("short\0", 6), "byte 6: the file ends where the header was expected"},
      {"a.stl", "short", "line 1: \"short\" where solid was expected"},
      {"a.stl", "EndSolid\n", "line 1: \"EndSolid\" where solid was expected"},
      {"a.stl", "\nfacet normal 0 0 1\n", "line 2: \"facet\" where solid was expected"},
      {"a.stl", "solid\nFacet Normal 0 0 1\nOUTER LOPP\n", "line 3: \"LOPP\" where loop was expected"},
      {"a.stl", "solid\n\x1b[31m\n", "line 2: \"?[31m\" where facet"},
      {"a.ply", "PLY\n", "line 1: does not begin with \"ply\""},
      {"a.ply", "ply\nformat text 1.0\n", "line 2: format \"text\""},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 99999\n",
       "line 3: the number of elements is 99999, more than"},
      {"a.ply", "ply\nformat ascii 1.0\nproperty float x\n", "line 3: a property before any element"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty real x\n",
       "line 4: property type \"real\""},
      {"a.ply", ply + ply_face + "0 0\n1 0\n0 1\n3 0 1 2\n", "element vertex has not the properties x, y, z"},
      {"a.ply", ply_z + "3 0 1 3\n", "line 13: a face names vertex 3; vertices run from 0 to 2"},
      {"a.ply", ply_z + "3 0 1 -1\n", "line 13: a face names vertex -1"},
      {"a.ply", ply_z + "2 0 1\n", "line 13: a face of 2 vertices"},
      {"a.ply", ply_z + "1000 0 1\n", "line 13: a list's length is 1000, more than"},
      {"a.ply", ply_z + "3 0 1.5 2\n", "line 13: a face's vertex number is not a whole number"},
      {"a.ply", ply_z + "3 0 1\n", "line 13: the file ends where a face's vertex number was expected"},
      {"a.ply", "ply\nelement vertex 0\nend_header\n", "the header has no format"},
      {"a.off", "OFF\n", "the file ends where the numbers of vertices, faces and edges was expected"},
      {"a.off", "4OFF\n1 1 1\n", "line 1: keyword \"4OFF\"; save it with x, y and z"},
      {"a.off", "OFF BINARY\n", "line 1: is a binary OFF"},
      {"a.off", "OFF\n3 -1 0\n", "line 2: a count is -1"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 4: a vertex coordinate is \"\""},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
       "line 6: a face names vertex 3; vertices run from 0 to 2"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "line 6: a face of 2 vertices"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n900 0 1 2\n", "line 6: a face's vertex number is \"\""},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n", "the file ends where a face was expected"},
      {"a.3ds", "x", "ending \".3ds\" is no known surface format; use .obj, .off, .ply or .stl"},
  };
  const test::TempFolder folder;
  for (const Refusal& refusal : refusals) {
    SCOPED_TRACE(refusal.content);
    ARGIL_EXPECT_THROW_WITH(read_text(folder, refusal.name, refusal.content), InputError, refusal.words);
  }
  ARGIL_EXPECT_THROW_WITH(read_triangle_mesh(folder / "none.obj"), IoError, "cannot be read: No such file");
}

TEST(RefuseSurfaces, BinaryNumbersThatAreNotFinite) {
  const test::TempFolder folder;
  for (const bool is_big : {false, true}) {
    std::string one;
    std::string nan;
    test::append_bytes(one, 1.0F, is_big);
    test::append_bytes(nan, std::numeric_limits<float>::quiet_NaN(), is_big);
    std::string ply = test::make_ply_binary(is_big);
    ply.replace(ply.find(one), 4, nan);
    ARGIL_EXPECT_THROW_WITH(read_text(folder, "a.ply", ply), InputError,
                            "vertex 1: x is nan; give a finite number");
    if (is_big) continue;
    std::string stl = test::make_stl_binary();
    stl.replace(stl.find(one), 4, nan);
    ARGIL_EXPECT_THROW_WITH(read_text(folder, "a.stl", stl), InputError,
                            "a corner's coordinate is not finite");
  }
}

TEST(FuzzSurfaces, AFileCutAnywhereIsRefusedOrShorter) {
  const test::TempFolder folder;
  for (const SampleFile& whole : test::make_surface_samples())
    for (std::size_t length = 0; length < whole.content.size(); ++length) {
      try {
        const mesh::TriangleMesh mesh = read_text(folder, whole.name, whole.content.substr(0, length));
        // Only OBJ has no end and no count.
        EXPECT_TRUE(whole.name == "text.obj" || mesh.num_triangles() == 4)
            << whole.name << " cut to " << length;
      } catch (const InputError&) {
      }
    }
}

TEST(FuzzSurfaces, DamagedBytesNeverGiveASurfaceOutOfRange) {
  const test::TempFolder folder;
  Rng rng(20240801, "damaged surfaces");
  constexpr int kTrials = 150;
  const std::string bytes = "0123456789.-+eE/ \n\\#\xff\x7f" + std::string(1, '\0');
  for (const SampleFile& whole : test::make_surface_samples())
    for (int trial = 0; trial < kTrials; ++trial) {
      std::string content = whole.content;
      const auto hits = 1 + rng.next_bits() % 4;
      for (std::uint64_t hit = 0; hit < hits; ++hit)
        content[rng.next_bits() % content.size()] = bytes[rng.next_bits() % bytes.size()];
      try {
        const mesh::TriangleMesh mesh = read_text(folder, whole.name, content);
        ASSERT_TRUE(mesh.vertices.allFinite()) << whole.name << " trial " << trial;
        ASSERT_GE(mesh.triangles.minCoeff(), 0);
        ASSERT_LT(mesh.triangles.maxCoeff(), mesh.num_vertices());
      } catch (const InputError&) {
      }
    }
}

}  // namespace
}  // namespace argil::mesh_files
