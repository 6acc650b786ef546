/* What the sky kernel is told. The transfer table has one entry per apparent elevation, evenly spaced, and in each
   entry SKY_CHANNEL_COUNT rows of SKY_WAVES numbers (wavelength fastest; padded to whole groups of LANES). */

enum SkyChannel {
  SKY_FROM_SUN = 0, /* true altitude minus that of the Sun's centre [rad] */
  SKY_SUN = 1,      /* radiance of the centre of the Sun's disk seen this way [W m^-2 sr^-1 nm^-1]; 0 off the sky */
  SKY_GLOW = 2,     /* radiance of sky or sea that does not depend on the angle from the Sun */
  SKY_AUREOLE = 3,  /* forward-scattered light, to be multiplied by the aerosol's phase function */
  SKY_JOINED = 4,   /* 1: interpolate to the next entry; less: the fraction of the way at which the outcome changes */
  SKY_CHANNEL_COUNT = 5
};

#define LIMB_TERMS 6

typedef struct SkyView {
  float sin_altitude, cos_altitude; /* of the picture's centre */
  float pixel_tangent;              /* tan of one pixel's angle at the centre */
  float centre_column, centre_row;  /* of the optical axis, in pixels of the whole picture */
  float first_elevation_rad, entries_per_rad;
  float sun_azimuth_rad;                    /* from the picture's centre, clockwise */
  float sun_sin_altitude, sun_cos_altitude; /* true altitude of its centre */
  float sun_radius_rad;
  float phase_asymmetry; /* Henyey & Greenstein's g of the aerosol */
  int entries;
  int width, rows;             /* of this band */
  int first_column, first_row; /* of this band in the whole picture: a crop has the same samples as the whole */
  unsigned int seed;
  int first_sample, samples; /* of this launch */
} SkyView;
