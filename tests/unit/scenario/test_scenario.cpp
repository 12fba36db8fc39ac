// Scenario files: what `show` prints, the paper's preset, --set, and what is refused with which words.
#include "scenario/scenario.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "scenario/json_document.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil::scenario {
namespace {

// The scene's own frames are no multiple of the paper's 14 ticks.
const std::vector<std::string> kPaper = {"/preset=paper", "/haptics/frame_period_ticks=28"};

class ScenarioFile : public testing::Test {
 protected:
  test::TempFolder folder;
  std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.1, "push");
  std::string file = folder.write("scene.json", test::make_ball_scenario("press.csv"));

  Scenario load(const std::vector<std::string>& settings = {}) const {
    std::vector<Setting> parsed;
    for (const std::string& text : settings) parsed.push_back(parse_setting(text));
    return load_scenario(file, parsed);
  }
  int count_warnings(const std::vector<std::string>& settings, const std::string& text) const {
    const std::vector<std::string> warnings = load(settings).warnings;
    return static_cast<int>(std::count_if(warnings.begin(), warnings.end(), [&](const std::string& warning) {
      return warning.find(text) != std::string::npos;
    }));
  }
  void expect_refused(const std::string& setting, const std::vector<std::string>& parts) const {
    for (const std::string& part : parts) ARGIL_EXPECT_THROW_WITH(load({setting}), InputError, part);
  }
};

TEST_F(ScenarioFile, ShownOneIsAFixedPointInAnyFolder) {
  const std::string shown = print_resolved(load());
  test::TempFolder elsewhere;
  EXPECT_EQ(print_resolved(load_scenario(elsewhere.write("shown.json", shown), {})), shown);
}

TEST_F(ScenarioFile, PortableOneIsTheSameWhereverTheFolderLies) {
  test::TempFolder elsewhere;
  test::write_press_trace(elsewhere / "press.csv", 0.048, 0.0435, 0.1, "push");
  const std::string moved = elsewhere.write("scene.json", test::make_ball_scenario("press.csv"));
  EXPECT_NE(print_resolved(load_scenario(moved, {})), print_resolved(load()));
  EXPECT_EQ(print_portable(load_scenario(moved, {})), print_portable(load()));
}

TEST_F(ScenarioFile, TheSkinIsTouchedByThePressureLawUnlessTheCageIsNamed) {
  const std::string skin = "/body/shape/skin_triangles=60", pressure = "/contact/law=pressure";
  const auto touched = [&](const std::vector<std::string>& settings) {
    return load(settings).params.contact_surface;
  };
  EXPECT_EQ(touched({pressure, skin}), sim::SurfaceKind::skin);
  EXPECT_EQ(touched({pressure}), sim::SurfaceKind::cage);  // there is none
  EXPECT_EQ(touched({skin}), sim::SurfaceKind::cage);      // by pairs
  EXPECT_EQ(touched({pressure, skin, "/contact/surface=cage"}), sim::SurfaceKind::cage);
  EXPECT_EQ(touched({skin, "/contact/surface=skin"}), sim::SurfaceKind::skin);
  EXPECT_EQ(touched({"/preset=paper", kPaper[1], skin}), sim::SurfaceKind::cage);
  const std::string shown = print_resolved(load({pressure, skin}));
  EXPECT_EQ(parse_json(shown, file)["contact"]["surface"], "skin");
}

/// The scene gives pairs their law and stiffness.
TEST_F(ScenarioFile, PressureIsTheLawUnlessAnotherIsNamed) {
  EXPECT_EQ(load().params.contact.law, contact::ContactLaw::pairs);
  std::string text = test::make_ball_scenario("press.csv");
  const std::string named = R"("law": "pairs", )";
  text.erase(text.find(named), named.size());
  file = folder.write("unnamed.json", text);
  EXPECT_EQ(load().params.contact.law, contact::ContactLaw::pressure);
  EXPECT_EQ(count_warnings({}, "/contact/vertex_face_stiffness_N_per_m: is of the pairs' law"), 1);
  EXPECT_EQ(count_warnings({"/contact/law=pressure"}, "is of the pairs' law"), 0);
  EXPECT_EQ(load({"/contact/damping_s_per_m=0.5"}).params.contact.damping, 0.0);
  EXPECT_EQ(load({"/preset=paper", kPaper[1]}).params.contact.law, contact::ContactLaw::pairs);
  const std::string stiffness = R"("vertex_face_stiffness_N_per_m": 400, "edge_edge_stiffness_N_per_m": 400)";
  text.erase(text.find(stiffness), stiffness.size());
  file = folder.write("plain.json", text);
  EXPECT_EQ(load().params.contact.law, contact::ContactLaw::pressure);
  EXPECT_EQ(count_warnings({}, "pairs"), 0);
  expect_refused("/contact/law=pairs", {"/contact/vertex_face_stiffness_N_per_m", "is missing"});
}

