// Water that a wet tool brings into dry clay through a flat face: as much as the tool gives until the face is
// full, then as much as a half-space takes up whose face is full. I [m]: volume of it over n and area; F
// [m/s]: the tool's flux of it; D constant [Crank1975, §3.3]:
//   I = F t until t = π D/(4 F²);  I → 2 √(D t/π) long after.
// In between: a fine bar in one dimension, made here. That holds for any cells, steps of the water and
// scheme.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/rng.h"
#include "support/block_mesh.h"
#include "water/water.h"

namespace argil::water {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kD = 1e-4;  // [m²/s]
constexpr double kDensity = 1000.0;
constexpr double kPorosity = 0.4;
constexpr double kDepth = 0.04;                              // of the clay [m]: more than the water reaches
const std::vector<double> kTimes = {0.02, 0.06, 0.1, 0.26};  // [s]

/// I of dry clay at kTimes: a thousand cells of 0.04 mm, explicit.
std::vector<double> compute_fine_bar(double flux) {
  constexpr double kCell = 4e-5;
  const double dt = 0.25 * kCell * kCell / kD;
  std::vector<double> S(1000, 0.0), flow(1001, 0.0), depths;
  double depth = 0.0;
  std::int64_t done = 0;
  for (const double time : kTimes) {
    for (; static_cast<double>(done) * dt < time; ++done) {
      flow[0] = std::min(flux, 2.0 * kD / kCell * (1.0 - S[0]));
      for (std::size_t i = 1; i < S.size(); ++i) flow[i] = kD / kCell * (S[i - 1] - S[i]);
      for (std::size_t i = 0; i < S.size(); ++i) S[i] += dt / kCell * (flow[i] - flow[i + 1]);
      depth += dt * flow[0];
    }
    depths.push_back(depth);
  }
  return depths;
}

/// Columns of cells of six tets, `across` by `across`; shaken: inner vertices are anywhere but their places.
struct Clay {
  mesh::TetMesh mesh;
  mesh::Topology topology;
  std::vector<int> tet;      // behind the face z = 0
  std::vector<double> area;  // of the triangles there
  double face = 0.0;         // [m²]

