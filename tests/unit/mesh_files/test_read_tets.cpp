// Tetrahedral formats: each reads a body known beforehand, in every encoding, and each refuses what it must
// with the file, the place, the value and a remedy. Base64 and zlib texts were written by VTK 9.1; the other
// layouts follow the formats' own manuals (sources in src/mesh/read_*.cpp).
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/rng.h"
#include "mesh/topology.h"
#include "mesh_files/readers.h"
#include "sample_files.h"
#include "support/temp_folder.h"
#include "support/utf16.h"

namespace argil::mesh_files {
namespace {

using std::string_literals::operator""s;
using test::SampleFile;

mesh::TetMesh read_sample(const test::TempFolder& folder, const SampleFile& sample, double scale = 1.0) {
  if (!sample.beside.empty()) folder.write(sample.beside, sample.beside_content);
  return read_tet_mesh(folder.write(sample.name, sample.content), scale);
}

SampleFile find_sample(const std::string& name) {
  for (const SampleFile& sample : test::make_tet_samples())
    if (sample.name == name || sample.beside == name) return sample;
  ADD_FAILURE() << "no sample " << name;
  return {};
}

void expect_two_tets(const mesh::TetMesh& mesh, const std::string& about, double scale = 1.0) {
  const mesh::TetMesh expected = test::make_two_tets();
  EXPECT_TRUE(mesh.vertices == scale * expected.vertices) << about << "\n" << mesh.vertices;
  EXPECT_TRUE(mesh.tets == expected.tets) << about << "\n" << mesh.tets;
}

void expect_field(const mesh::TetMesh& mesh, const std::string& name, double first, double second) {
  ASSERT_TRUE(mesh.cell_fields.contains(name)) << name;
  ASSERT_EQ(mesh.cell_fields.at(name).size(), 2);
  EXPECT_EQ(mesh.cell_fields.at(name)(0), first) << name;
  EXPECT_EQ(mesh.cell_fields.at(name)(1), second) << name;
}

TEST(ReadTets, EveryFormatAndEncodingGivesTheSameBits) {
  const test::TempFolder folder;
  for (const SampleFile& sample : test::make_tet_samples())
    expect_two_tets(read_sample(folder, sample), sample.name);
}

TEST(ReadTets, EitherNameOfATetGenPairReadsBoth) {
  const test::TempFolder folder;
  const SampleFile sample = find_sample("from_1.node");
  folder.write(sample.name, sample.content);
  expect_two_tets(read_tet_mesh(folder.write(sample.beside, sample.beside_content)), sample.beside);
}

TEST(ReadTets, ScaleMultipliesCoordinates) {
  const test::TempFolder folder;
  for (const SampleFile& sample : test::make_tet_samples())
    expect_two_tets(read_sample(folder, sample, 0.001), sample.name, 0.001);
}

TEST(ReadTets, KeywordsOfMeditMayBeInSmallLetters) {
  const test::TempFolder folder;
  SampleFile sample = find_sample("medit.mesh");
  for (char& c : sample.content) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  expect_two_tets(read_sample(folder, sample), sample.name);
}

TEST(ReadTets, LineEndsOfOtherSystemsReadTheSame) {
  const test::TempFolder folder;
  for (const char* name :
       {"22_ascii.msh", "41_ascii.msh", "medit.mesh", "vega.VEG", "version_4.vtk", "ascii.vtu"}) {
    SampleFile sample = find_sample(name);
    std::string content;
    for (const char c : sample.content) content += c == '\n' ? "\r\n" : std::string(1, c);
    sample.content = content;
    expect_two_tets(read_sample(folder, sample), name);
  }
}

// As on Macs before 2001.
TEST(ReadTets, LinesMayEndWithCarriageReturnsAlone) {
  const test::TempFolder folder;
  for (SampleFile sample : test::make_tet_samples()) {
    if (sample.content.find('\0') != std::string::npos) continue;  // binary
    for (std::string* text : {&sample.content, &sample.beside_content})
      std::replace(text->begin(), text->end(), '\n', '\r');
    expect_two_tets(read_sample(folder, sample), sample.name);
  }
}

TEST(RefuseTets, Utf16WithoutAMarkIsNamed) {
  const test::TempFolder folder;
  for (const SampleFile& sample : test::make_tet_samples()) {
    if (sample.content.find('\0') != std::string::npos) continue;  // binary
    SampleFile wide = sample;
    for (const bool is_big : {false, true}) {
      wide.content = test::to_utf16(sample.content, is_big);
      ARGIL_EXPECT_THROW_WITH(
          read_sample(folder, wide), InputError,
          sample.name + ": is text in UTF-16, without a byte order mark or cut; save it as UTF-8");
    }
  }
}

TEST(ReadTets, AByteOrderMarkIsNoPartOfTheText) {
  const test::TempFolder folder;
  for (const char* name :
       {"22_ascii.msh", "41_ascii.msh", "medit.mesh", "vega.VEG", "version_4.vtk", "ascii.vtu"}) {
    SampleFile sample = find_sample(name);
    sample.content.insert(0, "\xEF\xBB\xBF");
    expect_two_tets(read_sample(folder, sample), name);
  }
}

// x, y and z of some programs make every tet's volume negative; one alone is a fault of the mesh.
TEST(ReadTets, WhereAllAreMirroredTwoCornersAreSwappedAndTold) {
  const test::TempFolder folder;
  const auto read = [&](const std::string& tets, FileVertices& told) {
    return read_tet_mesh(
        folder.write("m.mesh",
                     "MeshVersionFormatted 1\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
                     "1 1 1 0\nTetrahedra\n2\n" +
                         tets + "End\n"),
        1.0, &told);
  };
  FileVertices told;
  const mesh::TetMesh mirrored = read("1 3 2 4 0\n2 4 3 5 0\n", told);
  EXPECT_TRUE(told.is_mirrored);
  EXPECT_EQ(
      told.describe("m", "tet"),
      "m: every tet is numbered the other way round, with a negative volume; two of its corners are swapped");
  const Field volumes = mesh::compute_volumes(mirrored.vertices, mirrored.tets);
  EXPECT_NEAR(volumes(0), 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(volumes(1), 1.0 / 3.0, 1e-15);
  const mesh::TetMesh one = read("1 3 2 4 0\n2 3 4 5 0\n", told);
  EXPECT_FALSE(told.is_mirrored);
  EXPECT_EQ(told.describe("m", "tet"), "");
  EXPECT_LT(mesh::compute_volumes(one.vertices, one.tets)(0), 0.0);
}

TEST(ReadTets, NumbersPerTetBecomeCellFields) {
  const test::TempFolder folder;
  const auto read = [&](const char* name) { return read_sample(folder, find_sample(name)); };
  expect_field(read("22_ascii.msh"), "E [Pa] of \"clay\"", 1e5, 2.5e5);
  expect_field(read("22_binary.msh"), "E", 1e5, 2.5e5);
  expect_field(read("from_1.node"), "attribute 1", 1e5, 2e5);
  expect_field(read("version_4.vtk"), "young modulus", 0.1, 2e5);
  expect_field(read("version_4.vtk"), "region", 3, 4);
  expect_field(read("binary.vtk"), "E", 1e5, 2.5e5);
  expect_field(read("binary.vtk"), "region", 10, 11);
  expect_field(read("ascii.vtu"), "E <Pa>", 0.1, 2e5);
  for (const char* name : {"version_5.vtk", "base64.vtu", "zlib.vtu", "appended.vtu"})
    expect_field(read(name), "region", 3, 4);
}

void replace_once(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

// "VTK File Formats" gives strings no form; this is what the writer of VTK makes of them (vtkDataWriter): one
// a line with percent signs, and after a length of 1, 2, 4 or 8 bytes in the binary form. Variants are lines
// in both, and a byte holds eight bits, the first highest.
TEST(ReadTets, LegacyVtkStringsArePassedOver) {
  const test::TempFolder folder;
  SampleFile text = find_sample("version_4.vtk");
  replace_once(text.content, "POINTS", "FIELD FieldData 1\nmaterial 1 1 string\nsoft clay\nPOINTS");
  replace_once(text.content, "FIELD FieldData 2\nyoung",
               "SCALARS name string 1\nLOOKUP_TABLE default\nclay\nSCALARS\n\n"
               "PEDIGREE_IDS id string\na\nb\nc\n"
               "FIELD FieldData 5\nlabel 2 3 string\na%20b\n\nMETADATA\nPOINTS 5\n1\n\n"
               "METADATA\nCOMPONENT_NAMES\none\ntwo\n\nany 1 3 variant\n13 clay\n10 2\n13 \n"
               "wet 1 3 bit\n1 0 1\nyoung");
  const mesh::TetMesh mesh = read_sample(folder, text);
  expect_two_tets(mesh, "text");
  expect_field(mesh, "young modulus", 0.1, 2e5);
  expect_field(mesh, "region", 3, 4);
  expect_field(mesh, "wet", 1, 0);
  EXPECT_EQ(mesh.cell_fields.size(), 3U);
  text.content.resize(text.content.find("a%20b"));
  ARGIL_EXPECT_THROW_WITH(read_sample(folder, text), InputError, "more than the 0 bytes left of the file");
}

TEST(ReadTets, LegacyVtkBinaryStringsArePassedOver) {
  const test::TempFolder folder;
  SampleFile sample = find_sample("binary.vtk");
  const std::string strings =
      "\xC4"
      "clay" +
      std::string("\x80\x46") + std::string(70, '\n') + std::string("\x40\0\x40\0", 4) +
      std::string(0x4000, 'x');
  const std::string long_one = std::string("\0\0\0\0\0\0\0\3abc", 11);  // as no writer needs it
  replace_once(sample.content, "SCALARS E",
               "FIELD f 4\nname 1 3 string\n" + strings + "\nfew 1 2 utf8_string\n" + long_one +
                   "\xC0\nany 1 2 variant\n13 clay\n10 2\nwet 1 3 bit\n\x5F\nSCALARS E");
  const mesh::TetMesh mesh = read_sample(folder, sample);
  expect_two_tets(mesh, "binary");
  expect_field(mesh, "E", 1e5, 2.5e5);
  expect_field(mesh, "wet", 0, 1);
  replace_once(sample.content, std::string("\x40\0\x40\0", 4), std::string("\x7F\0\x40\0", 4));
  ARGIL_EXPECT_THROW_WITH(read_sample(folder, sample), InputError,
                          "the file ends where a string was expected");
}

TEST(ReadTets, XmlVtkStringsArePassedOver) {
  const test::TempFolder folder;
  SampleFile sample = find_sample("ascii.vtu");
  replace_once(
      sample.content, "<CellData Scalars=\"region\">",
      "<CellData><DataArray type=\"String\" Name=\"name\" format=\"ascii\">97 0 98 0 99 0 </DataArray>"
      "<Array type=\"String\" Name=\"other\" format=\"ascii\">97 0 98 0 99 0</Array>");
  const mesh::TetMesh mesh = read_sample(folder, sample);
  expect_field(mesh, "E <Pa>", 0.1, 2e5);
  EXPECT_EQ(mesh.cell_fields.size(), 1U);
}

// Numbers that nothing uses yet: a scenario that names the field refuses them.
TEST(ReadTets, ACellFieldMayHoldWhatIsNotFinite) {
  const test::TempFolder folder;
  const auto read = [&](const char* name, const std::string& from, const std::string& to) {
    SampleFile sample = find_sample(name);
    replace_once(sample.content.find(from) == std::string::npos ? sample.beside_content : sample.content,
                 from, to);
    return read_sample(folder, sample);
  };
  const auto expect = [](const mesh::TetMesh& mesh, const std::string& name, double second) {
    ASSERT_TRUE(mesh.cell_fields.contains(name)) << name;
    EXPECT_TRUE(std::isnan(mesh.cell_fields.at(name)(0))) << name;
    EXPECT_EQ(mesh.cell_fields.at(name)(1), second) << name;
  };
  expect(read("22_ascii.msh", "2 1e5", "2 nan"), "E [Pa] of \"clay\"", 2.5e5);
  expect(read("22_ascii.msh", "2 1e5\n3 +2.5e5", "2 1.#QNAN\n3 -1.#INF"), "E [Pa] of \"clay\"", -HUGE_VAL);
  expect(read("version_4.vtk", "0.1 200000", "-nan(ind) +inf"), "young modulus", HUGE_VAL);
  expect(read("ascii.vtu", "0.1 200000", "NaN 200000"), "E <Pa>", 2e5);
  expect(read("from_1.ele", "4 1e5", "4 -1.#IND"), "attribute 1", 2e5);
  for (const char* name : {"22_binary.msh", "binary.vtk"}) {
    const bool is_big = std::string(name) == "binary.vtk";
    std::string one;
    test::append_bytes(one, 1e5, is_big);
    std::string nan;
    test::append_bytes(nan, std::numeric_limits<double>::quiet_NaN(), is_big);
    expect(read(name, one, nan), "E", 2.5e5);
  }
}

TEST(ReadTets, VectorsAndPointDataAreNoCellFields) {
  const test::TempFolder folder;
  EXPECT_EQ(read_sample(folder, find_sample("version_4.vtk")).cell_fields.size(), 2U);
  EXPECT_EQ(read_sample(folder, find_sample("ascii.vtu")).cell_fields.size(), 1U);
  EXPECT_TRUE(read_sample(folder, find_sample("vega.VEG")).cell_fields.empty());
}

TEST(ReadTets, ANumberKeepsItsBits) {
  const test::TempFolder folder;
  SampleFile sample = find_sample("from_0.ele");
  const auto at = sample.beside_content.find("4 1 1 1");
  sample.beside_content.replace(at, 7, "4 0.1 +1e-3 12345678901234567");
  const mesh::TetMesh mesh = read_sample(folder, sample);
  EXPECT_EQ(mesh.vertices(0, 4), 0.1);
  EXPECT_EQ(mesh.vertices(1, 4), 1e-3);
  EXPECT_EQ(mesh.vertices(2, 4), 12345678901234567.0);
}

// A vertex that no tet uses, in the middle of each format's list: the rest keeps order and bits.
TEST(ReadTets, VerticesOfNoTetAreLeftOutAndTold) {
  const test::TempFolder folder;
  struct Change {
    const char* from;
    const char* to;
  };
  const auto read = [&](const std::string& name, const std::vector<Change>& changes, FileVertices& vertices) {
    SampleFile sample = find_sample(name);
    for (const Change& change : changes) {
      std::string& text =
          sample.content.find(change.from) == std::string::npos ? sample.beside_content : sample.content;
      const std::size_t at = text.find(change.from);
      if (at == std::string::npos) throw std::logic_error(std::string("no ") + change.from + " in " + name);
      text.replace(at, std::string(change.from).size(), change.to);
    }
    if (!sample.beside.empty()) folder.write(sample.beside, sample.beside_content);
    return read_tet_mesh(folder.write(sample.name, sample.content), 1.0, &vertices);
  };
  // Place 2 of the file is new; corners behind it move up by one.
  const std::vector<std::pair<std::string, std::vector<Change>>> files = {
      {"version_4.vtk",
       {{"POINTS 5 double\n0 0 0 1 0 0 ", "POINTS 6 double\n0 0 0 1 0 0 7 7 7 "},
        {"4 0 1 2 3", "4 0 1 3 4"},
        {"4 1 2 3 4", "4 1 3 4 5"}}},
      {"medit.mesh",
       {{"Vertices\n5\n0 0 0 1\n1 0 0 1\n", "Vertices\n6\n0 0 0 1\n1 0 0 1\n7 7 7 1\n"},
        {"\n1 2 3 4 1\n2 3 4 5 1", "\n1 2 4 5 1\n2 4 5 6 1"}}},
      {"from_0.ele",
       {{"5 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1 1 1",
         "6 3 0 0\n0 0 0 0\n1 1 0 0\n2 7 7 7\n3 0 1 0\n4 0 0 1\n5 1 1 1"},
        {"0 0 1 2 3\n1 1 2 3 4", "0 0 1 3 4\n1 1 3 4 5"}}},
      {"vega.VEG",
       {{"5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1",
         "6 3 0 0\n1 0 0 0\n2 1 0 0\n3 7 7 7\n4 0 1 0\n5 0 0 1\n6 1 1 1"},
        {"1 1 2 3 4\n2 2 3 4 5", "1 1 2 4 5\n2 2 4 5 6"}}},
      {"ascii.vtu",
       {{"NumberOfPoints=\"5\"", "NumberOfPoints=\"6\""},
        {"0 0 0 1 0 0\n0 1 0", "0 0 0 1 0 0 7 7 7\n0 1 0"},
        {"0 1 2 3 1 2 3 4 0 2 1", "0 1 3 4 1 3 4 5 0 2 1"}}},
  };
  for (const auto& [name, changes] : files) {
    FileVertices vertices;
    expect_two_tets(read(name, changes, vertices), name);
    EXPECT_EQ(vertices.num_in_file, 6) << name;
    EXPECT_EQ(vertices.kept, (std::vector<int>{0, 1, 3, 4, 5})) << name;
    EXPECT_EQ(vertices.find(1), 1);
    EXPECT_EQ(vertices.find(2), -1);
    EXPECT_EQ(vertices.find(5), 4);
    EXPECT_EQ(vertices.describe("f", "tet"),
              "f: 1 of 6 vertices belong to no tet and are left out, number 2 (from 0) the first");
    std::vector<Change> not_finite = changes;
    not_finite.push_back({"7 7 7", "nan -inf 1.#IND"});
    expect_two_tets(read(name, not_finite, vertices), name + " not finite");
    EXPECT_EQ(vertices.kept, (std::vector<int>{0, 1, 3, 4, 5})) << name;
  }
  for (const char* name : {"22_ascii.msh", "41_ascii.msh"}) {  // the sample's node 7, before the last one
    FileVertices vertices;
    expect_two_tets(read(name, {}, vertices), name);
    EXPECT_EQ(vertices.kept, (std::vector<int>{0, 1, 2, 3, 5})) << name;
    expect_two_tets(read(name, {{"5 5 5", "nan -inf 1.#IND"}}, vertices), name + " not finite"s);
  }
  FileVertices all;
  expect_two_tets(read("medit.mesh", {}, all), "medit.mesh");
  EXPECT_TRUE(all.kept.empty());
  EXPECT_EQ(all.find(3), 3);
  EXPECT_EQ(all.describe("f", "tet"), "");
}

// One sample with one thing wrong, and what the message must say. `from` is replaced at its first appearance.
struct Refusal {
  const char* sample;
  const char* from;
  const char* to;
  const char* words;
};

void expect_refusals(std::initializer_list<Refusal> refusals) {
  const test::TempFolder folder;
  for (const Refusal& refusal : refusals) {
    SCOPED_TRACE(std::string(refusal.sample) + ": " + refusal.from + " -> " + refusal.to);
    SampleFile sample = find_sample(refusal.sample);
    std::string& content = sample.name == refusal.sample ? sample.content : sample.beside_content;
    const std::size_t at = content.find(refusal.from);
    ASSERT_NE(at, std::string::npos);
    content.replace(at, std::string(refusal.from).size(), refusal.to);
    ARGIL_EXPECT_THROW_WITH(read_sample(folder, sample), InputError, refusal.words);
    ARGIL_EXPECT_THROW_WITH(read_sample(folder, sample), InputError, refusal.sample);  // the file's name
  }
}

TEST(RefuseTets, GmshSaysWhere) {
  expect_refusals({
      {"22_ascii.msh", "$MeshFormat", "$Mesh", "line 1: does not begin with $MeshFormat"},
      {"22_ascii.msh", "2.2 0", "1.0 0", "line 2: format version \"1.0\"; save it as 4.1 or 2.2"},
      {"41_ascii.msh", "4.1 0", "4 0", "line 2: format version \"4\""},
      {"22_ascii.msh", "0 8", "0 4", "line 2: data size 4"},
      {"22_ascii.msh", "2.2 0", "2.2 5", "line 2: file type 5"},
      {"22_ascii.msh", "2 1 0 0", "2 nan 0 0", "22_ascii.msh: vertex 2: x is nan; give a finite number"},
      {"22_ascii.msh", "2 1 0 0", "2 -inf 0 0", "22_ascii.msh: vertex 2: x is -inf; give a finite number"},
      {"22_ascii.msh", "2 1 0 0", "2 1e999 0 0",
       "line 11: a node coordinate is \"1e999\", outside the range"},
      {"22_ascii.msh", "2 1 0 0", "2 1,5 0 0", "line 11: a node coordinate is \"1,5\", not a number"},
      {"22_ascii.msh", "2 1 0 0", "2 +-1 0 0", "line 11: a node coordinate is \"+-1\", not a number"},
      {"22_ascii.msh", "2 1 0 0", "1 1 0 0", "vertex number 1 appears twice"},
      {"22_ascii.msh", "2 3 5 9", "2 3 5 8",
       "line 21: tet 3 names vertex 8; vertices run from 1 to 9 with gaps"},
      {"22_ascii.msh", "$Nodes\n6", "$Nodes\n999999999999",
       "line 9: the number of nodes is 999999999999, more than the"},
      {"22_ascii.msh", "$Nodes\n6", "$Nodes\n-1", "line 9: the number of nodes is -1"},
      {"22_ascii.msh", "$Nodes\n6", "$Nodes\n5", "line 15: \"9\" where $EndNodes was expected"},
      {"22_ascii.msh", "$Elements\n3", "$Elements\n2", "line 21: \"3\" where $EndElements was expected"},
      {"22_ascii.msh", "3 4 2 1 1 2 3 5 9", "3 11 2 1 1 2 3 5 9",
       "line 21: element type 11 (10-node tetrahedron)"},
      {"22_ascii.msh", "3 4 2 1 1 2 3 5 9", "3 5 2 1 1 2 3 5 9",
       "line 21: element type 5 (8-node hexahedron)"},
      {"22_ascii.msh", "3 4 2 1 1 2 3 5 9", "3 77 2 1 1 2 3 5 9", "line 21: element type 77 is not known"},
      {"22_ascii.msh", "2 1e5\n3", "2 1e5\n1", "has no value for tet 3; give every tet a value"},
      {"22_ascii.msh", "2 1e5", "2 none", "line 33: a cell value is \"none\", not a number"},
      {"22_ascii.msh", "$PhysicalNames", "$ParametricNodes", "line 4: section $ParametricNodes"},
      {"41_ascii.msh", "3 6 1 9", "3 7 1 9", "hold 6 nodes, $Nodes announces 7"},
      {"41_ascii.msh", "3 3 1 3", "3 4 1 3", "hold 3 elements, $Elements announces 4"},
      {"41_ascii.msh", "3 1 0 2", "3 1 0 2000000", "the number of nodes of a block is 2000000, more than"},
      {"41_ascii.msh", "3 1 4 1", "3 1 29 1", "element type 29 (20-node tetrahedron)"},
  });
}

TEST(RefuseTets, MeditTetGenAndVegaSayWhere) {
  expect_refusals({
      {"medit.mesh", "MeshVersionFormatted", "MeshVersion",
       "line 1: does not begin with MeshVersionFormatted"},
      {"medit.mesh", "Formatted 2", "Formatted 9", "line 1: format version 9"},
      {"medit.mesh", "Dimension\n3", "Dimension\n2", "line 4: Dimension 2"},
      {"medit.mesh", "Vertices\n5", "Vertices\n6",
       "line 12: a vertex coordinate is \"Triangles\", not a number"},
      {"medit.mesh", "Vertices\n5", "Vertices\n4", "line 11: \"1\" where a keyword was expected"},
      {"medit.mesh", "Vertices\n5", "Vertices\n5000", "line 6: the number of vertices is 5000, more than"},
      {"medit.mesh", "2 3 4 5 1", "2 3 4 6 1", "line 21: tet 2 names vertex 6; vertices run from 1 to 5"},
      {"medit.mesh", "Corners", "Hexahedra",
       "section Hexahedra holds elements that are not 4-node tetrahedra"},
      {"medit.mesh", "Tetrahedra", "Edges", "holds no tetrahedra"},
      {"from_1.node", "5  3", "5  2", "line 2: dimension 2"},
      {"from_1.node", "2 1 0 0", "7 1 0 0", "vertex number 7 is in place 1"},
      {"from_1.node", "5  3", "4  3", "line 7: \"5\" after the last vertex"},
      {"from_1.node", "0 0 1  7", "0 0 x  7", "line 6: a vertex coordinate is \"x\""},
      {"from_1.node", "5  3  1  1", "5  3  1000000000000  1",
       "the number of vertex attributes is 1000000000000"},
      {"from_1.ele", "2 4 1", "2 10 1", "line 1: 10 nodes per element; only 4-node tetrahedra"},
      {"from_1.ele", "2 3 4 5", "2 3 4 0", "line 3: tet 2 names vertex 0; vertices run from 1 to 5"},
      {"from_1.ele", "2 2 3", "3 2 3", "tet number 3 is in place 1"},
      {"from_0.ele", "1 1 2 3 4\n", "1 1 2 3\n",
       "line 3: the file ends where a tet's vertex was expected; it is truncated"},
      {"vega.VEG", "TET\n", "CUBIC\n", "line 11: *ELEMENTS CUBIC; only 4-node"},
      {"vega.VEG", "*REGION", "*INCLUDE", "*INCLUDE is not followed"},
      {"vega.VEG", "*VERTICES", "*POINTS", "has no section *VERTICES"},
      {"vega.VEG", "2 4 0", "1 4 0", "line 14: \"2\" where a section such as *VERTICES was expected"},
  });
}

TEST(RefuseTets, LegacyVtkSaysWhere) {
  expect_refusals({
      {"version_4.vtk", "# vtk", "# VTX", "line 1: does not begin with \"# vtk DataFile Version\""},
      {"version_4.vtk", "ASCII", "TEXT", "line 3: encoding \"TEXT\""},
      {"version_4.vtk", "UNSTRUCTURED_GRID", "POLYDATA", "line 4: DATASET POLYDATA"},
      {"version_4.vtk", "POINTS 5 double", "POINTS 5 quad", "line 5: number type \"quad\" is not known"},
      {"version_4.vtk", "POINTS 5 double", "POINTS 5000 double",
       "line 5: the number of points is 5000, more than"},
      {"version_4.vtk", "POINTS 5 double", "POINTS 6 double", "line 8: a point coordinate is \"CELLS\""},
      {"version_4.vtk", "0 0 1 1 1 1", "0 0 1 1 1 inf",
       "version_4.vtk: vertex 4: z is inf; give a finite number"},
      {"version_4.vtk", "CELLS 3 14", "CELLS 3 13", "CELLS: the list ends within cell 2"},
      {"version_4.vtk", "4 1 2 3 4", "4 1 2 3 5", "tet 1 names vertex 5; vertices run from 0 to 4"},
      {"version_4.vtk", "4 1 2 3 4", "4 1 2 3 4.5", "a point number or offset is 4.5"},
      {"version_4.vtk", "CELL_TYPES 3\n10", "CELL_TYPES 3\n24", "cell 0: cell type 24 (10-node tetrahedron)"},
      {"version_4.vtk", "CELL_TYPES 3\n10", "CELL_TYPES 3\n12", "cell 0: cell type 12 (hexahedron)"},
      {"version_4.vtk", "10\n5\n", "10\n10\n", "cell 2: a tetrahedron of 3 points"},
      {"version_4.vtk", "CELL_TYPES 3\n10\n10\n5", "CELL_TYPES 2\n10\n10", "3 cells but 2 cell types"},
      {"version_4.vtk", "CELL_DATA 3", "CELL_DATA 2", "a section such as CELLS was expected"},
      {"version_4.vtk", "0.1 200000", "0.1 none", "an array's value is \"none\", not a number"},
      {"version_4.vtk", "1 3 double", "1 3 quad", "array \"young modulus\" of type \"quad\"; use int, float"},
      {"version_4.vtk", "region int", "region quad", "array \"region\" of type \"quad\"; use int, float"},
      {"version_4.vtk", "0 0 1 1 1 1", "0 0 1 1 1 \x1b[31m", "a point coordinate is \"?[31m\", not a number"},
      {"version_4.vtk", "0 0 1 1 1 1", "0 0 1 1 1 1\xff\xc2\x9b", "a point coordinate is \"1???\", not a"},
      {"version_4.vtk", "0 0 1 1 1 1", "0 0 1 1 1 1,5\xc3\xbc",
       "a point coordinate is \"1,5\xc3\xbc\", not a"},
      {"version_4.vtk", "young%20modulus", "region", "cell field \"region\" appears twice"},
      {"version_4.vtk", "young%20modulus", "a%0Ab",
       "a cell field has an empty name or one with control characters"},
      {"binary.vtk", "POINTS 5 float", "POINTS 5 double", "byte "},
  });
}

TEST(RefuseTets, LegacyVtkThatEndsAfterTheHeadOfItsScalars) {
  // The head's own last number is not the first value.
  const test::TempFolder folder;
  const std::string file =
      folder.write("cut.vtk",
                   "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
                   "0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
                   "CELL_DATA 1\nSCALARS E double 1");
  ARGIL_EXPECT_THROW_WITH(read_tet_mesh(file), InputError,
                          "line 12: a scalar is 1, more than the 0 bytes left of the file can hold");
}

TEST(RefuseTets, XmlVtkSaysWhere) {
  expect_refusals({
      {"ascii.vtu", "VTKFile", "HTML", "does not begin with a VTKFile element"},
      {"ascii.vtu", "\"UnstructuredGrid\"", "\"PolyData\"", "line 3: VTKFile of type \"PolyData\""},
      {"ascii.vtu", "\"LittleEndian\"", "\"Middle\"", "line 3: byte_order \"Middle\""},
      {"zlib.vtu", "vtkZLibDataCompressor", "vtkLZMADataCompressor",
       "line 3: compressor vtkLZMADataCompressor; save it with the compressor ZLib or None"},
      {"ascii.vtu", "0 1 0 0 0 1", "0 1 0 nan 0 1", "ascii.vtu: vertex 3: x is nan; give a finite number"},
      {"ascii.vtu", "NumberOfPoints=\"5\"", "NumberOfPoints=\"6\"", "has 15 numbers where 18 are announced"},
      {"ascii.vtu", "NumberOfCells=\"3\"", "NumberOfCells=\"x\"", "has NumberOfCells=\"x\""},
      {"ascii.vtu", "NumberOfCells=\"3\"", "NumberOfCells=3", "has an attribute without a quoted value"},
      {"ascii.vtu", "4 8 11", "4 7 11", "cell 1: a tetrahedron of 3 points"},
      {"ascii.vtu", "4 8 11", "9 13 14", "cell 0: a tetrahedron of 9 points"},
      {"ascii.vtu", "1 2 3 4 0 2 1", "1 2 3 7 0 2 1", "tet 1 names vertex 7"},
      {"ascii.vtu", "10 10 5", "10 71 5", "cell 1: cell type 71 (Lagrange tetrahedron)"},
      {"ascii.vtu", "\"connectivity\"", "\"links\"", "<Cells> has no array \"connectivity\""},
      {"ascii.vtu", "<CellData", "</Piece><Piece NumberOfPoints=\"1\" NumberOfCells=\"1\"><CellData",
       "a second Piece"},
      {"ascii.vtu", "format=\"ascii\"> 0.1", "format=\"hex\"> 0.1", "format \"hex\" is not known"},
      {"base64.vtu", "AwAAAAoKBQ==", "BAAAAAoKBQ==", "array \"types\": its length does not fit the file"},
      {"zlib.vtu", "eF7j4mIFAAA6ABo=", "eF7j4mIFAAA7ABo=", "array \"types\": zlib cannot unpack it"},
      {"appended.vtu", "encoding=\"base64\"", "encoding=\"hex\"", "AppendedData with encoding \"hex\""},
      {"appended.vtu", "offset=\"208\"", "offset=\"999999\"", "its offset is behind the end of the file"},
      {"raw.vtu", "offset=\"0\"", "offset=\"1\"", "array \"\""},
      {"appended.vtu", "offset=\"208\"", "offset=\"260\"", "has the offset of another; give each its own"},
  });
}

TEST(RefuseTets, BinaryNumbersThatAreNotFinite) {
  const test::TempFolder folder;
  for (const char* name : {"22_binary.msh", "41_binary.msh", "raw.vtu"}) {
    SampleFile sample = find_sample(name);
    const bool is_big = sample.name == "raw.vtu";
    std::string one;
    test::append_bytes(one, 1.0, is_big);
    std::string nan;
    test::append_bytes(nan, std::numeric_limits<double>::quiet_NaN(), is_big);
    sample.content.replace(sample.content.find(one), 8, nan);
    ARGIL_EXPECT_THROW_WITH(read_sample(folder, sample), InputError,
                            is_big ? "vertex 1: x is nan" : "vertex 2: x is nan");
  }
}

TEST(RefuseTets, ABinaryGmshFileOfTheOtherByteOrder) {
  const test::TempFolder folder;
  SampleFile sample = find_sample("22_binary.msh");
  std::string one;
  test::append_bytes(one, 1, true);
  sample.content.replace(sample.content.find("2.2 1 8\n") + 8, 4, one);
  ARGIL_EXPECT_THROW_WITH(read_sample(folder, sample), InputError, "the byte order is not this machine's");
}

TEST(RefuseTets, NamesThatCannotBeRead) {
  const test::TempFolder folder;
  ARGIL_EXPECT_THROW_WITH(read_tet_mesh(folder / "none.msh"), IoError, "cannot be read: No such file");
  ARGIL_EXPECT_THROW_WITH(read_tet_mesh(folder.write("lonely.ele", "0 4 0\n")), IoError, "lonely.node");
  ARGIL_EXPECT_THROW_WITH(read_tet_mesh(folder / "body.step"), InputError, "ending \".step\" is no known");
  ARGIL_EXPECT_THROW_WITH(read_tet_mesh(folder / "body"), InputError, "use .msh, .mesh, .node/.ele");
  std::filesystem::create_directory(folder / "folder.msh");
  ARGIL_EXPECT_THROW_WITH(read_tet_mesh(folder / "folder.msh"), IoError, "Is a directory");
  ARGIL_EXPECT_THROW_WITH(read_tet_mesh(folder.write("empty.msh", "")), InputError, "line 1: does not begin");
}

// The difference of these labels is no 64-bit integer.
TEST(ReadTets, LabelsMayLieAtBothEndsOfTheIntegers) {
  const test::TempFolder folder;
  SampleFile sample = find_sample("22_ascii.msh");
  const auto rename = [&](const std::string& from, const std::string& to) {
    const std::size_t at = sample.content.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    sample.content.replace(at, from.size(), to);
  };
  rename("\n1 0 0 0", "\n-9223372036854775808 0 0 0");
  rename("\n9 1 1 1", "\n9223372036854775807 1 1 1");
  rename("\n1 2 2 1 1 1 3 2", "\n1 2 2 1 1 5 3 2");  // the surface triangle
  rename("\n2 4 2 1 1 1 2", "\n2 4 2 1 1 -9223372036854775808 2");
  rename("2 3 5 9\n", "2 3 5 9223372036854775807\n");
  expect_two_tets(read_sample(folder, sample), sample.name);
}

TEST(RefuseTets, CoordinatesThatOverflowInMetres) {
  const test::TempFolder folder;
  SampleFile sample = find_sample("from_0.ele");
  sample.beside_content.replace(sample.beside_content.find("4 1 1 1"), 7, "4 1e300 1 1");
  ARGIL_EXPECT_THROW_WITH(
      read_sample(folder, sample, 1e10), InputError,
      "vertex 4: a coordinate is not finite in metres; give finite coordinates and check");
}

// Whatever is cut off, the answer is a refusal or, when only data behind the tets are missing, the same body.
TEST(FuzzTets, AFileCutAnywhereIsRefusedOrStillWhole) {
  const test::TempFolder folder;
  for (const SampleFile& whole : test::make_tet_samples()) {
    int refused = 0;
    for (std::size_t length = 0; length < whole.content.size(); ++length) {
      SampleFile cut = whole;
      cut.content.resize(length);
      try {
        expect_two_tets(read_sample(folder, cut), whole.name + " cut to " + std::to_string(length));
      } catch (const InputError&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, static_cast<int>(whole.content.size() / 2)) << whole.name;
  }
}

// Seeded damage: any answer but a crash, an index out of range or a coordinate that is not finite.
TEST(FuzzTets, DamagedBytesNeverGiveAMeshOutOfRange) {
  const test::TempFolder folder;
  Rng rng(20240801, "damaged tets");
  constexpr int kTrials = 150;
  const std::string bytes = "0123456789.-+eE \n\"<>$*#\xff\x7f" + std::string(1, '\0');
  for (const SampleFile& whole : test::make_tet_samples()) {
    for (int trial = 0; trial < kTrials; ++trial) {
      SampleFile damaged = whole;
      const auto hits = 1 + rng.next_bits() % 4;
      for (std::uint64_t hit = 0; hit < hits; ++hit)
        damaged.content[rng.next_bits() % damaged.content.size()] = bytes[rng.next_bits() % bytes.size()];
      try {
        const mesh::TetMesh mesh = read_sample(folder, damaged);
        ASSERT_TRUE(mesh.vertices.allFinite()) << whole.name << " trial " << trial;
        ASSERT_GE(mesh.tets.minCoeff(), 0);
        ASSERT_LT(mesh.tets.maxCoeff(), mesh.num_vertices());
        for (const auto& [name, field] : mesh.cell_fields) ASSERT_EQ(field.size(), mesh.num_tets()) << name;
      } catch (const InputError&) {
      }
    }
  }
}

}  // namespace
}  // namespace argil::mesh_files
