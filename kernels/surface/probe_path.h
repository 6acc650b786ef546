/* One path or segment from memory to memory: the same on the device and on the host twin. */

DEVICE void store_vec3(scalar *out, Vec3 v) {
  out[0] = v.x;
  out[1] = v.y;
  out[2] = v.z;
}

DEVICE void trace_path(const Geometry *g, const Air *air, PathStart start, PathEnd *end) {
  Path path;
  path.place = vec3(start.place[0], start.place[1], start.place[2]);
  path.momentum = vec3(start.momentum[0], start.momentum[1], start.momentum[2]);
  path.row = start.row;
  path.glass = start.glass;
  path.measured = 1;
  SurfaceHit hit;
  hit.normal = vec3(R(0), R(0), R(0));
  hit.u = hit.v = R(0);
  hit.primitive = NO_PRIMITIVE;
  end->outcome = trace_to_surface(g, air, &path, &hit);
  store_vec3(end->place, hit.place);
  store_vec3(end->normal, hit.normal);
  store_vec3(end->momentum, hit.momentum);
  end->u = hit.u;
  end->v = hit.v;
  end->path_m = hit.path_m;
  end->transmission = hit.transmission;
  end->primitive = hit.primitive;
  end->pad_ = 0;
}

DEVICE void find_on_segment(const Geometry *g, Segment segment, SegmentHit *hit) {
  Chain chain;
  chain.arcs = 1;
  chain.from = R(0);
  chain.end = R(1);
  chain.arc[0].place = vec3(segment.place[0], segment.place[1], segment.place[2]);
  chain.arc[0].momentum = vec3(segment.direction[0], segment.direction[1], segment.direction[2]);
  chain.arc[0].bend = chain.arc[0].lag = chain.arc[0].from = chain.arc[0].start = R(0);
  chain.arc[0].end = R(1);
  Nearest nearest = nothing_before(R(1));
  find_nearest(g, &chain, &nearest);
  hit->sigma = nearest.sigma;
  hit->u = nearest.u;
  hit->v = nearest.v;
  hit->primitive = nearest.primitive;
}
