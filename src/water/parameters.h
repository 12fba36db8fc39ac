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

struct WaterParams {
  double porosity = 0.4;     ///< n [–], in (0, 1): volume of water at S = 1 over rest volume
  double density = 1000.0;   ///< ρ_w [kg/m³], > 0
  double diffusivity = 0.0;  ///< D [m²/s], ≥ 0, of saturation
  FluxForm flux = FluxForm::corrected;
  UptakeForm uptake = UptakeForm::flux;
  double wetting_flux = 0.0;          ///< [kg/(m² s)], ≥ 0, given by the wet tool
  double drying_flux = 0.0;           ///< [kg/(m² s)], ≥ 0, taken by the dry tool
  double saturation_increment = 0.0;  ///< [–], ≥ 0, per water step, `increment` only
  double initial_saturation = 0.0;    ///< S at the start [–], in [0, 1]
};

}  // namespace argil::water
