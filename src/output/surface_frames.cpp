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
  m_tets = header.tets;
  m_is_skin = header.skin_triangles.cols() > 0 && !wants_cage;
  if (!m_is_skin) {
    number_surface_vertices(header.surface_triangles);
    m_rest_position = header.rest_position(Eigen::all, m_cage_vertices);
    return;
  }
  m_triangles = header.skin_triangles;
  const sim::Frame first = reader.read_frame(m_frames.front());
  m_num_vertices = static_cast<int>(first.skin_position.cols());
  mesh::TetMesh cage;
  cage.vertices = first.position;
  cage.tets = header.tets;
  const embed::Embedding embedding =
      embed::make_embedding(cage, first.skin_position, reader.file(), embed::kMostBeyondFitted);
  m_skin_tets = embedding.tet;
  m_rest_position = first.skin_position;  // to the last bit where the run began at rest
  if (first.position != header.rest_position)
    embed::interpolate_positions(embedding, header.tets, header.rest_position, m_rest_position);
}

void SurfaceFrames::number_surface_vertices(const Triangles& boundary) {
  std::vector<int> number(static_cast<std::size_t>(m_reader.read_header().rest_position.cols()), -1);
  m_triangles.resize(3, boundary.cols());
  for (Eigen::Index i = 0; i < boundary.size(); ++i) {
    int& mine = number[static_cast<std::size_t>(boundary(i))];
    if (mine < 0) {
      mine = static_cast<int>(m_cage_vertices.size());
      m_cage_vertices.push_back(boundary(i));
    }
    m_triangles(i) = mine;
  }
  m_num_vertices = static_cast<int>(m_cage_vertices.size());
}

Field SurfaceFrames::average_at_vertices(const Field& per_tet) const {
  const Eigen::Index num_vertices = 1 + m_tets.maxCoeff();
  Field sum = Field::Zero(num_vertices), count = Field::Zero(num_vertices);
  for (Eigen::Index tet = 0; tet < m_tets.cols(); ++tet)
    for (int corner = 0; corner < 4; ++corner) {
      sum(m_tets(corner, tet)) += per_tet(tet);
      count(m_tets(corner, tet)) += 1.0;
    }
  return (sum.array() / count.array().max(1.0)).matrix()(m_cage_vertices);
}

SurfaceFrames::Shot SurfaceFrames::read(const FrameInfo& info) const {
  const sim::Frame frame = m_reader.read_frame(info);
  const Field plastic_norm = frame.plastic_strain.colwise().norm();
  if (m_is_skin)
    return {frame.skin_position, frame.skin_saturation, plastic_norm(m_skin_tets), frame.skin_influence};
  return {frame.position(Eigen::all, m_cage_vertices), average_at_vertices(frame.saturation),
          average_at_vertices(plastic_norm), Field()};
}

}  // namespace argil::output
