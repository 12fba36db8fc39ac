// A step that fails, in whichever stage, leaves nothing behind: the archive is the one of before, to the bit,
// and the steps that follow are those of a body that never failed.
#include "solid/committed.h"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "solid/material_changes.h"
#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

constexpr double kStep = 2e-3;  // [s]
constexpr double kYoungs = 1e5;

/// Which kind of body takes the steps.
struct Kind {
  const char* name;
  void (*change)(SolidParams&);
  double slack = 0.0;  ///< [N] of each step
  double poisson = 0.3;
  bool is_local = false;  ///< steps of the region that moves
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

struct PulledBar;

/// Where a step fails.
struct Fault {
  const char* name;
  StepStatus (*fail)(PulledBar&);
};

void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.name;
}

/// A bar that is pulled about at its end and creeps.
struct PulledBar {
  Scene scene;
  double slack;
  double poisson;
  int steps = 0;
  std::vector<char> is_flowing, was_flowing;

  explicit PulledBar(const Kind& kind) : scene(make_scene(kind)), slack(kind.slack), poisson(kind.poisson) {
    is_flowing.resize(static_cast<std::size_t>(scene.solid.model.elements.num_tets() / kLanes + 1), 0);
    was_flowing = is_flowing;
    make_ready(scene.solid, scene.region, scene.state, scene.load);
    commit(scene.solid, scene.region, scene.state);
  }
  static Scene make_scene(const Kind& kind) {
    SolidParams params;
    params.rayleigh_stiffness = 1e-3;
    kind.change(params);
    Support wall;
    wall.region.kind = Region::Kind::plane;
    wall.region.normal = Vec3::UnitX();
    return Scene(test::make_irregular_block(6, 3, 3, Vec3(0.3, 0.1, 0.1)), std::vector{wall}, params, kYoungs,
                 kind.poisson, 1, kind.is_local);
  }
  int tip() const {
    Eigen::Index farthest = 0;
    scene.rest().row(0).maxCoeff(&farthest);
    return static_cast<int>(farthest);
  }
  void set_load() {
    const double angle = 0.7 * steps;
    scene.load.setZero();
    scene.load.col(tip()) = 2.0 * Vec3(std::cos(angle), std::sin(angle), 0.5);
  }
  StepStatus step() {
    StepLoads loads{scene.load, {}};
    loads.slack = slack;
    ARGIL_TRY(begin_step(scene.solid, scene.region, scene.state, loads, {kStep, scene.time + kStep, steps}));
    for (bool solved = false; !solved;) {
      solved = assemble(scene.solid, scene.region, loads);
      if (!solved) ARGIL_TRY(solve(scene.solid, scene.region, loads, steps, solved));
    }
    take_velocity(scene.solid, scene.region.part(), scene.state);
    move(scene.solid, scene.region.part(), scene.state);
    ARGIL_TRY(update_kinematics(scene.solid, scene.region, scene.state.x, steps));
    keep_start(scene.solid, scene.state);
    flow();
    note_flow(scene.solid, is_flowing, was_flowing);
    scene.region.put_to_sleep(scene.state, is_flowing);
    return StepStatus::ok();
  }
  /// Some points, others in each step.
  void flow() {
    const Elements& elements = scene.solid.model.elements;
    std::fill(is_flowing.begin(), is_flowing.end(), char{0});
    const auto tet = static_cast<std::size_t>(37 * (steps + 1) % elements.num_tets());
    const std::vector<int>* moving = scene.region.part().batches.list();
    if (moving && moving->empty()) return;
    const std::size_t batch =
        moving ? static_cast<std::size_t>((*moving)[tet % moving->size()]) : tet / kLanes;
    scene.state.plastic_strain(3, elements.points_per_tet * static_cast<Eigen::Index>(batch * kLanes)) +=
        1e-4;
    is_flowing[batch] = 1;
  }
  void make_steps(int count) {
    for (const int end = steps + count; steps < end; ++steps) {
      set_load();
      const StepStatus status = step();
      ASSERT_TRUE(status.is_ok()) << steps << ' ' << status.failure().quantity;
      commit(scene.solid, scene.region, scene.state, is_flowing);
      was_flowing = is_flowing;
      scene.time += kStep;
    }
  }
  void set_material(const TetMaterial& material) {
    for (int t = 0; t < scene.mesh.num_tets(); ++t)
      solid::set_material(scene.solid, scene.region, t, material);
  }
  Snapshot take_snapshot() {
    Snapshot snapshot;
    Archive archive = Archive::make_saving(snapshot);
    serialize(archive, scene.solid, scene.region, scene.state);
    return snapshot;
  }
};

void expect_equal(const Snapshot& a, const Snapshot& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, value] : a) {
    ASSERT_TRUE(b.contains(name)) << name;
    const Eigen::MatrixXd& other = b.at(name);
    ASSERT_EQ(value.rows(), other.rows()) << name;
    ASSERT_EQ(value.cols(), other.cols()) << name;
    EXPECT_TRUE((value.array() == other.array()).all()) << name;
  }
}

