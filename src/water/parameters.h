#pragma once

namespace argil::water {

enum class UptakeForm {
  flux,       ///< kg/(m² s) through the area that the tool touches
  increment,  ///< the paper's: a fixed step of saturation for every touched tet and water step
};

/// How water flows between two tets.
enum class FluxForm {
  corrected,  ///< two-point flux plus the part of the gradient along the face, limited: right D on any mesh
  two_point,  ///< two-point flux alone: a third of the cost; D is off where centroids are not opposite each
              ///< other
};

/// How diffusion goes on in time.
enum class DiffusionScheme {
  explicit_euler,  ///< substeps within the monotone limit; only tets with water or beside one are visited
  implicit_euler,  ///< one step of any length by a Cholesky factor that is kept; every tet is visited
};

struct WaterParams {
  double porosity = 0.4;              ///< n [–], in (0, 1): volume of water at S = 1 over rest volume
  double density = 1000.0;            ///< ρ_w [kg/m³], > 0
  double diffusivity = 0.0;           ///< D₀ [m²/s], ≥ 0, of saturation
  double diffusivity_exponent = 0.0;  ///< β [–] in D(S) = D₀ e^{βS} [Gardner1958]; 0: constant
  DiffusionScheme scheme = DiffusionScheme::explicit_euler;
  FluxForm flux = FluxForm::corrected;
  UptakeForm uptake = UptakeForm::flux;
  double wetting_flux = 0.0;          ///< [kg/(m² s)], ≥ 0, given by the wet tool
  double drying_flux = 0.0;           ///< [kg/(m² s)], ≥ 0, taken by the dry tool
  double saturation_increment = 0.0;  ///< [–], ≥ 0, per water step, `increment` only
  double initial_saturation = 0.0;    ///< S at the start [–], in [0, 1]
  double swelling = 0.0;   ///< growth of the rest volume at S = 1 over the dry one [–], ≥ 0, linear in S
  bool adds_mass = false;  ///< the body weighs its water, too; false: the dry clay alone, as in the paper
};

}  // namespace argil::water