TEST_F(ScenarioFile, LocalExtentIsRefusedWhereAStepNeedsTheWholeBody) {
  const std::string local = "/dynamics/extent=local";
  EXPECT_EQ(load({local}).params.extent, sim::Extent::local);
  EXPECT_NO_THROW(load({local, "/dynamics/model=hencky", "/material/plasticity/max=0"}));
  EXPECT_NO_THROW(load({local, "/dynamics/element=p2"}));
  const std::vector<std::vector<std::string>> needs_whole = {
      {"/dynamics/element=p1_nodal"},
      {"/dynamics/model=neo_hookean"},
      {"/dynamics/integrator=newmark"},
      {"/dynamics/iteration=newton"},
      {"/dynamics/solver/kind=cholesky"},
      {"/dynamics/solver/tolerance=1e-6"},
      {"/haptics/between_frames=compliant", "/preset=paper"},
      {"/water/swelling=0.02"}};
  for (std::vector<std::string> settings : needs_whole) {
    SCOPED_TRACE(settings.front());
    settings.push_back(local);
    ARGIL_EXPECT_THROW_WITH(load(settings), InputError, "/dynamics/extent: local");
    ARGIL_EXPECT_THROW_WITH(load(settings), InputError, "or use whole");
  }
}

TEST_F(ScenarioFile, AnEquilibriumIsOfTheWholeBodyWhateverTheFidelity) {
  for (const std::string fidelity : {"full", "auto", "check"})
    EXPECT_EQ(load({"/dynamics/mode=static", "/fidelity/mode=" + fidelity}).params.extent, sim::Extent::whole)
        << fidelity;
  ARGIL_EXPECT_THROW_WITH(load({"/dynamics/mode=static", "/dynamics/extent=local"}), InputError,
                          "/dynamics/extent: local");
}

TEST_F(ScenarioFile, ShownPaperPresetIsAFixedPointToo) {
  const std::string shown = print_resolved(load(kPaper));
  EXPECT_EQ(print_resolved(load_scenario(folder.write("shown.json", shown), {})), shown);
}

TEST_F(ScenarioFile, PaperPresetChoosesWhatThePaperSays) {
  const Json shown = parse_json(print_resolved(load(kPaper)), "shown");
  const auto value = [&](const char* pointer) { return shown[Json::json_pointer(pointer)]; };
  EXPECT_EQ(value("/dynamics/model"), "linear");                    // Cauchy strain
  EXPECT_EQ(value("/material/effective_medium/scheme"), "dilute");  // eq. 6 as printed
  EXPECT_EQ(value("/material/effective_medium/aspect"), 1.0);       // spheres
  EXPECT_EQ(value("/material/clay_kernel/form"), "per_step");       // eq. 9 every step
  EXPECT_EQ(value("/material/plasticity/form"), "literal");         // Müller and Gross as printed
  EXPECT_EQ(value("/material/plasticity/norm"), "voigt6");
  EXPECT_EQ(value("/material/plasticity/deviatoric"), false);
  EXPECT_EQ(value("/water/uptake"), "increment");  // saturation rises step by step
  EXPECT_EQ(value("/haptics/between_frames"), "hold");
  EXPECT_EQ(value("/haptics/physics_period_ticks"), 14);  // 71 Hz
}

TEST_F(ScenarioFile, OwnKeysStandAboveThePreset) {
  EXPECT_EQ(load({kPaper[0], kPaper[1], "/dynamics/model=corotational"}).params.solid.model,
            solid::StrainModel::corotational);
}

