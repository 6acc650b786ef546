// How wide the pupil opens to a field of light, and how much light then falls on the retina.
#pragma once

namespace greenray::vision {

enum class PupilModel {
  watson_yellott,  // Watson & Yellott 2012, unified formula: luminance, area, age, eyes
  de_groot,        // De Groot & Gebhard 1952 in cd/m2
  moon_spencer,    // Moon & Spencer 1944
  g04              // as G04 6.1-pupil prints it, misprint included
};

/// What the eye adapts to. The pupil answers this field, not a pixel of it.
struct PupilField {
  double luminance_cd_m2 = 0;  // mean over the field
  double area_deg2 = 60;       // Watson-Yellott only
  double age_years = 28.58;    // Watson-Yellott only, 20 to 83; 28.58 is the age without correction
  int eyes = 2;                // Watson-Yellott only: that see the field
};

/* Diameter of the pupil [mm].
   clamp: keep within [2, 8] mm, the range of real pupils; De Groot's curve falls to 0.1 mm in sunlight without it
   returns: finite for every luminance >= 0, 0 included
   errors: luminance negative or not finite -> std::domain_error
   source: Watson & Yellott, J. Vision 12(10):12 (2012), eqs. of section "A unified formula"; De Groot & Gebhard, JOSA
           42, 492 (1952); Moon & Spencer, JOSA 34, 319 (1944)
   differs: De Groot's luminance is in millilambert (0.1 cd/pi/cm2): in cd/m2 the offset is 7.597, where G04 prints 8.6,
            the conversion with its sign turned. The printed form is kept as `g04`. */
double pupil_diameter_mm(PupilModel model, const PupilField &field, bool clamp = true);

/* Effectivity of light through the whole pupil against the same light through its centre (Stiles-Crawford), for cones.
   source: Moon & Spencer 1944, 1 - 0.085 r^2 + 0.002 r^4 averaged over the pupil; G04 6.1-effectivity prints 4.19e-5
   for the last constant, 0.1 % of it too much at 8 mm */
double effectivity(double diameter_mm);

/// Retinal illuminance [effective photopic td] of luminance [cd/m2] seen through the pupil.
double trolands(double luminance_cd_m2, double diameter_mm);

}  // namespace greenray::vision
