#pragma once

namespace argil::water {

enum class UptakeForm {
  flux,       ///< kg/(m² s) through the area that the tool touches
  increment,  ///< the paper's: a fixed step of saturation for every touched tet and water step
};

struct WaterParams {
  double porosity = 0.4;     ///< n [–], in (0, 1): volume of water at S = 1 over rest volume
  double density = 1000.0;   ///< ρ_w [kg/m³]
  double diffusivity = 0.0;  ///< D [m²/s], of saturation
  UptakeForm uptake = UptakeForm::flux;
  double wetting_flux = 0.0;          ///< [kg/(m² s)], given by the wet tool
  double drying_flux = 0.0;           ///< [kg/(m² s)], taken by the dry tool
  double saturation_increment = 0.0;  ///< [–] per water step, `increment` only
  double initial_saturation = 0.0;    ///< S at the start [–]
};

}  // namespace argil::water
