#include "output/surface_frames.h"

#include "base/error.h"
#include "embed/embedding.h"

namespace argil::output {

SurfaceFrames::SurfaceFrames(const ResultReader& reader, bool wants_cage)
    : m_reader(reader), m_frames(reader.read_frame_list()) {
  if (m_frames.empty())
    throw InputError(reader.file(), "/frames", "has no frames, so there is no body to show",
                     "set /haptics/frame_period_ticks in the scenario and run it again");
  const ResultHeader header = reader.read_header();
  m_is_skin = header.skin_triangles.cols() > 0 && !wants_cage;
  if (m_is_skin) m_triangles = header.skin_triangles;
  for (int number = 0; number <= reader.num_epochs(); ++number) {
    Epoch& epoch = m_epochs.emplace_back();
    const FrameInfo* first = find_first_frame(number);
    if (number > 0 && !first) continue;  // it gave no frame
    epoch.cells = reader.read_cells(number);
    if (!m_is_skin)
      add_cage(epoch);
    else
      add_skin(epoch, first ? *first : m_frames.front());
  }
}

const FrameInfo* SurfaceFrames::find_first_frame(int epoch) const {
  for (const FrameInfo& info : m_frames)
    if (info.epoch == epoch) return &info;
  return nullptr;
}

/// Rest positions: of the start.
void SurfaceFrames::add_skin(Epoch& epoch, const FrameInfo& info) {
  const sim::Frame frame = m_reader.read_frame(info);
  mesh::TetMesh cage;
  cage.vertices = frame.position;
  cage.tets = epoch.cells.tets;
  const embed::Embedding embedding =
      embed::make_embedding(cage, frame.skin_position, m_reader.file(), embed::kAnyBeyond);
  epoch.skin_tets = embedding.tet;
  if (m_num_vertices > 0) return;
  m_num_vertices = static_cast<int>(frame.skin_position.cols());
  m_rest_position = frame.skin_position;  // to the last bit where the run began at rest
  if (frame.position != epoch.cells.rest_position)
    embed::interpolate_positions(embedding, epoch.cells.tets, epoch.cells.rest_position, m_rest_position);
}

void SurfaceFrames::add_cage(Epoch& epoch) {
  const Triangles& boundary = epoch.cells.surface_triangles;
  std::vector<int> number(static_cast<std::size_t>(epoch.cells.rest_position.cols()), -1);
  epoch.first_vertex = m_num_vertices;
  const Eigen::Index before = m_triangles.cols();
  m_triangles.conservativeResize(3, before + boundary.cols());
  for (Eigen::Index i = 0; i < boundary.size(); ++i) {
    int& mine = number[static_cast<std::size_t>(boundary(i))];
    if (mine < 0) {
      mine = m_num_vertices++;
      epoch.cage_vertices.push_back(boundary(i));
    }
    m_triangles(3 * before + i) = mine;
  }
  m_rest_position.conservativeResize(3, m_num_vertices);
  m_rest_position.rightCols(m_num_vertices - epoch.first_vertex) =
      epoch.cells.rest_position(Eigen::all, epoch.cage_vertices);
}

Field SurfaceFrames::average_at_vertices(const Epoch& epoch, const Field& per_tet) {
  const Tets& tets = epoch.cells.tets;
  const Eigen::Index num_vertices = 1 + tets.maxCoeff();
  Field sum = Field::Zero(num_vertices), count = Field::Zero(num_vertices);
  for (Eigen::Index tet = 0; tet < tets.cols(); ++tet)
    for (int corner = 0; corner < 4; ++corner) {
      sum(tets(corner, tet)) += per_tet(tet);
      count(tets(corner, tet)) += 1.0;
    }
  return (sum.array() / count.array().max(1.0)).matrix()(epoch.cage_vertices);
}

SurfaceFrames::Shot SurfaceFrames::place_among_all(const Epoch& epoch, const Shot& shot) const {
  const Eigen::Index first = epoch.first_vertex;
  const Eigen::Index count = shot.position.cols();
  if (count == m_num_vertices) return shot;
  Shot all;
  all.position = shot.position.col(0).replicate(1, m_num_vertices);
  all.saturation = Field::Constant(m_num_vertices, shot.saturation(0));
  all.plastic_strain = Field::Constant(m_num_vertices, shot.plastic_strain(0));
  all.position.middleCols(first, count) = shot.position;
  all.saturation.segment(first, count) = shot.saturation;
  all.plastic_strain.segment(first, count) = shot.plastic_strain;
  return all;
}

SurfaceFrames::Shot SurfaceFrames::read(const FrameInfo& info) const {
  const sim::Frame frame = m_reader.read_frame(info);
  const Field plastic_norm = frame.plastic_strain.colwise().norm();
  const Epoch& epoch = m_epochs[static_cast<std::size_t>(info.epoch)];
  if (m_is_skin)
    return {frame.skin_position, frame.skin_saturation, plastic_norm(epoch.skin_tets), frame.skin_influence};
  return place_among_all(
      epoch, {frame.position(Eigen::all, epoch.cage_vertices), average_at_vertices(epoch, frame.saturation),
              average_at_vertices(epoch, plastic_norm), Field()});
}

}  // namespace argil::output
