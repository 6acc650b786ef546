/* Exact Earth flattening: z = R ln(1 + h/R) maps a spherically layered medium to a flat one with index N = n (1 + h/R).
   The map is conformal, so elevations and turning points are unchanged and Bouguer's n r cos(e) becomes the horizontal
   momentum N cos(e). curvature_per_m = 1/R; 0 is a flat surface, where z = h. */

/* returns: z [m] for geometric height_m above the surface. Argument and result in double on the host. */
DEVICE double flattened_height_m(double height_m, double curvature_per_m) {
  return curvature_per_m > 0 ? log1p(height_m * curvature_per_m) / curvature_per_m : height_m;
}
DEVICE double geometric_height_m(double z_m, double curvature_per_m) {
  return curvature_per_m > 0 ? expm1(z_m * curvature_per_m) / curvature_per_m : z_m;
}
