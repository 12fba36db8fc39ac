#include <filesystem>
#include <fstream>
#include <locale>
#include <optional>
#include <ostream>
#include <span>
#include <string_view>
#include <vector>

#include "hdf5/file.h"
#include "output/result_file.h"
#include "output/schema.h"
#include "output/text.h"

namespace argil::output {
namespace {

using hdf5::Dataset;
using hdf5::Element;
using hdf5::Group;

constexpr std::string_view kEnd = "</Xdmf>\n";

// Whole datasets only: a part of a dataset (HyperSlab) is not opened by ParaView's readers. Arrays of a name
// have the same shape in all frames of an epoch, so only those of its first are opened: opening costs memory
// that stays.
struct Writer {
  std::ostream& text;
  std::string file;  // as the XDMF names it, escaped

  /// The dataset `path`, of the shape and type of `like`.
  void data_item(const Dataset& like, const std::string& path) {
    text << "<DataItem Format=\"HDF\" Dimensions=\"";
    const char* gap = "";
    for (const std::uint64_t length : like.shape()) {
      text << gap << length;
      gap = " ";
    }
    const bool is_real = like.element() == Element::real64;
    text << "\" NumberType=\"" << (is_real ? "Float\" Precision=\"8" : "Int\" Precision=\"4") << "\">" << file
         << ":" << escape_xml(path) << "</DataItem>";
  }
};

/// One of the body's two surfaces and what it shows.
struct Picture {
  struct Attribute {
    const char* name;
    const char* dataset;
  };
  const char* name;
  const char* elements;  // in /mesh
  const char* topology;
  const char* position;
  const char* centre;
  std::span<const Attribute> attributes;
};

constexpr Picture::Attribute kOnCage[] = {{"saturation", "saturation"},
                                          {"plastic_strain_norm", "plastic_strain_norm"}};
constexpr Picture::Attribute kOnSkin[] = {{"saturation", "skin_saturation"}, {"influence", "skin_influence"}};

constexpr Picture kCage = {"cage", "tets", "Tetrahedron", "position", "Cell", kOnCage};
constexpr Picture kSkin = {"skin", "skin_triangles", "Triangle", "skin_position", "Node", kOnSkin};

/// Only the cage's are others in every epoch.
Dataset open_elements(const Group& root, const Picture& picture, int epoch) {
  return schema::open_mesh(root, &picture == &kSkin ? 0 : epoch).open_dataset(picture.elements);
}

void write_collection(Writer& out, const Picture& picture, const Group& root) {
  const Group frames = root.open_group("frames");
  out.text << "    <Grid Name=\"" << picture.name
           << "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  std::vector<Dataset> first;  // of an epoch: position, then the attributes
  std::optional<Dataset> elements;
  int epoch = 0;
  for (const std::string& number : frames.names()) {
    const Group frame = frames.open_group(number);
    const int now =
        frame.has_attribute(schema::kEpoch) ? static_cast<int>(frame.read_integer(schema::kEpoch)) : 0;
    if (first.empty() || now != epoch) {
      epoch = now;
      first.clear();
      elements = open_elements(root, picture, epoch);
      first.push_back(frame.open_dataset(picture.position));
      for (const auto& attribute : picture.attributes) first.push_back(frame.open_dataset(attribute.dataset));
    }
    out.text << "      <Grid Name=\"" << picture.name << "\" GridType=\"Uniform\">\n        <Time Value=\""
             << frame.read_real("time") << "\"/>\n        <Topology TopologyType=\"" << picture.topology
             << "\" NumberOfElements=\"" << elements->shape()[0] << "\">";
    out.data_item(*elements, elements->path());
    out.text << "</Topology>\n        <Geometry GeometryType=\"XYZ\">";
    out.data_item(first[0], frame.path() + "/" + picture.position);
    out.text << "</Geometry>\n";
    for (std::size_t i = 0; i < picture.attributes.size(); ++i) {
      out.text << "        <Attribute Name=\"" << picture.attributes[i].name
               << "\" AttributeType=\"Scalar\" Center=\"" << picture.centre << "\">";
      out.data_item(first[i + 1], frame.path() + "/" + picture.attributes[i].dataset);
      out.text << "</Attribute>\n";
    }
    out.text << "      </Grid>\n";
  }
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
    write_collection(out, kCage, root);
    const bool has_skin = root.open_group("mesh").open_dataset("skin_triangles").shape()[0] > 0;
    if (has_skin) write_collection(out, kSkin, root);
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
