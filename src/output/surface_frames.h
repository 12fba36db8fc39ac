#pragma once

#include <string>
#include <vector>

#include "output/result_reader.h"

namespace argil::output {

/// The surface of a body as one looks at it: its skin, or the boundary of its cage. Where that gets new
/// cells, the list of triangles has those of all epochs, so that it is one for all frames; those of the
/// others shrink to a point.
class SurfaceFrames {
 public:
  /// Takes the skin where there is one, unless `wants_cage`. Throws InputError when there are no frames.
  SurfaceFrames(const ResultReader& reader, bool wants_cage);

  bool is_skin() const { return m_is_skin; }
  const Triangles& triangles() const { return m_triangles; }  ///< numbers of the vertices below, outward
  int num_vertices() const { return m_num_vertices; }
  const std::vector<FrameInfo>& frames() const { return m_frames; }  ///< all, in the order of ticks

  /// [m] Where the vertices are when nothing deforms the body, which may be so in no frame: of a static
  /// result.
  const Points& rest_position() const { return m_rest_position; }

  /// The surface at one frame; fields at its vertices.
  struct Shot {
    Points position;       ///< [m]
    Field saturation;      ///< 0 to 1
    Field plastic_strain;  ///< ‖ε_p‖_F; on a skin that of the containing tet
    Field influence;       ///< region of influence, 0 to 1; empty on a cage
  };
  Shot read(const FrameInfo& info) const;

 private:
  /// What the body was made of for some of the frames.
  struct Epoch {
    CellMesh cells;
    std::vector<int> cage_vertices;  ///< of the surface; none with a skin
    int first_vertex = 0;            ///< among those of all epochs, that of these
    std::vector<int> skin_tets;      ///< containing tet of each skin vertex; none without a skin
  };

  static Field average_at_vertices(const Epoch& epoch, const Field& per_tet);
  void add_cage(Epoch& epoch);
  void add_skin(Epoch& epoch, const FrameInfo& info);
  Shot place_among_all(const Epoch& epoch, const Shot& shot) const;
  const FrameInfo* find_first_frame(int epoch) const;

  const ResultReader& m_reader;
  std::vector<Epoch> m_epochs;
  std::vector<FrameInfo> m_frames;
  bool m_is_skin = false;
  int m_num_vertices = 0;
  Points m_rest_position;
  Triangles m_triangles;
};

}  // namespace argil::output