const Kind kKinds[] = {
    {"pcg", [](SolidParams&) {}},
    {"lag", [](SolidParams& p) { p.solver.kind = linear::SolverKind::pcg_jacobi; }, 1e-2},
    {"exact_jacobi",
     [](SolidParams& p) {
       p.solver.kind = linear::SolverKind::pcg_jacobi;
       p.solver.tolerance = 1e-9;
     }},
    {"pcg_cholesky",
     [](SolidParams& p) {
       p.solver.kind = linear::SolverKind::pcg_cholesky;
       p.solver.refactor_iterations = 1;
     }},
    {"cholesky", [](SolidParams& p) { p.solver.kind = linear::SolverKind::cholesky; }},
    {"matrix_free", [](SolidParams& p) { p.solver.kind = linear::SolverKind::pcg_matrix_free; }},
    {"local", [](SolidParams&) {}, 0.0, 0.3, true},
    {"local_lag", [](SolidParams&) {}, 1e-2, 0.3, true},
    {"local_short",  // its region is left when a blow is too much for it
     [](SolidParams& p) { p.solver.max_iterations = 9; }, 0.0, 0.3, true},
    {"linear", [](SolidParams& p) { p.model = StrainModel::linear; }},
    {"bdf2", [](SolidParams& p) { p.integrator = Integrator::bdf2; }},
    {"newmark", [](SolidParams& p) { p.integrator = Integrator::newmark; }},
    {"newton", [](SolidParams& p) { p.iteration = Iteration::newton; }},
    {"neo_hookean",
     [](SolidParams& p) {
       p.model = StrainModel::neo_hookean;
       p.iteration = Iteration::newton;
     }},
    {"p1_nodal", [](SolidParams& p) { p.element = ElementKind::p1_nodal; }, 0.0, 0.45},
    {"p1_nodal_lag", [](SolidParams& p) { p.element = ElementKind::p1_nodal; }, 1e-2, 0.45},
    {"p1_nodal_short",  // the nodes' stiffness is stored when a solve is long
     [](SolidParams& p) {
       p.element = ElementKind::p1_nodal;
       p.solver.jacobi_iterations = 30;
     },
     0.0, 0.45},
    {"p1_nodal_newton",
     [](SolidParams& p) {
       p.element = ElementKind::p1_nodal;
       p.iteration = Iteration::newton;
     },
     0.0, 0.45},
    {"curnier", [](SolidParams& p) { p.model = StrainModel::curnier; }},
    {"p2", [](SolidParams& p) { p.element = ElementKind::p2; }},
    {"p2_local", [](SolidParams& p) { p.element = ElementKind::p2; }, 0.0, 0.3, true},
    {"p2_curnier_local_lag",
     [](SolidParams& p) {
       p.element = ElementKind::p2;
       p.model = StrainModel::curnier;
     },
     1e-2, 0.3, true},
    {"p2_hencky",
     [](SolidParams& p) {
       p.element = ElementKind::p2;
       p.model = StrainModel::hencky;
     }},
};

const Fault kFaults[] = {
    {"solve_of_no_number",
     [](PulledBar& run) {
       run.scene.load(1, run.tip()) = std::numeric_limits<double>::quiet_NaN();
       return run.step();
     }},
    {"inverted_tet",
     [](PulledBar& run) {
       run.scene.load.col(run.tip()) = Vec3(-1e6, 3e5, 2e5);
       return run.step();
     }},
    {"indefinite_matrix",
     [](PulledBar& run) {
       run.set_material({-1e9, -1e9, 1.0});
       return run.step();
     }},
    {"other_moduli",
     [](PulledBar& run) {  // as by water, and then no balance
       run.set_material(test::make_material(0.1 * kYoungs, 0.2));
       run.scene.load.col(run.tip()) = Vec3(-1e6, 3e5, 2e5);
       return run.step();
     }},
    {"size",
     [](PulledBar& run) {  // likewise; a size comes back by its ratio
       set_swelling(run.scene.solid, 5, 1.02);
       const StepStatus status = update_kinematics(run.scene.solid, run.scene.region, run.scene.state.x, 0);
       set_swelling(run.scene.solid, 5, 1.0);
       EXPECT_TRUE(status.is_ok());
       return StepStatus::failed({});
     }},
    {"after_flow",
     [](PulledBar& run) {  // what comes after the step fails
       const StepStatus status = run.step();
       EXPECT_TRUE(status.is_ok());
       return StepStatus::failed({});
     }},
    {"line_search",
     [](PulledBar& run) {  // a load on a held node enters the potential alone
       run.scene.load.col(0).setConstant(std::numeric_limits<double>::infinity());
       const bool has_line_search = run.scene.params.iteration == Iteration::newton;
       const StepStatus status = run.step();
       return has_line_search ? status : StepStatus::failed({});
     }},
};

class FailedStep : public testing::TestWithParam<std::tuple<Kind, Fault>> {};

TEST_P(FailedStep, LeavesTheArchiveOfBefore) {
  const auto& [kind, fault] = GetParam();
  PulledBar run(kind), twin(kind);
  run.make_steps(12);
  twin.make_steps(12);
  const Snapshot before = run.take_snapshot();
  expect_equal(before, twin.take_snapshot());
  for (int time = 0; time < 2; ++time) {
    const StepStatus failed = fault.fail(run);
    ASSERT_FALSE(failed.is_ok());
    run.set_material(test::make_material(kYoungs, run.poisson));  // as who knows the water does
    ASSERT_TRUE(roll_back(run.scene.solid, run.scene.region, run.scene.state, 0).is_ok());
    expect_equal(before, run.take_snapshot());
    EXPECT_TRUE(
        (run.scene.solid.kinematics.strain().array() == twin.scene.solid.kinematics.strain().array()).all());
  }
  run.make_steps(12);
  twin.make_steps(12);
  expect_equal(run.take_snapshot(), twin.take_snapshot());
}

INSTANTIATE_TEST_SUITE_P(Every, FailedStep,
                         testing::Combine(testing::ValuesIn(kKinds), testing::ValuesIn(kFaults)),
                         [](const auto& instance) {
                           return std::string(std::get<0>(instance.param).name) + "_" +
                                  std::get<1>(instance.param).name;
                         });

}  // namespace
}  // namespace argil::solid