TEST_F(ScenarioFile, SetTakesNumbersWordsAndLists) {
  const Scenario s = load({"/material/youngs_modulus_Pa=2e5", "/tool/mode=wet", "/about=\"in quotes\"",
                           "/body/loads/gravity_m_per_s2=[0, 0, -9.81]", "/body/fixed/0/offset_m=0.007",
                           "/dynamics/implicit_contact=false"});
  EXPECT_EQ(s.params.elastic.youngs_modulus, 2e5);
  EXPECT_EQ(s.tool.mode, ModeChoice::wet);
  EXPECT_EQ(s.about, "in quotes");
  EXPECT_EQ(s.params.solid.gravity, Vec3(0, 0, -9.81));
  EXPECT_EQ(s.body.fixed.at(0).region.offset, 0.007);
  EXPECT_FALSE(s.params.solid.implicit_contact);
}

TEST_F(ScenarioFile, HasNoClayKernelUnlessOneIsAskedFor) {
  EXPECT_EQ(load({"/material/clay_kernel={}"}).params.kernel.form, material::KernelForm::off);
  EXPECT_EQ(load({R"(/material/clay_kernel={"k1_per_m": 2, "radius_m": 0.04})"}).params.kernel.form,
            material::KernelForm::rate);
  expect_refused(R"(/material/clay_kernel={"k1_per_m": 2})", {"/material/clay_kernel/radius_m: is 0"});
}

TEST_F(ScenarioFile, LaterSetWins) {
  EXPECT_EQ(load({"/water/porosity=0.3", "/water/porosity=0.35"}).params.water.porosity, 0.35);
}

TEST_F(ScenarioFile, BadSetPointersNameTheNearestKey) {
  expect_refused(
      "/water/porosty=0.3",
      {"scene.json: /water/porosty", "did you mean \"porosity\"? known here are: ", "diffusivity_m2_per_s"});
  expect_refused("/watr/porosity=0.3", {"/watr", "did you mean \"water\"?"});
  expect_refused("/body/fixed/0/ofset_m=1", {"/body/fixed/0/ofset_m", "did you mean \"offset_m\"?"});
  expect_refused("/about/first=1",
                 {"/about/first", "cannot be set: /about is \"a ball", "which holds nothing; give"});
  expect_refused("/body/fixed/one/offset_m=1",
                 {"cannot be set: /body/fixed is a list", "\"one\" is no number"});
  expect_refused("/body/loads/gravity_m_per_s2/0=1",
                 {"cannot be set: /body/loads/gravity_m_per_s2 is not set, "
                  "so it has no element 0; set the whole list"});
  expect_refused("/wa~ter=1", {"/wa~ter: cannot be set", "~ is written ~0"});
  expect_refused("/water/a~1b=1", {"/water/a~1b: is not a known key"});
  expect_refused("porosity=0.3", {"--set: porosity=0.3", "/json/pointer=value"});
  expect_refused("/water/porosity", {"--set: /water/porosity", "/json/pointer=value"});
}

TEST_F(ScenarioFile, MayNameItsSchemaForAnEditor) {
  EXPECT_EQ(print_resolved(load({R"(/$schema="argil.schema.json")"})), print_resolved(load()));
  EXPECT_NE(print_schema().find("\"$schema\": {"), std::string::npos);
  expect_refused("/$schema=1", {"/$schema: is not a known key"});
  expect_refused(R"(/body/$schema="x")", {"/body/$schema: is not a known key"});
}

TEST_F(ScenarioFile, DuplicateKeysAreRefusedAtAnyDepthAndInSettings) {
  expect_refused(R"(/water={"porosity": 0.3, "porosity": 0.4})",
                 {"--set /water: /porosity: stands twice in one object"});
  std::string text = test::make_ball_scenario("press.csv");
  text.insert(text.find("\"k1_per_m\""), "\"k1_per_m\": 3, ");
  file = folder.write("scene.json", text);
  ARGIL_EXPECT_THROW_WITH(load(), InputError, "scene.json: /material/clay_kernel/k1_per_m: stands twice");
}

TEST_F(ScenarioFile, ValuesOutsideTheirRangeNamePointerValueRangeAndUnit) {
  expect_refused(
      "/material/youngs_modulus_Pa=0",
      {"/material/youngs_modulus_Pa", "0 is outside [1e-09, 1e+18] Pa", "give a value in that range"});
  expect_refused("/water/porosity=1", {"/water/porosity", "1 is outside (0.0, 1.0)"});
  expect_refused("/haptics/chatter_limit=0", {"/haptics/chatter_limit", "0 is outside (0.0, 1.0]"});
  EXPECT_EQ(load({"/haptics/chatter_limit=1"}).params.chatter_limit, 1.0);
  expect_refused("/haptics/period_s=1", {"/haptics/period_s", "1 is outside [1e-06, 1.0) s"});
  expect_refused("/tool/shape/subdivisions=7", {"/tool/shape/subdivisions", "7 is outside [0, 6]; give"});
  expect_refused("/body/loads/gravity_m_per_s2=[0,0]",
                 {"/body/loads/gravity_m_per_s2", "[0,0] is not a list of 3 numbers in m/s²"});
  expect_refused("/tool/mode=squeeze", {"/tool/mode", "\"squeeze\" is not one of", "wet"});
  expect_refused("/haptics/water_period_ticks=1e30", {"/haptics/water_period_ticks", "whole number"});
}

