#include "scenario/file_faults.h"

#include "device/trace.h"
#include "mesh_files/readers.h"

namespace argil::scenario {

void find_file_faults(const Scenario& s, Faults& faults) {
  const bool has_tool = s.tool.kind == ToolKind::mesh && !s.tool.file.empty();
  if (has_tool && !faults.concerns("/tool"))
    faults.check([&] { mesh_files::read_triangle_mesh(s.tool.file, s.tool.scale); });
  if (s.mode == Mode::dynamic && !s.trace.file.empty() && !faults.concerns("/trace"))
    faults.check([&] { device::read_trace(s.trace.file, s.trace.options); });
  if (s.body.kind == BodyKind::shape || s.body.file.empty() || faults.concerns("/body")) return;
  faults.check([&] {
    if (s.body.kind == BodyKind::mesh)
      mesh_files::read_tet_mesh(s.body.file, s.body.scale);
    else
      mesh_files::read_triangle_mesh(s.body.file, s.body.scale);
  });
}

}  // namespace argil::scenario