  Clay(double cell, int across, bool is_shaken) {
    const double width = across * cell;
    mesh = test::make_block(across, across, static_cast<int>(std::lround(kDepth / cell)),
                            Vec3(width, width, kDepth));
    const Vec3 size(width, width, kDepth);
    Rng rng(3, "shake");
    for (int v = 0; is_shaken && v < mesh.num_vertices(); ++v)
      for (int c = 0; c < 3; ++c)
        if (double& x = mesh.vertices(c, v); x > 1e-9 && x < size(c) - 1e-9)
          x += cell * rng.uniform(-0.2, 0.2);
    topology = mesh::make_topology(mesh);
    for (Eigen::Index i = 0; i < topology.boundary.cols(); ++i) {
      const auto corner = [&](int k) { return Vec3(mesh.vertices.col(topology.boundary(k, i))); };
      if (std::max({corner(0).z(), corner(1).z(), corner(2).z()}) > 1e-9) continue;
      tet.push_back(topology.boundary_tet[static_cast<std::size_t>(i)]);
      area.push_back(0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm());
      face += area.back();
    }
  }
};

WaterParams make_params(DiffusionScheme scheme, double flux, FluxForm form = FluxForm::corrected) {
  WaterParams params;
  params.porosity = kPorosity;
  params.density = kDensity;
  params.diffusivity = kD;
  params.scheme = scheme;
  params.flux = form;
  params.wetting_flux = params.drying_flux = flux * kDensity * kPorosity;
  return params;
}

/// I at kTimes. Wets dry clay, or dries wet clay, in steps of the water of `step_s`.
std::vector<double> compute_uptake(const Clay& clay, const WaterParams& params, double step_s, int sign = 1,
                                   double start = 0.0) {
  PoreWater water(clay.mesh, clay.topology, params,
                  Field::Constant(clay.mesh.num_tets(), sign > 0 ? start : 1.0));
  std::vector<double> depths;
  std::int64_t done = 0;
  for (const double time : kTimes) {
    for (; done < std::lround(time / step_s); ++done) water.move({clay.tet, clay.area, sign}, step_s);
    const WaterLedger ledger = water.ledger();
    depths.push_back((sign > 0 ? ledger.added : ledger.removed) / (kDensity * kPorosity * clay.face));
    EXPECT_GE(water.saturation().minCoeff(), 0.0);
    EXPECT_LE(water.saturation().maxCoeff(), 1.0);
    EXPECT_LT(std::abs(water.ledger_error()), 1e-14);
  }
  return depths;
}

TEST(Infiltration, FineBarHasTheClosedFormsAtItsEnds) {
  const std::vector<double> slow = compute_fine_bar(0.01);  // the face stays below S = 1
  const std::vector<double> fast = compute_fine_bar(30.0);
  for (std::size_t k = 0; k < kTimes.size(); ++k) {
    EXPECT_NEAR(slow[k], 0.01 * kTimes[k], 1e-6);
    EXPECT_NEAR(fast[k], 2.0 * std::sqrt(kD * kTimes[k] / kPi), 2e-3 * fast[k]);
  }
}

TEST(Infiltration, IsTheSameWhateverCellsAndSteps) {
  // Cells of 0.25 to 4 mm under water that goes 1.6 mm deep in the first 20 ms, 5.8 mm in 260.
  // Discretisation: 3 % of what has gone in, and while that is less than a cell 4 % of the cell.
  for (const double flux : {0.01, 0.3, 30.0}) {  // never fills the face, fills it in 0.9 ms, at once
    const std::vector<double> exact = compute_fine_bar(flux);
    for (const double cell : {0.25e-3, 0.5e-3, 1e-3, 2e-3, 4e-3}) {
      const bool is_shaken = cell > 0.6e-3;
      const Clay clay(cell, is_shaken ? 2 : 1, is_shaken);
      std::vector<std::vector<double>> uptakes;
      for (const double step : {0.001, 0.01, 0.02}) {
        if (cell < 0.4e-3 && step < 0.01) continue;  // takes long
        uptakes.push_back(compute_uptake(clay, make_params(DiffusionScheme::explicit_euler, flux), step));
        for (std::size_t k = 0; k < kTimes.size(); ++k)
          EXPECT_NEAR(uptakes.back()[k], exact[k], std::max(0.03 * exact[k], 0.04 * cell))
              << flux << " m/s, cells of " << cell << " m, steps of " << step << " s, after " << kTimes[k];
      }
      std::printf(
          "flux %5.2f m/s, cells of %.2f mm: I off by %5.1f %5.1f %5.1f %5.1f %% after 20, 60, 100, 260 ms\n",
          flux, 1e3 * cell, 1e2 * (uptakes.back()[0] / exact[0] - 1.0),
          1e2 * (uptakes.back()[1] / exact[1] - 1.0), 1e2 * (uptakes.back()[2] / exact[2] - 1.0),
          1e2 * (uptakes.back()[3] / exact[3] - 1.0));
    }
  }
}

TEST(Infiltration, OfClayThatIsWetAlreadyIsThatOfDryClayInProportion) {
  // With S₀ everywhere, (S − S₀)/(1 − S₀) is that of dry clay under a tool of flux F/(1 − S₀).
  constexpr double kStart = 0.5;
  const std::vector<double> of_dry = compute_fine_bar(0.3 / (1.0 - kStart));
  for (const double cell : {1e-3, 4e-3}) {
    const Clay clay(cell, 2, true);
    for (const DiffusionScheme scheme : {DiffusionScheme::explicit_euler, DiffusionScheme::implicit_euler}) {
      const std::vector<double> uptake = compute_uptake(clay, make_params(scheme, 0.3), 0.001, 1, kStart);
      for (std::size_t k = 0; k < kTimes.size(); ++k) {
        const double exact = (1.0 - kStart) * of_dry[k];
        EXPECT_NEAR(uptake[k], exact, std::max(0.04 * exact, 0.04 * (1.0 - kStart) * cell))
            << cell << ' ' << kTimes[k];
      }
    }
  }
}

TEST(Infiltration, ByTwoPointFluxIsRightWhereThatIs) {
  // On shaken cells its D is too large by up to a tenth.
  const std::vector<double> exact = compute_fine_bar(0.3);
  const WaterParams params = make_params(DiffusionScheme::explicit_euler, 0.3, FluxForm::two_point);
  for (const double cell : {0.5e-3, 2e-3}) {
    const std::vector<double> straight = compute_uptake(Clay(cell, 1, false), params, 0.01);
    const std::vector<double> shaken = compute_uptake(Clay(cell, 3, true), params, 0.01);
    for (std::size_t k = 0; k < kTimes.size(); ++k) {
      EXPECT_NEAR(straight[k], exact[k], 0.02 * exact[k]);
      EXPECT_NEAR(shaken[k], exact[k], 0.07 * exact[k]);
    }
  }
}

TEST(Infiltration, ByImplicitStepsIsTheSameToFirstOrder) {
  // Backward Euler of a face that is full at once takes √(D h) in the first step, 11 % less than 2 √(D h/π).
  // That is lost once, and as much of a cell that is deeper than the water.
  for (const double flux : {0.01, 0.3, 30.0}) {
    const std::vector<double> exact = compute_fine_bar(flux);
    for (const double cell : {1e-3, 4e-3}) {
      const Clay clay(cell, 2, true);
      for (const double step : {0.001, 0.01}) {
        const double lost = 0.13 * std::sqrt(kD * step) + 0.2 * std::min(cell, std::sqrt(kD * step));
        const std::vector<double> uptake =
            compute_uptake(clay, make_params(DiffusionScheme::implicit_euler, flux), step);
        for (std::size_t k = 0; k < kTimes.size(); ++k)
          EXPECT_NEAR(uptake[k], exact[k], 0.03 * exact[k] + lost)
              << flux << " m/s, cells of " << cell << " m, steps of " << step << " s, after " << kTimes[k];
      }
    }
  }
}

TEST(Infiltration, OfADryToolIsTheSameWithTheSignTurned) {
  const Clay clay(1e-3, 3, true);
  for (const DiffusionScheme scheme : {DiffusionScheme::explicit_euler, DiffusionScheme::implicit_euler}) {
    const WaterParams params = make_params(scheme, 0.3);
    const std::vector<double> wet = compute_uptake(clay, params, 0.01);
    const std::vector<double> dry = compute_uptake(clay, params, 0.01, -1);
    // Explicit: water below a trace in dry clay does not flow, and its front goes a tet a substep.
    for (std::size_t k = 0; k < kTimes.size(); ++k) EXPECT_NEAR(dry[k], wet[k], 1e-4 * wet[k]);
  }
}

TEST(Infiltration, ThroughHalfOfEveryTriangleIsAsFastWhereTheToolsFluxLimitsIt) {
  // And where the clay does, it is between a half and all of it: water goes sideways, too.
  Clay clay(2e-3, 3, true);
  for (const double flux : {0.01, 30.0}) {
    const WaterParams params = make_params(DiffusionScheme::explicit_euler, flux);
    const std::vector<double> whole = compute_uptake(clay, params, 0.01);
    Clay half = clay;
    for (double& area : half.area) area *= 0.5;
    const std::vector<double> part = compute_uptake(half, params, 0.01);
    for (std::size_t k = 0; k < kTimes.size(); ++k) {
      if (flux < 0.1) {
        EXPECT_NEAR(part[k], 0.5 * whole[k], 1e-12);
      }
      EXPECT_GE(part[k], 0.499 * whole[k]);
      EXPECT_LE(part[k], 0.95 * whole[k]);
    }
  }
}

}  // namespace
}  // namespace argil::water
