#include "output/vtu.h"

#include <bit>
#include <filesystem>
#include <sstream>

#include "base/error.h"
#include "output/result_reader.h"
#include "output/text.h"

namespace argil::output {
namespace {

namespace fs = std::filesystem;

constexpr std::uint8_t kVtkTriangle = 5;
constexpr std::uint8_t kVtkTetra = 10;

/// One .vtu: XML that names arrays, and their bytes behind it, each after its length (UInt64).
class Grid {
 public:
  /// Cells are the columns of `cells`.
  template <class Cells>
  Grid(const Points& points, const Cells& cells, std::uint8_t type) {
    const auto count = static_cast<std::size_t>(cells.cols());
    m_head << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
              "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <UnstructuredGrid>\n"
           << "    <Piece NumberOfPoints=\"" << points.cols() << "\" NumberOfCells=\"" << count << "\">\n";
    open("Points");
    array("position", "Float64", points);
    close("Points");
    open("Cells");
    array("connectivity", "Int32", cells, 1);
    Eigen::RowVectorXi ends(cells.cols());
    for (Eigen::Index cell = 0; cell < cells.cols(); ++cell)
      ends(cell) = static_cast<int>(cells.rows() * (cell + 1));
    array("offsets", "Int32", ends);
    array("types", "UInt8", std::vector<std::uint8_t>(count, type), 1);
    close("Cells");
  }

  void open(const char* section) { m_head << "      <" << section << ">\n"; }
  void close(const char* section) { m_head << "      </" << section << ">\n"; }

  /// One tuple a column.
  template <class Values>
  void array(const char* name, const char* type, const Values& values) {
    array(name, type, values, values.rows());
  }
  template <class Values>
  void array(const char* name, const char* type, const Values& values, Eigen::Index components) {
    static_assert(std::endian::native == std::endian::little);
    m_head << "        <DataArray type=\"" << type << "\" Name=\"" << name << "\" NumberOfComponents=\""
           << components << "\" format=\"appended\" offset=\"" << m_bytes.size() << "\"/>\n";
    const auto size = static_cast<std::uint64_t>(values.size()) * sizeof(*values.data());
    m_bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
    m_bytes.append(reinterpret_cast<const char*>(values.data()), size);
  }

  void write(const fs::path& file) const {
    write_file(file.string(), m_head.str() +
                                  "    </Piece>\n  </UnstructuredGrid>\n"
                                  "  <AppendedData encoding=\"raw\">\n_" +
                                  m_bytes + "\n  </AppendedData>\n</VTKFile>\n");
  }

 private:
  std::ostringstream m_head;
  std::string m_bytes;
};

/// Displacement: from `first`.
Grid make_cage(const Tets& tets, const sim::Frame& frame, const Points& first) {
  Grid grid(frame.position, tets, kVtkTetra);
  const Points displacement = frame.position - first;
  const Eigen::RowVectorXd norm = frame.plastic_strain.colwise().norm();
  grid.open("PointData");
  grid.array("displacement", "Float64", displacement);
  grid.close("PointData");
  grid.open("CellData");
  grid.array("saturation", "Float64", Eigen::RowVectorXd(frame.saturation.transpose()));
  grid.array("plastic_strain", "Float64", frame.plastic_strain);
  grid.array("plastic_strain_norm", "Float64", norm);
  grid.close("CellData");
  return grid;
}

Grid make_skin(const ResultHeader& header, const sim::Frame& frame, const Points& first) {
  Grid grid(frame.skin_position, header.skin_triangles, kVtkTriangle);
  const Points displacement = frame.skin_position - first;
  grid.open("PointData");
  grid.array("displacement", "Float64", displacement);
  grid.array("saturation", "Float64", Eigen::RowVectorXd(frame.skin_saturation.transpose()));
  grid.array("influence", "Float64", Eigen::RowVectorXd(frame.skin_influence.transpose()));
  grid.close("PointData");
  return grid;
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw IoError(folder.string(), "cannot be made: " + error.message());
}

}  // namespace

std::size_t write_vtu_series(const std::string& result_file, const std::string& pvd_file) {
  const fs::path folder = fs::path(pvd_file).replace_extension();
  if (fs::path(pvd_file).extension() != ".pvd")
    throw InputError(pvd_file, "", "does not end in .pvd, the list of a series",
                     "name it " + folder.string() + ".pvd");
  const ResultReader reader(result_file);
  const ResultHeader header = reader.read_header();
  const std::vector<FrameInfo> frames = reader.read_frame_list();
  if (frames.empty())
    throw InputError(result_file, "/frames", "has no frames, so there is no body to show",
                     "set /haptics/frame_period_ticks in the scenario and run it again");
  make_folder(folder);
  const sim::Frame first = reader.read_frame(frames.front());
  std::ostringstream list;
  list.imbue(std::locale::classic());
  list.precision(17);
  list << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
  const auto write = [&](const Grid& grid, const FrameInfo& frame, const char* name, int part) {
    const std::string file = name + ("_" + frame.name) + ".vtu";
    grid.write(folder / file);
    list << "    <DataSet timestep=\"" << frame.time << "\" part=\"" << part << "\" file=\""
         << escape_xml((folder.filename() / file).generic_string()) << "\"/>\n";
  };
  CellMesh cells = reader.read_cells(0);
  cells.rest_position = first.position;
  int epoch = 0;
  for (const FrameInfo& info : frames) {
    const sim::Frame frame = reader.read_frame(info);
    if (info.epoch != epoch) cells = reader.read_cells(epoch = info.epoch);
    write(make_cage(cells.tets, frame, cells.rest_position), info, "cage", 0);
    if (header.skin_triangles.cols() > 0)
      write(make_skin(header, frame, first.skin_position), info, "skin", 1);
  }
  list << "  </Collection>\n</VTKFile>\n";
  write_file(pvd_file, list.str());
  return frames.size();
}

}  // namespace argil::output
