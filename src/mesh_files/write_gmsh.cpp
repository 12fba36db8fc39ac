// Gmsh 4.1 as text. 17 significant digits bring every double back to the bit.
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <memory>

#include "base/error.h"
#include "mesh_files/readers.h"

namespace argil::mesh_files {
namespace {

void append(std::string& text, double value) {
  char digits[32];
  constexpr int kDigitsAfterPoint = 16;
  const auto end =
      std::to_chars(digits, digits + sizeof digits, value, std::chars_format::scientific, kDigitsAfterPoint);
  text.append(digits, end.ptr);
}

void append_points(std::string& text, const Points& points) {
  for (Eigen::Index v = 0; v < points.cols(); ++v) {
    for (int c = 0; c < 3; ++c) {
      if (c > 0) text += ' ';
      append(text, points(c, v));
    }
    text += '\n';
  }
}

void write_text(const std::string& text, const std::string& file) {
  const auto fail = [&] {
    throw IoError(file, std::string("cannot be written: ") + std::strerror(errno != 0 ? errno : EIO));
  };
  errno = 0;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "wb"), std::fclose);
  if (!stream) fail();
  if (std::fwrite(text.data(), 1, text.size(), stream.get()) != text.size()) fail();
  if (std::fclose(stream.release()) != 0) fail();
}

}  // namespace

void write_gmsh(const mesh::TetMesh& mesh, const std::string& file) {
  const std::string vertices = std::to_string(mesh.num_vertices());
  const std::string tets = std::to_string(mesh.num_tets());
  std::string text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  text += "$Nodes\n1 " + vertices + " 1 " + vertices + "\n3 1 0 " + vertices + "\n";
  for (int v = 1; v <= mesh.num_vertices(); ++v) text += std::to_string(v) + "\n";
  append_points(text, mesh.vertices);
  text += "$EndNodes\n$Elements\n1 " + tets + " 1 " + tets + "\n3 1 4 " + tets + "\n";
  for (int t = 0; t < mesh.num_tets(); ++t) {
    text += std::to_string(t + 1);
    for (int c = 0; c < 4; ++c) text += " " + std::to_string(mesh.tets(c, t) + 1);
    text += '\n';
  }
  text += "$EndElements\n";
  for (const auto& [name, values] : mesh.cell_fields) {
    text += "$ElementData\n1\n\"" + name + "\"\n1\n0\n3\n0\n1\n" + tets + "\n";
    for (int t = 0; t < mesh.num_tets(); ++t) {
      text += std::to_string(t + 1) + " ";
      append(text, values(t));
      text += '\n';
    }
    text += "$EndElementData\n";
  }
  write_text(text, file);
}

}  // namespace argil::mesh_files