TEST_F(ScenarioFile, FilesThatCannotBeLookedUpAreNamedWithTheirKeyAndTheReason) {
  expect_refused("/trace/file=gone.csv", {"/trace/file", "gone.csv\" does not exist; give a path relative"});
  expect_refused("/trace/file=" + std::string(300, 'x') + ".csv",
                 {"scene.json: /trace/file", "cannot be looked up: File name too long; give a path"});
}

TEST_F(ScenarioFile, DuplicateKeyInAListIsNamedWithItsElement) {
  ARGIL_EXPECT_THROW_WITH(parse_json(R"({"a": [1, {"b": 2}, {"c/d": [], "c/d": 3}]})", "f"), InputError,
                          "f: /a/2/c~1d: stands twice");
}

TEST(ParseJson, RefusesAnObjectOfMoreKeysThanAnyFileHas) {
  // Each key is compared with all before: a file of 4 MB would be looked at for a minute.
  const auto object = [](int keys) {
    std::string text = "{";
    for (int k = 0; k < keys; ++k) text += (k > 0 ? ",\"" : "\"") + std::to_string(k) + "\":0";
    return "[" + text + "}]";
  };
  EXPECT_EQ(parse_json(object(10000), "f")[0].size(), 10000u);
  ARGIL_EXPECT_THROW_WITH(parse_json(object(10001), "f"), InputError,
                          "f: /0/10000: is one key more than the 10000 that an object may have");
}

TEST_F(ScenarioFile, PeriodThatIsNoMultipleIsToldTheNext) {
  expect_refused("/haptics/physics_period_ticks=14",
                 {"/haptics/water_period_ticks: 10 is no multiple of physics_period_ticks (14)",
                  "give a multiple of it, for instance 14"});
}

TEST_F(ScenarioFile, MissingRequiredKeysAreNamedWithTheirMeaning) {
  file = folder.write("scene.json", R"({"about": "x", "body": {"shape": {"kind": "sphere"}}})");
  ARGIL_EXPECT_THROW_WITH(load(), InputError,
                          "/material/youngs_modulus_Pa: is missing; add it: Young's modulus");
}

TEST_F(ScenarioFile, BodyOfTwoKindsIsRefused) {
  expect_refused("/body/mesh={\"file\": \"a.msh\"}", {"/body", "has 2 of mesh, shape and surface"});
}

TEST_F(ScenarioFile, LiteralFlowOfMoreThanTheElasticStrainIsRefused) {
  const auto flow = [](const std::string& form, int creep) {
    return std::vector<std::string>{"/material/plasticity/enabled=true", "/material/plasticity/form=" + form,
                                    "/material/plasticity/creep_per_s=" + std::to_string(creep)};
  };
  EXPECT_NO_THROW(load(flow("literal", 1000)));  // c h = 1 at 1 ms
  EXPECT_NO_THROW(load(flow("rate", 3000)));     // takes 1 − e^{−c h}
  ARGIL_EXPECT_THROW_WITH(load(flow("literal", 1001)), InputError, "/material/plasticity/form");
  ARGIL_EXPECT_THROW_WITH(load(flow("literal", 1001)), InputError, "allowed: [0, 1]");
}

TEST_F(ScenarioFile, PlasticStretchOfNeoHookeanClayMustKeepItsDimensions) {
  const auto with = [](const std::string& max, const std::string& model, const std::string& norm) {
    return std::vector<std::string>{"/dynamics/model=" + model, "/material/plasticity/max=" + max,
                                    "/material/plasticity/deviatoric=false",
                                    "/material/plasticity/norm=" + norm};
  };
  ARGIL_EXPECT_THROW_WITH(load(with("1.0", "neo_hookean", "frobenius")), InputError,
                          "/material/plasticity/max");
  EXPECT_NO_THROW(load(with("0.99", "neo_hookean", "frobenius")));
  ARGIL_EXPECT_THROW_WITH(load(with("0.71", "neo_hookean", "voigt6")), InputError, "outside (0, 0.707");
  EXPECT_NO_THROW(load(with("5", "corotational", "frobenius")));
}

