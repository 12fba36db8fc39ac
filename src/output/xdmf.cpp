#include <filesystem>
#include <fstream>
#include <locale>
#include <ostream>
#include <string_view>

#include "hdf5/file.h"
#include "output/result_file.h"
#include "output/text.h"

namespace argil::output {
namespace {

using hdf5::Dataset;
using hdf5::Element;
using hdf5::Group;

constexpr std::string_view kEnd = "</Xdmf>\n";

// Whole datasets only: a part of a dataset (HyperSlab) is not opened by ParaView's readers.
struct Writer {
  std::ostream& text;
  std::string file;  // as the XDMF names it, escaped

  void data_item(const Dataset& dataset) {
    text << "<DataItem Format=\"HDF\" Dimensions=\"";
    const char* gap = "";
    for (const std::uint64_t length : dataset.shape()) {
      text << gap << length;
      gap = " ";
    }
    const bool is_real = dataset.element() == Element::real64;
    text << "\" NumberType=\"" << (is_real ? "Float\" Precision=\"8" : "Int\" Precision=\"4") << "\">" << file
         << ":" << escape_xml(dataset.path()) << "</DataItem>";
  }

  void attribute(const Dataset& dataset, const char* name, const char* type, const char* centre) {
    text << "        <Attribute Name=\"" << name << "\" AttributeType=\"" << type << "\" Center=\"" << centre
         << "\">";
    data_item(dataset);
    text << "</Attribute>\n";
  }

  void begin_grid(const char* name, double time, const char* topology, const Dataset& elements,
                  const Dataset& position) {
    text << "      <Grid Name=\"" << name << "\" GridType=\"Uniform\">\n        <Time Value=\"" << time
         << "\"/>\n        <Topology TopologyType=\"" << topology << "\" NumberOfElements=\""
         << elements.shape()[0] << "\">";
    data_item(elements);
    text << "</Topology>\n        <Geometry GeometryType=\"XYZ\">";
    data_item(position);
    text << "</Geometry>\n";
  }
  void end_grid() { text << "      </Grid>\n"; }
};

void write_cage(Writer& out, const Group& mesh, const Group& frame) {
  out.begin_grid("cage", frame.read_real("time"), "Tetrahedron", mesh.open_dataset("tets"),
                 frame.open_dataset("position"));
  out.attribute(frame.open_dataset("saturation"), "saturation", "Scalar", "Cell");
  out.attribute(frame.open_dataset("plastic_strain_norm"), "plastic_strain_norm", "Scalar", "Cell");
  out.end_grid();
}

void write_skin(Writer& out, const Group& mesh, const Group& frame) {
  out.begin_grid("skin", frame.read_real("time"), "Triangle", mesh.open_dataset("skin_triangles"),
                 frame.open_dataset("skin_position"));
  out.attribute(frame.open_dataset("skin_saturation"), "saturation", "Scalar", "Node");
  out.attribute(frame.open_dataset("skin_influence"), "influence", "Scalar", "Node");
  out.end_grid();
}

template <class WriteGrid>
void write_collection(Writer& out, const char* name, const Group& root, WriteGrid write_grid) {
  const Group mesh = root.open_group("mesh");
  const Group frames = root.open_group("frames");
  out.text << "    <Grid Name=\"" << name << "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (const std::string& frame : frames.names()) write_grid(out, mesh, frames.open_group(frame));
  out.text << "    </Grid>\n";
}

std::string relative_name(const std::string& result_file, const std::string& xdmf_file) {
  const std::filesystem::path folder = std::filesystem::absolute(xdmf_file).parent_path();
  const std::filesystem::path relative = std::filesystem::absolute(result_file).lexically_relative(folder);
  return relative.generic_string();
}

}  // namespace

void write_xdmf(const std::string& result_file, const std::string& xdmf_file) {
  const hdf5::File file = hdf5::File::open_for_reading(result_file);
  const Group root = file.root();
  write_file(xdmf_file, [&](std::ostream& text) {
    text.precision(17);
    text.imbue(std::locale::classic());
    Writer out{text, escape_xml(relative_name(result_file, xdmf_file))};
    text << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n";
    write_collection(out, "cage", root, write_cage);
    const bool has_skin = root.open_group("mesh").open_dataset("skin_triangles").shape()[0] > 0;
    if (has_skin) write_collection(out, "skin", root, write_skin);
    text << "  </Domain>\n" << kEnd;
  });
}

bool has_whole_xdmf(const std::string& xdmf_file) {
  std::ifstream file(xdmf_file, std::ios::binary);
  std::string end(kEnd.size(), '\0');
  file.seekg(-static_cast<std::streamoff>(kEnd.size()), std::ios::end);
  file.read(end.data(), static_cast<std::streamsize>(end.size()));
  return file && end == kEnd;
}

}  // namespace argil::output
