// Plastic flow through a whole run: a box drawn out along z between plates that let it contract, against the
// closed forms of uniaxial stress; and which laws of flow a scenario may not ask for.
#include <gtest/gtest.h>

#include <cmath>

#include "output/result_reader.h"
#include "refusal.h"

namespace argil {
namespace {

constexpr double kYoungsModulus = 1e5;  // [Pa]
constexpr double kNu = 0.3;
constexpr double kVolume = 1e-3;  // a cube of 0.1 m
constexpr double kPull = 0.01;    // strain, reached after kRamp and held
constexpr double kRamp = 0.3;     // [s]
constexpr double kEnd = 0.4;      // [s]

class PulledBox : public testing::Test {
 protected:
  test::TempFolder folder;

  /// Damped so that it follows its equilibrium: the slowest wave takes 10 ms to and fro.
  std::string make_scene(const std::string& plasticity, int period_ticks) const {
    const std::string trace = test::write_press_trace(folder / "away.csv", 0.5, 0.4, kEnd, "push");
    return R"({"about": "a box drawn out along z", "body": {
      "shape": {"kind": "box", "size_m": 0.1, "target_tets": 150, "skin_triangles": 0}, "fixed": [
        {"kind": "plane", "normal": [1, 0, 0], "offset_m": -0.05, "fixes_y": false, "fixes_z": false},
        {"kind": "plane", "normal": [0, 1, 0], "offset_m": -0.05, "fixes_x": false, "fixes_z": false},
        {"kind": "plane", "normal": [0, 0, 1], "offset_m": 0, "fixes_x": false, "fixes_y": false},
        {"kind": "plane", "normal": [0, 0, 1], "offset_m": 0.1, "fixes_x": false, "fixes_y": false,
         "displacement_m": [0, 0, )" +
           std::to_string(kPull * 0.1) + R"(], "ramp_end_s": )" + std::to_string(kRamp) + R"(}]},
      "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "density_kg_per_m3": 500,
        "clay_kernel": {"form": "off"}, "plasticity": {)" +
           plasticity + R"(}},
      "tool": {"shape": {"kind": "sphere", "radius_m": 0.006, "subdivisions": 1}, "mode": "push"},
      "contact": {"law": "pairs", "vertex_face_stiffness_N_per_m": 1, "edge_edge_stiffness_N_per_m": 1},
      "dynamics": {"model": "linear", "rayleigh_stiffness_s": 0.005, "solver": {"kind": "cholesky"}},
      "haptics": {"physics_period_ticks": )" +
           std::to_string(period_ticks) + R"(, "frame_period_ticks": 100},
      "trace": {"file": ")" +
           trace + "\"}}";
  }
  std::vector<sim::PhysicsRecord> run(const std::string& plasticity, int period_ticks,
                                      const std::vector<std::string>& settings = {}) const {
    run::RunOptions options;
    options.quiet = true;
    options.settings = settings;
    options.scenario = test::write_text(folder / "scene.json", make_scene(plasticity, period_ticks));
    options.output = folder / "out.h5";
    EXPECT_EQ(run::run(options), run::kDone);
    return output::ResultReader(options.output).read_physics();
  }
  void expect_refused(const std::string& plasticity, const std::vector<std::string>& parts) const {
    test::expect_refused(folder, make_scene(plasticity, 1), {}, parts);
  }
};

TEST_F(PulledBox, OfJ2YieldsAtItsStrengthAndDissipatesTheRest) {
  // σ_y = √6 μ·yield = E ε_y. At rest ½ E ε_y² is stored and σ_y (ε − ε_y) gone, per volume.
  const double strain_at_yield = 0.003;
  const double yield = strain_at_yield * 2.0 * (1.0 + kNu) / std::sqrt(6.0);
  const auto records = run(R"("form": "j2", "yield": )" + std::to_string(yield) + R"(, "max": 1)", 1);
  const double stored = 0.5 * kYoungsModulus * strain_at_yield * strain_at_yield * kVolume;
  const double gone = kYoungsModulus * strain_at_yield * (kPull - strain_at_yield) * kVolume;
  // Flow comes after each step, which overshoots by dε = ε h/ramp; the last ones leave less than that.
  const double overshoot = kPull * 1e-3 / kRamp / strain_at_yield;
  EXPECT_NEAR(records.back().elastic_energy, stored, 2.0 * overshoot * stored);
  EXPECT_NEAR(records.back().plastic_dissipation, gone, 2.0 * overshoot * gone);
  double before = 0.0;
  for (const sim::PhysicsRecord& record : records) {
    EXPECT_GE(record.plastic_dissipation, before);
    before = record.plastic_dissipation;
  }
}

TEST_F(PulledBox, OfLargeStrainBearsItsStrengthDrawnOutAndAtHalfItsLength) {
  // σ_y = √3 c_u on the true area: σ_y²/2E stays stored, σ_y (|ln s| − σ_y/E) is gone, per volume at rest.
  const double strength = 3e3;
  const double tension = std::sqrt(3.0) * strength;
  for (const double stretch : {1.1, 0.5}) {  // drawn out farther it necks
    const auto records = run(R"("strength_Pa": 3000)", 1,
                             {"/dynamics/model=hencky", "/body/fixed/3/displacement_m=[0,0," +
                                                            std::to_string(0.1 * (stretch - 1.0)) + "]"});
    const double stored = tension * tension / (2.0 * kYoungsModulus) * kVolume;
    const double gone = tension * (std::abs(std::log(stretch)) - tension / kYoungsModulus) * kVolume;
    EXPECT_NEAR(records.back().elastic_energy, stored, 0.01 * stored) << stretch;
    EXPECT_NEAR(records.back().plastic_dissipation, gone, 0.06 * gone) << stretch;  // of the step
  }
}

TEST_F(PulledBox, OfRateFlowRelaxesAtItsRateWhateverTheStep) {
  // ε̇_p = c dev ε_e under uniaxial stress at held strain: σ̇ = −E c σ/(3μ), so the energy falls with
  // e^{−2·2(1+ν)c t/3}.
  const double creep = 5.0;
  const double rate = 4.0 * (1.0 + kNu) * creep / 3.0;
  for (const int period : {5, 2, 1}) {
    const auto records = run(R"("form": "rate", "yield": 0, "creep_per_s": 5, "max": 1)", period);
    const auto at = [&](double time) {
      for (const sim::PhysicsRecord& record : records)
        if (record.time > time - 1e-9) return record;
      ADD_FAILURE() << time;
      return records.back();
    };
    const sim::PhysicsRecord first = at(0.34);
    const sim::PhysicsRecord last = at(0.4);
    EXPECT_NEAR(std::log(first.elastic_energy / last.elastic_energy) / (last.time - first.time), rate,
                0.01 * rate)
        << period;
  }
}

TEST_F(PulledBox, OfRateFlowToYieldEndsThereWhateverTheStepAndOfRateFlowPastItToFirstOrder) {
  // At held strain flow ends with the tensile strain ε_y that the yield norm allows, ½ E ε_y² stored. The
  // rate form's last step relaxes by up to e^{−c h} too far.
  const double strain_at_yield = 0.003;
  const double yield = strain_at_yield * 2.0 * (1.0 + kNu) / std::sqrt(6.0);
  const double stored = 0.5 * kYoungsModulus * strain_at_yield * strain_at_yield * kVolume;
  const auto run_form = [&](const std::string& form, int period) {
    return run(R"("form": ")" + form + R"(", "yield": )" + std::to_string(yield) +
                   R"(, "creep_per_s": 50, "max": 1)",
               period)
        .back()
        .elastic_energy;
  };
  for (const int period : {10, 5, 2, 1}) {
    EXPECT_NEAR(run_form("rate_to_yield", period), stored, 0.004 * stored) << period;
    // Flow of the deviator's share f takes ⅔(1+ν) f of the tensile stress.
    const double left = 1.0 - 2.0 / 3.0 * (1.0 + kNu) * (1.0 - std::exp(-50.0 * period * 1e-3));
    const double rate = run_form("rate", period);
    EXPECT_LT(rate, 0.98 * stored) << period;
    EXPECT_GT(rate, left * left * stored) << period;
  }
}

TEST_F(PulledBox, LosesEnergyToFlowInEveryModelAndFormAtLargeStrain) {
  // Second law: the dissipation never falls, though plastic strain goes to its cap. Squashed by 40 %, and
  // drawn out by 60 %.
  for (const char* model : {"corotational", "neo_hookean"})
    for (const char* form : {"rate", "rate_to_yield", "literal", "j2"})
      for (const char* pull : {"-0.04", "0.06"}) {
        const auto records = run(
            std::string(R"("form": ")") + form + R"(", "yield": 0.005, "creep_per_s": 100, "max": 0.7)", 5,
            {std::string("/dynamics/model=") + model,
             std::string("/body/fixed/3/displacement_m=[0,0,") + pull + "]"});
        double before = 0.0;
        for (const sim::PhysicsRecord& record : records) {
          EXPECT_GE(record.plastic_dissipation, before * (1.0 - 1e-12))
              << model << form << pull << record.time;
          before = record.plastic_dissipation;
        }
        EXPECT_GT(before, 0.01) << model << form << pull;
        EXPECT_GT(records.back().max_plastic_strain, 0.3) << model << form << pull;
      }
}

TEST_F(PulledBox, MayNotMixJ2WithAnotherNormOrWithFlowOfTheVolume) {
  const std::string j2 = R"("form": "j2", "yield": 0.01, "max": 1)";
  expect_refused(j2 + R"(, "norm": "voigt6")", {"/material/plasticity/form", "j2", "Frobenius", "norm"});
  expect_refused(j2 + R"(, "deviatoric": false)", {"/material/plasticity/form", "j2", "deviator"});
  expect_refused(R"("form": "j3")", {"/material/plasticity/form", "j3", "j2"});
}

}  // namespace
}  // namespace argil