TEST_F(ScenarioFile, HenckyClayFlowsWithoutACapAndKeepsItsVolume) {
  const auto with = [](const std::string& key, const std::string& value) {
    return std::vector<std::string>{"/dynamics/model=hencky", "/material/plasticity/enabled=true",
                                    "/material/plasticity/max=0",
                                    "/material/plasticity/" + key + "=" + value};
  };
  EXPECT_NO_THROW(load(with("deviatoric", "true")));
  ARGIL_EXPECT_THROW_WITH(load(with("max", "0.5")), InputError, "/material/plasticity/max: 0.5");
  ARGIL_EXPECT_THROW_WITH(load(with("max", "0.5")), InputError, "leave it out");
  ARGIL_EXPECT_THROW_WITH(load(with("deviatoric", "false")), InputError, "keeps the volume");
  ARGIL_EXPECT_THROW_WITH(load(with("norm", "voigt6")), InputError, "Frobenius");
  EXPECT_NO_THROW(load({with("max", "0.5")[0], with("max", "0.5")[3], "/dynamics/mode=static"}));
}

TEST_F(ScenarioFile, AStrengthInPascalsMakesClayOfLargeStrain) {
  const std::string strength = "/material/plasticity/strength_Pa=15000";
  const std::vector<std::string> plain = {"/material/plasticity/enabled=true", "/material/plasticity/yield=0",
                                          "/material/plasticity/max=0", strength, "/contact/law=pressure"};
  const Scenario s = load(plain);
  EXPECT_EQ(s.params.solid.model, solid::StrainModel::hencky);
  EXPECT_EQ(s.params.plasticity.form, material::FlowForm::j2);
  EXPECT_EQ(s.body.cells.kind, CellKind::graded);
  EXPECT_EQ(s.body.fit, embed::Fit::surface);
  const std::vector<std::string> own = {plain[0],
                                        plain[1],
                                        plain[2],
                                        strength,
                                        "/dynamics/model=corotational",
                                        "/material/plasticity/form=rate"};
  EXPECT_EQ(load(own).params.solid.model, solid::StrainModel::corotational);
  EXPECT_EQ(load(own).params.plasticity.form, material::FlowForm::rate);
  ARGIL_EXPECT_THROW_WITH(load({plain[0], "/material/plasticity/yield=0.02", plain[2], strength}), InputError,
                          "/material/plasticity/strength_Pa: is given, and yield too");
  ARGIL_EXPECT_THROW_WITH(load({plain[0], plain[1], plain[2], "/material/plasticity/strength_Pa=-1"}),
                          InputError, "/material/plasticity/strength_Pa");
}

TEST_F(ScenarioFile, ABodyMadeHereIsTheSurfaceWithItsCellsWhereTheToolIs) {
  const std::string elastic = "/material/plasticity/enabled=false", pressure = "/contact/law=pressure";
  const Scenario s = load({elastic, pressure});
  EXPECT_EQ(s.params.solid.model, solid::StrainModel::curnier);
  const std::string creep = "/material/plasticity/creep_per_s=2";
  ARGIL_EXPECT_THROW_WITH(load({creep, pressure, "/dynamics/model=curnier"}), InputError,
                          "/dynamics/model: curnier is a law of clay that does not flow");
  EXPECT_EQ(s.body.cells.kind, CellKind::graded);
  EXPECT_EQ(s.body.fit, embed::Fit::surface);

  const std::string yield = "/material/plasticity/yield=0.02";
  const Scenario by_strain = load({yield, pressure});
  EXPECT_EQ(by_strain.params.solid.model, solid::StrainModel::corotational);
  EXPECT_EQ(by_strain.body.cells.kind, CellKind::even);
  EXPECT_EQ(by_strain.body.fit, embed::Fit::surface);

  const Scenario as_paper = load({elastic, "/contact/law=pairs"});
  EXPECT_EQ(as_paper.body.cells.kind, CellKind::even);
  EXPECT_EQ(as_paper.body.fit, embed::Fit::enclose);
  EXPECT_EQ(as_paper.params.solid.model, solid::StrainModel::corotational);
  EXPECT_EQ(load({elastic, pressure, "/dynamics/mode=static"}).body.cells.kind, CellKind::even);
  EXPECT_EQ(load({elastic, pressure, "/material/effective_medium/orientation=aligned"}).params.solid.model,
            solid::StrainModel::corotational);
}

