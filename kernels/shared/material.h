/* What surfaces are made of. Quantities by wavelength are rows of a table, spectra[rows][waves]; -1 is no row. */

enum MaterialKind {
  MATERIAL_LAMBERT = 0,
  MATERIAL_MIRROR = 1,          /* smooth, reflectance by wavelength */
  MATERIAL_DIELECTRIC = 2,      /* smooth, Fresnel and Snell with the medium outside */
  MATERIAL_ROUGH_CONDUCTOR = 3, /* GGX, complex index */
  MATERIAL_ROUGH_DIELECTRIC = 4 /* GGX, Fresnel, refracting (Walter et al. 2007) */
};

typedef struct Material {
  int kind;
  int reflectance;  /* row: albedo, mirror's reflectance, tint of conductors; transmittance per metre is `absorption` */
  int index;        /* row: n of dielectrics and conductors */
  int extinction;   /* row: k of conductors */
  int absorption;   /* row: absorption inside a dielectric [1/m] */
  int texture;      /* image that replaces `reflectance`, or -1 */
  int disperses;    /* 1: n differs between wavelengths, so that a bundle of them must be split */
  scalar roughness; /* alpha of GGX */
} Material;

/* A texture: width x height texels from `first` on in a buffer of SpectrumCurve, rows from the bottom (v = 0) up;
   repeats outside 0..1; bilinear. */
typedef struct Texture {
  int first, width, height, pad_;
} Texture;

/* A reflectance spectrum by three coefficients: with t the wavelength over the visible range (360 to 830 nm) in 0..1
   and x = (c0 t + c1) t + c2, it is 1/2 + x / (2 sqrt(1 + x^2)). source: Jakob & Hanika, "A Low-Dimensional Function
   Space for Efficient Spectral Upsampling", EGSR 2019 */
typedef struct SpectrumCurve {
  scalar c0, c1, c2, pad_;
} SpectrumCurve;