TEST_F(ScenarioFile, HenckyClayStopsWhereATetIsInverted) {
  const auto with = [](const std::string& model, const std::string& least) {
    return std::vector<std::string>{"/dynamics/model=" + model, "/material/plasticity/enabled=false",
                                    "/dynamics/min_volume_ratio=" + least};
  };
  ARGIL_EXPECT_THROW_WITH(load(with("hencky", "-0.5")), InputError, "/dynamics/min_volume_ratio: -0.5");
  ARGIL_EXPECT_THROW_WITH(load(with("hencky", "-0.5")), InputError, "outside [0, 1] for hencky");
  EXPECT_NO_THROW(load(with("hencky", "0")));
  EXPECT_NO_THROW(load(with("corotational", "-0.5")));
}

TEST_F(ScenarioFile, IntegratorsThatDoNotServeAreWarnedOf) {
  const std::string newton = "/dynamics/iteration=newton";
  const auto integrator = [](const char* name) { return std::string("/dynamics/integrator=") + name; };
  EXPECT_EQ(count_warnings({integrator("bdf2")}, "gains energy"), 1);
  EXPECT_EQ(count_warnings({integrator("newmark")}, "gains energy"), 1);
  EXPECT_EQ(count_warnings({integrator("bdf2"), newton}, "gains energy"), 0);
  EXPECT_EQ(count_warnings({integrator("bdf2"), "/dynamics/model=linear"}, "gains energy"), 0);
  EXPECT_EQ(count_warnings({integrator("symplectic_euler"), newton}, "/dynamics/iteration has no effect"), 1);
  EXPECT_EQ(count_warnings({integrator("symplectic_euler")}, "no effect"), 0);
  EXPECT_EQ(count_warnings({integrator("newmark"), newton, "/dynamics/mode=static"},
                           "/dynamics/integrator has no effect"),
            1);
  EXPECT_EQ(count_warnings({"/dynamics/mode=static"}, "no effect"), 0);
}

TEST_F(ScenarioFile, J2IsALawOfIsotropicClay) {
  const std::vector<std::string> flat = {"/material/plasticity/enabled=true", "/material/plasticity/form=j2",
                                         "/material/effective_medium/aspect=0.1",
                                         "/material/effective_medium/orientation=aligned"};
  ARGIL_EXPECT_THROW_WITH(load(flat), InputError, "j2 is a law of isotropic clay");
  EXPECT_NO_THROW(load({flat[0], flat[1], flat[2]}));
}

class IsotropicLaw : public ScenarioFile, public testing::WithParamInterface<const char*> {};

INSTANTIATE_TEST_SUITE_P(Every, IsotropicLaw, testing::Values("neo_hookean", "hencky"));

TEST_P(IsotropicLaw, TakesEverySchemeThatLeavesClayIsotropic) {
  const std::vector<std::string> flat = {
      std::string("/dynamics/model=") + GetParam(), "/material/plasticity/enabled=false",
      "/material/effective_medium/aspect=0.1", "/material/effective_medium/orientation=aligned"};
  ARGIL_EXPECT_THROW_WITH(load(flat), InputError, "takes isotropic stiffness only");
  for (const char* other :
       {"/material/effective_medium/scheme=voigt",  // knows no shape
        "/material/effective_medium/orientation=random", "/material/effective_medium/aspect=1"}) {
    std::vector<std::string> settings = flat;
    settings.emplace_back(other);
    EXPECT_NO_THROW(load(settings)) << other;
  }
}

TEST(FindNearest, IsByEditDistanceAndSilentWhenNothingIsNear) {
  const std::vector<std::string> keys = {"youngs_modulus_Pa", "density_kg_per_m3"};
  EXPECT_EQ(find_nearest("youngs_modulus", keys), "youngs_modulus_Pa");
  EXPECT_EQ(find_nearest("densty_kg_per_m3", keys), "density_kg_per_m3");
  EXPECT_EQ(find_nearest("xyz", keys), "");
}

}  // namespace
}  // namespace argil::scenario
